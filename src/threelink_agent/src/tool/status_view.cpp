#include "status_view.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>

#include <fmt/format.h>

#include "threelink_sim/excerpt.hpp"

namespace threelink_agent {
namespace {

using threelink_msgs::TrainingStatus;
using threelink_msgs::WorkerReport;

const char* state_of(const WorkerReport& worker) {
  switch (worker.state) {
    case WorkerReport::ALIVE:
      return "alive";
    case WorkerReport::GONE:
      return "gone";
    default:
      return "refused";
  }
}

double done(const TrainingStatus& status) {
  return status.updates > 0 ? double(status.update) / status.updates : 0;
}

bool finished(const TrainingStatus& status) { return status.update == status.updates; }

std::string time_left(const TrainingStatus& status) {
  if (finished(status)) return "finished";
  return status.steps_per_s > 0 ? duration(status.time_left) + " left" : "begins";
}

std::string speed(double steps_per_s) { return fmt::format("{:.1f} k steps/s", steps_per_s / 1e3); }

std::string policy(const TrainingStatus& status) {
  std::string text = fmt::format("return {:.3f}", status.mean_return);
  if (std::isfinite(status.speed))
    text += fmt::format("  speed {:.5f}", std::round(status.speed * 1e5) / 1e5 + 0.0);
  if (std::isfinite(status.success_rate))
    text += fmt::format("  success {:.1f} %", 100 * status.success_rate);
  return text;
}

std::string age_of(double age) {
  return age < kOldStatus ? "" : fmt::format("  (as of {} ago)", duration(age));
}

std::string workers(const TrainingStatus& status) {
  const auto count = [&](std::uint8_t state) {
    return std::count_if(status.worker_reports.begin(), status.worker_reports.end(),
                         [&](const WorkerReport& worker) { return worker.state == state; });
  };
  std::string text = fmt::format("{} worker{}", status.workers, status.workers == 1 ? "" : "s");
  if (const auto gone = count(WorkerReport::GONE)) text += fmt::format(", {} gone", gone);
  if (const auto refused = count(WorkerReport::REFUSED))
    text += fmt::format(", {} refused", refused);
  return text;
}

constexpr std::size_t kLongestName = 60, kLongestReason = 200;

// Names in one namespace are shown without it.
std::string last_part(const std::string& name) {
  return threelink_sim::excerpt(name.substr(name.rfind('/') + 1), kLongestName);
}

std::string host_of(const WorkerReport& worker) {
  return threelink_sim::excerpt(worker.host, kLongestName);
}

std::vector<std::string> table(std::vector<WorkerReport> reports, std::size_t room) {
  std::stable_sort(reports.begin(), reports.end(), [](const auto& a, const auto& b) {
    return a.state > b.state;  // refused, gone, alive
  });
  std::size_t name = 6, host = 4;
  for (const WorkerReport& worker : reports) {
    name = std::max(name, last_part(worker.name).size());
    host = std::max(host, host_of(worker).size());
  }
  std::vector<std::string> lines{fmt::format("{:<{}}  {:<{}}  {:<7} {:>9} {:>10} {:>5} {:>8} {:>7}",
                                             "worker", name, "host", host, "state", "episodes",
                                             "heard ago", "lost", "refused", "started")};
  for (const WorkerReport& worker : reports) {
    if (lines.size() + 1 >= room && lines.size() <= reports.size() - 1) break;
    std::string line =
        fmt::format("{:<{}}  {:<{}}  {:<7} {:>9} {:>10} {:>5} {:>8} {:>7}", last_part(worker.name),
                    name, host_of(worker), host, state_of(worker), worker.episodes,
                    fmt::format("{:.1f} s", worker.silence), worker.leases_lost,
                    worker.batches_refused, worker.instances);
    if (!worker.reason.empty())
      line += "  " + threelink_sim::excerpt(worker.reason, kLongestReason);
    lines.push_back(std::move(line));
  }
  if (const std::size_t left = reports.size() + 1 - lines.size())
    lines.push_back(fmt::format("and {} more", left));
  return lines;
}

}  // namespace

std::string status_line(const TrainingStatus& status, double age) {
  return fmt::format("{:3.0f} %  {}  update {}/{}  {} episodes  {}  {}  {}{}",
                     std::floor(100 * done(status)), time_left(status), status.update,
                     status.updates, status.episodes, speed(status.steps_per_s), policy(status),
                     workers(status), age_of(age));
}

std::vector<std::string> status_screen(const TrainingStatus& status, double age,
                                       const TerminalSize& size) {
  std::vector<std::string> lines{
      fmt::format("{} {:3.0f} %  {}{}", bar(done(status), 30), std::floor(100 * done(status)),
                  time_left(status), age_of(age)),
      fmt::format("update {}/{}  {} episodes  {} steps  {}", status.update, status.updates,
                  status.episodes, status.steps, speed(status.steps_per_s)),
      policy(status), fmt::format("{}", workers(status))};
  if (!status.worker_reports.empty()) {
    lines.push_back("");
    const std::size_t above = lines.size() + 1;  // and the line of the cursor
    const auto rows = table(status.worker_reports, size.rows > above ? size.rows - above : 0);
    lines.insert(lines.end(), rows.begin(), rows.end());
  }
  for (std::string& line : lines) line = line.substr(0, size.columns - 1);  // none may wrap
  return lines;
}

}  // namespace threelink_agent

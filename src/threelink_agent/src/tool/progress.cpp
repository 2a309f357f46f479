#include "progress.hpp"

#include <cmath>
#include <cstdio>

#include <fmt/format.h>
#include <unistd.h>

#include "terminal.hpp"

namespace threelink_agent {
namespace {

constexpr double kSmoothingTime = 3;  // [s] over which the shown steps/s are averaged

}  // namespace

Progress::Progress(const TrainConfig& config, std::uint32_t episodes, double seconds)
    : episodes_(config.episodes),
      terminal_(isatty(STDOUT_FILENO)),
      start_(Clock::now()),
      first_episode_(episodes),
      first_seconds_(seconds),
      last_seconds_(seconds),
      last_steps_(std::uint64_t{episodes} * config.environment.steps),
      tenths_(static_cast<int>(10.0 * episodes / config.episodes)) {}

Progress::~Progress() {
  if (terminal_) std::puts("");
}

double Progress::seconds() const {
  return first_seconds_ + std::chrono::duration<double>(Clock::now() - start_).count();
}

void Progress::show(const UpdateReport& report) {
  const double now = seconds();
  const double taken = now - last_seconds_;
  steps_per_s_ = (report.steps - last_steps_) / taken;
  const double weight = smoothed_ > 0 ? 1 - std::exp(-taken / kSmoothingTime) : 1;
  smoothed_ += weight * (steps_per_s_ - smoothed_);
  last_seconds_ = now;
  last_steps_ = report.steps;
  if (report.evaluation)  // + 0: not "-0.00000"
    speed_ = fmt::format("{:.5f}", std::round(report.evaluation->speed * 1e5) / 1e5 + 0.0);

  const double done = double(report.episodes) / episodes_;
  left_ =
      (now - first_seconds_) * (episodes_ - report.episodes) / (report.episodes - first_episode_);
  std::string text = fmt::format(
      "{}/{} episodes  {:.1f} k steps/s  return {:.3f}  speed {}  {} left", report.episodes,
      episodes_, smoothed_ / 1000, report.mean_return, speed_, duration(left_));
  if (report.poisoned > 0) text += fmt::format("  {} poisoned", report.poisoned);
  if (terminal_) {  // a longer line would wrap, and could not be redrawn in place
    const std::string line = fmt::format("{} {:3.0f} %  {}", bar(done), 100 * done, text);
    std::printf("\r\033[K%s", line.substr(0, terminal_size().columns - 1).c_str());
  } else if (static_cast<int>(10 * done) > tenths_) {
    tenths_ = static_cast<int>(10 * done);
    std::printf("%s\n", text.c_str());
  }
  std::fflush(stdout);
}

void Progress::warn(const std::string& text) {
  std::fprintf(stderr, "%swarning: %s\n", terminal_ ? "\r\033[K" : "", text.c_str());
}

}  // namespace threelink_agent

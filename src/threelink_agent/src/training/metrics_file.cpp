#include "threelink_agent/training/metrics_file.hpp"

#include <cerrno>
#include <system_error>

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>

namespace threelink_agent {
namespace {

constexpr char kHeader[] =
    "update,episodes,steps,seconds,steps_per_s,mean_return,policy_loss,value_loss,kl,"
    "clip_fraction,entropy,std,actor_learning_rate,critic_learning_rate,speed,efficiency,success,"
    "poisoned\n";

[[noreturn]] void fail(const std::string& path, const std::string& what) {
  throw threelink_sim::FileError(
      fmt::format("{}: cannot {}: {}", path, what, std::generic_category().message(errno)));
}

threelink_sim::Descriptor open_for_appending(const std::string& path, int flags) {
  threelink_sim::Descriptor file(path, O_WRONLY | O_APPEND | flags);
  if (!file) fail(path, "open");
  return file;
}

// One column, empty where there is no value.
std::string optional_column(bool known, double value) {
  return known ? fmt::format("{:.7f}", value) : "";
}

std::string row(const UpdateReport& report, double seconds, double steps_per_s) {
  const UpdateStatistics& s = report.statistics;
  const bool evaluated = report.evaluation.has_value();
  const Evaluation evaluation = report.evaluation.value_or(Evaluation{});
  return fmt::format("{},{},{},{:.3f},{:.0f},{:.6g},{:.6g},{:.6g},{:.6g},{:.6g},{:.6g},{:.6g},",
                     report.update, report.episodes, report.steps, seconds, steps_per_s,
                     report.mean_return, s.policy_loss, s.value_loss, s.kl, s.clip_fraction,
                     report.entropy, report.std) +
         fmt::format("{:.6g},{:.6g},{},{},{},{}\n", report.rates.actor, report.rates.critic,
                     optional_column(evaluated, evaluation.speed),
                     optional_column(evaluated, evaluation.efficiency),
                     optional_column(evaluation.trials > 0, evaluation.success_rate),
                     report.poisoned);
}

}  // namespace

MetricsFile::MetricsFile(const std::string& path)
    : path_(path), file_(open_for_appending(path, O_CREAT | O_TRUNC)), kept_(kHeader) {
  flush();
}

MetricsFile::MetricsFile(const std::string& path, std::uint64_t bytes)
    : path_(path), file_(open_for_appending(path, 0)), bytes_(bytes) {
  struct stat status {};
  ::fstat(file_.get(), &status);
  const auto size = static_cast<std::uint64_t>(status.st_size);
  if (size < bytes)
    throw threelink_sim::FileError(
        fmt::format("{}: {} bytes, but the checkpoint was made after {}", path, size, bytes));
  if (::ftruncate(file_.get(), static_cast<off_t>(bytes)) != 0) fail(path, "shorten");
}

void MetricsFile::add(const UpdateReport& report, double seconds, double steps_per_s) {
  kept_ += row(report, seconds, steps_per_s);
  flush();
}

void MetricsFile::flush() {
  std::size_t done = 0;
  while (done < kept_.size()) {
    const ssize_t written = ::write(file_.get(), &kept_[done], kept_.size() - done);
    if (written < 0 && errno == EINTR) continue;
    if (written < 0) {
      const int error = errno;
      // Without the piece of a row. Should this fail too, the next resume cuts it off.
      if (done > 0 && ::ftruncate(file_.get(), static_cast<off_t>(bytes_)) != 0) errno = error;
      errno = error;
      fail(path_, fmt::format("write {} bytes", kept_.size()));
    }
    done += static_cast<std::size_t>(written);
  }
  bytes_ += kept_.size();
  kept_.clear();
}

void MetricsFile::sync() const {
  // Some file systems cannot, and say so.
  if (::fsync(file_.get()) != 0 && errno != EINVAL) fail(path_, "sync");
}

}  // namespace threelink_agent

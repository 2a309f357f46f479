#include "progress.hpp"

#include <cstdio>
#include <string>

#include <fmt/format.h>
#include <sys/ioctl.h>
#include <unistd.h>

namespace threelink_agent {
namespace {

std::string bar(double done) {
  constexpr int kWidth = 12;
  const int filled = static_cast<int>(done * kWidth);
  return "[" + std::string(filled, '#') + std::string(kWidth - filled, '.') + "]";
}

std::string duration(double seconds) {
  const auto s = static_cast<long>(seconds + 0.5);
  if (s < 120) return fmt::format("{} s", s);
  return s < 7200 ? fmt::format("{} min", s / 60)
                  : fmt::format("{} h {} min", s / 3600, s % 3600 / 60);
}

// A longer line would wrap, and could not be redrawn in place.
std::size_t terminal_width() {
  winsize size{};
  ioctl(STDOUT_FILENO, TIOCGWINSZ, &size);
  return size.ws_col > 0 ? size.ws_col : 80;
}

}  // namespace

Progress::Progress(const TrainConfig& config)
    : episodes_(config.episodes), terminal_(isatty(STDOUT_FILENO)), start_(Clock::now()) {}

Progress::~Progress() {
  if (terminal_) std::puts("");
}

double Progress::seconds() const {
  return std::chrono::duration<double>(Clock::now() - start_).count();
}

void Progress::show(const UpdateReport& report) {
  const double now = seconds();
  steps_per_s_ = (report.steps - last_steps_) / (now - last_seconds_);
  last_seconds_ = now;
  last_steps_ = report.steps;
  if (report.evaluation) speed_ = fmt::format("{:.5f}", report.evaluation->speed);

  const double done = double(report.episodes) / episodes_;
  const std::string text = fmt::format(
      "{}/{} episodes  {:.1f} k steps/s  return {:.3f}  speed {}  {} left", report.episodes,
      episodes_, steps_per_s_ / 1000, report.mean_return, speed_, duration(now / done - now));
  if (terminal_) {
    const std::string line = fmt::format("{} {:3.0f} %  {}", bar(done), 100 * done, text);
    std::printf("\r\033[K%s", line.substr(0, terminal_width() - 1).c_str());
  } else if (static_cast<int>(10 * done) > tenths_) {
    tenths_ = static_cast<int>(10 * done);
    std::printf("%s\n", text.c_str());
  }
  std::fflush(stdout);
}

}  // namespace threelink_agent

#include "terminal.hpp"

#include <algorithm>
#include <cstdio>

#include <fmt/format.h>
#include <sys/ioctl.h>
#include <unistd.h>

namespace threelink_agent {

void say(const std::string& text) { std::fputs(text.c_str(), stdout); }
void complain(const std::string& text) { std::fputs(text.c_str(), stderr); }

std::string duration(double seconds) {
  constexpr double kMost = 1e9;
  if (!(seconds >= 0 && seconds <= kMost)) return "some time";
  const auto s = static_cast<long>(seconds + 0.5);
  if (s < 120) return fmt::format("{} s", s);
  return s < 7200 ? fmt::format("{} min", s / 60)
                  : fmt::format("{} h {} min", s / 3600, s % 3600 / 60);
}

std::string bar(double done, int width) {
  const int filled = std::clamp(static_cast<int>(std::clamp(done, 0.0, 1.0) * width), 0, width);
  return "[" + std::string(filled, '#') + std::string(width - filled, '.') + "]";
}

TerminalSize terminal_size() {
  winsize size{};
  ioctl(STDOUT_FILENO, TIOCGWINSZ, &size);
  return {size.ws_col > 0 ? size.ws_col : 80u, size.ws_row > 0 ? size.ws_row : 24u};
}

}  // namespace threelink_agent

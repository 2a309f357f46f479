#include "threelink_sim/node/quiet_log.hpp"

#include <fmt/format.h>
#include <ros/console.h>

#include "threelink_sim/excerpt.hpp"

namespace threelink_sim {

void QuietLog::say(const std::string& text, bool error) {
  constexpr std::chrono::seconds kPause(10);
  constexpr std::size_t kLongest = 1000;
  const Lock lock(mutex_);
  const auto now = std::chrono::steady_clock::now();
  if (said_ && now - last_ < kPause) {
    ++left_out_;
    return;
  }
  std::string line = excerpt(text, kLongest);
  if (left_out_ > 0) line += fmt::format(" (and {} more since)", left_out_);
  said_ = true;
  last_ = now;
  left_out_ = 0;
  if (error)
    ROS_ERROR("%s", line.c_str());
  else
    ROS_WARN("%s", line.c_str());
}

}  // namespace threelink_sim

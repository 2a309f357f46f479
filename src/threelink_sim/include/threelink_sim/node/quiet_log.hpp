/// @file
/// A log with a limited rate, for events of which there may be thousands per second.
#pragma once

#include <chrono>
#include <cstdint>
#include <string>

#include "threelink_sim/mutex.hpp"

namespace threelink_sim {

/// Logs the first message immediately, and then one in ten seconds of wall time with the number of
/// suppressed ones. Text is passed through excerpt(). Thread-safe.
class QuietLog {
 public:
  void warn(const std::string& text) { say(text, false); }
  void error(const std::string& text) { say(text, true); }

 private:
  void say(const std::string& text, bool error);

  Mutex mutex_;
  bool said_ GUARDED_BY(mutex_) = false;
  std::chrono::steady_clock::time_point last_ GUARDED_BY(mutex_);
  std::uint64_t left_out_ GUARDED_BY(mutex_) = 0;
};

}  // namespace threelink_sim

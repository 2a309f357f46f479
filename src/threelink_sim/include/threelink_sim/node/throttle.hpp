/// @file
/// Limits the rate of a repeated output in wall time without losing the last one.
#pragma once

#include <chrono>
#include <cstdint>

namespace threelink_sim {

/// The limiter. The owner calls request(), and take() at deadline().
class Throttle {
 public:
  using Time = std::chrono::steady_clock::time_point;

  /// rate [1/s], > 0
  explicit Throttle(double rate)
      : interval_(std::chrono::nanoseconds(static_cast<std::int64_t>(1e9 / rate))) {}

  /// Records that there is new output.
  void request() { pending_ = true; }
  /// Returns true if it is to be published now.
  bool take(Time now) {
    if (now < deadline()) return false;
    pending_ = false;
    next_ = now + interval_;
    return true;
  }
  /// When to call take() at the latest; Time::max() if nothing is pending.
  Time deadline() const { return pending_ ? next_ : Time::max(); }

 private:
  std::chrono::steady_clock::duration interval_;
  bool pending_ = false;
  Time next_ = Time::min();
};

}  // namespace threelink_sim

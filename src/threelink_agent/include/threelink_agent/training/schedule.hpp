/// @file
/// Schedules of a training. progress in [0, 1) is the fraction of the updates that are done.
#pragma once

#include <algorithm>
#include <cmath>

namespace threelink_agent {

/// Learning rate, linear in the progress from `initial` to `initial * final_fraction`.
inline double annealed(double initial, double final_fraction, double progress) {
  return initial * (1 - (1 - final_fraction) * progress);
}

/// Standard deviation of the exploration noise [1/T0]: its logarithm is linear in the progress from
/// `initial` to `final` at progress `fraction`, and constant after that.
inline double decayed_std(double initial, double final, double fraction, double progress) {
  const double s = std::min(1.0, progress / fraction);
  return std::exp((1 - s) * std::log(initial) + s * std::log(final));
}

}  // namespace threelink_agent

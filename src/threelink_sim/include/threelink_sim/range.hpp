/// @file
/// Bounds of a number and their text.
#pragma once

#include <string>

namespace threelink_sim {

/// An interval. Each end is closed unless it is marked as open.
template <class T>
struct Range {
  T low;
  T high;
  bool low_open = false;
  bool high_open = false;

  /// Whether the value is in the interval; false for NaN.
  bool contains(T value) const {
    return (low_open ? value > low : value >= low) && (high_open ? value < high : value <= high);
  }
  /// Text such as "in (0, 10]".
  std::string text() const;
};

}  // namespace threelink_sim

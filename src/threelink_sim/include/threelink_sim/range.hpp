/// @file
/// Bounds of a number, and their words.
#pragma once

#include <string>

namespace threelink_sim {

/// An interval, closed unless an end is said to be open.
template <class T>
struct Range {
  T low;
  T high;
  bool low_open = false;
  bool high_open = false;

  /// False for NaN.
  bool contains(T value) const {
    return (low_open ? value > low : value >= low) && (high_open ? value < high : value <= high);
  }
  /// Such as "in (0, 10]".
  std::string text() const;
};

}  // namespace threelink_sim

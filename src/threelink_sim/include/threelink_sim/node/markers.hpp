/// @file
/// What the displays of rviz share.
#pragma once

#include <std_msgs/ColorRGBA.h>

namespace threelink_sim {

/// A colour of red, green, blue and opacity, each in [0, 1].
inline std_msgs::ColorRGBA colour(double r, double g, double b, double a = 1.0) {
  std_msgs::ColorRGBA result;
  result.r = static_cast<float>(r);
  result.g = static_cast<float>(g);
  result.b = static_cast<float>(b);
  result.a = static_cast<float>(a);
  return result;
}

}  // namespace threelink_sim

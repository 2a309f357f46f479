/// @file
/// The robot description of the N-link swimmer, for robot_state_publisher and rviz.
///
/// base_link is the heading link's frame: origin at its midpoint, x along it. From there the joints
/// go outwards, so that their angles are alpha_j = theta_{j+1} - theta_j: hinges ahead of the
/// heading link turn about +z, those behind it, where link j hangs on link j + 1, about -z.
#pragma once

#include <string>

#include "threelink_sim/model.hpp"

namespace threelink_sim {

struct RobotDescription {
  Model model;
  double length_scale = 1.0;  ///< [m] of one L
  double time_scale = 1.0;    ///< [s] of one T0
};

/// As URDF.
std::string urdf(const RobotDescription& robot);

}  // namespace threelink_sim

/// @file
/// The robot description of the N-link swimmer, for robot_state_publisher and rviz.
///
/// base_link is the heading link's frame: origin at its midpoint, x along it. The joints proceed
/// outwards from there. Their angles are alpha_j = theta_{j+1} - theta_j: hinges ahead of the
/// heading link turn about +z; hinges behind it, where link j is the child of link j + 1, turn
/// about -z.
#pragma once

#include <string>

#include "threelink_sim/model.hpp"

namespace threelink_sim {

/// The swimmer and its units.
struct RobotDescription {
  Model model;
  double length_scale = 1.0;  ///< [m] of one L
  double time_scale = 1.0;    ///< [s] of one T0
};

/// The URDF of the robot.
std::string urdf(const RobotDescription& robot);

}  // namespace threelink_sim

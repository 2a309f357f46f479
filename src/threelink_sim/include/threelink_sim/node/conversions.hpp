/// @file
/// Conversion of the swimmer's state to messages. threelink_msgs/SwimmerState holds the complete
/// state in dimensionless units; the standard messages are derived from it in SI units (REP-103).
#pragma once

#include <geometry_msgs/PoseStamped.h>
#include <geometry_msgs/TransformStamped.h>
#include <sensor_msgs/JointState.h>
#include <threelink_msgs/Observation.h>
#include <threelink_msgs/SwimmerState.h>
#include <threelink_msgs/WorldState.h>

#include "threelink_sim/environment.hpp"

namespace threelink_sim {

/// SI values of the paper's units.
struct Scales {
  double length = 1.0;  ///< [m] of one L
  double time = 1.0;    ///< [s] of one T0
};

/// Whether a received state is valid: one link more than hinges, at most kMaxLinks, a rate for each
/// hinge or none, and only finite numbers.
bool well_formed(const threelink_msgs::SwimmerState& state);

/// Fills all fields but header, episode and step without rounding, so that the state can be read
/// back to the bit.
void to_message(const Model& model, const StepRecord& record, threelink_msgs::SwimmerState& out);
/// Likewise, for an environment of one lane.
void to_message(const Environment& environment, const StepRecord& record,
                threelink_msgs::WorldState& out);
/// Fills all fields but header, episode and step with the observation of an environment of one
/// lane.
void to_message(const Environment& environment, threelink_msgs::Observation& out);

/// Fills all of `out`, including the stamp; `out` may be reused. Joints hinge_1 .. hinge_{N-1}:
/// [rad], [rad/s].
void to_joint_state(const threelink_msgs::SwimmerState& state, const Scales& scales,
                    sensor_msgs::JointState& out);
/// Centroid [m] and orientation of the heading link, in `world`.
void to_pose(const threelink_msgs::SwimmerState& state, const Scales& scales,
             geometry_msgs::PoseStamped& out);
/// world -> base_link: midpoint [m] and orientation of the heading link.
void to_transform(const threelink_msgs::SwimmerState& state, const Scales& scales,
                  geometry_msgs::TransformStamped& out);

/// [L] midpoint of link i, from 0.
Eigen::Vector2d link_midpoint(const threelink_msgs::SwimmerState& state, int i);

/// Rotation by an angle [rad] about z.
geometry_msgs::Quaternion yaw_quaternion(double angle);

}  // namespace threelink_sim

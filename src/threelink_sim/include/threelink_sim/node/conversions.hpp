/// @file
/// From the swimmer's state to messages. threelink_msgs/SwimmerState holds all that is known of a
/// state, without units of measure; the standard messages follow from it, in SI units (REP-103).
#pragma once

#include <geometry_msgs/PoseStamped.h>
#include <geometry_msgs/TransformStamped.h>
#include <sensor_msgs/JointState.h>
#include <threelink_msgs/Observation.h>
#include <threelink_msgs/SwimmerState.h>
#include <threelink_msgs/WorldState.h>

#include "threelink_sim/environment.hpp"

namespace threelink_sim {

/// What the units of the paper measure.
struct Scales {
  double length = 1.0;  ///< [m] of one L
  double time = 1.0;    ///< [s] of one T0
};

/// Whether a state that came by a topic can be used: one link more than hinges, at most kMaxLinks,
/// a rate for each hinge or none, and nothing but finite numbers.
bool well_formed(const threelink_msgs::SwimmerState& state);

/// Fills all but header, episode and step, unrounded: the state can be read back to the bit.
void to_message(const Model& model, const StepRecord& record, threelink_msgs::SwimmerState& out);
/// Likewise, of an environment of one lane.
void to_message(const Environment& environment, const StepRecord& record,
                threelink_msgs::WorldState& out);
/// Fills all but header, episode and step with what is observed in an environment of one lane.
void to_message(const Environment& environment, threelink_msgs::Observation& out);

/// Each fills all of `out`, the stamp included; `out` may be used again and again.
/// Joints hinge_1 .. hinge_{N-1}: [rad], [rad/s].
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

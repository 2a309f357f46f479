/// @file
/// One swimmer: its state, its motion under given hinge rates, and stepping.
///
/// Uses the kernels of kernel/kernels.hpp with one lane and therefore agrees with Batch to the bit.
#pragma once

#include <Eigen/Core>

#include "threelink_sim/model.hpp"

namespace threelink_sim {

/// The state that evolves. The free end x_1 and the link angles follow from it (below).
struct SwimmerState {
  Eigen::Vector2d centroid = Eigen::Vector2d::Zero();  ///< [L] x_c, mean of the link midpoints
  double heading = 0.0;                                ///< [rad] angle of the heading link
  HingeVector alpha;                                   ///< [rad] (N-1) hinge angles
};

/// The state for the paper's coordinates: x_1 [L] free end of link 1 (fixed frame), theta_1 [rad]
/// its angle, alpha [rad] (N-1) hinge angles.
SwimmerState state_from_free_end(const Model& model, const Eigen::Vector2d& x_1, double theta_1,
                                 const HingeVector& alpha);
/// [L] free end x_1 of link 1, fixed frame.
Eigen::Vector2d free_end(const Model& model, const SwimmerState& state);

/// [rad] (N) theta_i of each link; theta[heading_link] is exactly state.heading.
LinkVector link_angles(const Model& model, const SwimmerState& state);

/// [L] (2, N) midpoint of each link, fixed frame.
Eigen::Matrix2Xd link_midpoints(const Model& model, const SwimmerState& state);

/// Throws std::invalid_argument that names field, value and bound if the state is not finite, has
/// the wrong number of hinges, or an angle beyond the joint limit.
void validate(const Model& model, const SwimmerState& state);

/// Motion of the swimmer in a given shape with given hinge rates, in the body frame: origin at the
/// centroid, x along the heading link.
struct BodyMotion {
  Eigen::Vector2d velocity;  ///< [L/T0] of the centroid
  double spin;               ///< [rad/T0] of the heading link
  double power;              ///< [C_perp L^3/T0^2] rate of work on the fluid, Phi
};

/// Solves for the motion without net force and torque. alpha [rad] (N-1), rates [rad/T0] (N-1).
BodyMotion body_motion(const Model& model, const HingeVector& alpha, const HingeVector& rates);

/// The 3x3 body-frame resistance about the centroid: (force, torque) on the fluid = K (velocity,
/// spin) for a rigid shape. [C_perp L, C_perp L^2, C_perp L^3]; symmetric positive definite.
Eigen::Matrix3d resistance_matrix(const Model& model, const HingeVector& alpha);

/// Net hydrodynamic force [C_perp L^2/T0] (x, y) and torque about the centroid [C_perp L^3/T0] on a
/// swimmer that moves with `motion`, summed link by link: zero for the motion of body_motion().
Eigen::Vector3d net_force_and_torque(const Model& model, const HingeVector& alpha,
                                     const HingeVector& rates, const BodyMotion& motion);

/// Result of one action step.
struct StepResult {
  HingeVector rates;             ///< [1/T0] applied, after the joint limit
  Eigen::Vector2d displacement;  ///< [L] of the centroid, fixed frame
  double work;                   ///< [C_perp L^3/T0] W done on the fluid
};

/// Advances the state by dt [T0] with constant rates [1/T0] (N-1), which must be finite. A rate
/// that would pass the joint limit is reduced so that the angle ends exactly on it. `substeps` is
/// the number that substeps() returns.
StepResult advance(const Model& model, SwimmerState& state, const HingeVector& rates, double dt,
                   int substeps);

}  // namespace threelink_sim

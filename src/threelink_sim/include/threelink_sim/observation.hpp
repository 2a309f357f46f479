/// @file
/// What the agent is shown of the swimmer and its target.
///
/// theta_d = theta_a - theta_T is the angle of the swimmer's axis against the direction to the
/// target, p = (cos theta_T, sin theta_T), and r the distance to it. The axis is that of the middle
/// link, theta_a = theta_h; an even number of links has two in the middle, of which it takes the
/// mean, theta_a = (theta_{N/2} + theta_{N/2+1}) / 2 = theta_h - alpha_{N/2} / 2. So it turns by
/// pi, and no more, if the links are counted from the other end, which symmetry.hpp of
/// threelink_agent relies on. N links:
///
///   direction  cos theta_d, sin theta_d, alpha_1 .. alpha_{N-1}         (the paper's)
///   target     the same, then w cos theta_d, w sin theta_d, (ln r + 4) / 2
///              with r clipped to [kNearest, kFarthest] and w = tanh(r / 0.1)
///
/// Far away "target" says no more than "direction"; near by it says how near, and the direction,
/// which then swings within a stroke, loses its weight.
#pragma once

#include <string>

#include <Eigen/Core>

#include "threelink_sim/model.hpp"
#include "threelink_sim/words.hpp"

namespace threelink_sim {

/// Kind of observation.
enum class ObservationKind { kDirection, kTarget };

constexpr double kNearest = 5e-4;  ///< [L] lower bound of r
constexpr double kFarthest = 0.5;  ///< [L] upper bound of r

/// The names of the kinds.
Words<ObservationKind> words_of(ObservationKind);
std::string to_string(ObservationKind kind);  ///< "direction", "target"
/// Throws std::invalid_argument that names the kinds.
ObservationKind observation_kind_from_string(const std::string& name);

/// Number of components of an observation: N + 1 or N + 4.
int observation_size(ObservationKind kind, const Model& model);

/// Unit vector p = (x_T - x_c) / |x_T - x_c| from the centroid to the target, and the distance.
/// Does not overflow: any finite target has a finite direction, and the distance is limited to the
/// largest double. For a target on the centroid the direction is the previous one.
struct TargetDirection {
  Eigen::Vector2d p;  ///< [1]
  double distance;    ///< in the unit of the arguments, [L]
};
/// The direction from `centroid` to `target` [L], fixed frame. `previous` [1] is the result for a
/// target on the centroid.
TargetDirection target_direction(const Eigen::Vector2d& centroid, const Eigen::Vector2d& target,
                                 const Eigen::Vector2d& previous);

}  // namespace threelink_sim

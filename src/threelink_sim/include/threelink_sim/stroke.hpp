/// @file
/// A stroke: hinge rates over one period, after which the swimmer has its initial shape again.
#pragma once

#include <vector>

#include "threelink_sim/swimmer.hpp"

namespace threelink_sim {

/// The period consists of pieces of length dt with constant rates.
struct Stroke {
  Model model;
  double dt = 0.1;                 ///< [T0]
  HingeVector start;               ///< [rad] (N-1) initial hinge angles
  std::vector<HingeVector> rates;  ///< [1/T0] (N-1) for each piece

  int pieces() const { return static_cast<int>(rates.size()); }
  double period() const { return pieces() * dt; }

  /// Throws std::invalid_argument that names field, value and bound: the model, rates within
  /// [-1, 1], angles within the joint limit, and the shape closed to within 1e-9 rad.
  void validate() const;
};

/// [rad] hinge angles at the start and after each piece: pieces() + 1 vectors.
std::vector<HingeVector> hinge_angles(const Stroke& stroke);

/// Result of one period of a swimmer whose centroid and heading are initially 0.
struct StrokeMeasures {
  Eigen::Vector2d displacement;  ///< [L] of the centroid
  double rotation;               ///< [rad]
  double work;                   ///< [C_perp L^3/T0]
  double speed;                  ///< [L/T0] |displacement| / period
  double power;                  ///< [C_perp L^3/T0^2] Phi = work / period
  double efficiency;             ///< gamma speed^2 / power
};

/// Plays one period. A swimmer whose stroke rotates it moves in a circle; `speed` is then that of
/// the first period only.
StrokeMeasures measure(const Stroke& stroke);

/// The start, with the centroid at the origin, from which the net displacement points along +x.
SwimmerState aligned_start(const Stroke& stroke);

/// [L/T0] of the fastest stroke of 3 to 8 links with gamma = 1/2 and rates within [-1, 1], as
/// optimal_stroke finds it (docs/links.md); NaN for other numbers of links.
double fastest_speed(int links);

/// Purcell's stroke: the outer hinges swing between angles low < high [rad], one at a time at rate
/// 1, clockwise in the plane (first hinge, last hinge) from (low, low), so that `pieces`, a
/// multiple of 4, are equal. All other hinges stay straight.
Stroke square_stroke(const Model& model, double low, double high, int pieces);

}  // namespace threelink_sim

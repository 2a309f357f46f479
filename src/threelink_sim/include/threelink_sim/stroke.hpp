// A stroke: hinge rates over one period, after which the swimmer has its first shape again.
#pragma once

#include <vector>

#include "threelink_sim/swimmer.hpp"

namespace threelink_sim {

// The period is cut into pieces of length dt, in each of which the rates are held.
struct Stroke {
  Model model;
  double dt = 0.1;                 // [T0]
  HingeVector start;               // [rad] (N-1) hinge angles in the beginning
  std::vector<HingeVector> rates;  // [1/T0] one (N-1) a piece

  int pieces() const { return static_cast<int>(rates.size()); }
  double period() const { return pieces() * dt; }

  // Throws std::invalid_argument that names field, value and bound: the model, rates within
  // [-1, 1], angles within the joint limit, and the shape closed to within 1e-9 rad.
  void validate() const;
};

// [rad] hinge angles in the beginning and after each piece: pieces() + 1 of them.
std::vector<HingeVector> hinge_angles(const Stroke& stroke);

// What one period does, for a swimmer with centroid and heading 0 in the beginning.
struct StrokeMeasures {
  Eigen::Vector2d displacement;  // [L] of the centroid
  double rotation;               // [rad]
  double work;                   // [C_perp L^3/T0]
  double speed;                  // [L/T0] |displacement| / period
  double power;                  // [C_perp L^3/T0^2] Phi = work / period
  double efficiency;             // gamma speed^2 / power
};

// Plays one period. A swimmer whose stroke turns it goes round in a circle: `speed` is then that of
// the first period only.
StrokeMeasures measure(const Stroke& stroke);

// Where a period starts so that its net displacement points along +x: centroid at the origin.
SwimmerState aligned_start(const Stroke& stroke);

// [L/T0] of the fastest stroke of 3 to 8 links with gamma = 1/2 and rates within [-1, 1], as
// optimal_stroke finds it (docs/links.md); NaN for other numbers of links.
double fastest_speed(int links);

// Purcell's stroke: the outer hinges swing between angles low < high [rad], one at a time at rate
// 1, clockwise in the plane (first hinge, last hinge) from (low, low), so that `pieces`, a multiple
// of 4, are equal. All other hinges stay straight.
Stroke square_stroke(const Model& model, double low, double high, int pieces);

}  // namespace threelink_sim

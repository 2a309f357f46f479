/// @file
/// Optimal strokes by direct transcription: what a policy can be compared with.
///
/// Unknown are the first shape, the period, and the rates of each piece. Sought is the largest
/// value of the objective over strokes that close, do not turn the swimmer, and keep rates within
/// [-1, 1] and angles within the joint limit. NLopt's SLSQP (Kraft 1988) climbs from random starts,
/// so that what is found is a local optimum: the best of those that the starts lead to.
#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "threelink_sim/stroke.hpp"

namespace threelink_sim {

enum class Objective {
  kSpeed,        ///< v = |displacement| / period
  kEfficiency,   ///< gamma v^2 / Phi; the period is then the shortest that the rates allow
  kEnergyAware,  ///< b v - c Phi
};

struct StrokeSearch {
  Model model;  ///< of 3 links at least: one hinge leads nowhere
  Objective objective = Objective::kSpeed;
  double b = 6.0;          ///< weight of the speed, > 0
  double c = 3.0;          ///< weight of the power, in [0, 4 b]: beyond, rest attracts
  int pieces = 120;        ///< of the period, in [8, 1000]
  double dt = 0;           ///< [T0] length of a piece; 0: free, else it decides on the pieces
  int starts = 8;          ///< in [1, 1000]
  std::uint64_t seed = 0;  ///< keys the starts

  /// Throws std::invalid_argument that names field, value and bound.
  void validate() const;
};

/// Where a climb is.
struct ClimbStep {
  int evaluation;    ///< counted from 1
  double value;      ///< of the objective
  double violation;  ///< largest of the constraints: [rad], rates by their bounds exactly
};

struct Climb {
  std::string name;  ///< "start 3", "refinement"
  int pieces = 0;
  bool converged = false;
  double value = 0;  ///< of the objective, at the end
  double seconds = 0;
  std::vector<ClimbStep> history;
};

struct OptimalStroke {
  Stroke stroke;
  double value = 0;           ///< of the objective
  std::vector<Climb> climbs;  ///< from each start on a coarse grid, then from the best of them
};

/// The objective of a stroke as it is played.
double objective_value(const StrokeSearch& search, const StrokeMeasures& measures);

using ClimbWatch = std::function<void(const Climb&)>;

/// Calls `on_step` after each step of a climb, `on_end` after each climb. Throws
/// std::invalid_argument for a bad search, and std::runtime_error if no climb converges.
OptimalStroke find_optimal_stroke(const StrokeSearch& search, const ClimbWatch& on_step,
                                  const ClimbWatch& on_end);

}  // namespace threelink_sim

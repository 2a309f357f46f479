/// @file
/// Optimal strokes by direct transcription, as a reference for policies.
///
///
/// The unknowns are the first shape, the period, and the hinge rates of each piece. The objective
/// is maximised over strokes that close, do not rotate the swimmer, and keep rates within [-1, 1]
/// and angles within the joint limit. NLopt's SLSQP (Kraft 1988) climbs from random starts. The
/// result is the best of the local optima that it reaches.
#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "threelink_sim/stroke.hpp"

namespace threelink_sim {

/// Quantity to maximise.
enum class Objective {
  kSpeed,        ///< v = |displacement| / period
  kEfficiency,   ///< gamma v^2 / Phi; with the shortest period that the rates allow
  kEnergyAware,  ///< b v - c Phi
};

/// The problem and the effort of the search.
struct StrokeSearch {
  Model model;  ///< at least 3 links: a swimmer with one hinge has no net motion
  Objective objective = Objective::kSpeed;
  double b = 6.0;          ///< weight of the speed, > 0
  double c = 3.0;          ///< weight of the power, in [0, 4 b]: above, the optimum is rest
  int pieces = 120;        ///< pieces of the period, in [8, 1000]
  double dt = 0;           ///< [T0] length of a piece, which determines their number; 0: free
  int starts = 8;          ///< number of random starts, in [1, 1000]
  std::uint64_t seed = 0;  ///< keys the starts

  /// Throws std::invalid_argument that names field, value and bound.
  void validate() const;
};

/// State of a climb.
struct ClimbStep {
  int evaluation;    ///< counted from 1
  double value;      ///< objective
  double violation;  ///< largest violation of a constraint [rad]; rates obey their bounds exactly
};

/// One run of the optimiser.
struct Climb {
  std::string name;  ///< such as "start 3" or "refinement"
  int pieces = 0;
  bool converged = false;
  double value = 0;  ///< objective at the end
  double seconds = 0;
  std::vector<ClimbStep> history;
};

/// Result of a search.
struct OptimalStroke {
  Stroke stroke;
  double value = 0;           ///< objective
  std::vector<Climb> climbs;  ///< from each start on a coarse grid, then from the best of them
};

/// The objective of a played stroke.
double objective_value(const StrokeSearch& search, const StrokeMeasures& measures);

/// Receives the state of a climb.
using ClimbWatch = std::function<void(const Climb&)>;

/// Calls `on_step` after each step of a climb, `on_end` after each climb. Throws
/// std::invalid_argument for a bad search, and std::runtime_error if no climb converges.
OptimalStroke find_optimal_stroke(const StrokeSearch& search, const ClimbWatch& on_step,
                                  const ClimbWatch& on_end);

}  // namespace threelink_sim

/// @file
/// What a stroke does, with its derivatives: the product's physics over dual numbers.
#pragma once

#include <Eigen/Core>

#include "threelink_sim/model.hpp"

namespace threelink_sim {

/// A stroke as the search sees it: hinge angles in the beginning, length of a piece, and the rates.
struct StrokeVariables {
  HingeVector start;      ///< [rad] (N-1)
  double dt;              ///< [T0]
  Eigen::MatrixXd rates;  ///< [1/T0] (N-1, pieces)
};

/// A number that a stroke has, and its derivatives by the variables.
struct StrokeQuantity {
  double value = 0;
  StrokeVariables by;
};

struct StrokeOutcome {
  StrokeQuantity distance;  ///< [L] |displacement| of the centroid in a period
  StrokeQuantity rotation;  ///< [rad]
  StrokeQuantity work;      ///< [C_perp L^3/T0]
};

/// The motion of a piece depends on the angles that it goes through alone, and its work is
/// inversely proportional to dt: each piece is differentiated by its first angles and its change of
/// angles, at dt = 1, and the rest is the chain rule. `dt` times each rate must be below 1e6.
StrokeOutcome stroke_outcome(const Model& model, const StrokeVariables& variables);

}  // namespace threelink_sim

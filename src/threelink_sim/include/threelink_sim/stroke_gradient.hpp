/// @file
/// The result of a stroke with its derivatives, by the same physics over dual numbers.
#pragma once

#include <Eigen/Core>

#include "threelink_sim/model.hpp"

namespace threelink_sim {

/// The unknowns of a stroke: initial hinge angles, length of a piece, and rates.
struct StrokeVariables {
  HingeVector start;      ///< [rad] (N-1)
  double dt;              ///< [T0]
  Eigen::MatrixXd rates;  ///< [1/T0] (N-1, pieces)
};

/// A result of a stroke and its derivatives with respect to the variables.
struct StrokeQuantity {
  double value = 0;
  StrokeVariables by;
};

/// The results of one period.
struct StrokeOutcome {
  StrokeQuantity distance;  ///< [L] |displacement| of the centroid in a period
  StrokeQuantity rotation;  ///< [rad]
  StrokeQuantity work;      ///< [C_perp L^3/T0]
};

/// Computes the results. The motion of a piece depends only on the sequence of its angles, and its
/// work is inversely proportional to dt. Therefore each piece is differentiated with respect to its
/// first angles and its change of angles at dt = 1; the rest is the chain rule. `dt` times each
/// rate must be below 1e6.
StrokeOutcome stroke_outcome(const Model& model, const StrokeVariables& variables);

}  // namespace threelink_sim

/// @file
/// The stroke in a series of shapes, of any number of links: where it begins, and how long it
/// takes.
///
/// A stroke is one turn of the shape around its mean, in the plane in which the shapes spread most:
/// that of their first two principal components. Three links have but one plane, (alpha_1,
/// alpha_2).
#pragma once

#include <Eigen/Core>

namespace threelink_sim {

/// One position a column.
using Way = Eigen::Matrix2Xd;

/// The hinge angles (N-1, n) [rad] of n states, a step apart, as seen in that plane; those of three
/// links as they are. A single hinge only goes to and fro.
Way in_stroke_plane(const Eigen::MatrixXd& angles);

/// The whole strokes of a way.
struct WholeStrokes {
  int count;
  double steps;  ///< from the beginning of the first of them to the end of the way
};

/// The strokes that end with the way. If there are none, the way has no period, and `steps` is all
/// of it.
WholeStrokes whole_strokes(const Way& way);

/// [steps] mean of the whole strokes; NaN if there are none.
double stroke_period(const Eigen::MatrixXd& angles);

/// [positions] about a stroke of three links.
constexpr int kSmoothing = 71;

/// The number of positions, odd, whose mean is free of the stroke's oscillation: the one next to
/// the period. It is kSmoothing without a stroke, and always for three links: the published
/// measures of these use it.
int smoothing(const Eigen::MatrixXd& angles);

}  // namespace threelink_sim

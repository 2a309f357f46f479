#include "threelink_sim/stroke_period.hpp"

#include <cmath>
#include <limits>

#include <Eigen/Eigenvalues>

#include "threelink_sim/model.hpp"

namespace threelink_sim {
namespace {

// [rad] the change from a to b, in [-pi, pi].
double turn(double a, double b) { return std::remainder(b - a, 2 * kPi); }

}  // namespace

Way in_stroke_plane(const Eigen::MatrixXd& angles) {
  const Eigen::Index hinges = angles.rows();
  if (hinges <= 2) {
    Way way = Way::Zero(2, angles.cols());
    way.topRows(hinges) = angles;
    return way;
  }
  const Eigen::MatrixXd spread = angles.colwise() - angles.rowwise().mean();
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> components(spread * spread.transpose());
  Way way = components.eigenvectors().rightCols<2>().transpose() * spread;
  // Shapes on a line have only rounding beside it, which would go round now and then.
  constexpr double kFlat = 1e-9;
  if (way.row(0).norm() <= kFlat * way.row(1).norm()) way.row(0).setZero();
  return way;
}

WholeStrokes whole_strokes(const Way& way) {
  const int last = static_cast<int>(way.cols()) - 1;
  Eigen::Vector2d mean = Eigen::Vector2d::Zero();
  for (int k = 0; k < last; ++k) mean += way.col(k) / last;
  const auto phase = [&](int k) { return std::atan2(way(1, k) - mean.y(), way(0, k) - mean.x()); };
  WholeStrokes strokes{0, static_cast<double>(last)};
  double angle = 0;  // turned between step k and `last`
  for (int k = last - 1; k >= 0; --k) {
    const double before = angle;
    angle += turn(phase(k), phase(k + 1));
    const double wanted = 2 * kPi * (strokes.count + 1);
    if (std::abs(angle) >= wanted) {
      const double fraction = (wanted - std::abs(before)) / std::abs(angle - before);
      strokes.steps = last - (k + 1) + fraction;
      ++strokes.count;
    }
  }
  return strokes;
}

double stroke_period(const Eigen::MatrixXd& angles) {
  const WholeStrokes strokes = whole_strokes(in_stroke_plane(angles));
  return strokes.count > 0 ? strokes.steps / strokes.count
                           : std::numeric_limits<double>::quiet_NaN();
}

int smoothing(const Eigen::MatrixXd& angles) {
  if (angles.rows() == 2) return kSmoothing;
  const double period = stroke_period(angles);
  return std::isnan(period) ? kSmoothing : 2 * static_cast<int>(std::lround((period - 1) / 2)) + 1;
}

}  // namespace threelink_sim

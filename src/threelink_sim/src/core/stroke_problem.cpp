#include "stroke_problem.hpp"

#include <algorithm>
#include <cmath>

namespace threelink_sim {
namespace {

using VectorMap = Eigen::Map<const Eigen::VectorXd>;
// Gradients of several constraints, a row each.
using Rows = Eigen::Map<Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>>;

// [rad] hinge angles before each piece.
Eigen::MatrixXd angles_of(const StrokeVariables& x) {
  Eigen::MatrixXd angles(x.rates.rows(), x.rates.cols());
  angles.col(0) = x.start;
  for (Eigen::Index k = 1; k < x.rates.cols(); ++k)
    angles.col(k) = angles.col(k - 1) + x.dt * x.rates.col(k - 1);
  return angles;
}

}  // namespace

StrokeProblem::StrokeProblem(const StrokeSearch& search, const StrokeVariables& x, Climb& climb,
                             const ClimbWatch& on_step)
    : search_(search),
      hinges_(x.rates.rows()),
      pieces_(x.rates.cols()),
      root_(std::sqrt(static_cast<double>(pieces_))),
      dt_scale_(root_ / x.dt),
      climb_(climb),
      on_step_(on_step) {}

Eigen::VectorXd StrokeProblem::pack(const StrokeVariables& x) const {
  Eigen::VectorXd z(size());
  z.head(hinges_) = root_ * x.start;
  z[dt_at()] = dt_scale_ * x.dt;
  z.tail(hinges_ * pieces_) = VectorMap(x.rates.data(), hinges_ * pieces_);
  return z;
}

StrokeVariables StrokeProblem::unpack(const double* z) const {
  StrokeVariables x;
  x.start = VectorMap(z, hinges_) / root_;
  x.dt = z[dt_at()] / dt_scale_;
  x.rates = Eigen::Map<const Eigen::MatrixXd>(z + rate_at(0, 0), hinges_, pieces_);
  return x;
}

void StrokeProblem::put(double* gradient, const StrokeVariables& by) const {
  Eigen::Map<Eigen::VectorXd> g(gradient, size());
  g.head(hinges_) = by.start / root_;
  g[dt_at()] = by.dt / dt_scale_;
  g.tail(hinges_ * pieces_) = VectorMap(by.rates.data(), hinges_ * pieces_);
}

const StrokeVariables& StrokeProblem::at(const double* z) {
  const VectorMap point(z, size());
  if (z_.size() == 0 || point != z_) {
    z_ = point;
    x_ = unpack(z);
    outcome_ = stroke_outcome(search_.model, x_);
  }
  return x_;
}

double StrokeProblem::objective_scale() const {
  constexpr double kTypicalSpeed = 0.01, kTypicalEfficiency = 0.01;
  switch (search_.objective) {
    case Objective::kSpeed:
      return 1 / kTypicalSpeed;
    case Objective::kEfficiency:
      return 1 / kTypicalEfficiency;
    case Objective::kEnergyAware:
      return 1 / (search_.b * kTypicalSpeed);
  }
  return 1;
}

double StrokeProblem::objective(const double* z, double* gradient) {
  const StrokeVariables& x = at(z);
  const StrokeQuantity &distance = outcome_.distance, &work = outcome_.work;
  const double period = x.dt * pieces_, scale = pieces_ * objective_scale();
  double value, by_distance, by_work;
  if (search_.objective == Objective::kEfficiency) {
    value = search_.model.gamma * distance.value * distance.value / (period * work.value);
    by_distance = 2 * value / distance.value;
    by_work = -value / work.value;
  } else {
    const bool energy_aware = search_.objective == Objective::kEnergyAware;
    const double b = energy_aware ? search_.b : 1, c = energy_aware ? search_.c : 0;
    value = (b * distance.value - c * work.value) / period;
    by_distance = b / period;
    by_work = -c / period;
  }
  if (gradient) {
    StrokeVariables by;
    by.start = scale * (by_distance * distance.by.start + by_work * work.by.start);
    by.dt = scale * (by_distance * distance.by.dt + by_work * work.by.dt - value / x.dt);
    by.rates = scale * (by_distance * distance.by.rates + by_work * work.by.rates);
    put(gradient, by);
  }

  const ClimbStep step{static_cast<int>(climb_.history.size()) + 1, value, violation(x)};
  climb_.history.push_back(step);
  on_step_(climb_);
  if (step.violation <= kFeasible && (!found_ || value > climb_.value)) {
    found_ = true;
    best_ = x;
    climb_.value = value;
  }
  return scale * value;
}

double StrokeProblem::violation(const StrokeVariables& x) const {
  const double gap = x.dt * x.rates.rowwise().sum().cwiseAbs().maxCoeff();
  const double beyond = angles_of(x).cwiseAbs().maxCoeff() - limit();
  return std::max({gap, std::abs(outcome_.rotation.value), beyond, 0.0});
}

void StrokeProblem::equalities(double* result, const double* z, double* gradient) {
  const StrokeVariables& x = at(z);
  Eigen::Map<Eigen::VectorXd>(result, hinges_) = x.rates.rowwise().sum();
  result[hinges_] = outcome_.rotation.value;
  if (!gradient) return;
  Rows rows(gradient, equalities(), size());
  rows.setZero();
  for (Index j = 0; j < hinges_; ++j)
    for (Index k = 0; k < pieces_; ++k) rows(j, rate_at(j, k)) = 1;
  put(&rows(hinges_, 0), outcome_.rotation.by);
}

void StrokeProblem::inequalities(double* result, const double* z, double* gradient) {
  const StrokeVariables& x = at(z);
  const Eigen::MatrixXd angles = angles_of(x);
  for (Index i = 0; i < inequalities(); ++i)
    result[i] = held_[i].sign * angles(held_[i].hinge, held_[i].piece) - limit();
  if (!gradient) return;
  Rows rows(gradient, inequalities(), size());
  rows.setZero();
  for (Index i = 0; i < inequalities(); ++i) {
    const auto [j, piece, sign] = held_[i];
    rows(i, j) = sign / root_;
    rows(i, dt_at()) = sign * (angles(j, piece) - x.start[j]) / x.dt / dt_scale_;
    for (Index k = 0; k < piece; ++k) rows(i, rate_at(j, k)) = sign * x.dt;
  }
}

bool StrokeProblem::is_held(Index hinge, Index piece, double sign) const {
  return std::any_of(held_.begin(), held_.end(), [&](const Held& held) {
    return held.hinge == hinge && held.piece == piece && held.sign == sign;
  });
}

bool StrokeProblem::hold(const StrokeVariables& x, double margin) {
  const Eigen::MatrixXd angles = angles_of(x);
  const std::size_t before = held_.size();
  for (Index k = 0; k < pieces_; ++k)
    for (Index j = 0; j < hinges_; ++j)
      for (double sign : {-1.0, 1.0})
        if (sign * angles(j, k) > limit() + kFeasible - margin && !is_held(j, k, sign))
          held_.push_back({j, k, sign});
  return held_.size() > before;
}

}  // namespace threelink_sim

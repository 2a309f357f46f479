#include "stroke_problem.hpp"

#include <algorithm>
#include <cmath>

#include <Eigen/QR>

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
  const VectorMap all(x.rates.data(), rates());
  if (whole())
    z.tail(rates()) = all;
  else
    z.tail(space_.basis.cols()) = space_.basis.transpose() * (all - space_.fixed);
  return z;
}

StrokeVariables StrokeProblem::unpack(const double* z) const {
  StrokeVariables x;
  x.start = VectorMap(z, hinges_) / root_;
  x.dt = z[dt_at()] / dt_scale_;
  if (whole()) {
    x.rates = Eigen::Map<const Eigen::MatrixXd>(z + first_rate(), hinges_, pieces_);
  } else {
    const VectorMap y(z + first_rate(), space_.basis.cols());
    const Eigen::VectorXd all = space_.fixed + space_.basis * y;
    x.rates = Eigen::Map<const Eigen::MatrixXd>(all.data(), hinges_, pieces_);
  }
  return x;
}

void StrokeProblem::put(double* gradient, const StrokeVariables& by) const {
  Eigen::Map<Eigen::VectorXd> g(gradient, size());
  g.head(hinges_) = by.start / root_;
  g[dt_at()] = by.dt / dt_scale_;
  put_rates(gradient, VectorMap(by.rates.data(), rates()));
}

void StrokeProblem::put_rates(double* gradient, const Eigen::VectorXd& by) const {
  Eigen::Map<Eigen::VectorXd> g(gradient + first_rate(), size() - first_rate());
  if (whole())
    g = by;
  else
    g = space_.basis.transpose() * by;
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

StrokeProblem::Slopes StrokeProblem::slopes() const {
  const StrokeQuantity &distance = outcome_.distance, &work = outcome_.work;
  const double period = x_.dt * pieces_;
  if (search_.objective == Objective::kEfficiency) {
    const double value =
        search_.model.gamma * distance.value * distance.value / (period * work.value);
    return {value, 2 * value / distance.value, -value / work.value};
  }
  const bool energy_aware = search_.objective == Objective::kEnergyAware;
  const double b = energy_aware ? search_.b : 1, c = energy_aware ? search_.c : 0;
  return {(b * distance.value - c * work.value) / period, b / period, -c / period};
}

double StrokeProblem::objective(const double* z, double* gradient) {
  const StrokeVariables& x = at(z);
  const StrokeQuantity &distance = outcome_.distance, &work = outcome_.work;
  const double scale = pieces_ * objective_scale();
  const auto [value, by_distance, by_work] = slopes();
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
  for (Index j = 0; j < hinges_; ++j) {
    Eigen::VectorXd by = Eigen::VectorXd::Zero(rates());
    for (Index k = 0; k < pieces_; ++k) by[rate_at(j, k)] = 1;
    put_rates(&rows(j, 0), by);
  }
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
    Eigen::VectorXd by = Eigen::VectorXd::Zero(rates());
    for (Index k = 0; k < piece; ++k) by[rate_at(j, k)] = sign * x.dt;
    put_rates(&rows(i, 0), by);
  }
}

void StrokeProblem::fix_saturated(const StrokeVariables& x, Index margin) {
  constexpr double kAtBound = 1 - 1e-9;
  const auto inside = [&](Index j, Index k) {
    const double rate = x.rates(j, k), next = x.rates(j, (k + 1) % pieces_);
    return std::abs(rate) < kAtBound || rate * next < 0;
  };
  free_.assign(rates(), false);
  for (Index j = 0; j < hinges_; ++j)
    for (Index k = 0; k < pieces_; ++k)
      for (Index near = -margin; inside(j, k) && near <= margin; ++near)
        free_[rate_at(j, (k + near + pieces_) % pieces_)] = true;
  space_.fixed = VectorMap(x.rates.data(), rates());
  select_free();
}

void StrokeProblem::select_free() {
  space_.basis.setZero(rates(), std::count(free_.begin(), free_.end(), true));
  for (Index i = 0, column = 0; i < rates(); ++i) {
    if (!free_[i]) continue;
    space_.fixed[i] = 0;
    space_.basis(i, column++) = 1;
  }
  z_.resize(0);
}

bool StrokeProblem::release(const StrokeVariables& x) {
  x_ = x;
  outcome_ = stroke_outcome(search_.model, x);
  z_.resize(0);
  const auto [value, by_distance, by_work] = slopes();
  const Eigen::MatrixXd by =
      by_distance * outcome_.distance.by.rates + by_work * outcome_.work.by.rates;
  // Columns: what each constraint that binds changes by with each rate.
  Eigen::MatrixXd constraints = Eigen::MatrixXd::Zero(rates(), hinges_ + 1);
  for (Index i = 0; i < rates(); ++i) constraints(i, i % hinges_) = 1;
  constraints.col(hinges_) = VectorMap(outcome_.rotation.by.rates.data(), rates());
  const Eigen::MatrixXd angles = angles_of(x);
  for (const auto& [hinge, piece, sign] : held_) {
    constexpr double kBinds = 1e-6;  // [rad]
    if (sign * angles(hinge, piece) < limit() - kBinds) continue;
    constraints.conservativeResize(Eigen::NoChange, constraints.cols() + 1);
    constraints.rightCols<1>().setZero();
    for (Index k = 0; k < piece; ++k) constraints(rate_at(hinge, k), constraints.cols() - 1) = sign;
  }
  // Multipliers: what the rates within their bounds say.
  constexpr double kWithin = 1 - 1e-6;
  const VectorMap all(x.rates.data(), rates()), gradient(by.data(), rates());
  Eigen::VectorXd weight(rates());
  for (Index i = 0; i < rates(); ++i) weight[i] = std::abs(all[i]) < kWithin;
  const Eigen::MatrixXd within = weight.asDiagonal() * constraints;
  const Eigen::VectorXd multipliers =
      within.completeOrthogonalDecomposition().solve(weight.cwiseProduct(gradient));
  const Eigen::VectorXd reduced = gradient - constraints * multipliers;
  const double least = 1e-3 * reduced.cwiseAbs().maxCoeff();
  bool more = false;
  for (Index i = 0; i < rates(); ++i) {
    if (free_[i] || reduced[i] * all[i] > -least) continue;
    free_[i] = more = true;
  }
  space_.fixed = all;
  select_free();
  return more;
}

RateSpace harmonics(Eigen::Index hinges, Eigen::Index pieces, int modes) {
  Eigen::MatrixXd of_one(pieces, 2 * modes + 1);
  for (Eigen::Index k = 0; k < pieces; ++k) {
    const double phase = 2 * kPi * (static_cast<double>(k) + 0.5) / static_cast<double>(pieces);
    of_one(k, 0) = 1;
    for (int m = 1; m <= modes; ++m) {
      of_one(k, 2 * m - 1) = std::cos(m * phase);
      of_one(k, 2 * m) = std::sin(m * phase);
    }
  }
  of_one.colwise().normalize();
  RateSpace space;
  space.fixed.setZero(hinges * pieces);
  space.basis.setZero(hinges * pieces, hinges * of_one.cols());
  for (Eigen::Index j = 0; j < hinges; ++j)
    for (Eigen::Index k = 0; k < pieces; ++k)
      for (Eigen::Index m = 0; m < of_one.cols(); ++m)
        space.basis(k * hinges + j, j * of_one.cols() + m) = of_one(k, m);
  return space;
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

#include "stroke_climb.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <stdexcept>

#include <nlopt.hpp>

#include "stroke_problem.hpp"

namespace threelink_sim {
namespace {

constexpr int kRounds = 20;  // of adding angles to be held to the joint limit

// True if the optimiser stopped by itself.
bool maximise(StrokeProblem& problem, Period period, bool rates_bounded, const StrokeVariables& x) {
  const Eigen::VectorXd z = problem.pack(x);
  const Eigen::Index first_rate = problem.first_rate();
  const double dt = z[problem.dt_at()], bound = rates_bounded ? 1 : HUGE_VAL;
  std::vector<double> low(z.size(), -HUGE_VAL), high(z.size(), HUGE_VAL);
  std::fill(low.begin() + first_rate, low.end(), -bound);
  std::fill(high.begin() + first_rate, high.end(), bound);
  low[problem.dt_at()] = period == Period::kFixed ? dt : dt / 50;
  high[problem.dt_at()] = period == Period::kFixed ? dt : dt * 50;

  nlopt::opt optimiser(nlopt::LD_SLSQP, z.size());
  optimiser.set_lower_bounds(low);
  optimiser.set_upper_bounds(high);
  optimiser.set_max_objective(
      [](unsigned, const double* at, double* gradient, void* data) {
        return static_cast<StrokeProblem*>(data)->objective(at, gradient);
      },
      &problem);
  constexpr double kTolerance = 1e-10;
  optimiser.add_equality_mconstraint(
      [](unsigned, double* result, unsigned, const double* at, double* gradient, void* data) {
        static_cast<StrokeProblem*>(data)->equalities(result, at, gradient);
      },
      &problem, std::vector<double>(problem.equalities(), kTolerance));
  if (problem.inequalities() > 0)
    optimiser.add_inequality_mconstraint(
        [](unsigned, double* result, unsigned, const double* at, double* gradient, void* data) {
          static_cast<StrokeProblem*>(data)->inequalities(result, at, gradient);
        },
        &problem, std::vector<double>(problem.inequalities(), kTolerance));
  optimiser.set_ftol_rel(1e-9);
  constexpr int kMaxEvaluations = 500;
  optimiser.set_maxeval(kMaxEvaluations);
  std::vector<double> point(z.data(), z.data() + z.size());
  double value;
  try {
    return optimiser.optimize(point, value) != nlopt::MAXEVAL_REACHED;
  } catch (const nlopt::roundoff_limited&) {  // as near as double precision gets
    return true;
  } catch (const std::runtime_error&) {  // NLopt gave up
    return false;
  } catch (const std::invalid_argument&) {  // it went where nothing can be simulated
    return false;
  }
}

// Not so if the optimiser lost its way and ended elsewhere than at the best that it came by.
bool at_best(const Climb& climb) {
  const ClimbStep& last = climb.history.back();
  return last.violation <= 1e-6 && std::abs(last.value - climb.value) <= 1e-6 * climb.value;
}

}  // namespace

Climb climb(const StrokeSearch& search, const std::string& name, Period period, double margin,
            Rates rates, const ClimbWatch& on_step, StrokeVariables& x) {
  const auto begin = std::chrono::steady_clock::now();
  Climb result;
  result.name = name;
  result.pieces = static_cast<int>(x.rates.cols());
  // The efficiency does not depend on the period, if that is free: it is scaled afterwards.
  const bool scaled = search.objective == Objective::kEfficiency && period == Period::kFree;
  StrokeProblem problem(search, x, result, on_step);
  if (rates == Rates::kFewer && scaled) {
    // Those that the pieces resolve.
    const int modes = std::min(20, static_cast<int>(x.rates.cols() - 1) / 2);
    problem.restrict_to(harmonics(x.rates.rows(), x.rates.cols(), modes));
  }
  const bool saturated = rates == Rates::kFewer && !scaled;
  // A piece of the coarse grid in which a rate changes its sign says where, within itself.
  constexpr Eigen::Index kCoarse = 40;
  if (saturated) problem.fix_saturated(x, x.rates.cols() / kCoarse);
  problem.hold(x, margin);
  bool more = true;
  for (int round = 0; more && round < kRounds; ++round) {
    problem.forget_best();
    const bool stopped = maximise(problem, scaled ? Period::kFixed : period, !scaled, x);
    if (!stopped || !problem.found()) break;
    x = problem.best();
    more = problem.hold(x, 0);
    if (saturated && problem.release(x)) more = true;
    if (rates == Rates::kFewer && !at_best(result)) more = true;  // from there anew
  }
  // Not at rest, either.
  result.converged = !more && result.value > 1e-9 && at_best(result);
  if (scaled) {
    const double fastest = x.rates.cwiseAbs().maxCoeff();
    x.rates /= fastest;
    x.dt *= fastest;
  }
  const std::chrono::duration<double> seconds = std::chrono::steady_clock::now() - begin;
  result.seconds = seconds.count();
  return result;
}

}  // namespace threelink_sim

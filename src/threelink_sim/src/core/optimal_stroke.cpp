#include "threelink_sim/optimal_stroke.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include <fmt/format.h>

#include "stroke_climb.hpp"
#include "threelink_sim/random.hpp"

namespace threelink_sim {
namespace {

using Eigen::Index;

constexpr int kCoarsePieces = 40;  // all starts climb with these; only the best goes on
// Of many hinges with fewer, since a climb takes a time that goes as the cube of the unknowns.
constexpr int kCoarseUnknowns = 120, kFewestCoarse = 20;
constexpr int kMinPieces = 8, kMaxPieces = 1000;

int coarse_pieces(const StrokeSearch& search) {
  const int hinges = search.model.hinges();
  const int coarse =
      hinges <= 2 ? kCoarsePieces : std::max(kFewestCoarse, kCoarseUnknowns / hinges);
  return std::min(search.pieces, coarse);
}

// Hinges that swing sinusoidally, each with an amplitude and a phase of its own.
StrokeVariables random_start(const StrokeSearch& search, std::uint32_t start, int pieces) {
  Random random(search.seed, Stream::kStroke, start);
  const int hinges = search.model.hinges();
  const double limit = std::min(search.model.joint_limit, 1.5);  // [rad]
  StrokeVariables x;
  x.start.resize(hinges);
  x.rates.resize(hinges, pieces);
  HingeVector amplitude(hinges);
  for (int j = 0; j < hinges; ++j) amplitude[j] = random.uniform(0.3 * limit, 0.95 * limit);
  const double step = 2 * kPi / pieces;  // of the phase
  x.dt = amplitude.maxCoeff() * step;
  for (int j = 0; j < hinges; ++j) {
    const double phase = random.uniform(0, 2 * kPi);
    const auto angle = [&](int k) { return amplitude[j] * std::cos(phase + k * step); };
    x.start[j] = angle(0);
    for (int k = 0; k < pieces; ++k) x.rates(j, k) = (angle(k + 1) - angle(k)) / x.dt;
  }
  return x;
}

// The same way through the hinge angles in other pieces.
StrokeVariables resampled(const StrokeVariables& x, int pieces, double dt) {
  const Index from = x.rates.cols();
  const auto angle = [&](int k) {
    const double at = static_cast<double>(k) * from / pieces;  // in the old pieces
    const Index whole = static_cast<Index>(at);
    HingeVector sum = x.start + x.dt * x.rates.leftCols(whole).rowwise().sum();
    if (whole < from) sum += x.dt * (at - whole) * x.rates.col(whole);
    return sum;
  };
  StrokeVariables result;
  result.start = x.start;
  result.dt = dt;
  result.rates.resize(x.rates.rows(), pieces);
  for (int k = 0; k < pieces; ++k)
    result.rates.col(k) = ((angle(k + 1) - angle(k)) / dt).cwiseMax(-1).cwiseMin(1);
  return result;
}

// The pieces to try: for a given dt, those on both sides of the best period.
std::vector<int> pieces_to_try(const StrokeSearch& search, double period) {
  if (search.dt == 0) return {search.pieces};
  const int below = static_cast<int>(period / search.dt);
  std::vector<int> result;
  for (int pieces : {below, below + 1})
    if (pieces >= kMinPieces && pieces <= kMaxPieces) result.push_back(pieces);
  if (result.empty())
    throw std::invalid_argument(fmt::format("dt = {}: a period of {:.4g} must have {} to {} pieces",
                                            search.dt, period, kMinPieces, kMaxPieces));
  return result;
}

// Closed and within the bounds to the last bit that rounding leaves, beginning where the first
// hinge is most bent.
Stroke stroke_of(const Model& model, const StrokeVariables& x) {
  Eigen::MatrixXd rates = x.rates.colwise() - x.rates.rowwise().mean();
  rates /= std::max(1.0, rates.cwiseAbs().maxCoeff());
  Stroke stroke;
  stroke.model = model;
  stroke.dt = x.dt;
  stroke.start = x.start;
  for (Index k = 0; k < rates.cols(); ++k) stroke.rates.push_back(rates.col(k));
  const std::vector<HingeVector> angles = hinge_angles(stroke);
  const auto most = std::max_element(angles.begin(), angles.end() - 1,
                                     [](const auto& a, const auto& b) { return a[0] < b[0]; });
  stroke.start = *most;
  std::rotate(stroke.rates.begin(), stroke.rates.begin() + (most - angles.begin()),
              stroke.rates.end());
  return stroke;
}

}  // namespace

void StrokeSearch::validate() const {
  model.validate();
  if (model.links < 3)
    throw std::invalid_argument("links = 2: must be 3 or more; a single hinge leads nowhere");
  if (!(b > 0 && b <= 1e6))
    throw std::invalid_argument(fmt::format("b = {}: must be in (0, 1e6]", b));
  if (!(c >= 0 && c <= 4 * b))
    throw std::invalid_argument(fmt::format("c = {}: must be in [0, 4 b] = [0, {}]", c, 4 * b));
  if (pieces < kMinPieces || pieces > kMaxPieces)
    throw std::invalid_argument(
        fmt::format("pieces = {}: must be in [{}, {}]", pieces, kMinPieces, kMaxPieces));
  if (!(dt >= 0 && dt <= 1))
    throw std::invalid_argument(fmt::format("dt = {}: must be in (0, 1], or 0", dt));
  if (starts < 1 || starts > 1000)
    throw std::invalid_argument(fmt::format("starts = {}: must be in [1, 1000]", starts));
}

double objective_value(const StrokeSearch& search, const StrokeMeasures& measures) {
  switch (search.objective) {
    case Objective::kSpeed:
      return measures.speed;
    case Objective::kEfficiency:
      return measures.efficiency;
    case Objective::kEnergyAware:
      return search.b * measures.speed - search.c * measures.power;
  }
  return 0;
}

OptimalStroke find_optimal_stroke(const StrokeSearch& search, const ClimbWatch& on_step,
                                  const ClimbWatch& on_end) {
  search.validate();
  OptimalStroke result;
  const auto climbed = [&](const std::string& name, Period period, double margin, Rates rates,
                           StrokeVariables& x) {
    result.climbs.push_back(climb(search, name, period, margin, rates, on_step, x));
    on_end(result.climbs.back());
    return result.climbs.back().converged;
  };

  StrokeVariables best;
  double best_value = -HUGE_VAL;
  const double all_angles = search.model.joint_limit;
  for (int start = 0; start < search.starts; ++start) {
    StrokeVariables x = random_start(search, start, coarse_pieces(search));
    if (!climbed(fmt::format("start {}", start + 1), Period::kFree, all_angles, Rates::kAll, x))
      continue;
    if (result.climbs.back().value <= best_value) continue;
    best = x;
    best_value = result.climbs.back().value;
  }
  if (best_value == -HUGE_VAL)
    throw std::runtime_error(fmt::format("no climb from {} starts converged", search.starts));

  best_value = -HUGE_VAL;
  const double period = best.rates.cols() * best.dt;
  for (int pieces : pieces_to_try(search, period)) {
    const bool free = search.dt == 0;
    StrokeVariables x = resampled(best, pieces, free ? period / pieces : search.dt);
    constexpr double kMargin = 0.5;  // [rad]
    // Three links are soon refined as they are.
    const Rates rates = search.model.hinges() > 2 ? Rates::kFewer : Rates::kAll;
    if (!climbed("refinement", free ? Period::kFree : Period::kFixed, kMargin, rates, x)) continue;
    if (result.climbs.back().value <= best_value) continue;
    best_value = result.climbs.back().value;
    if (!free) x.dt = search.dt;  // without the rounding of the optimiser's units
    result.stroke = stroke_of(search.model, x);
  }
  if (best_value == -HUGE_VAL)
    throw std::runtime_error("the refinement of the best stroke did not converge");
  result.stroke.validate();
  result.value = objective_value(search, measure(result.stroke));
  return result;
}

}  // namespace threelink_sim

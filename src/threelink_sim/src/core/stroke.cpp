#include "threelink_sim/stroke.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>

#include <fmt/format.h>

namespace threelink_sim {
namespace {

// Plays one period from `state`; returns the work [C_perp L^3/T0].
double play(const Stroke& stroke, SwimmerState& state) {
  double work = 0;
  for (const HingeVector& rates : stroke.rates) {
    const int n = substeps(stroke.model, stroke.dt, rates.cwiseAbs().maxCoeff());
    work += advance(stroke.model, state, rates, stroke.dt, n).work;
  }
  return work;
}

}  // namespace

void Stroke::validate() const {
  model.validate();
  if (!(dt > 0 && std::isfinite(dt)))
    throw std::invalid_argument(fmt::format("dt = {}: must be positive", dt));
  if (rates.empty()) throw std::invalid_argument("rates: there are none");
  SwimmerState state;
  state.alpha = start;
  threelink_sim::validate(model, state);
  for (int k = 0; k < pieces(); ++k) {
    if (rates[k].size() != model.hinges())
      throw std::invalid_argument(fmt::format("rates, row {}: {} values, {} links have {} hinges",
                                              k + 1, rates[k].size(), model.links, model.hinges()));
    if (!(rates[k].cwiseAbs().maxCoeff() <= 1))
      throw std::invalid_argument(fmt::format("rates, row {}: must be within [-1, 1]", k + 1));
  }
  constexpr double kRounding = 1e-12;  // [rad] of the sum of the rates
  const std::vector<HingeVector> angles = hinge_angles(*this);
  for (int k = 0; k < pieces(); ++k)
    if (!(angles[k + 1].cwiseAbs().maxCoeff() <= model.joint_limit + kRounding))
      throw std::invalid_argument(fmt::format(
          "rates, row {}: a hinge would pass the joint limit of {} rad", k + 1, model.joint_limit));
  constexpr double kClosed = 1e-9;  // [rad]
  const double gap = (angles.back() - angles.front()).cwiseAbs().maxCoeff();
  if (!(gap <= kClosed))
    throw std::invalid_argument(fmt::format(
        "rates: the shape must be closed after a period, and misses it by {} rad", gap));
}

std::vector<HingeVector> hinge_angles(const Stroke& stroke) {
  std::vector<HingeVector> angles{stroke.start};
  for (const HingeVector& rates : stroke.rates) angles.push_back(angles.back() + stroke.dt * rates);
  return angles;
}

StrokeMeasures measure(const Stroke& stroke) {
  SwimmerState state;
  state.alpha = stroke.start;
  StrokeMeasures m;
  m.work = play(stroke, state);
  m.displacement = state.centroid;
  m.rotation = state.heading;
  m.speed = m.displacement.norm() / stroke.period();
  m.power = m.work / stroke.period();
  m.efficiency = m.power > 0 ? stroke.model.gamma * m.speed * m.speed / m.power : 0;
  return m;
}

double fastest_speed(int links) {
  constexpr double kSpeeds[] = {0.0129154, 0.0218664, 0.0303811, 0.0387526, 0.0467596, 0.0545997};
  constexpr int kFirst = 3, kLast = kFirst + sizeof(kSpeeds) / sizeof(*kSpeeds) - 1;
  return links >= kFirst && links <= kLast ? kSpeeds[links - kFirst]
                                           : std::numeric_limits<double>::quiet_NaN();
}

SwimmerState aligned_start(const Stroke& stroke) {
  const Eigen::Vector2d net = measure(stroke).displacement;
  SwimmerState state;
  state.alpha = stroke.start;
  state.heading = -std::atan2(net.y(), net.x());
  return state;
}

Stroke square_stroke(const Model& model, double low, double high, int pieces) {
  model.validate();
  if (!(low < high))
    throw std::invalid_argument(
        fmt::format("square stroke: the low angle {} must be below the high one {}", low, high));
  if (pieces < 4 || pieces % 4 != 0)
    throw std::invalid_argument(
        fmt::format("pieces = {}: a square stroke needs a multiple of 4", pieces));
  Stroke stroke;
  stroke.model = model;
  const int pieces_per_side = pieces / 4;
  stroke.dt = (high - low) / pieces_per_side;
  const int first = 0, last = model.hinges() - 1;
  stroke.start = HingeVector::Zero(model.hinges());
  stroke.start[first] = stroke.start[last] = low;
  for (int k = 0; k < pieces; ++k) {
    const int side = 4 * k / pieces;  // last up, first up, last down, first down
    HingeVector rates = HingeVector::Zero(model.hinges());
    if (side % 2 == 0 || first != last)  // a single hinge rests in the odd ones
      rates[side % 2 == 0 ? last : first] = side < 2 ? 1 : -1;
    stroke.rates.push_back(rates);
  }
  stroke.validate();
  return stroke;
}

}  // namespace threelink_sim

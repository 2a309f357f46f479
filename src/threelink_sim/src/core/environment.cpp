#include "threelink_sim/environment.hpp"

#include <algorithm>
#include <limits>
#include <stdexcept>

#include <fmt/format.h>

#include "threelink_sim/fields.hpp"
#include "threelink_sim/random.hpp"

namespace threelink_sim {

void EnvironmentConfig::validate() const { check_fields(*this); }

std::string swimmer_difference(const EnvironmentConfig& found, const EnvironmentConfig& wanted) {
  const auto texts = [](const EnvironmentConfig& config) {
    FieldTexts texts;
    EnvironmentConfig::swimmer_fields(config,
                                      [&](const std::string& name, auto value, const auto&...) {
                                        texts.emplace_back(name, fmt::format("{}", value));
                                      });
    return texts;
  };
  const FieldTexts is = texts(found), must_be = texts(wanted);
  std::string difference;
  for (std::size_t i = 0; i < is.size(); ++i)
    if (is[i] != must_be[i])
      difference += fmt::format("{}{} = {} instead of {}", difference.empty() ? "" : ", ",
                                is[i].first, is[i].second, must_be[i].second);
  return difference;
}

Environment::Environment(const EnvironmentConfig& config, std::size_t lanes, const Kernels& kernels)
    : config_((config.validate(), config)),
      substeps_(substeps(config.model, config.dt, 1.0)),
      batch_(config.model, lanes, kernels),
      px_(lanes, 1.0),
      py_(lanes, 0.0),
      distance_(lanes),
      reward_(lanes),
      sine_(lanes),
      cosine_(lanes),
      clipped_(lanes) {
  SwimmerState straight;
  straight.alpha = HingeVector::Zero(config.model.hinges());
  for (std::size_t i = 0; i < lanes; ++i) reset(i, straight);
}

void Environment::reset(std::size_t i, const SwimmerState& state) {
  batch_.set_state(i, state);
  for (int j = 0; j < config_.model.hinges(); ++j) batch_.rates(j)[i] = 0;
  set_direction(i, {1.0, 0.0});
  reward_[i] = 0.0;
}

void Environment::aim(std::size_t i, const Eigen::Vector2d& target) {
  const TargetDirection to_target =
      target_direction({batch_.x()[i], batch_.y()[i]}, target, direction(i));
  set_direction(i, to_target.p);
  distance_[i] = to_target.distance;
}

void Environment::set_direction(std::size_t i, const Eigen::Vector2d& p) {
  px_[i] = p.x();
  py_[i] = p.y();
  distance_[i] = std::numeric_limits<double>::infinity();
}

void Environment::observe(double* out) const {
  const std::size_t n = lanes();
  batch_.heading_sincos(sine_.data(), cosine_.data());
  for (std::size_t i = 0; i < n; ++i) {
    out[i] = cosine_[i] * px_[i] + sine_[i] * py_[i];
    out[n + i] = sine_[i] * px_[i] - cosine_[i] * py_[i];
  }
  for (int j = 0; j < config_.model.hinges(); ++j)
    std::copy_n(batch_.alpha(j), n, out + (2 + j) * n);
  if (config_.observation != ObservationKind::kTarget) return;
  double* weighted_cosine = out + (2 + config_.model.hinges()) * n;
  double* weighted_sine = weighted_cosine + n;
  for (std::size_t i = 0; i < n; ++i) clipped_[i] = std::clamp(distance_[i], kNearest, kFarthest);
  batch_.look_at_distance(clipped_.data(), weighted_cosine, weighted_sine + n);
  for (std::size_t i = 0; i < n; ++i) {
    weighted_sine[i] = weighted_cosine[i] * out[n + i];
    weighted_cosine[i] *= out[i];
  }
}

void Environment::step(const double* rates) {
  const std::size_t n = lanes();
  for (int j = 0; j < config_.model.hinges(); ++j) {
    double* wanted = batch_.rates(j);
    for (std::size_t i = 0; i < n; ++i) wanted[i] = std::clamp(rates[j * n + i], -1.0, 1.0);
  }
  batch_.advance(config_.dt, substeps_);
  const double* dx = batch_.dx();
  const double* dy = batch_.dy();
  const double* work = batch_.work();
  for (std::size_t i = 0; i < n; ++i)
    reward_[i] = config_.b * (dx[i] * px_[i] + dy[i] * py_[i]) - config_.c * work[i];
}

StepRecord Environment::record(std::size_t i) const {
  StepRecord record;
  record.state = batch_.state(i);
  record.hinge_rates.resize(config_.model.hinges());
  for (int j = 0; j < config_.model.hinges(); ++j) record.hinge_rates[j] = batch_.rates(j)[i];
  record.power = body_motion(config_.model, record.state.alpha, record.hinge_rates).power;
  record.work = batch_.work()[i];
  record.reward = reward_[i];
  return record;
}

SwimmerState random_start(const Model& model, std::uint64_t seed, std::uint32_t episode) {
  Random random(seed, Stream::kStart, episode);
  SwimmerState state;
  state.heading = random.uniform(-kPi, kPi);
  state.alpha.resize(model.hinges());
  for (int j = 0; j < model.hinges(); ++j)
    state.alpha[j] = random.uniform(-model.joint_limit, model.joint_limit);
  return state;
}

}  // namespace threelink_sim

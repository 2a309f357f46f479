#include "threelink_sim/environment.hpp"

#include <algorithm>
#include <limits>
#include <stdexcept>

#include <fmt/format.h>

#include "threelink_sim/fields.hpp"
#include "threelink_sim/isa.hpp"
#include "threelink_sim/random.hpp"

namespace threelink_sim {

void EnvironmentConfig::validate() const {
  check_fields(*this);
  if (world) world->check_step(dt, substeps(model, dt, 1.0));
}

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

namespace {

// Those of the same instruction set.
const WorldKernels& world_kernels_of(const Kernels& kernels) {
  for (const Isa isa : available_isas())
    if (to_string(isa) == kernels.isa) return world_kernels(isa);
  return world_kernels();
}

}  // namespace

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
  if (config.world && !config.world->still())
    world_.emplace(config.world, config.model, lanes, kernels, world_kernels_of(kernels));
}

void Environment::reset(std::size_t i, const SwimmerState& state, const EpisodeKey& key) {
  if (world_) world_->check_start(state, key);
  resume(i, state, key, 0);
}

void Environment::resume(std::size_t i, const SwimmerState& state, const EpisodeKey& key,
                         std::uint32_t step) {
  batch_.set_state(i, state);
  if (world_) world_->begin(i, key, step);
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
  batch_.axis_sincos(sine_.data(), cosine_.data());
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
  if (world_)
    world_->advance(batch_, config_.dt, substeps_);
  else
    batch_.advance(config_.dt, substeps_);
  const double* dx = batch_.dx();
  const double* dy = batch_.dy();
  for (std::size_t i = 0; i < n; ++i)
    reward_[i] = config_.b * (dx[i] * px_[i] + dy[i] * py_[i]) - config_.c * effort(i);
}

double Environment::effort(std::size_t i) const {
  const double work = batch_.work()[i];
  return world_ ? std::max(work, 0.0) : work;
}

Eigen::Vector2d Environment::flow(std::size_t i) const {
  if (!world_) return Eigen::Vector2d::Zero();
  return config_.world->flow(world_->time(i, config_.dt), centroid(i));
}

StepRecord Environment::record(std::size_t i) const {
  StepRecord record;
  record.state = batch_.state(i);
  record.hinge_rates.resize(config_.model.hinges());
  for (int j = 0; j < config_.model.hinges(); ++j) record.hinge_rates[j] = batch_.rates(j)[i];
  record.work = batch_.work()[i];
  record.reward = reward_[i];
  if (world_) {
    record.power = world_->power(batch_, i, config_.dt);
    record.dissipation = world_->dissipation()[i];
    record.contact = world_->contact(i);
  } else {
    record.power = body_motion(config_.model, record.state.alpha, record.hinge_rates).power;
    record.dissipation = record.work;
  }
  return record;
}

namespace {

SwimmerState draw_start(const Model& model, Random random) {
  SwimmerState state;
  state.heading = random.uniform(-kPi, kPi);
  state.alpha.resize(model.hinges());
  for (int j = 0; j < model.hinges(); ++j)
    state.alpha[j] = random.uniform(-model.joint_limit, model.joint_limit);
  return state;
}

}  // namespace

SwimmerState random_start(const Model& model, std::uint64_t seed, std::uint32_t episode) {
  return draw_start(model, Random(seed, Stream::kStart, episode));
}

SwimmerState random_start(const EnvironmentConfig& config, std::uint64_t seed,
                          std::uint32_t episode) {
  if (!config.world || config.world->obstacles().empty())
    return random_start(config.model, seed, episode);
  constexpr std::uint32_t kAttempts = 1000;
  ContactSolver contacts(*config.world, config.model);
  for (std::uint32_t attempt = 0;; ++attempt) {
    const SwimmerState state =
        draw_start(config.model, Random(seed, Stream::kStart, episode, attempt));
    try {
      contacts.check_free(state);
      return state;
    } catch (const std::invalid_argument&) {
      if (attempt + 1 == kAttempts) throw;
    }
  }
}

}  // namespace threelink_sim

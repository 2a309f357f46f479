#include "threelink_agent/training/rollout.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "threelink_agent/symmetry.hpp"
#include "threelink_agent/training/gaussian.hpp"
#include "threelink_sim/random.hpp"

namespace threelink_agent {

using threelink_sim::Environment;
using threelink_sim::EnvironmentConfig;
using threelink_sim::Stream;

Rollout::Rollout(const EnvironmentConfig& config, int episodes)
    : steps(static_cast<int>(config.steps)),
      episodes(episodes),
      observation_size(threelink_sim::observation_size(config.observation, config.model)),
      hinges(config.model.hinges()) {
  const std::size_t stride = std::size_t(steps) * episodes;
  observations.resize(observation_size * (stride + episodes));
  actions.resize(hinges * stride);
  log_probs.resize(stride);
  rewards.resize(stride);
  captured.resize(stride);
}

double Rollout::mean_return() const {
  return std::accumulate(rewards.begin(), rewards.end(), 0.0) / episodes;
}

threelink_sim::SwimmerState start_of(const Play& play, int i) {
  return threelink_sim::random_start(play.environment, play.seed, play.first_episode + i);
}

RolloutActor::RolloutActor(const Play& play, int begin, int end, Rollout& rollout)
    : play_(&play),
      std_(play.log_std.array().exp()),
      begin_(begin),
      n_(end - begin),
      rollout_(&rollout),
      noise_(play.seed, play.first_episode + begin, n_, rollout.hinges),
      seen_(rollout.observation_size * n_),
      mean_(rollout.hinges * n_),
      reversed_(n_, false),
      rates_(rollout.hinges * n_) {}

void RolloutActor::see(int t, const double* observed) {
  const int inputs = rollout_->observation_size;
  const std::size_t stride = std::size_t(rollout_->steps + 1) * rollout_->episodes;
  std::copy_n(observed, inputs * n_, seen_.data());
  if (play_->canonical == Symmetry::kReversal)
    for (int i = 0; i < n_; ++i) {
      reversed_[i] = observed[i] < 0;
      if (reversed_[i]) reverse_observation(seen_.data(), inputs, rollout_->hinges, n_, i);
    }
  for (int k = 0; k < inputs; ++k)
    std::copy_n(&seen_[k * n_], n_, &rollout_->observations[k * stride + at(t)]);
}

const double* RolloutActor::act(int t) {
  const std::size_t stride = std::size_t(rollout_->steps) * rollout_->episodes;
  play_->actor.forward(n_, seen_.data(), mean_.data());
  noise_.draw(t);
  float* log_prob = &rollout_->log_probs[at(t)];
  std::fill_n(log_prob, n_, 0.0f);
  for (int j = 0; j < rollout_->hinges; ++j) {
    float* action = &rollout_->actions[j * stride + at(t)];
    for (int i = 0; i < n_; ++i) {
      const float z = noise_(j, i);
      action[i] = mean_[j * n_ + i] + std_[j] * z;
      log_prob[i] += log_density(z, play_->log_std[j]);
      rates_[j * n_ + i] = action[i];
    }
  }
  for (int i = 0; i < n_; ++i)
    if (reversed_[i]) reverse_rates(rates_.data(), rollout_->hinges, n_, i);
  return rates_.data();
}

void RolloutActor::earn(int t, const double* rewards) {
  std::copy_n(rewards, n_, &rollout_->rewards[at(t)]);
}

void collect(const Play& play, int begin, int end, Rollout& rollout) {
  const int n = end - begin;
  Environment environment(play.environment, n);
  const auto goals =
      threelink_sim::make_goals(play.goal, play.seed, play.first_episode + begin, environment);
  RolloutActor actor(play, begin, end, rollout);
  std::vector<double> observed(rollout.observation_size * n);
  const auto observe = [&](int t) {
    environment.observe(observed.data());
    actor.see(t, observed.data());
  };
  for (int t = 0; t < rollout.steps; ++t) {
    observe(t);
    environment.step(actor.act(t));
    const std::size_t at = std::size_t(t) * rollout.episodes + begin;
    goals->after_step(t, &rollout.rewards[at], &rollout.captured[at]);
  }
  observe(rollout.steps);
}

void mirror_half(Rollout& rollout, std::uint64_t seed, std::uint32_t first_episode) {
  const int n = rollout.episodes;
  const std::size_t observation_stride = std::size_t(rollout.steps + 1) * n;
  const std::size_t stride = std::size_t(rollout.steps) * n;
  for (int i = 0; i < n; ++i) {
    threelink_sim::Random random(seed, Stream::kMirror, first_episode + i);
    if (random.below(2) == 0) continue;
    for (int t = 0; t <= rollout.steps; ++t)
      mirror_observation(rollout.observations.data(), rollout.observation_size, rollout.hinges,
                         observation_stride, t * n + i);
    for (int t = 0; t < rollout.steps; ++t)
      mirror_rates(rollout.actions.data(), rollout.hinges, stride, t * n + i);
  }
}

}  // namespace threelink_agent

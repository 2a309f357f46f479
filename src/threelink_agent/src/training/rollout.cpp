#include "threelink_agent/training/rollout.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "threelink_agent/symmetry.hpp"
#include "threelink_agent/training/gaussian.hpp"
#include "threelink_sim/isa.hpp"
#include "threelink_sim/random.hpp"

namespace threelink_agent {

using threelink_sim::Environment;
using threelink_sim::EnvironmentConfig;
using threelink_sim::RandomCounter;
using threelink_sim::Stream;

namespace {

// Standard normals for one step of all episodes: hinge j of episode i at [i * hinges_even + j].
class ExplorationNoise {
 public:
  ExplorationNoise(std::uint64_t seed, std::uint32_t first_episode, int episodes, int hinges)
      : key_{static_cast<std::uint32_t>(seed), static_cast<std::uint32_t>(seed >> 32)},
        draws_((hinges + 1) / 2),
        counters_(episodes * draws_),
        normals_(2 * counters_.size()) {
    for (std::size_t k = 0; k < counters_.size(); ++k)
      counters_[k] = {static_cast<std::uint32_t>(k % draws_), 0,
                      first_episode + static_cast<std::uint32_t>(k / draws_),
                      static_cast<std::uint32_t>(Stream::kExploration)};
  }

  void draw(std::uint32_t step) {
    for (RandomCounter& counter : counters_) counter.step = step;
    threelink_sim::kernels().normals(counters_.size(), key_, &counters_[0].draw, normals_.data());
  }
  float operator()(int hinge, int episode) const {
    return static_cast<float>(normals_[2 * draws_ * episode + hinge]);
  }

 private:
  std::uint32_t key_[2];
  int draws_;  // a counter gives two normals
  std::vector<RandomCounter> counters_;
  std::vector<double> normals_;
};

}  // namespace

Rollout::Rollout(const EnvironmentConfig& config, int episodes)
    : steps(static_cast<int>(config.steps)),
      episodes(episodes),
      observation_size(threelink_sim::direction_observation_size(config.model)),
      hinges(config.model.hinges()) {
  const std::size_t stride = std::size_t(steps) * episodes;
  observations.resize(observation_size * (stride + episodes));
  actions.resize(hinges * stride);
  log_probs.resize(stride);
  rewards.resize(stride);
}

double Rollout::mean_return() const {
  return std::accumulate(rewards.begin(), rewards.end(), 0.0) / episodes;
}

void collect(const Play& play, int begin, int end, Rollout& rollout) {
  const int n = end - begin, inputs = rollout.observation_size, hinges = rollout.hinges;
  const std::size_t stride = std::size_t(rollout.steps) * rollout.episodes;
  const std::size_t observation_stride = stride + rollout.episodes;
  const std::uint32_t first = play.first_episode + begin;

  Environment environment(play.environment, n);
  for (int i = 0; i < n; ++i)
    environment.reset(i, threelink_sim::random_start(play.environment.model, play.seed, first + i));
  ExplorationNoise noise(play.seed, first, n, hinges);
  const Eigen::VectorXf std = play.log_std.array().exp();

  std::vector<double> observed(inputs * n), rates(hinges * n);
  std::vector<float> seen(inputs * n), mean(hinges * n);
  std::vector<char> reversed(n, false);
  const auto observe = [&](int t) {
    environment.observe(observed.data());
    std::copy(observed.begin(), observed.end(), seen.begin());
    if (play.canonical == Symmetry::kReversal)
      for (int i = 0; i < n; ++i) {
        reversed[i] = observed[i] < 0;
        if (reversed[i]) reverse_observation(seen.data(), hinges, n, i);
      }
    const std::size_t at = std::size_t(t) * rollout.episodes + begin;
    for (int k = 0; k < inputs; ++k)
      std::copy_n(&seen[k * n], n, &rollout.observations[k * observation_stride + at]);
  };

  for (int t = 0; t < rollout.steps; ++t) {
    observe(t);
    play.actor.forward(n, seen.data(), mean.data());
    noise.draw(t);
    const std::size_t at = std::size_t(t) * rollout.episodes + begin;
    float* log_prob = &rollout.log_probs[at];
    std::fill_n(log_prob, n, 0.0f);
    for (int j = 0; j < hinges; ++j) {
      float* action = &rollout.actions[j * stride + at];
      for (int i = 0; i < n; ++i) {
        const float z = noise(j, i);
        action[i] = mean[j * n + i] + std[j] * z;
        log_prob[i] += log_density(z, play.log_std[j]);
        rates[j * n + i] = action[i];
      }
    }
    for (int i = 0; i < n; ++i)
      if (reversed[i]) reverse_rates(rates.data(), hinges, n, i);
    environment.step(rates.data());
    std::copy_n(environment.rewards(), n, &rollout.rewards[at]);
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
      mirror_observation(rollout.observations.data(), rollout.hinges, observation_stride,
                         t * n + i);
    for (int t = 0; t < rollout.steps; ++t)
      mirror_rates(rollout.actions.data(), rollout.hinges, stride, t * n + i);
  }
}

}  // namespace threelink_agent

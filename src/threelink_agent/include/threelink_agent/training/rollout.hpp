// Whole episodes played with exploration noise: what the learner learns from.
#pragma once

#include <cstdint>
#include <vector>

#include <Eigen/Core>

#include "threelink_agent/policy.hpp"
#include "threelink_sim/environment.hpp"

namespace threelink_agent {

// Structure of arrays over samples: step t of episode i is sample t * episodes + i. Observations
// and actions are those of the network, that is after canonicalisation.
struct Rollout {
  int steps;  // N_s
  int episodes;
  int observation_size;  // O
  int hinges;            // A
  std::vector<float>
      observations;              // (O, steps + 1, episodes); the last ones follow the last action
  std::vector<float> actions;    // (A, steps, episodes) [1/T0] as sampled, before any clipping
  std::vector<float> log_probs;  // (steps, episodes) of the sampled action when it was sampled
  std::vector<float> rewards;    // (steps, episodes)

  Rollout(const threelink_sim::EnvironmentConfig& config, int episodes);

  // Mean over the episodes of their undiscounted sum of rewards.
  double mean_return() const;
};

// How episodes are played.
struct Play {
  threelink_sim::EnvironmentConfig environment;
  Symmetry canonical;       // applied to what the network sees
  Mlp actor;                // the mean of the actions
  Eigen::VectorXf log_std;  // (A) of their standard deviation [1/T0]
  std::uint64_t seed;
  std::uint32_t first_episode;  // number of the rollout's first one
};

// Plays the rollout's episodes begin .. end - 1 side by side from random starts towards theta_T =
// 0. Actions are mean + std * noise; the environment clips them, the log-probability is that of the
// unclipped ones. Start and noise are keyed by (seed, number of the episode, step), so that an
// episode does not depend on which others are played with it.
void collect(const Play& play, int begin, int end, Rollout& rollout);

// Shows a random half of the episodes mirrored, keyed by (seed, episode). The log-probabilities
// stay those of the actions that were taken: recomputing them would declare an action likely that
// this policy may never take, and PPO's ratio would no longer limit the step.
void mirror_half(Rollout& rollout, std::uint64_t seed, std::uint32_t first_episode);

}  // namespace threelink_agent

/// @file
/// Episodes that are played with exploration noise, from which the learner learns.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include <Eigen/Core>

#include "threelink_agent/policy.hpp"
#include "threelink_agent/training/exploration_noise.hpp"
#include "threelink_sim/environment.hpp"
#include "threelink_sim/goal/goals.hpp"

namespace threelink_agent {

/// Structure of arrays over samples: step t of episode i is sample t * episodes + i. Observations
/// and actions are those of the network, that is after canonicalisation. Observations are those of
/// the critic; the actor receives their first components, as many as it has inputs.
struct Rollout {
  int steps;  ///< N_s
  int episodes;
  int observation_size;             ///< O
  int hinges;                       ///< A
  std::vector<float> observations;  ///< (O, steps + 1, episodes); the last follow the last action
  std::vector<float> actions;       ///< (A, steps, episodes) [1/T0] as sampled, before any clipping
  std::vector<float> log_probs;     ///< (steps, episodes) of the sampled action when it was sampled
  std::vector<float> rewards;       ///< (steps, episodes)
  std::vector<std::uint8_t> captured;  ///< (steps, episodes) 1: the step ended in a capture, else 0

  Rollout(const threelink_sim::EnvironmentConfig& config, int episodes);

  /// Mean over the episodes of their undiscounted sum of rewards.
  double mean_return() const;
};

/// Everything that determines how episodes are played.
struct Play {
  threelink_sim::EnvironmentConfig environment;
  threelink_sim::GoalConfig goal;
  Symmetry canonical;       ///< applied to input and output of the actor
  Mlp actor;                ///< the mean of the actions
  Eigen::VectorXf log_std;  ///< (A) logarithm of their standard deviation [1/T0]
  std::uint64_t seed;
  std::uint32_t first_episode;  ///< number of the rollout's first episode
};

/// The start of the rollout's episode i if its goal is a direction, keyed by (seed, number of the
/// episode).
threelink_sim::SwimmerState start_of(const Play& play, int i);

/// The policy in the rollout's episodes begin .. end - 1, n of them side by side. It computes
/// actions from observations and records observations, actions and rewards in the rollout. The
/// caller moves the swimmers. Only the constructor allocates.
class RolloutActor {
 public:
  /// Both references must outlive the object.
  RolloutActor(const Play& play, int begin, int end, Rollout& rollout);

  /// Step t in [0, steps]: the observations, component k of episode i at [k * n + i].
  void see(int t, const double* observed);
  /// Step t in [0, steps): the rates for the last observations [1/T0], hinge j of episode i at [j *
  /// n + i], before any clipping.
  const double* act(int t);
  /// The rewards of step t (n).
  void earn(int t, const double* rewards);

 private:
  std::size_t at(int t) const { return std::size_t(t) * rollout_->episodes + begin_; }

  const Play* play_;
  Eigen::VectorXf std_;
  int begin_, n_;
  Rollout* rollout_;
  ExplorationNoise noise_;
  std::vector<float> seen_, mean_;
  std::vector<char> reversed_;
  std::vector<double> rates_;
};

/// Plays the rollout's episodes begin .. end - 1 side by side from random starts. Actions are mean
/// + std * noise; the environment clips them, the log-probability is that of the unclipped ones.
/// Start and noise are keyed by (seed, number of the episode, step), so that an episode does not
/// depend on the others.
void collect(const Play& play, int begin, int end, Rollout& rollout);

/// Mirrors a random half of the episodes, keyed by (seed, episode). The log-probabilities remain
/// those of the sampled actions: recomputing them would assign a high probability to an action that
/// this policy may never sample, and PPO's ratio would no longer limit the step.
void mirror_half(Rollout& rollout, std::uint64_t seed, std::uint32_t first_episode);

}  // namespace threelink_agent

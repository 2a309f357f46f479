/// @file
/// A whole episode in one process: task, simulation and policy without topics between them.
///
/// The loop over topics gives the same numbers to the bit for the same seed and episode number.
#pragma once

#include <functional>

#include "threelink_agent/policy.hpp"
#include "threelink_sim/environment.hpp"
#include "threelink_tasks/task.hpp"

namespace threelink_tasks {

/// State k of an episode and the decision in it.
struct EpisodeStep {
  std::uint64_t step;  ///< k
  threelink_sim::SwimmerState state;
  Eigen::Vector2d target;            ///< [L]
  threelink_sim::HingeVector rates;  ///< [1/T0] rates of the policy; empty in the last state
};

/// Progress of an episode in state k.
struct EpisodeMeasures {
  std::uint64_t steps = 0;  ///< k
  double time = 0.0;        ///< [T0] k dt
  double distance = 0.0;    ///< [L] centroid to target
  double mean_speed = 0.0;  ///< [L/T0] the centroid's net displacement / time; 0 in state 0
};
/// The progress from positions [L] in the fixed frame.
EpisodeMeasures measure(std::uint64_t step, double dt, const Eigen::Vector2d& first_centroid,
                        const Eigen::Vector2d& centroid, const Eigen::Vector2d& target);

/// Outcome and final measures of an episode.
struct EpisodeResult {
  Outcome outcome = Outcome::kRunning;
  EpisodeMeasures measures;
};

/// Plays an episode. `environment` must have one lane and the policy's number of links. `sampled`
/// actions are keyed by (seed, episode, step); otherwise the mean is used. `watch` receives every
/// state in order.
EpisodeResult run_episode(Task& task, threelink_sim::Environment& environment,
                          const threelink_agent::Policy& policy, std::uint64_t seed,
                          std::uint32_t episode, bool sampled,
                          const std::function<void(const EpisodeStep&)>& watch);

}  // namespace threelink_tasks

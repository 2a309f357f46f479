/// @file
/// Many episodes of a task at once, side by side in the batch simulation.
///
/// Each is equal to the bit to run_episode() and therefore to the loop over topics.
#pragma once

#include <memory>
#include <vector>

#include "threelink_agent/policy.hpp"
#include "threelink_tasks/episode.hpp"
#include "threelink_tasks/task_factory.hpp"

namespace threelink_tasks {

/// Number and kind of the trials.
struct TrialsConfig {
  std::uint64_t seed = 0;
  int trials = 100;      ///< episodes 1 .. trials, > 0
  bool sampled = false;  ///< actions, else their mean
  std::size_t lanes = 64;
  std::shared_ptr<const threelink_sim::World> world;  ///< null: still water
};

/// Result of one trial.
struct Trial {
  Outcome outcome = Outcome::kRunning;  ///< still: it has left the grid of the world's flow
  EpisodeMeasures measures;
  double path_length = 0;  ///< [L] from the start through all waypoints; 0 if there are none
};

/// Plays all trials and returns them in order. `make` returns a configured task. Swimmer and dt are
/// those of the policy. Throws std::invalid_argument if a start does not fit.
std::vector<Trial> run_trials(const TaskMaker& make, const threelink_agent::Policy& policy,
                              const TrialsConfig& config);

}  // namespace threelink_tasks

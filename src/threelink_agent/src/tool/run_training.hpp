// A training from its configuration to its policy, for `train` and for the learner node.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>

#include "progress.hpp"
#include "threelink_agent/training/rollout_source.hpp"
#include "threelink_agent/training/trainer.hpp"

namespace threelink_agent {

struct RunSettings {
  std::string prefix = "--";              // of the names of these settings, in messages
  std::string config;                     // YAML file; may be empty if a run is resumed
  std::string out;                        // folder of the run
  std::optional<std::uint64_t> seed;      // instead of the configuration's
  std::optional<std::uint32_t> episodes;  // likewise
  std::string backend = "fused";
  int threads = 1;
  bool resume = false;
  std::uint32_t checkpoint_every = 1;  // [updates]
  bool stop_on_save_error = true;
  bool plot = true;  // draw learning_curve.png
};

// How the one who runs it takes part.
struct RunHooks {
  // Asked once, when settings and folder are found good.
  std::function<std::unique_ptr<RolloutSource>(const TrainConfig&)> make_source;
  // Asked after each update.
  std::function<bool()> keep_going;
  // Told after each update, and once before the first.
  std::function<void(const Trainer&, const UpdateReport*, const Progress&)> on_update;
};

struct RunOutcome {
  bool finished;       // not so if keep_going() or the source ended it
  std::string policy;  // file of the best one; empty if there was no evaluation yet
  std::string sha256;  // of its weights, as in the file
};

// Trains, shows its progress on standard output, and keeps the run's folder (run_folder.hpp). What
// ends it before it has finished leaves a checkpoint of the last update, as does NoRollout.
//
// Throws ConfigError and RunFolderError before anything is changed, FileError, TrainingError,
// NoRollout.
RunOutcome run_training(const RunSettings& settings, const RunHooks& hooks);

}  // namespace threelink_agent

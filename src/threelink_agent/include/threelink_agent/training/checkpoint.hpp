/// @file
/// The state of a training between two updates as a file, sufficient to continue to the same bits.
///
/// A safetensors container (safetensors.hpp) like a policy. All tensors are F32:
///
///   actor.0.weight, .., log_std, critic.0.weight, ..   the networks
///   adam.mean.actor.0.weight, .., adam.variance. ..    Adam's moments of each of the above
///   best.actor.0.weight, .., best.log_std              the best policy so far, if there is one
///
/// The metadata hold, beside the two hashes:
///
///   format          threelink-checkpoint-1
///   config          the effective configuration (YAML); with `update` it keys all random numbers
///   backend         backend that computed the updates
///   update, adam_steps, poisoned, poisoned_in_a_row    counters
///   best_score      score of the best policy
///   metrics_bytes   length of metrics.csv up to this update
///   seconds         wall time of the training up to here
#pragma once

#include <cstdint>
#include <stdexcept>
#include <string>

#include "threelink_agent/training/train_config.hpp"
#include "threelink_agent/training/trainer.hpp"

namespace threelink_agent {

/// Error for bytes that are not a checkpoint of this training. what() names the source, the entry,
/// its value and the expected one.
class CheckpointError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// The content of a checkpoint.
struct Checkpoint {
  TrainConfig config;
  std::string backend;
  TrainerState state;
  std::uint64_t metrics_bytes = 0;
  double seconds = 0;  ///< [s]
};

/// The bytes of a checkpoint file.
std::string serialize(const Checkpoint& checkpoint);

/// Reads a checkpoint. Checks both hashes, the shape of every tensor against the networks of
/// `config`, that every number is finite and every counter within its bounds, and that the
/// checkpoint's configuration is `config`. Throws CheckpointError.
Checkpoint parse_checkpoint(const std::string& bytes, const std::string& source,
                            const TrainConfig& config);

}  // namespace threelink_agent

// The training whose checkpoints and batches are fuzzed: as small as it can be, so that inputs are.
#pragma once

#include "threelink_agent/training/train_config.hpp"

namespace threelink_fuzz {

inline threelink_agent::TrainConfig tiny_training() {
  threelink_agent::TrainConfig config =
      threelink_agent::load_train_config(THREELINK_CONFIG "/train_vfs.yaml");
  config.episodes = 8;
  config.evaluate_every = 1;
  config.environment.steps = 3;
  config.hidden = {2};
  config.update.episodes = 2;
  config.update.epochs = 1;
  config.update.minibatch = 6;
  return config;
}

}  // namespace threelink_fuzz

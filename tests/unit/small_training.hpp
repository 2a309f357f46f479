// A training of a fraction of a second, for tests.
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <utility>

#include "threelink_agent/training/backend.hpp"
#include "threelink_agent/training/trainer.hpp"

namespace threelink_tests {

// Two thirds of an update are left over for the last one, the third.
inline threelink_agent::TrainConfig small(std::uint64_t seed = 0) {
  threelink_agent::TrainConfig config =
      threelink_agent::load_train_config(THREELINK_CONFIG "/train_vfs.yaml");
  config.seed = seed;
  config.episodes = 32;
  config.evaluate_every = 2;
  config.environment.steps = 50;
  config.hidden = {16, 16};
  config.update.episodes = 12;
  config.update.epochs = 3;
  config.update.minibatch = 250;
  return config;
}

// The same with points to reach, many of them reached by chance.
inline threelink_agent::TrainConfig small_homing(std::uint64_t seed = 0) {
  threelink_agent::TrainConfig config = small(seed);
  config.environment.observation = threelink_sim::ObservationKind::kTarget;
  config.goal.points = threelink_sim::PointsGoal{0.3, 0.002, 0.02, 0.004, 1.5};
  return config;
}

inline threelink_agent::Trainer trainer_of(
    const threelink_agent::TrainConfig& config, int threads = 1,
    threelink_agent::Backend backend = threelink_agent::Backend::kFused) {
  return threelink_agent::Trainer(config,
                                  threelink_agent::make_ppo_update(backend, config, threads),
                                  std::make_unique<threelink_agent::LocalRollouts>(threads));
}

inline std::string sha256_of_training(
    const threelink_agent::TrainConfig& config, int threads = 1,
    threelink_agent::Backend backend = threelink_agent::Backend::kFused) {
  threelink_agent::Trainer trainer = trainer_of(config, threads, backend);
  while (!trainer.finished()) trainer.update();
  return trainer.policy().sha256();
}

}  // namespace threelink_tests

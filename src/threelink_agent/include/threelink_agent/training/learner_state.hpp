/// @file
/// The state of networks and optimisers that training changes, as checkpoints hold it.
#pragma once

#include <cstdint>
#include <vector>

#include <Eigen/Core>

#include "threelink_agent/mlp.hpp"
#include "threelink_agent/training/train_config.hpp"

namespace threelink_agent {

/// One number for each parameter.
struct LearnerTensors {
  std::vector<Linear> actor;
  Eigen::VectorXf log_std;  ///< (A) logarithm of the standard deviation of the noise [1/T0];
                            ///< constant for Adam unless it is learned
  std::vector<Linear> critic;
};

/// Networks and optimisers between two updates.
struct LearnerState {
  LearnerTensors parameters;
  LearnerTensors mean, variance;  ///< Adam's first and second moment, m and v
  std::uint64_t adam_steps = 0;   ///< steps taken so far, the same number for actor and critic

  /// Whether no number is NaN or infinite.
  bool all_finite() const;
};

/// The state before the first update. Weights are uniform in +- gain sqrt(6 / (inputs + outputs))
/// (Glorot and Bengio 2010), keyed by (seed, network, layer); gain 1, but 0.01 for the last layer
/// of the actor, so that the first mean action is nearly zero and the first episodes explore all
/// directions alike. Biases and moments are 0.
LearnerState initial_state(const TrainConfig& config);

}  // namespace threelink_agent

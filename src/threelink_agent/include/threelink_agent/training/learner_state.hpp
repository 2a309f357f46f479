/// @file
/// All that training changes in the networks: what a checkpoint holds of them.
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
  Eigen::VectorXf log_std;  ///< (A) of the noise [1/T0]; Adam only moves it if it is learned
  std::vector<Linear> critic;
};

struct LearnerState {
  LearnerTensors parameters;
  LearnerTensors mean, variance;  ///< Adam's first and second moment, m and v
  std::uint64_t adam_steps = 0;   ///< taken so far, the same number by actor and critic

  /// No NaN, no infinity anywhere.
  bool all_finite() const;
};

/// Before the first update. Weights are uniform in +- gain sqrt(6 / (inputs + outputs)) (Glorot and
/// Bengio 2010), keyed by (seed, network, layer); gain 1, but 0.01 for the last layer of the actor,
/// so that the first mean is nearly zero and the first episodes try all directions alike. Biases
/// and moments are 0.
LearnerState initial_state(const TrainConfig& config);

}  // namespace threelink_agent

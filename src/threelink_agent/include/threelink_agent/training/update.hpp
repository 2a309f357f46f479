/// @file
/// Inputs of one update beside the rollout, and its statistics.
#pragma once

namespace threelink_agent {

/// Learning rates of one update.
struct LearningRates {
  double actor = 0;
  double critic = 0;
};

/// Statistics of one update.
struct UpdateStatistics {
  double policy_loss = 0;    ///< mean over the samples of all epochs
  double value_loss = 0;     ///< likewise
  double kl = 0;             ///< mean estimate of KL(old || new) in the last epoch
  double clip_fraction = 0;  ///< of the last epoch's samples: ratio outside 1 +- epsilon
};

}  // namespace threelink_agent

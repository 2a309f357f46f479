// What goes into one update beside the rollout, and what comes out of it.
#pragma once

namespace threelink_agent {

struct LearningRates {
  double actor;
  double critic;
};

struct UpdateStatistics {
  double policy_loss;    // mean over the samples of all epochs
  double value_loss;     // likewise
  double kl;             // mean estimate of KL(old || new) in the last epoch
  double clip_fraction;  // of the samples of the last epoch whose ratio was outside 1 +- epsilon
};

}  // namespace threelink_agent

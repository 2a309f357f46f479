/// @file
/// One PPO update of actor and critic: the interface of the backends.
#pragma once

#include <cstdint>

#include <Eigen/Core>

#include "threelink_agent/mlp.hpp"
#include "threelink_agent/training/advantage.hpp"
#include "threelink_agent/training/learner_state.hpp"
#include "threelink_agent/training/rollout.hpp"
#include "threelink_agent/training/update.hpp"

namespace threelink_agent {

/// Holds the networks and the state of their optimisers. Actor and critic share neither parameters
/// nor loss; each has its own Adam and its own limit of the gradient norm.
class PpoUpdate {
 public:
  virtual ~PpoUpdate() = default;

  /// K epochs over the rollout; `update` counts from 0 and keys the order of the samples.
  virtual UpdateStatistics run(const Rollout& rollout, const Advantages& advantages,
                               std::uint32_t update, const LearningRates& rates) = 0;

  virtual Mlp actor() const = 0;
  virtual Mlp critic() const = 0;
  virtual Eigen::VectorXf log_std() const = 0;  ///< (A)
  /// Sets a scheduled standard deviation [1/T0].
  virtual void set_std(double std) = 0;

  /// The state of networks and optimisers. After restore(), whose argument must have the shapes of
  /// state(), the updates give the same bits again.
  virtual LearnerState state() const = 0;
  virtual void restore(const LearnerState& state) = 0;
};

}  // namespace threelink_agent

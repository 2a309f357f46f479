// One PPO update of actor and critic by LibTorch's autograd and Adam.
#pragma once

#include <cstdint>

#include <torch/torch.h>

#include "threelink_agent/training/advantage.hpp"
#include "threelink_agent/training/networks.hpp"
#include "threelink_agent/training/optimiser.hpp"
#include "threelink_agent/training/rollout.hpp"
#include "threelink_agent/training/train_config.hpp"
#include "threelink_agent/training/update.hpp"

namespace threelink_agent {

// Holds the networks and the optimisers. Actor and critic share no parameter and no loss: each has
// its own Adam and gradient clip, and the two are independent given the batch, so that two threads
// give the same bits as one.
class PpoUpdate {
 public:
  PpoUpdate(const TrainConfig& config, int threads);

  // K epochs over the rollout; `update` counts from 0 and keys the order of the samples.
  UpdateStatistics run(const Rollout& rollout, const Advantages& advantages, std::uint32_t update,
                       const LearningRates& rates);

  Mlp actor() const { return actor_.mlp(); }
  Mlp critic() const { return critic_.mlp(); }
  Eigen::VectorXf log_std() const;
  // Of a scheduled standard deviation.
  void set_std(double std);

 private:
  struct Batch;
  void train_actor(const Batch& batch, std::uint32_t update, UpdateStatistics& statistics);
  void train_critic(const Batch& batch, std::uint32_t update, UpdateStatistics& statistics);
  // Calls visit(epoch, indices of the samples) for K epochs, each of which visits every sample
  // once.
  template <class Visit>
  void for_each_minibatch(std::int64_t samples, std::uint32_t update, Visit&& visit) const;
  std::vector<torch::Tensor> actor_parameters() const;

  TrainConfig config_;
  int threads_;
  TanhNetwork actor_, critic_;
  torch::Tensor log_std_;  // (A) of the noise [1/T0]
  FlatAdam actor_adam_, critic_adam_;
};

}  // namespace threelink_agent

/// @file
/// The update by LibTorch's autograd and Adam. It is slower than FusedUpdate and serves as its
/// reference in tests.
#pragma once

#include <cstdint>

#include <torch/torch.h>

#include "threelink_agent/training/networks.hpp"
#include "threelink_agent/training/optimiser.hpp"
#include "threelink_agent/training/ppo_update.hpp"

namespace threelink_agent {

/// Actor and critic are independent of each other, so that two threads give the same bits as one.
class TorchUpdate : public PpoUpdate {
 public:
  /// Sets BLAS and LibTorch in the whole process to one thread for each operation. threads: at
  /// least 1; at most two are used.
  TorchUpdate(const TrainConfig& config, int threads);

  UpdateStatistics run(const Rollout& rollout, const Advantages& advantages, std::uint32_t update,
                       const LearningRates& rates) override;

  Mlp actor() const override { return Mlp(actor_.layers()); }
  Mlp critic() const override { return Mlp(critic_.layers()); }
  Eigen::VectorXf log_std() const override;
  void set_std(double std) override;

  LearnerState state() const override;
  void restore(const LearnerState& state) override;

 private:
  TorchUpdate(const TrainConfig& config, int threads, const LearnerState& start);

  struct Batch;
  void train_actor(const Batch& batch, std::uint32_t update, UpdateStatistics& statistics);
  void train_critic(const Batch& batch, std::uint32_t update, UpdateStatistics& statistics);
  /// Calls visit(epoch, indices of the samples) for K epochs, each of which visits every sample
  /// once.
  template <class Visit>
  void for_each_minibatch(std::int64_t samples, std::uint32_t update, Visit&& visit) const;
  std::vector<torch::Tensor> actor_parameters() const;

  TrainConfig config_;
  int threads_;
  TanhNetwork actor_, critic_;
  torch::Tensor log_std_;  ///< (A) of the noise [1/T0]
  FlatAdam actor_adam_, critic_adam_;
};

}  // namespace threelink_agent

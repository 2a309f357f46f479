/// @file
/// The update by this project's own kernels: forward pass, loss and backward pass of a minibatch,
/// without LibTorch.
#pragma once

#include <cstdint>
#include <vector>

#include "threelink_agent/training/crew.hpp"
#include "threelink_agent/training/fused_network.hpp"
#include "threelink_agent/training/ppo_update.hpp"
#include "threelink_agent/training/samples.hpp"
#include "threelink_sim/isa.hpp"

namespace threelink_agent {

/// Each minibatch is cut into kSlices slices. The gradients of the samples of a slice are summed in
/// their order, and so are the sums of the slices, whichever threads computed them. The result
/// depends neither on the number of threads nor on the instruction set.
class FusedUpdate : public PpoUpdate {
 public:
  static constexpr int kSlices = 4;

  /// threads: at least 1; more than 2 kSlices are not used. Throws ConfigError,
  /// and std::invalid_argument if this processor lacks the instruction set.
  FusedUpdate(const TrainConfig& config, int threads,
              threelink_sim::Isa isa = threelink_sim::isa_in_use());

  UpdateStatistics run(const Rollout& rollout, const Advantages& advantages, std::uint32_t update,
                       const LearningRates& rates) override;

  Mlp actor() const override { return Mlp(actor_.parameters().layers, isa_); }
  Mlp critic() const override { return Mlp(critic_.parameters().layers, isa_); }
  Eigen::VectorXf log_std() const override;
  void set_std(double std) override;

  LearnerState state() const override;
  void restore(const LearnerState& state) override;

 private:
  FusedUpdate(const TrainConfig& config, int threads, threelink_sim::Isa isa,
              const LearnerState& start);

  /// The part of a minibatch that belongs to one slice.
  struct Share {
    const std::int64_t* chosen;  ///< (count) samples
    int count;
    float weight;  ///< weight of a sample in the loss: 1 / samples of the minibatch
    bool last_epoch;
  };
  /// Sums over samples for the statistics. Each occupies its own cache line.
  struct alignas(64) Sums {
    double policy_loss = 0, value_loss = 0;  // over all epochs
    double kl = 0, outside = 0;              // over the last one
  };
  void differentiate_actor(const Samples& samples, const Share& share, FusedNetwork::Slice& slice,
                           Sums& sums) const;
  void differentiate_critic(const Samples& samples, const Share& share, FusedNetwork::Slice& slice,
                            Sums& sums) const;

  TrainConfig config_;
  threelink_sim::Isa isa_;
  const GradientKernels* kernels_;
  SampleRow row_;
  FusedNetwork actor_, critic_;  ///< log_std is the actor's extra parameter
  std::vector<FusedNetwork::Slice> actor_slices_, critic_slices_;
  Crew crew_;
};

}  // namespace threelink_agent

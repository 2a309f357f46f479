#include "threelink_agent/training/fused_update.hpp"

#include <algorithm>
#include <cmath>
#include <functional>

#include "threelink_agent/training/minibatches.hpp"

namespace threelink_agent {

using threelink_sim::kMaxHinges;

FusedUpdate::FusedUpdate(const TrainConfig& config, int threads, threelink_sim::Isa isa)
    : FusedUpdate(config, threads, isa, initial_state(config)) {}

FusedUpdate::FusedUpdate(const TrainConfig& config, int threads, threelink_sim::Isa isa,
                         const LearnerState& start)
    : config_((config.validate(), config)),
      isa_(isa),
      kernels_(&gradient_kernels(isa)),
      row_{
          threelink_sim::observation_size(config.environment.observation, config.environment.model),
          config.environment.model.hinges()},
      actor_({start.parameters.actor, start.parameters.log_std}, *kernels_),
      critic_({start.parameters.critic, {}}, *kernels_),
      actor_slices_(kSlices, FusedNetwork::Slice(actor_, row_.stride())),
      critic_slices_(kSlices, FusedNetwork::Slice(critic_, row_.stride())),
      crew_(std::min(threads, 2 * kSlices)) {}

Eigen::VectorXf FusedUpdate::log_std() const {
  return Eigen::Map<const Eigen::VectorXf>(actor_.extra(), row_.hinges);
}

void FusedUpdate::set_std(double std) {
  std::fill_n(actor_.extra(), row_.hinges, static_cast<float>(std::log(std)));
}

LearnerState FusedUpdate::state() const {
  const auto join = [](const NetworkTensors& actor, const NetworkTensors& critic) {
    return LearnerTensors{actor.layers, actor.extra, critic.layers};
  };
  return {join(actor_.parameters(), critic_.parameters()), join(actor_.mean(), critic_.mean()),
          join(actor_.variance(), critic_.variance()), actor_.steps()};
}

void FusedUpdate::restore(const LearnerState& state) {
  const auto actor = [](const LearnerTensors& t) { return NetworkTensors{t.actor, t.log_std}; };
  const auto critic = [](const LearnerTensors& t) { return NetworkTensors{t.critic, {}}; };
  actor_.set(actor(state.parameters), actor(state.mean), actor(state.variance), state.adam_steps);
  critic_.set(critic(state.parameters), critic(state.mean), critic(state.variance),
              state.adam_steps);
}

UpdateStatistics FusedUpdate::run(const Rollout& rollout, const Advantages& advantages,
                                  std::uint32_t update, const LearningRates& rates) {
  const Samples samples(rollout, advantages);
  const std::uint32_t n = samples.count(), epochs = config_.update.epochs;
  const double max_norm = config_.update.max_gradient_norm;
  std::vector<std::int64_t> order;
  std::uint32_t epoch = 0, begin = 0, size = 0;  // of the present minibatch
  Sums sums[kSlices][2];

  // Even tasks are slices of the actor, odd ones of the critic.
  const std::function<void(int)> differentiate = [&](int task) {
    const int slice = task / 2;
    const std::uint64_t from = std::uint64_t{size} * slice / kSlices;
    const std::uint64_t to = std::uint64_t{size} * (slice + 1) / kSlices;
    const Share share{order.data() + begin + from, static_cast<int>(to - from), 1.0f / size,
                      epoch + 1 == epochs};
    if (task % 2 == 0)
      differentiate_actor(samples, share, actor_slices_[slice], sums[slice][0]);
    else
      differentiate_critic(samples, share, critic_slices_[slice], sums[slice][1]);
  };
  const std::function<void(int)> descend = [&](int task) {
    if (task == 0)
      actor_.descend(actor_slices_, rates.actor, max_norm);
    else
      critic_.descend(critic_slices_, rates.critic, max_norm);
  };
  for (epoch = 0; epoch < epochs; ++epoch) {
    order = shuffled(n, config_.seed, update, epoch);
    for (begin = 0; begin < n; begin += size) {
      size = std::min(config_.update.minibatch, n - begin);
      crew_.run(2 * kSlices, differentiate);
      crew_.run(2, descend);
    }
  }

  UpdateStatistics statistics{};
  for (const auto& [actor, critic] : sums) {
    statistics.policy_loss += actor.policy_loss / epochs / n;
    statistics.value_loss += critic.value_loss / epochs / n;
    statistics.kl += actor.kl / n;
    statistics.clip_fraction += actor.outside / n;
  }
  return statistics;
}

void FusedUpdate::differentiate_actor(const Samples& samples, const Share& share,
                                      FusedNetwork::Slice& slice, Sums& sums) const {
  const int hinges = row_.hinges, stride = slice.output_stride();
  const bool learned_std = config_.exploration.learned;
  const float* log_std = actor_.extra();
  float inverse_std[kMaxHinges];
  for (int j = 0; j < hinges; ++j) inverse_std[j] = std::exp(-log_std[j]);
  alignas(64) float mean[kMaxHinges * kLossBlock], actions[kMaxHinges * kLossBlock],
      z[kMaxHinges * kLossBlock], log_probs[kLossBlock], advantages[kLossBlock],
      log_ratio[kLossBlock], loss[kLossBlock], slope[kLossBlock];
  const PolicyLoss policy_loss{hinges,    static_cast<float>(config_.update.clip),
                               log_std,   inverse_std,
                               mean,      actions,
                               log_probs, advantages,
                               z,         log_ratio,
                               loss,      slope};
  slice.clear();
  for (int first = 0; first < share.count; first += kLossBlock) {
    const int n = std::min(kLossBlock, share.count - first);
    samples.gather(share.chosen + first, n, slice.inputs());
    slice.forward(n);
    for (int i = 0; i < n; ++i) {
      const float* row = slice.inputs() + i * row_.stride();
      const float* output = slice.outputs() + i * stride;
      for (int j = 0; j < hinges; ++j) {
        mean[j * kLossBlock + i] = output[j];
        actions[j * kLossBlock + i] = row[row_.action() + j];
      }
      log_probs[i] = row[row_.log_prob()];
      advantages[i] = row[row_.advantage()];
    }
    kernels_->policy_loss(policy_loss);
    for (int i = 0; i < n; ++i) {
      const float weighted = slope[i] * share.weight;
      float* gradient = slice.output_gradient() + i * stride;
      for (int j = 0; j < hinges; ++j) {
        const float z_j = z[j * kLossBlock + i];
        gradient[j] = weighted * z_j * inverse_std[j];
        if (learned_std) slice.extra_gradient()[j] += weighted * (z_j * z_j - 1);
      }
      sums.policy_loss += loss[i];
    }
    if (learned_std)  // the entropy is sum_j log std_j and a constant
      for (int j = 0; j < hinges; ++j)
        slice.extra_gradient()[j] -=
            static_cast<float>(config_.update.entropy_weight) * share.weight * n;
    if (share.last_epoch)
      for (int i = 0; i < n; ++i) {
        const double change = std::expm1(static_cast<double>(log_ratio[i]));  // of the probability
        sums.kl += change - log_ratio[i];
        sums.outside += std::abs(change) > config_.update.clip;
      }
    slice.backward(n);
  }
}

void FusedUpdate::differentiate_critic(const Samples& samples, const Share& share,
                                       FusedNetwork::Slice& slice, Sums& sums) const {
  const int stride = slice.output_stride();
  slice.clear();
  for (int first = 0; first < share.count; first += kLossBlock) {
    const int n = std::min(kLossBlock, share.count - first);
    samples.gather(share.chosen + first, n, slice.inputs());
    slice.forward(n);
    for (int i = 0; i < n; ++i) {
      const float target = slice.inputs()[i * row_.stride() + row_.value_target()];
      const float error = slice.outputs()[i * stride] - target;
      slice.output_gradient()[i * stride] = error * share.weight;
      sums.value_loss += 0.5 * error * error;
    }
    slice.backward(n);
  }
}

}  // namespace threelink_agent

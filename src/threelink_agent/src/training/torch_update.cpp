#include "threelink_agent/training/torch_update.hpp"

#include <algorithm>
#include <future>

#include "threelink_agent/training/blas.hpp"
#include "threelink_agent/training/losses.hpp"
#include "threelink_agent/training/minibatches.hpp"

namespace threelink_agent {

using torch::Tensor;

namespace {

// Component-major rows of `stride` samples -> (samples, components), contiguous.
Tensor samples_of(const std::vector<float>& array, std::int64_t components, std::int64_t stride,
                  std::int64_t samples) {
  return torch::from_blob(const_cast<float*>(array.data()), {components, stride})
      .narrow(1, 0, samples)
      .t()
      .contiguous();
}

Tensor vector_of(const std::vector<float>& array) {
  return torch::from_blob(const_cast<float*>(array.data()), {std::int64_t(array.size())}).clone();
}

Tensor tensor_of(const Eigen::VectorXf& vector) {
  return torch::from_blob(const_cast<float*>(vector.data()), {vector.size()}).clone();
}

// In the order of torch::nn::Module::parameters(): weight, bias, weight, ...
std::vector<float> flattened(const std::vector<Linear>& layers) {
  std::vector<float> flat;
  for (const Linear& layer : layers) {
    flat.insert(flat.end(), layer.weight.data(), layer.weight.data() + layer.weight.size());
    flat.insert(flat.end(), layer.bias.data(), layer.bias.data() + layer.bias.size());
  }
  return flat;
}

// The inverse, into layers of the right shapes; returns what follows.
const float* unflatten(const float* flat, std::vector<Linear>& layers) {
  for (Linear& layer : layers) {
    std::copy_n(flat, layer.weight.size(), layer.weight.data());
    flat += layer.weight.size();
    std::copy_n(flat, layer.bias.size(), layer.bias.data());
    flat += layer.bias.size();
  }
  return flat;
}

}  // namespace

struct TorchUpdate::Batch {
  Tensor observations;  // (n, O)
  Tensor actions;       // (n, A)
  Tensor log_probs;     // (n)
  Tensor advantages;    // (n)
  Tensor returns;       // (n)

  std::int64_t size() const { return log_probs.size(0); }
};

TorchUpdate::TorchUpdate(const TrainConfig& config, int threads)
    : TorchUpdate(config, threads, initial_state(config)) {}

TorchUpdate::TorchUpdate(const TrainConfig& config, int threads, const LearnerState& start)
    : config_(config),
      threads_(threads),
      actor_("actor", start.parameters.actor),
      critic_("critic", start.parameters.critic),
      log_std_(tensor_of(start.parameters.log_std).set_requires_grad(config.exploration.learned)),
      actor_adam_(actor_parameters(), config.update.max_gradient_norm),
      critic_adam_(critic_.parameters(), config.update.max_gradient_norm) {
  use_one_thread_per_operation();
}

std::vector<Tensor> TorchUpdate::actor_parameters() const {
  std::vector<Tensor> parameters = actor_.parameters();
  if (config_.exploration.learned) parameters.push_back(log_std_);
  return parameters;
}

Eigen::VectorXf TorchUpdate::log_std() const {
  return Eigen::Map<const Eigen::VectorXf>(log_std_.data_ptr<float>(), log_std_.numel());
}

void TorchUpdate::set_std(double std) { log_std_.fill_(std::log(std)); }

LearnerState TorchUpdate::state() const {
  const int hinges = config_.environment.model.hinges();
  LearnerState state;
  state.parameters = {actor_.layers(), log_std(), critic_.layers()};
  state.mean = state.variance = state.parameters;  // for the shapes
  const FlatAdam::State actor = actor_adam_.state(), critic = critic_adam_.state();
  state.adam_steps = actor.steps;
  const auto unpack = [&](const Tensor& of_actor, const Tensor& of_critic,
                          LearnerTensors& tensors) {
    const float* rest = unflatten(of_actor.data_ptr<float>(), tensors.actor);
    tensors.log_std.setZero();
    if (config_.exploration.learned)
      tensors.log_std = Eigen::Map<const Eigen::VectorXf>(rest, hinges);
    unflatten(of_critic.data_ptr<float>(), tensors.critic);
  };
  unpack(actor.mean, critic.mean, state.mean);
  unpack(actor.variance, critic.variance, state.variance);
  return state;
}

void TorchUpdate::restore(const LearnerState& state) {
  torch::NoGradGuard no_grad;
  actor_.set_layers(state.parameters.actor);
  critic_.set_layers(state.parameters.critic);
  log_std_.copy_(tensor_of(state.parameters.log_std));
  const auto of_actor = [&](const LearnerTensors& tensors) {
    std::vector<float> flat = flattened(tensors.actor);
    if (config_.exploration.learned)
      flat.insert(flat.end(), tensors.log_std.data(),
                  tensors.log_std.data() + tensors.log_std.size());
    return vector_of(flat);
  };
  const auto steps = static_cast<std::int64_t>(state.adam_steps);
  actor_adam_.restore({of_actor(state.mean), of_actor(state.variance), steps});
  critic_adam_.restore({vector_of(flattened(state.mean.critic)),
                        vector_of(flattened(state.variance.critic)), steps});
}

UpdateStatistics TorchUpdate::run(const Rollout& rollout, const Advantages& advantages,
                                  std::uint32_t update, const LearningRates& rates) {
  actor_adam_.set_learning_rate(rates.actor);
  critic_adam_.set_learning_rate(rates.critic);
  const std::int64_t n = rollout.log_probs.size();
  const Batch batch{
      samples_of(rollout.observations, rollout.observation_size, n + rollout.episodes, n),
      samples_of(rollout.actions, rollout.hinges, n, n), vector_of(rollout.log_probs),
      vector_of(advantages.advantages), vector_of(advantages.returns)};
  UpdateStatistics statistics{};
  const auto policy = threads_ > 1 ? std::launch::async : std::launch::deferred;
  auto critic = std::async(policy, [&] { train_critic(batch, update, statistics); });
  train_actor(batch, update, statistics);
  critic.get();
  return statistics;
}

void TorchUpdate::train_actor(const Batch& batch, std::uint32_t update,
                              UpdateStatistics& statistics) {
  const double epsilon = config_.update.clip;
  const Tensor seen = batch.observations.narrow(1, 0, actor_.inputs());
  double loss_sum = 0;
  for_each_minibatch(batch.size(), update, [&](std::uint32_t epoch, const Tensor& chosen) {
    const Tensor advantages = batch.advantages.index_select(0, chosen);
    const Tensor mean = actor_.forward(seen.index_select(0, chosen));
    const Tensor log_ratio =
        log_probability(batch.actions.index_select(0, chosen), mean, log_std_) -
        batch.log_probs.index_select(0, chosen);
    Tensor loss = clipped_policy_loss(log_ratio, advantages, epsilon);
    loss_sum += loss.item<double>() * chosen.size(0);
    if (config_.update.entropy_weight > 0)
      loss = loss - config_.update.entropy_weight * entropy(log_std_);
    actor_adam_.descend(loss);
    if (epoch + 1 == config_.update.epochs) {
      const double share = double(chosen.size(0)) / batch.size();
      const Tensor detached = log_ratio.detach();
      statistics.kl += share * kl_estimate(detached).item<double>();
      statistics.clip_fraction += share * clip_fraction(detached, epsilon).item<double>();
    }
  });
  statistics.policy_loss = loss_sum / (batch.size() * config_.update.epochs);
}

void TorchUpdate::train_critic(const Batch& batch, std::uint32_t update,
                               UpdateStatistics& statistics) {
  double loss_sum = 0;
  for_each_minibatch(batch.size(), update, [&](std::uint32_t, const Tensor& chosen) {
    const Tensor values = critic_.forward(batch.observations.index_select(0, chosen)).squeeze(1);
    const Tensor loss = value_loss(values, batch.returns.index_select(0, chosen));
    loss_sum += loss.item<double>() * chosen.size(0);
    critic_adam_.descend(loss);
  });
  statistics.value_loss = loss_sum / (batch.size() * config_.update.epochs);
}

template <class Visit>
void TorchUpdate::for_each_minibatch(std::int64_t samples, std::uint32_t update,
                                     Visit&& visit) const {
  for (std::uint32_t epoch = 0; epoch < config_.update.epochs; ++epoch) {
    std::vector<std::int64_t> order = shuffled(samples, config_.seed, update, epoch);
    const Tensor indices = torch::from_blob(order.data(), {samples}, torch::kInt64);
    for (const Tensor& chosen : indices.split(config_.update.minibatch)) visit(epoch, chosen);
  }
}

}  // namespace threelink_agent

#include "threelink_agent/training/ppo_update.hpp"

#include <future>

#include "threelink_agent/training/losses.hpp"
#include "threelink_agent/training/minibatches.hpp"

namespace threelink_agent {

using torch::Tensor;

namespace {

constexpr std::uint32_t kActor = 0, kCritic = 1;  // for initialise()

std::vector<int> layer_sizes(const TrainConfig& config, int outputs) {
  std::vector<int> sizes{threelink_sim::direction_observation_size(config.environment.model)};
  sizes.insert(sizes.end(), config.hidden.begin(), config.hidden.end());
  sizes.push_back(outputs);
  return sizes;
}

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

}  // namespace

struct PpoUpdate::Batch {
  Tensor observations;  // (n, O)
  Tensor actions;       // (n, A)
  Tensor log_probs;     // (n)
  Tensor advantages;    // (n)
  Tensor returns;       // (n)

  std::int64_t size() const { return log_probs.size(0); }
};

PpoUpdate::PpoUpdate(const TrainConfig& config, int threads)
    : config_(config),
      threads_(threads),
      actor_("actor", layer_sizes(config, config.environment.model.hinges())),
      critic_("critic", layer_sizes(config, 1)),
      log_std_(torch::full({config.environment.model.hinges()}, std::log(config.exploration.std),
                           torch::requires_grad(config.exploration.learned))),
      actor_adam_(actor_parameters(), config.update.max_gradient_norm),
      critic_adam_(critic_.parameters(), config.update.max_gradient_norm) {
  // The first mean is nearly zero, so that the first episodes try all directions alike.
  actor_.initialise(config.seed, kActor, 0.01);
  critic_.initialise(config.seed, kCritic, 1.0);
}

std::vector<Tensor> PpoUpdate::actor_parameters() const {
  std::vector<Tensor> parameters = actor_.parameters();
  if (config_.exploration.learned) parameters.push_back(log_std_);
  return parameters;
}

Eigen::VectorXf PpoUpdate::log_std() const {
  return Eigen::Map<const Eigen::VectorXf>(log_std_.data_ptr<float>(), log_std_.numel());
}

void PpoUpdate::set_std(double std) { log_std_.fill_(std::log(std)); }

UpdateStatistics PpoUpdate::run(const Rollout& rollout, const Advantages& advantages,
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

void PpoUpdate::train_actor(const Batch& batch, std::uint32_t update,
                            UpdateStatistics& statistics) {
  const double epsilon = config_.update.clip;
  double loss_sum = 0;
  std::int64_t minibatches = 0;
  for_each_minibatch(batch.size(), update, [&](std::uint32_t epoch, const Tensor& chosen) {
    const Tensor advantages = batch.advantages.index_select(0, chosen);
    const Tensor mean = actor_.forward(batch.observations.index_select(0, chosen));
    const Tensor log_ratio =
        log_probability(batch.actions.index_select(0, chosen), mean, log_std_) -
        batch.log_probs.index_select(0, chosen);
    Tensor loss = clipped_policy_loss(log_ratio, advantages, epsilon);
    loss_sum += loss.item<double>();
    ++minibatches;
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
  statistics.policy_loss = loss_sum / minibatches;
}

void PpoUpdate::train_critic(const Batch& batch, std::uint32_t update,
                             UpdateStatistics& statistics) {
  double loss_sum = 0;
  std::int64_t minibatches = 0;
  for_each_minibatch(batch.size(), update, [&](std::uint32_t, const Tensor& chosen) {
    const Tensor values = critic_.forward(batch.observations.index_select(0, chosen)).squeeze(1);
    const Tensor loss = value_loss(values, batch.returns.index_select(0, chosen));
    loss_sum += loss.item<double>();
    ++minibatches;
    critic_adam_.descend(loss);
  });
  statistics.value_loss = loss_sum / minibatches;
}

template <class Visit>
void PpoUpdate::for_each_minibatch(std::int64_t samples, std::uint32_t update,
                                   Visit&& visit) const {
  for (std::uint32_t epoch = 0; epoch < config_.update.epochs; ++epoch) {
    std::vector<std::int64_t> order = shuffled(samples, config_.seed, update, epoch);
    const Tensor indices = torch::from_blob(order.data(), {samples}, torch::kInt64);
    for (const Tensor& chosen : indices.split(config_.update.minibatch)) visit(epoch, chosen);
  }
}

}  // namespace threelink_agent

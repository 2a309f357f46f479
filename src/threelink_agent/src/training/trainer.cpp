#include "threelink_agent/training/trainer.hpp"

#include <algorithm>

#include "threelink_agent/training/blas.hpp"
#include "threelink_agent/training/gaussian.hpp"
#include "threelink_agent/training/ppo_update.hpp"
#include "threelink_agent/training/schedule.hpp"

namespace threelink_agent {

Trainer::Trainer(const TrainConfig& config, int threads)
    : config_((config.validate(), config)), ppo_(std::make_unique<PpoUpdate>(config, threads)) {
  use_one_thread_per_operation();
}

Trainer::~Trainer() = default;

UpdateReport Trainer::update() {
  const double progress = double(update_) / config_.updates();
  const auto& exploration = config_.exploration;
  if (!exploration.learned)
    ppo_->set_std(
        decayed_std(exploration.std, exploration.std_final, exploration.decay_fraction, progress));
  const LearningRates rates{
      annealed(config_.update.actor_learning_rate, config_.update.final_learning_rate, progress),
      annealed(config_.update.critic_learning_rate, config_.update.final_learning_rate, progress)};
  const Eigen::VectorXf log_std = ppo_->log_std();

  const auto episodes = std::min(config_.update.episodes, config_.episodes - episodes_);
  Rollout rollout = collect(config_.environment, config_.symmetry.canonical, ppo_->actor(), log_std,
                            config_.seed, episodes_, static_cast<int>(episodes));
  if (config_.symmetry.mirror) mirror_half(rollout, config_.seed, episodes_);

  UpdateReport report;
  report.statistics = ppo_->run(rollout, advantages(rollout), update_, rates);
  report.update = ++update_;
  report.episodes = episodes_ += episodes;
  report.steps = std::uint64_t{episodes_} * config_.environment.steps;
  report.mean_return = rollout.mean_return();
  report.entropy = log_std.unaryExpr(&gaussian_entropy).sum();
  report.std = log_std.array().exp().mean();
  report.rates = rates;
  if (finished() || update_ % config_.evaluate_every == 0) report.evaluation = evaluate_present();
  return report;
}

Advantages Trainer::advantages(const Rollout& rollout) const {
  const int states = (rollout.steps + 1) * rollout.episodes;
  std::vector<float> values(states);
  ppo_->critic().forward(states, rollout.observations.data(), values.data());
  Advantages result =
      generalised_advantages(rollout.steps, rollout.episodes, rollout.rewards, values,
                             {config_.advantage.discount, config_.advantage.lambda,
                              config_.advantage.bootstrap_at_time_limit});
  if (config_.advantage.normalise) normalise(result.advantages);
  return result;
}

Policy Trainer::policy() const {
  PolicyMetadata metadata;
  metadata.links = config_.environment.model.links;
  metadata.dt = config_.environment.dt;
  metadata.gamma = config_.environment.model.gamma;
  metadata.symmetry = config_.symmetry.canonical;
  metadata.config = to_yaml(config_);
  return Policy(metadata, ppo_->actor(), ppo_->log_std());
}

namespace {
// Enough to notice a policy that gets stuck from one shape in a hundred.
constexpr int kTrials = 200;
}  // namespace

Evaluation Trainer::evaluate_present() {
  const Policy present = policy();
  const Evaluation evaluation = evaluate(present, kTrials, config_.seed);
  const double present_score = score(evaluation, config_.environment);
  if (!best_ || present_score > best_score_) {
    best_ = present;
    best_score_ = present_score;
  }
  return evaluation;
}

double score(const Evaluation& evaluation, const threelink_sim::EnvironmentConfig& environment) {
  double sum = 0;
  for (const StartResult& start : evaluation.starts)
    sum += start.speed - environment.c / environment.b * start.power;
  return evaluation.success_rate * sum / evaluation.starts.size();
}

}  // namespace threelink_agent

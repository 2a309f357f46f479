#include "threelink_agent/training/trainer.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>
#include <utility>

#include <fmt/format.h>

#include "threelink_agent/training/gaussian.hpp"
#include "threelink_agent/training/schedule.hpp"

namespace threelink_agent {
namespace {

// Random starts of an evaluation. At first many policies are the best so far, and none for long; in
// the end a policy that gets stuck from one shape in a thousand is to be told from one that does
// not.
int trials(double progress) { return progress < 0.5 ? 25 : progress < 0.8 ? 200 : 1000; }

bool all_finite(const std::vector<float>& values) {
  constexpr std::uint32_t kExponent = 0x7f800000;  // all ones in a NaN or an infinity
  std::uint32_t found = 0;
  for (float value : values) {  // without a branch, so that it goes in vectors
    std::uint32_t bits;
    std::memcpy(&bits, &value, sizeof(bits));
    found |= (bits & kExponent) == kExponent;
  }
  return found == 0;
}

// The first of the rollout's arrays that holds a number that is not finite; or nothing.
std::string poison_of(const Rollout& rollout) {
  const std::pair<const char*, const std::vector<float>*> arrays[] = {
      {"an observation", &rollout.observations},
      {"an action", &rollout.actions},
      {"a log-probability", &rollout.log_probs},
      {"a reward", &rollout.rewards}};
  for (const auto& [name, values] : arrays)
    if (!all_finite(*values)) return name;
  return "";
}

std::string poison_of(const UpdateStatistics& statistics) {
  const std::pair<const char*, double> numbers[] = {
      {"the policy loss", statistics.policy_loss},
      {"the value loss", statistics.value_loss},
      {"the KL divergence", statistics.kl},
      {"the share of clipped samples", statistics.clip_fraction}};
  for (const auto& [name, value] : numbers)
    if (!std::isfinite(value)) return name;
  return "";
}

}  // namespace

Trainer::Trainer(const TrainConfig& config, std::unique_ptr<PpoUpdate> ppo,
                 std::unique_ptr<RolloutSource> source)
    : config_((config.validate(), config)), ppo_(std::move(ppo)), source_(std::move(source)) {
  state_.learner = ppo_->state();
}

Trainer::Trainer(const TrainConfig& config, std::unique_ptr<PpoUpdate> ppo,
                 std::unique_ptr<RolloutSource> source, TrainerState state)
    : config_((config.validate(), config)),
      ppo_(std::move(ppo)),
      source_(std::move(source)),
      state_(std::move(state)) {
  ppo_->restore(state_.learner);
}

UpdateReport Trainer::update() {
  const double progress = double(state_.update) / config_.updates();
  const auto& exploration = config_.exploration;
  if (!exploration.learned)
    ppo_->set_std(
        decayed_std(exploration.std, exploration.std_final, exploration.decay_fraction, progress));
  const LearningRates rates{
      annealed(config_.update.actor_learning_rate, config_.update.final_learning_rate, progress),
      annealed(config_.update.critic_learning_rate, config_.update.final_learning_rate, progress)};
  const Eigen::VectorXf log_std = ppo_->log_std();

  const std::uint32_t first = state_.update * config_.update.episodes;
  const auto episodes = std::min(config_.update.episodes, config_.episodes - first);
  const Play play{
      config_.environment, config_.goal, config_.symmetry.canonical, ppo_->actor(), log_std,
      config_.seed,        first};
  Rollout rollout = play_or_restore(play, static_cast<int>(episodes));
  if (config_.symmetry.mirror) mirror_half(rollout, config_.seed, first);

  UpdateReport report{};
  report.poison = learn(rollout, rates, report.statistics);
  if (report.poison.empty()) {
    state_.poisoned_in_a_row = 0;
  } else {
    ppo_->restore(state_.learner);
    ++state_.poisoned;
    ++state_.poisoned_in_a_row;
  }
  report.poisoned = state_.poisoned;
  report.update = ++state_.update;
  report.episodes = first + episodes;
  report.steps = std::uint64_t{report.episodes} * config_.environment.steps;
  report.mean_return = rollout.mean_return();
  report.entropy = log_std.unaryExpr(&gaussian_entropy).sum();
  report.std = log_std.array().exp().mean();
  report.rates = rates;
  if (state_.poisoned_in_a_row >= kMostPoisonedInARow)
    throw TrainingError(
        fmt::format("{} updates in a row were thrown away, the last one, update {}, since {} was "
                    "not finite; lower learning rates may help",
                    state_.poisoned_in_a_row, report.update, report.poison));
  if (finished() || state_.update % config_.evaluate_every == 0)
    report.evaluation = evaluate_present();
  return report;
}

Rollout Trainer::play_or_restore(const Play& play, int episodes) {
  try {
    return source_->play(play, episodes);
  } catch (...) {
    ppo_->restore(state_.learner);  // the policy is again that of the last update
    throw;
  }
}

std::string Trainer::learn(const Rollout& rollout, const LearningRates& rates,
                           UpdateStatistics& statistics) {
  constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
  statistics = {kNaN, kNaN, kNaN, kNaN};
  std::string poison = poison_of(rollout);
  if (!poison.empty()) return poison;
  const Advantages estimates = advantages(rollout);
  if (!all_finite(estimates.advantages) || !all_finite(estimates.returns)) return "an advantage";
  statistics = ppo_->run(rollout, estimates, state_.update, rates);
  poison = poison_of(statistics);
  if (!poison.empty()) return poison;
  LearnerState learner = ppo_->state();
  if (!learner.all_finite()) return "a parameter";
  state_.learner = std::move(learner);
  return "";
}

Advantages Trainer::advantages(const Rollout& rollout) const {
  const int states = (rollout.steps + 1) * rollout.episodes;
  std::vector<float> values(states);
  ppo_->critic().forward(states, rollout.observations.data(), values.data());
  Advantages result = generalised_advantages(rollout.steps, rollout.episodes, rollout.rewards,
                                             rollout.captured, values, config_.advantage);
  if (config_.advantage.normalise) normalise(result.advantages);
  return result;
}

Policy Trainer::policy() const {
  return Policy(policy_metadata(config_), ppo_->actor(), ppo_->log_std());
}

Evaluation Trainer::evaluate_present() {
  const Policy present = policy();
  Evaluation evaluation = evaluate(present, 0, config_.seed);
  if (config_.goal.has_target()) {  // see Trainer::best()
    state_.best = BestPolicy{present, objective(evaluation, config_.environment)};
    return evaluation;
  }
  // A score is at most the objective if that is positive, and at most 0 if not: most policies need
  // no random starts to be seen not to be the best.
  const double most = std::max(objective(evaluation, config_.environment), 0.0);
  if (!finished() && state_.best && !(most > state_.best->score)) return evaluation;
  evaluation = evaluate(present, trials(double(state_.update) / config_.updates()), config_.seed);
  const double present_score = score(evaluation, config_.environment);
  if (!state_.best || present_score > state_.best->score)
    state_.best = BestPolicy{present, present_score};
  return evaluation;
}

double objective(const Evaluation& evaluation,
                 const threelink_sim::EnvironmentConfig& environment) {
  double sum = 0;
  for (const StartResult& start : evaluation.starts)
    sum += start.speed - environment.c / environment.b * start.power;
  return sum / evaluation.starts.size();
}

double score(const Evaluation& evaluation, const threelink_sim::EnvironmentConfig& environment) {
  return evaluation.success_rate * objective(evaluation, environment);
}

PolicyMetadata policy_metadata(const TrainConfig& config) {
  PolicyMetadata metadata;
  metadata.observation = config.observation;
  metadata.sampled = config.goal.has_target();  // the noise breaks the orbits around a point
  metadata.links = config.environment.model.links;
  metadata.dt = config.environment.dt;
  metadata.gamma = config.environment.model.gamma;
  metadata.joint_limit = config.environment.model.joint_limit;
  metadata.symmetry = config.symmetry.canonical;
  metadata.config = to_yaml(config);
  return metadata;
}

}  // namespace threelink_agent

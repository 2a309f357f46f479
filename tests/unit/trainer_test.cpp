// Small trainings: determinism, going on from a state, poison, the policy that comes out.
#include "threelink_agent/training/trainer.hpp"

#include <cmath>
#include <functional>
#include <limits>
#include <vector>

#include <gtest/gtest.h>

#include "available_backends.hpp"
#include "small_training.hpp"

namespace threelink_tests {
namespace {

using namespace threelink_agent;

TEST(Trainer, SameSeedSamePolicy) {
  for (Backend backend : available_backends()) {
    const std::string policy = sha256_of_training(small(0), 1, backend);  // 0 is a seed like others
    EXPECT_EQ(sha256_of_training(small(0), 1, backend), policy);
    EXPECT_EQ(sha256_of_training(small(0), 2, backend), policy);
    EXPECT_EQ(sha256_of_training(small(0), 3, backend), policy);
    EXPECT_NE(sha256_of_training(small(1), 1, backend), policy);
  }
}

TEST(Trainer, ReportsWhatItDid) {
  Trainer trainer = trainer_of(small());
  const UpdateReport first = trainer.update();
  EXPECT_EQ(first.update, 1u);
  EXPECT_EQ(first.episodes, 12u);
  EXPECT_EQ(first.steps, 600u);
  EXPECT_NEAR(first.std, 0.6, 1e-6);
  EXPECT_NEAR(first.rates.actor, trainer.config().update.actor_learning_rate, 1e-12);
  EXPECT_FALSE(first.evaluation);
  EXPECT_FALSE(trainer.best());
  const UpdateReport second = trainer.update();
  EXPECT_TRUE(second.evaluation);
  EXPECT_TRUE(trainer.best());
  EXPECT_GE(second.statistics.kl, 0);
  EXPECT_FALSE(trainer.finished());
  const UpdateReport last = trainer.update();
  EXPECT_EQ(last.episodes, 32u);
  EXPECT_TRUE(last.evaluation);
  EXPECT_GT(last.evaluation->trials, 0);
  EXPECT_EQ(last.poisoned, 0u);
  EXPECT_TRUE(trainer.finished());
}

TEST(Trainer, GoesOnFromEveryStateToTheSameBits) {
  for (bool learned : {false, true}) {
    TrainConfig config = small();
    config.exploration.learned = learned;
    config.update.entropy_weight = learned ? 0.1 : 0;
    for (Backend backend : available_backends()) {
      const std::string unbroken = sha256_of_training(config, 1, backend);
      for (std::uint32_t broken_at : {0, 1, 2, 3}) {
        Trainer first = trainer_of(config, 1, backend);
        while (first.state().update < broken_at) first.update();
        Trainer second(config, make_ppo_update(backend, config, 1),
                       std::make_unique<LocalRollouts>(1), first.state());
        while (!second.finished()) second.update();
        EXPECT_EQ(second.policy().sha256(), unbroken) << to_string(backend) << broken_at;
      }
    }
  }
}

TEST(Trainer, RandomStartsAreLeftOutOnlyWhereTheyCannotMatter) {
  TrainConfig config = load_train_config(THREELINK_CONFIG "/train_vfs.yaml");
  config.episodes = 240;
  config.evaluate_every = 1;
  config.update.episodes = 20;
  for (double c : {0.0, 3.0}) {  // with c > 0 objectives are below 0 at first
    config.environment.c = c;
    Trainer trainer = trainer_of(config);
    double best = 0;
    std::string kept;
    int left_out = 0;
    for (bool first = true; !trainer.finished(); first = false) {
      const UpdateReport report = trainer.update();
      left_out += report.evaluation->trials == 0;
      const double now = score(evaluate(trainer.policy(), 200, config.seed), config.environment);
      if (first || now > best) {
        best = now;
        kept = trainer.policy().sha256();
      }
      ASSERT_EQ(trainer.best()->sha256(), kept) << report.update;
    }
    EXPECT_EQ(trainer.state().best->score, best);
    EXPECT_GT(left_out + (c > 0), 0);
  }
}

// --- Poison --------------------------------------------------------------------------------------

// An update that goes wrong where it is told to.
class Poisoned : public PpoUpdate {
 public:
  using Poison = std::function<void(UpdateStatistics&, LearnerState&)>;
  Poisoned(const TrainConfig& config, std::uint32_t from, std::uint32_t to, Poison poison)
      : inner_(make_ppo_update(Backend::kFused, config, 1)),
        from_(from),
        to_(to),
        poison_(std::move(poison)) {}

  UpdateStatistics run(const Rollout& rollout, const Advantages& advantages, std::uint32_t update,
                       const LearningRates& rates) override {
    UpdateStatistics statistics = inner_->run(rollout, advantages, update, rates);
    LearnerState state = inner_->state();
    if (update >= from_ && update < to_) poison_(statistics, state);
    state_ = state;
    return statistics;
  }
  Mlp actor() const override { return inner_->actor(); }
  Mlp critic() const override { return inner_->critic(); }
  Eigen::VectorXf log_std() const override { return inner_->log_std(); }
  void set_std(double std) override { inner_->set_std(std); }
  LearnerState state() const override { return state_ ? *state_ : inner_->state(); }
  void restore(const LearnerState& state) override {
    inner_->restore(state);
    state_.reset();
  }

 private:
  std::unique_ptr<PpoUpdate> inner_;
  std::uint32_t from_, to_;
  Poison poison_;
  std::optional<LearnerState> state_;
};

constexpr float kNaN = std::numeric_limits<float>::quiet_NaN();
constexpr float kInfinity = std::numeric_limits<float>::infinity();

const Poisoned::Poison kPoisons[] = {
    [](UpdateStatistics& s, LearnerState&) { s.policy_loss = kNaN; },
    [](UpdateStatistics& s, LearnerState&) { s.value_loss = kInfinity; },
    [](UpdateStatistics& s, LearnerState&) { s.kl = kNaN; },
    [](UpdateStatistics&, LearnerState& l) { l.parameters.actor[1].weight(3, 2) = kNaN; },
    [](UpdateStatistics&, LearnerState& l) { l.parameters.critic[0].bias[0] = -kInfinity; },
    [](UpdateStatistics&, LearnerState& l) { l.variance.actor[0].weight(0, 0) = kInfinity; }};

bool same(const LearnerTensors& a, const LearnerTensors& b) {
  const auto equal = [](const std::vector<Linear>& x, const std::vector<Linear>& y) {
    for (std::size_t l = 0; l < x.size(); ++l)
      if (x[l].weight != y[l].weight || x[l].bias != y[l].bias) return false;
    return true;
  };
  return equal(a.actor, b.actor) && equal(a.critic, b.critic) && a.log_std == b.log_std;
}

TEST(Trainer, APoisonedUpdateLeavesNetworksAndOptimisersAsTheyWere) {
  TrainConfig config = small();
  config.episodes = 12 * 4;
  for (const Poisoned::Poison& poison : kPoisons) {
    Trainer trainer(config, std::make_unique<Poisoned>(config, 1, 2, poison));
    EXPECT_TRUE(trainer.update().poison.empty());
    const LearnerState before = trainer.state().learner;
    const UpdateReport report = trainer.update();
    EXPECT_FALSE(report.poison.empty());
    EXPECT_EQ(report.poisoned, 1u);
    EXPECT_TRUE(report.evaluation);  // of the networks as they were
    const LearnerState after = trainer.state().learner;
    EXPECT_TRUE(same(before.parameters, after.parameters));
    EXPECT_TRUE(same(before.mean, after.mean));
    EXPECT_TRUE(same(before.variance, after.variance));
    EXPECT_EQ(before.adam_steps, after.adam_steps);
    // The training goes on.
    const UpdateReport next = trainer.update();
    EXPECT_TRUE(next.poison.empty());
    EXPECT_EQ(next.poisoned, 1u);
    EXPECT_FALSE(same(before.parameters, trainer.state().learner.parameters));
  }
}

TEST(Trainer, APoisonedRolloutOrAdvantageIsNotLearnedFrom) {
  TrainConfig config = small();
  // The values of a critic with such biases are finite, their differences are not.
  const auto huge = [](UpdateStatistics&, LearnerState& l) {
    l.parameters.critic.back().bias.setConstant(3e38F);
    l.parameters.critic.back().weight.setConstant(-1e38F);
  };
  // Noise without bounds.
  const auto loud = [](UpdateStatistics&, LearnerState& l) {
    l.parameters.log_std.setConstant(100);
  };
  config.exploration.learned = true;
  for (const Poisoned::Poison& poison : {Poisoned::Poison(huge), Poisoned::Poison(loud)}) {
    Trainer first(config, std::make_unique<Poisoned>(config, 0, 1, poison));
    EXPECT_TRUE(first.update().poison.empty());
    Trainer second(config, make_ppo_update(Backend::kFused, config, 1),
                   std::make_unique<LocalRollouts>(1), first.state());
    const UpdateReport report = second.update();
    EXPECT_FALSE(report.poison.empty());
    EXPECT_TRUE(std::isnan(report.statistics.policy_loss));
    EXPECT_TRUE(same(first.state().learner.parameters, second.state().learner.parameters));
  }
}

TEST(Trainer, TooManyPoisonedUpdatesInARowEndTheTraining) {
  TrainConfig config = small();
  config.episodes = 12 * 20;
  Trainer trainer(config, std::make_unique<Poisoned>(config, 3, 1000, kPoisons[0]));
  for (std::uint32_t update = 0; update < 3 + kMostPoisonedInARow - 1; ++update) trainer.update();
  try {
    trainer.update();
    FAIL();
  } catch (const TrainingError& error) {
    EXPECT_NE(std::string(error.what()).find("update 8, since the policy loss was not finite"),
              std::string::npos)
        << error.what();
  }
}

// --- What comes out ------------------------------------------------------------------------------

TEST(Trainer, PolicyTellsWhereItComesFrom) {
  TrainConfig config = small();
  config.environment.model.gamma = 0.6;
  const Policy policy = trainer_of(config).policy();
  EXPECT_EQ(policy.metadata().gamma, 0.6);
  EXPECT_EQ(policy.metadata().symmetry, config.symmetry.canonical);
  EXPECT_EQ(to_yaml(parse_train_config(policy.metadata().config, "policy")), to_yaml(config));
  EXPECT_NEAR(policy.log_std()[0], std::log(0.6), 1e-6);
}

TEST(Trainer, LearnsAndKeepsTheLearnedStd) {
  TrainConfig config = small();
  config.exploration.learned = true;
  config.update.entropy_weight = 0.1;
  Trainer trainer = trainer_of(config);
  for (int update = 0; update < 3; ++update) trainer.update();
  EXPECT_GT(trainer.policy().log_std().maxCoeff(), std::log(0.6) + 1e-4);
}

TEST(Trainer, AShortTrainingImprovesTheReturn) {
  TrainConfig config = load_train_config(THREELINK_CONFIG "/train_vfs.yaml");
  config.seed = 2;  // not every seed has found its stroke so early
  config.episodes = 1600;
  config.update.episodes = 20;
  Trainer trainer = trainer_of(config, 2);
  const double first = trainer.update().mean_return;
  double last = first;
  while (!trainer.finished()) last = trainer.update().mean_return;
  // 200 steps at the optimal speed return 1.55; noise at random returns 0 on average.
  EXPECT_LT(first, 0.2);
  EXPECT_GT(last, 0.3);
}

TEST(Trainer, ManyLinks) {
  TrainConfig config = small();
  config.environment.model.links = 5;
  EXPECT_EQ(sha256_of_training(config), sha256_of_training(config));
}

}  // namespace
}  // namespace threelink_tests

// Tasks as goals of trainings: rewards, captures, what they depend on, and that they are learned.
#include <cmath>
#include <memory>
#include <vector>

#include <gtest/gtest.h>

#include "small_training.hpp"
#include "threelink_agent/training/rollout.hpp"
#include "threelink_sim/goal/goals.hpp"
#include "threelink_sim/plugins.hpp"
#include "threelink_tasks/task_factory.hpp"
#include "threelink_tasks/trials.hpp"

namespace threelink_tests {
namespace {

using namespace threelink_agent;
using threelink_sim::Environment;
using threelink_sim::GoalConfig;
using threelink_sim::ObservationKind;

const char* const kEnvironment = R"(version: 2
seed: 0
episodes: 2000
evaluate_every: 50
environment: {links: 3, gamma: 0.5, joint_limit: 2.0943951023931953, dt: 0.1, b: 6.0, c: 0.0, steps: 1000}
observation: target
hidden: [64, 64]
symmetry: {canonical: reversal, mirror: true}
exploration: {learned: false, std: 0.6, std_final: 0.3, decay_fraction: 0.8}
advantage: {discount: 0.998, lambda: 0.99, bootstrap_at_time_limit: true, normalise: true}
update: {episodes: 20, epochs: 5, minibatch: 500, clip: 0.2, entropy_weight: 0.0,
         max_gradient_norm: 0.5, actor_learning_rate: 2.0e-3, critic_learning_rate: 1.0e-3,
         final_learning_rate: 0.0}
)";

TrainConfig config_with(const std::string& goal) {
  return parse_train_config(kEnvironment + ("goal: {" + goal + "}\n"), "test");
}

std::string refusal(const std::string& goal) {
  try {
    config_with(goal);
  } catch (const ConfigError& error) {
    return error.what();
  }
  return "taken";
}

const std::string kPursuit =
    "kind: pursuit, bonus: 1.5, v_m: 0.01, random_start: true, v_ratio: 0.02, target_x: 1.504, "
    "target_y: 0.0, threshold: 0.003, diffusivity: 0.0";

TEST(TaskGoal, IsReadWithTheParametersOfTheTask) {
  const TrainConfig config = config_with(kPursuit);
  ASSERT_TRUE(config.goal.task);
  EXPECT_EQ(config.goal.kind(), "pursuit");
  EXPECT_EQ(config.goal.task->v_m, 0.01);
  EXPECT_EQ(config.environment.observation, ObservationKind::kTarget);
  const std::string yaml = to_yaml(config);
  EXPECT_NE(yaml.find("\n  v_ratio: 0.02\n"), std::string::npos) << yaml;
  EXPECT_NE(yaml.find("\n  max_steps: 50000\n"), std::string::npos) << "defaults are told, too";
  EXPECT_EQ(to_yaml(parse_train_config(yaml, "again")), yaml);
}

TEST(TaskGoal, RefusalsNameFileKeyValueAndBound) {
  EXPECT_EQ(refusal("kind: pursiut"),
            "test: goal.kind = pursiut: must be direction, points, or the name of a task; the "
            "nearest one is pursuit");
  EXPECT_EQ(refusal("kind: 3"), "test: goal.kind = 3: must be text");
  EXPECT_EQ(refusal("bonus: 3.0"),
            "test: goal.bonus: unknown key (the nearest known one is goal.kind)");
  EXPECT_EQ(refusal("kind: direction, bonus: 1.0"),
            "test: goal.bonus: unknown key (the nearest known one is goal.kind)");
  EXPECT_EQ(refusal("kind: pursuit, v_m: 0.01, random_start: true, v_ratio: 0.5"),
            "test: goal.bonus: missing");
  EXPECT_EQ(refusal("kind: pursuit, bonus: -1.0, v_m: 0.01, random_start: true, v_ratio: 0.5"),
            "test: goal.bonus = -1.0: must be in [0, 1000000]");
  EXPECT_EQ(refusal(kPursuit + ", v_ratoi: 1.0"),
            "test: goal.v_ratoi: unknown key (the nearest known one is goal.v_ratio)");
  EXPECT_EQ(refusal("kind: pursuit, bonus: 1.0, v_m: 0.01, random_start: true, v_ratio: 101.0"),
            "test: goal.v_ratio = 101.0: must be in [0, 100]");
}

TEST(TaskGoal, ABrokenPointFileIsNamedLikeAnyOtherValue) {
  EXPECT_EQ(refusal("kind: waypoints, bonus: 1.0, v_m: 0.01, random_start: true, points: /nowhere"),
            "test: goal.points = /nowhere: /nowhere: cannot open: No such file or directory");
}

TEST(TaskGoal, RewardsProgressAndCapture) {
  const TrainConfig config = config_with(kPursuit);
  constexpr std::size_t kLanes = 20;
  threelink_sim::EnvironmentConfig settings = config.environment;
  settings.c = 3;
  Environment environment(settings, kLanes);
  const auto goals = make_goals(config.goal, 7, 100, environment);
  const Eigen::Vector2d start(1.5, 0), drift(0.02 * 0.01 * 0.1 * std::cos(threelink_sim::kPi / 6),
                                             0.02 * 0.01 * 0.1 * std::sin(threelink_sim::kPi / 6));
  std::vector<int> steps(kLanes);  // of the attempt
  std::vector<double> rates(2 * kLanes);
  std::vector<float> rewards(kLanes);
  std::vector<std::uint8_t> captured(kLanes);
  int captures = 0;
  for (std::uint32_t k = 0; k < 200; ++k) {
    std::vector<double> before;
    for (std::size_t i = 0; i < kLanes; ++i) {
      before.push_back(environment.distance(i));
      rates[i] = std::sin(0.07 * k + i);
      rates[kLanes + i] = std::cos(0.05 * k + 2.0 * i);
    }
    environment.step(rates.data());
    std::vector<Eigen::Vector2d> here;
    for (std::size_t i = 0; i < kLanes; ++i) here.push_back(environment.centroid(i));
    const std::vector<double> work(environment.batch().work(), environment.batch().work() + kLanes);
    goals->after_step(k, rewards.data(), captured.data());
    for (std::size_t i = 0; i < kLanes; ++i) {
      const Eigen::Vector2d target = Eigen::Vector2d(1.504, 0) + steps[i] * drift;
      const double now = (target - here[i]).norm();
      const bool reached = (target + drift - here[i]).norm() < 0.003;
      EXPECT_EQ(captured[i], reached);
      EXPECT_NEAR(rewards[i], 6 * (before[i] - now) - 3 * work[i] + (reached ? 1.5 : 0), 1e-6);
      ++steps[i];
      if (!reached) continue;
      ++captures;
      steps[i] = 0;
      EXPECT_LT((environment.centroid(i) - start).norm(), 1e-12) << "back at the start";
      EXPECT_NEAR(environment.distance(i), 0.004, 1e-12);
    }
  }
  EXPECT_GT(captures, 3);
}

Rollout rollout(const TrainConfig& config, std::uint32_t first, int episodes) {
  const LearnerTensors start = initial_state(config).parameters;
  return LocalRollouts(1).play({config.environment, config.goal, config.symmetry.canonical,
                                Mlp(start.actor), start.log_std, 4, first},
                               episodes);
}

TEST(TaskGoal, AnEpisodeDoesNotDependOnItsCompany) {
  const TrainConfig config = config_with(kPursuit + ", target_heading: 1.0");
  const Rollout many = rollout(config, 3, 9);
  int captures = 0;
  for (std::uint32_t i = 0; i < 9; ++i) {
    const Rollout alone = rollout(config, 3 + i, 1);
    for (int t = 0; t < many.steps; ++t) {
      ASSERT_EQ(many.rewards[t * 9 + i], alone.rewards[t]);
      ASSERT_EQ(many.captured[t * 9 + i], alone.captured[t]);
      captures += alone.captured[t];
    }
  }
  EXPECT_GT(captures, 0);
}

int captured_of(const Policy& policy, const std::string& parameters) {
  constexpr int kTrials = 50;
  threelink_tasks::TrialsConfig config;
  config.trials = kTrials;
  config.sampled = true;
  const auto make = [&] {
    auto map = threelink_sim::parse_parameters("parameters", parameters);
    return threelink_tasks::make_task("pendulum", map, {0.1, 0.01});
  };
  int captured = 0;
  for (const threelink_tasks::Trial& trial : run_trials(make, policy, config))
    captured += trial.outcome == threelink_tasks::Outcome::kCaptured;
  return captured;
}

// The task of another package, of which this one knows nothing.
TEST(TaskGoal, APluginIsLearned) {
  threelink_sim::load_plugins();
  const TrainConfig config = config_with(
      "kind: pendulum, bonus: 1.5, v_m: 0.01, random_start: true, amplitude: 0.2, period: 500.0, "
      "threshold: 0.1");
  Trainer trainer = trainer_of(config);
  const std::string test = "{amplitude: 0.2, period: 500, threshold: 0.1, max_steps: 800}";
  const int before = captured_of(trainer.policy(), test);
  while (!trainer.finished()) trainer.update();
  const int after = captured_of(trainer.policy(), test);
  EXPECT_LT(before, 10);
  EXPECT_GT(after, 40) << "of 50; before it was " << before;
  EXPECT_TRUE(trainer.policy().metadata().sampled);
}

}  // namespace
}  // namespace threelink_tests

// Points to reach: rewards, captures, and what they depend on.
#include <cmath>
#include <set>
#include <vector>

#include <gtest/gtest.h>

#include "small_training.hpp"
#include "threelink_agent/training/rollout.hpp"
#include "threelink_sim/goal/goals.hpp"
#include "threelink_sim/random.hpp"

namespace threelink_tests {
namespace {

using namespace threelink_agent;
using threelink_sim::Environment;
using threelink_sim::EnvironmentConfig;
using threelink_sim::Goals;
using threelink_sim::ObservationKind;
using threelink_sim::PointsGoal;

EnvironmentConfig environment_config() {
  EnvironmentConfig config;
  config.c = 3;
  config.observation = ObservationKind::kTarget;
  return config;
}

// Direction as seen by lane i: from its observation, since that is what policies learn from.
Eigen::Vector2d point_of(const Environment& environment, std::size_t i) {
  const Eigen::Vector2d here(environment.batch().x()[i], environment.batch().y()[i]);
  return here + environment.distance(i) * environment.direction(i);
}

std::unique_ptr<Goals> points_goals(const PointsGoal& points, std::uint64_t seed,
                                    std::uint32_t first_episode, Environment& environment) {
  threelink_sim::GoalConfig config;
  config.points = points;
  return make_goals(config, seed, first_episode, environment);
}

TEST(PointsGoal, RewardProgressAndCapture) {
  const PointsGoal config{0, 0.02, 0.02, 0.019, 1.5};
  constexpr std::size_t kLanes = 40;
  Environment environment(environment_config(), kLanes);
  const auto goals = points_goals(config, 7, 0, environment);
  std::vector<Eigen::Vector2d> points;
  for (std::size_t i = 0; i < kLanes; ++i) {
    EXPECT_NEAR(environment.distance(i), 0.02, 1e-12);
    points.push_back(point_of(environment, i));
  }
  std::vector<double> before(kLanes), rates(2 * kLanes, 1.0);
  std::vector<float> rewards(kLanes);
  std::vector<std::uint8_t> captured(kLanes);
  int captures = 0;
  for (std::uint32_t k = 0; k < 10; ++k) {
    for (std::size_t i = 0; i < kLanes; ++i) before[i] = environment.distance(i);
    environment.step(rates.data());
    goals->after_step(k, rewards.data(), captured.data());
    for (std::size_t i = 0; i < kLanes; ++i) {
      const Eigen::Vector2d here(environment.batch().x()[i], environment.batch().y()[i]);
      const double now = (points[i] - here).norm();
      // b (r_k - r_{k+1}) - c W, and the bonus within the threshold
      EXPECT_NEAR(
          rewards[i],
          6 * (before[i] - now) - 3 * environment.batch().work()[i] + (now < 0.019 ? 1.5 : 0),
          1e-6);
      EXPECT_EQ(captured[i], now < 0.019);
      if (!captured[i]) continue;
      ++captures;
      EXPECT_NEAR(environment.distance(i), 0.02, 1e-12);  // to the next point
      EXPECT_GT((point_of(environment, i) - points[i]).norm(), 1e-4);
      points[i] = point_of(environment, i);
    }
  }
  EXPECT_GT(captures, 5);
}

TEST(PointsGoal, AreDrawnFromTheStatedDistribution) {
  const PointsGoal config{0.25, 0.001, 0.5, 0.001, 1.5};
  constexpr std::size_t kLanes = 4000;
  Environment environment(environment_config(), kLanes);
  const auto goals = points_goals(config, 3, 100, environment);
  int directions = 0, below_middle = 0, left = 0, points = 0;
  for (std::size_t i = 0; i < kLanes; ++i) {
    const double r = environment.distance(i);
    if (std::isinf(r)) {
      EXPECT_EQ(environment.direction(i), Eigen::Vector2d(1, 0));
      ++directions;
      continue;
    }
    EXPECT_GT(r, 0.001 * (1 - 1e-9));
    EXPECT_LT(r, 0.5 * (1 + 1e-9));
    ++points;
    below_middle += r < std::sqrt(0.001 * 0.5);
    left += environment.direction(i).y() > 0;
  }
  // Five standard deviations of a binomial distribution.
  EXPECT_NEAR(directions, 0.25 * kLanes, 5 * std::sqrt(kLanes * 0.25 * 0.75));
  EXPECT_NEAR(below_middle, 0.5 * points, 5 * std::sqrt(0.25 * points));
  EXPECT_NEAR(left, 0.5 * points, 5 * std::sqrt(0.25 * points));
}

Rollout rollout(std::uint32_t first, int episodes) {
  const TrainConfig config = small_homing();
  const LearnerTensors start = initial_state(config).parameters;
  return LocalRollouts(1).play({config.environment, config.goal, config.symmetry.canonical,
                                Mlp(start.actor), start.log_std, 4, first},
                               episodes);
}

TEST(PointsRollout, AnEpisodeDoesNotDependOnItsCompany) {
  const Rollout many = rollout(3, 20);
  ASSERT_EQ(many.observation_size, 7);
  int captures = 0;
  for (std::uint32_t i = 0; i < 20; ++i) {
    const Rollout alone = rollout(3 + i, 1);
    for (int t = 0; t < many.steps; ++t) {
      ASSERT_EQ(many.rewards[t * 20 + i], alone.rewards[t]);
      ASSERT_EQ(many.captured[t * 20 + i], alone.captured[t]);
      captures += alone.captured[t];
      for (int k = 0; k < 7; ++k)
        ASSERT_EQ(many.observations[(k * (many.steps + 1) + t) * 20 + i],
                  alone.observations[k * (many.steps + 1) + t]);
    }
  }
  EXPECT_GT(captures, 3);
}

TEST(PointsTraining, DoesNotDependOnThreads) {
  const TrainConfig config = small_homing();
  const std::string one = sha256_of_training(config, 1);
  for (int threads : {2, 3}) EXPECT_EQ(sha256_of_training(config, threads), one);
}

TEST(PointsTraining, TheActorMaySeeLessThanTheCritic) {
  TrainConfig config = small_homing();
  for (const auto& [kind, inputs] :
       {std::pair{ObservationKind::kDirection, 4}, std::pair{ObservationKind::kTarget, 7}}) {
    config.observation = kind;
    Trainer trainer = trainer_of(config);
    trainer.update();
    EXPECT_EQ(trainer.policy().metadata().observation, kind);
    EXPECT_EQ(trainer.policy().observation_size(), inputs);
    EXPECT_EQ(trainer.state().learner.parameters.critic.front().weight.cols(), 7);
  }
}

}  // namespace
}  // namespace threelink_tests

// Episodes played once more from their hinge rates.
#include "threelink_tasks/replay.hpp"

#include <vector>

#include <gtest/gtest.h>

#include "make_task.hpp"
#include "random_policy.hpp"
#include "threelink_tasks/episode.hpp"

namespace {

using threelink_sim::Environment;
using threelink_sim::EnvironmentConfig;
using threelink_tasks::EpisodeStep;
using threelink_tasks::Replay;
using threelink_tasks::ReplayedState;

class ReplayTest : public testing::Test {
 protected:
  void SetUp() override {
    const auto task = threelink_tests::make_task("pursuit", "{v_ratio: 0, max_steps: 150}");
    Environment environment(config_, 1);
    run_episode(*task, environment, policy_, 4, 1, false, [&](const EpisodeStep& step) {
      steps_.push_back(step);
      rewards_.push_back(environment.rewards()[0]);
      work_.push_back(environment.batch().work()[0]);
    });
  }

  const EnvironmentConfig config_{};
  const threelink_agent::Policy policy_ = threelink_tests::random_policy(1);
  std::vector<EpisodeStep> steps_;
  std::vector<double> rewards_, work_;
};

TEST_F(ReplayTest, GivesTheSameStatesObservationsRewardsAndActions) {
  Replay replay(config_);
  replay.start(steps_[0].state);
  for (std::size_t k = 0;; ++k) {
    const ReplayedState now = replay.state();
    ASSERT_EQ(now.state.centroid, steps_[k].state.centroid) << "step " << k;
    ASSERT_EQ(now.state.heading, steps_[k].state.heading);
    ASSERT_EQ(now.state.alpha, steps_[k].state.alpha);
    if (k > 0) {
      ASSERT_EQ(now.reward, rewards_[k]);
      ASSERT_EQ(now.work, work_[k]);
    }
    ASSERT_EQ(now.power, body_motion(config_.model, now.state.alpha, now.rates).power);
    if (steps_[k].rates.size() == 0) break;
    const auto seen = replay.observe(steps_[k].target);
    ASSERT_DOUBLE_EQ(seen.distance, (steps_[k].target - now.state.centroid).norm());
    std::vector<double> rates(policy_.hinges());
    policy_.act(seen.values.data(), rates.data());
    ASSERT_EQ(threelink_sim::HingeVector::Map(rates.data(), 2), steps_[k].rates);
    replay.step(rates.data());
  }
}

TEST_F(ReplayTest, GoesOnFromAnyState) {
  Replay replay(config_);
  replay.start(steps_[70].state);
  EXPECT_EQ(replay.state().work, 0);
  EXPECT_EQ(replay.state().power, 0);
  for (std::size_t k = 70; k < 100; ++k) {
    replay.observe(steps_[k].target);
    replay.step(steps_[k].rates.data());
    ASSERT_EQ(replay.state().state.centroid, steps_[k + 1].state.centroid);
    ASSERT_EQ(replay.state().reward, rewards_[k + 1]);
  }
}

TEST_F(ReplayTest, AChangedRateChangesTheState) {
  Replay replay(config_);
  replay.start(steps_[0].state);
  replay.observe(steps_[0].target);
  threelink_sim::HingeVector rates = steps_[0].rates;
  rates[0] += rates[0] > 0 ? -1e-12 : 1e-12;
  replay.step(rates.data());
  EXPECT_NE(replay.state().state.alpha, steps_[1].state.alpha);
  EXPECT_LT((replay.state().state.alpha - steps_[1].state.alpha).norm(), 1e-12);
}

TEST(ReplayErrors, AStateBeyondTheJointLimitIsRefused) {
  Replay replay{EnvironmentConfig()};
  threelink_sim::SwimmerState state;
  state.alpha = threelink_sim::HingeVector::Constant(2, 2.5);
  EXPECT_THROW(replay.start(state), std::invalid_argument);
}

}  // namespace

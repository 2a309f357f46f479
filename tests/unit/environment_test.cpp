// Episodes played once more from their hinge rates.
#include "threelink_sim/environment.hpp"

#include <vector>

#include <gtest/gtest.h>

#include "make_task.hpp"
#include "random_policy.hpp"
#include "threelink_tasks/episode.hpp"

namespace {

using threelink_sim::Environment;
using threelink_sim::EnvironmentConfig;
using threelink_sim::StepRecord;
using threelink_tasks::EpisodeStep;

class EnvironmentTest : public testing::Test {
 protected:
  void SetUp() override {
    const auto task = threelink_tests::make_task("pursuit", "{v_ratio: 0, max_steps: 150}");
    Environment environment(config_, 1);
    threelink_tasks::run_episode(*task, environment, policy_, 4, 1, false,
                                 [&](const EpisodeStep& step) {
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

TEST_F(EnvironmentTest, GivesTheSameStatesObservationsRewardsAndActions) {
  Environment replay(config_, 1);
  replay.reset(0, steps_[0].state);
  for (std::size_t k = 0;; ++k) {
    const StepRecord now = replay.record(0);
    ASSERT_EQ(now.state.centroid, steps_[k].state.centroid) << "step " << k;
    ASSERT_EQ(now.state.heading, steps_[k].state.heading);
    ASSERT_EQ(now.state.alpha, steps_[k].state.alpha);
    if (k > 0) {
      ASSERT_EQ(now.reward, rewards_[k]);
      ASSERT_EQ(now.work, work_[k]);
    }
    ASSERT_EQ(now.power, body_motion(config_.model, now.state.alpha, now.hinge_rates).power);
    if (steps_[k].rates.size() == 0) break;
    replay.aim(0, steps_[k].target);
    std::vector<double> seen(replay.observation_size());
    replay.observe(seen.data());
    ASSERT_DOUBLE_EQ(replay.distance(0), (steps_[k].target - now.state.centroid).norm());
    std::vector<double> rates(policy_.hinges());
    policy_.act(seen.data(), rates.data());
    ASSERT_EQ(threelink_sim::HingeVector::Map(rates.data(), 2), steps_[k].rates);
    replay.step(rates.data());
  }
}

TEST_F(EnvironmentTest, GoesOnFromAnyState) {
  Environment replay(config_, 1);
  replay.reset(0, steps_[70].state);
  EXPECT_EQ(replay.record(0).work, 0);
  EXPECT_EQ(replay.record(0).power, 0);
  for (std::size_t k = 70; k < 100; ++k) {
    replay.aim(0, steps_[k].target);
    replay.step(steps_[k].rates.data());
    ASSERT_EQ(replay.record(0).state.centroid, steps_[k + 1].state.centroid);
    ASSERT_EQ(replay.record(0).reward, rewards_[k + 1]);
  }
}

TEST_F(EnvironmentTest, AChangedRateChangesTheState) {
  Environment replay(config_, 1);
  replay.reset(0, steps_[0].state);
  replay.aim(0, steps_[0].target);
  threelink_sim::HingeVector rates = steps_[0].rates;
  rates[0] += rates[0] > 0 ? -1e-12 : 1e-12;
  replay.step(rates.data());
  EXPECT_NE(replay.record(0).state.alpha, steps_[1].state.alpha);
  EXPECT_LT((replay.record(0).state.alpha - steps_[1].state.alpha).norm(), 1e-12);
}

TEST(Environment, AStateBeyondTheJointLimitIsRefused) {
  Environment replay(EnvironmentConfig(), 1);
  threelink_sim::SwimmerState state;
  state.alpha = threelink_sim::HingeVector::Constant(2, 2.5);
  EXPECT_THROW(replay.reset(0, state), std::invalid_argument);
}

}  // namespace

// Episodes that a swimmer elsewhere plays are those of one process, or are known to be spoilt.
#include "threelink_agent/distributed/live_episode.hpp"

#include <functional>
#include <limits>
#include <optional>
#include <vector>

#include <gtest/gtest.h>

#include "random_policy.hpp"

namespace {

using namespace threelink_agent;
using threelink_sim::Environment;
using Verdict = LiveEpisode::Verdict;

constexpr int kEpisodes = 3;

class LiveEpisodeTest : public testing::Test {
 protected:
  static Play play_of(int links) {
    const Policy policy = threelink_tests::random_policy(1, Symmetry::kReversal, links);
    Play play{
        {}, threelink_sim::GoalConfig(), Symmetry::kReversal, policy.actor(), policy.log_std(), 7,
        40};
    play.environment.model.links = links;
    play.environment.steps = 60;
    return play;
  }

  void begin(int i) {
    episode_ = std::make_unique<LiveEpisode>(play_, i, rollout_);
    environment_.reset(0, start_of(play_, i));
    step_ = 0;
  }
  std::vector<double> alpha() const {
    const auto alpha = environment_.batch().state(0).alpha;
    return {alpha.data(), alpha.data() + alpha.size()};
  }
  std::vector<double> applied() const {
    std::vector<double> rates;
    for (int j = 0; j < rollout_.hinges; ++j) rates.push_back(environment_.batch().rates(j)[0]);
    return rates;
  }
  std::vector<double> observed() const {
    std::vector<double> values(rollout_.observation_size);
    environment_.observe(values.data());
    return values;
  }
  Verdict tell_state() {
    return episode_->state(step_, alpha(), applied(), environment_.rewards()[0]);
  }
  Verdict tell_observation() { return episode_->observation(step_, observed()); }
  void move() {
    environment_.step(episode_->rates().data());
    ++step_;
  }
  void play_on(std::uint64_t steps) {
    for (std::uint64_t end = step_ + steps; step_ < end; move()) {
      ASSERT_EQ(tell_state(), Verdict::kAccepted);
      ASSERT_EQ(tell_observation(), Verdict::kAccepted);
    }
  }

  Play play_ = play_of(3);
  Rollout rollout_{play_.environment, kEpisodes};
  Environment environment_{play_.environment, 1};
  std::unique_ptr<LiveEpisode> episode_;
  std::uint64_t step_ = 0;
};

TEST_F(LiveEpisodeTest, IsTheEpisodeOfOneProcess) {
  for (int links : {3, 5}) {
    play_ = play_of(links);
    rollout_ = Rollout(play_.environment, kEpisodes);
    environment_ = Environment(play_.environment, 1);
    for (int i : {2, 0, 1}) {
      begin(i);
      play_on(play_.environment.steps);
      EXPECT_FALSE(episode_->done());
      EXPECT_EQ(tell_state(), Verdict::kAccepted);
      EXPECT_EQ(tell_observation(), Verdict::kAccepted);
      EXPECT_TRUE(episode_->done());
      EXPECT_EQ(difference_from_collect(play_, rollout_, i), "");
    }
    Rollout expected(play_.environment, kEpisodes);
    collect(play_, 0, kEpisodes, expected);
    EXPECT_EQ(rollout_.observations, expected.observations);
    EXPECT_EQ(rollout_.actions, expected.actions);
    EXPECT_EQ(rollout_.log_probs, expected.log_probs);
    EXPECT_EQ(rollout_.rewards, expected.rewards);
  }
}

TEST_F(LiveEpisodeTest, ADifferenceOfOneBitIsNamed) {
  collect(play_, 0, kEpisodes, rollout_);
  EXPECT_EQ(difference_from_collect(play_, rollout_, 1), "");
  float& reward = rollout_.rewards[5 * kEpisodes + 1];
  reward = std::nextafter(reward, 1.0F);
  EXPECT_EQ(difference_from_collect(play_, rollout_, 1).rfind("reward 5 is ", 0), 0u);
  EXPECT_EQ(difference_from_collect(play_, rollout_, 2), "");
}

TEST_F(LiveEpisodeTest, RepetitionsAreStaleAndGapsSpoilIt) {
  begin(0);
  EXPECT_EQ(tell_observation(), Verdict::kFuture);  // before its state
  play_on(3);
  EXPECT_EQ(tell_observation(), Verdict::kFuture);
  EXPECT_EQ(tell_state(), Verdict::kAccepted);
  EXPECT_EQ(tell_state(), Verdict::kStale);
  EXPECT_EQ(episode_->observation(2, observed()), Verdict::kStale);
  EXPECT_EQ(tell_observation(), Verdict::kAccepted);
  const std::vector<double> rates = episode_->rates();
  EXPECT_EQ(tell_observation(), Verdict::kStale);
  EXPECT_EQ(episode_->rates(), rates);
  EXPECT_EQ(episode_->state(5, alpha(), applied(), 0), Verdict::kFuture);
  move();
  EXPECT_EQ(tell_state(), Verdict::kAccepted);
  move();  // before it was observed
  EXPECT_EQ(tell_state(), Verdict::kFuture);
}

TEST_F(LiveEpisodeTest, OtherRatesThanItsOwnSpoilIt) {
  begin(0);
  play_on(3);
  std::vector<double> rates = applied();
  rates[1] = std::nextafter(rates[1], 2.0);
  EXPECT_EQ(episode_->state(3, {0, 0}, rates, 0), Verdict::kNotOurs);
  EXPECT_EQ(episode_->state(3, {0, 0}, {0, 0}, 0), Verdict::kNotOurs);  // the watchdog's
  // The joint limit may cut them.
  const double limit = play_.environment.model.joint_limit;
  EXPECT_EQ(episode_->state(3, {limit, -limit}, {0, 0}, 0), Verdict::kAccepted);
}

TEST_F(LiveEpisodeTest, WhatIsNoNumberSpoilsIt) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  begin(0);
  EXPECT_EQ(episode_->state(0, {0}, {0, 0}, 0), Verdict::kMalformed);
  EXPECT_EQ(episode_->state(0, {0, 0}, {0, 0, 0}, 0), Verdict::kMalformed);
  EXPECT_EQ(episode_->state(0, {0, 0}, {0, 0}, nan), Verdict::kMalformed);
  EXPECT_EQ(tell_state(), Verdict::kAccepted);
  EXPECT_EQ(episode_->observation(0, {1, 0, 0}), Verdict::kMalformed);
  EXPECT_EQ(episode_->observation(0, {1, 0, nan, 0}), Verdict::kMalformed);
  EXPECT_EQ(episode_->observation(0, {1, 0, 1e30, 0}), Verdict::kMalformed);
}

}  // namespace

// Which states a recording takes: lost ones are counted, strangers' ones do not deafen it.
#include "state_sequence.hpp"

#include <cstdint>
#include <limits>
#include <vector>

#include <gtest/gtest.h>

namespace {

using threelink_tasks::StateSequence;
using Steps = std::vector<std::uint64_t>;

constexpr std::uint64_t kMost = std::numeric_limits<std::uint64_t>::max();

class StateSequenceTest : public testing::Test {
 protected:
  static ros::Time time_of(std::uint64_t step) { return ros::Time(100 + 0.1 * step); }

  void add(std::uint64_t step, const ros::Time& stamp, std::size_t hinges = 2) {
    threelink_msgs::SwimmerState state;
    state.step = step;
    state.header.stamp = stamp;
    state.alpha.resize(hinges);
    sequence_.add(state, take_);
  }
  void add(const Steps& steps) {
    for (const std::uint64_t step : steps) add(step, time_of(step));
  }

  Steps taken_;
  StateSequence::Take take_ = [this](const threelink_msgs::SwimmerState& state) {
    taken_.push_back(state.step);
  };
  StateSequence sequence_{0, time_of(0)};
};

TEST_F(StateSequenceTest, TakesEachStateOnce) {
  add({0, 1, 1, 2, 0, 2, 3});
  sequence_.finish(3, take_);
  EXPECT_EQ(taken_, (Steps{0, 1, 2, 3}));
  EXPECT_EQ(sequence_.missing(), 0u);
  EXPECT_EQ(sequence_.refused(), 0u);
}

TEST_F(StateSequenceTest, CountsLostStates) {
  add({0, 1, 4, 5, 7});
  EXPECT_EQ(taken_, (Steps{0, 1, 4, 5}));
  EXPECT_TRUE(sequence_.reaches(7));
  sequence_.finish(7, take_);
  EXPECT_EQ(taken_, (Steps{0, 1, 4, 5, 7}));
  EXPECT_EQ(sequence_.missing(), 3u);
  EXPECT_EQ(sequence_.refused(), 0u);
}

TEST_F(StateSequenceTest, CountsLostStatesAtBothEnds) {
  add({500, 501, 502});
  sequence_.finish(510, take_);
  EXPECT_EQ(taken_, (Steps{500, 501, 502}));
  EXPECT_EQ(sequence_.missing(), 508u);
}

TEST_F(StateSequenceTest, CountsStatesOfWhichEverySecondIsLost) {
  add({0, 2, 4, 6, 8, 10, 12});
  sequence_.finish(12, take_);
  EXPECT_EQ(taken_, (Steps{0, 2, 4, 6, 8, 10, 12}));
  EXPECT_EQ(sequence_.missing(), 6u);
}

TEST_F(StateSequenceTest, IsNotDeafenedByAStepFarAhead) {
  for (const std::uint64_t far : {std::uint64_t{1} << 63, kMost, std::uint64_t{50}}) {
    StateSequenceTest::taken_.clear();
    sequence_ = StateSequence(0, time_of(0));
    add({0, 1, 2});
    add(far, time_of(2));
    add({3, 4, 5});
    sequence_.finish(5, take_);
    EXPECT_EQ(taken_, (Steps{0, 1, 2, 3, 4, 5})) << far;
    EXPECT_EQ(sequence_.missing(), 0u) << far;
    EXPECT_EQ(sequence_.refused(), 1u) << far;
  }
}

TEST_F(StateSequenceTest, IsNotDeafenedByATimeFarAhead) {
  add({0, 1, 2});
  add(3, ros::Time(4e9));
  add({3, 4});
  add(5, ros::Time(1));  // nor by one that is over
  add({5});
  sequence_.finish(5, take_);
  EXPECT_EQ(taken_, (Steps{0, 1, 2, 3, 4, 5}));
  EXPECT_EQ(sequence_.refused(), 2u);
  EXPECT_EQ(sequence_.stamp(), time_of(5));
}

TEST_F(StateSequenceTest, IsNotDeafenedByTheFirstOne) {
  add(kMost, time_of(0));
  add({0, 1});
  EXPECT_EQ(taken_, (Steps{0, 1}));
}

TEST_F(StateSequenceTest, TakesAPauseForWhatItIs) {
  add({0, 1});
  add(2, ros::Time(50000));
  add(3, ros::Time(50000.1));
  EXPECT_EQ(taken_, (Steps{0, 1, 2, 3}));
  EXPECT_EQ(sequence_.missing(), 0u);
}

TEST_F(StateSequenceTest, RefusesAStateOfAnotherSwimmer) {
  add({0});
  add(1, time_of(1), 3);
  add(1, time_of(1), 100000);
  add({1});
  EXPECT_EQ(taken_, (Steps{0, 1}));
  EXPECT_EQ(sequence_.refused(), 2u);
}

}  // namespace

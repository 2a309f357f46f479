// Returns and advantages against values worked out by hand.
#include "threelink_agent/training/advantage.hpp"

#include <cmath>
#include <vector>

#include <gtest/gtest.h>

namespace threelink_tests {
namespace {

using namespace threelink_agent;

void expect_near(const std::vector<float>& actual, const std::vector<double>& expected) {
  ASSERT_EQ(actual.size(), expected.size());
  for (std::size_t k = 0; k < actual.size(); ++k) EXPECT_NEAR(actual[k], expected[k], 1e-6) << k;
}

// One episode of three steps: r = 1, 2, 3; V = 0.5, 1, 1.5 and 4 after the last; Gamma = 0.5.
const std::vector<float> kRewards = {1, 2, 3}, kValues = {0.5, 1, 1.5, 4};
const std::vector<std::uint8_t> kNone = {0, 0, 0};  // no captures

TEST(Advantage, BootstrapsAtTheTimeLimit) {
  // delta_2 = 3 + 0.5 * 4 - 1.5 = 3.5
  // delta_1 = 2 + 0.5 * 1.5 - 1 = 1.75
  // delta_0 = 1 + 0.5 * 1 - 0.5 = 1
  // lambda = 0.8: A_2 = 3.5, A_1 = 1.75 + 0.4 * 3.5 = 3.15, A_0 = 1 + 0.4 * 3.15 = 2.26
  const Advantages result =
      generalised_advantages(3, 1, kRewards, kNone, kValues, {0.5, 0.8, true});
  expect_near(result.advantages, {2.26, 3.15, 3.5});
  expect_near(result.returns, {2.76, 4.15, 5.0});  // A + V
}

TEST(Advantage, TimeLimitAsTerminationHasNoFuture) {
  // delta_2 = 3 - 1.5 = 1.5; A_1 = 1.75 + 0.4 * 1.5 = 2.35, A_0 = 1 + 0.4 * 2.35 = 1.94
  const Advantages result =
      generalised_advantages(3, 1, kRewards, kNone, kValues, {0.5, 0.8, false});
  expect_near(result.advantages, {1.94, 2.35, 1.5});
}

TEST(Advantage, LambdaOneGivesMonteCarloReturns) {
  // R_2 = 3, R_1 = 2 + 0.5 * 3 = 3.5, R_0 = 1 + 0.5 * 3.5 = 2.75
  const Advantages result =
      generalised_advantages(3, 1, kRewards, kNone, kValues, {0.5, 1.0, false});
  expect_near(result.returns, {2.75, 3.5, 3});
  expect_near(result.advantages, {2.25, 2.5, 1.5});  // R - V
}

TEST(Advantage, LambdaZeroLooksOneStepAhead) {
  const Advantages result =
      generalised_advantages(3, 1, kRewards, kNone, kValues, {0.5, 0.0, true});
  expect_near(result.advantages, {1, 1.75, 3.5});
}

TEST(Advantage, ACaptureEndsTheReturn) {
  // After step 1: A_2 = 3.5 as above, delta_1 = 2 - 1 = 1 = A_1, A_0 = 1 + 0.4 * 1 = 1.4
  const Advantages within =
      generalised_advantages(3, 1, kRewards, {0, 1, 0}, kValues, {0.5, 0.8, true});
  expect_near(within.advantages, {1.4, 1, 3.5});
  expect_near(within.returns, {1.9, 2, 5});
  // At the time limit there is then nothing to bootstrap: as BootstrapsAtTheTimeLimit without it.
  const Advantages last =
      generalised_advantages(3, 1, kRewards, {0, 0, 1}, kValues, {0.5, 0.8, true});
  expect_near(last.advantages, {1.94, 2.35, 1.5});
}

TEST(Advantage, EpisodesSideBySideDoNotMix) {
  // The first is the one above, the second has no reward and no value.
  const std::vector<float> rewards = {1, 0, 2, 0, 3, 0}, values = {0.5, 0, 1, 0, 1.5, 0, 4, 0};
  const Advantages result =
      generalised_advantages(3, 2, rewards, {0, 0, 0, 0, 0, 0}, values, {0.5, 0.8, true});
  expect_near(result.advantages, {2.26, 0, 3.15, 0, 3.5, 0});
}

TEST(Advantage, NormalisedToMeanZeroAndDeviationOne) {
  std::vector<float> advantages = {1, 2, 3, 6};  // mean 3, variance (4 + 1 + 0 + 9) / 4 = 3.5
  normalise(advantages);
  expect_near(advantages, {-2 / std::sqrt(3.5), -1 / std::sqrt(3.5), 0, 3 / std::sqrt(3.5)});
  std::vector<float> constant = {2, 2, 2};
  normalise(constant);
  expect_near(constant, {0, 0, 0});
}

}  // namespace
}  // namespace threelink_tests

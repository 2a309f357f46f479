// The terms of PPO's loss, and their gradients, against values worked out by hand.
#include "threelink_agent/training/losses.hpp"

#include <cmath>

#include <gtest/gtest.h>

namespace threelink_tests {
namespace {

using namespace threelink_agent;

const double kLog2Pi = std::log(2 * std::acos(-1.0));

// Gradient of the loss of one sample by its log-ratio.
double policy_gradient(double ratio, double advantage, double* loss = nullptr) {
  torch::Tensor log_ratio = torch::full({1}, std::log(ratio), torch::requires_grad());
  torch::Tensor result = clipped_policy_loss(log_ratio, torch::full({1}, advantage), 0.2);
  result.backward();
  if (loss) *loss = result.item<double>();
  return log_ratio.grad().item<double>();
}

TEST(PolicyLoss, InsideTheIntervalItIsTheRatioTimesTheAdvantage) {
  for (double ratio : {0.81, 1.0, 1.19})
    for (double advantage : {2.0, -2.0}) {
      double loss;
      // d(-r A)/d(log r) = -r A
      EXPECT_NEAR(policy_gradient(ratio, advantage, &loss), -ratio * advantage, 1e-6);
      EXPECT_NEAR(loss, -ratio * advantage, 1e-6);
    }
}

TEST(PolicyLoss, AboveTheIntervalAGoodActionIsClipped) {
  double loss;
  EXPECT_EQ(policy_gradient(1.3, 2, &loss), 0);
  EXPECT_NEAR(loss, -1.2 * 2, 1e-6);
}

TEST(PolicyLoss, AboveTheIntervalABadActionIsNot) {
  double loss;
  EXPECT_NEAR(policy_gradient(1.3, -2, &loss), 2.6, 1e-6);
  EXPECT_NEAR(loss, 2.6, 1e-6);
}

TEST(PolicyLoss, BelowTheIntervalABadActionIsClipped) {
  double loss;
  EXPECT_EQ(policy_gradient(0.7, -2, &loss), 0);
  EXPECT_NEAR(loss, 0.8 * 2, 1e-6);
}

TEST(PolicyLoss, BelowTheIntervalAGoodActionIsNot) {
  double loss;
  EXPECT_NEAR(policy_gradient(0.7, 2, &loss), -1.4, 1e-6);
  EXPECT_NEAR(loss, -1.4, 1e-6);
}

TEST(PolicyLoss, IsTheMeanOverSamples) {
  const torch::Tensor log_ratio = torch::log(torch::tensor({1.0f, 1.3f}));
  const torch::Tensor advantages = torch::tensor({1.0f, 2.0f});
  EXPECT_NEAR(clipped_policy_loss(log_ratio, advantages, 0.2).item<double>(), -(1 + 2.4) / 2, 1e-6);
}

TEST(Losses, LogProbability) {
  // Hinge 1: z = (1 - 0.5) / 0.5 = 1; hinge 2: z = (-1 - 1) / 2 = -1.
  const torch::Tensor actions = torch::tensor({{1.0f, -1.0f}}),
                      mean = torch::tensor({{0.5f, 1.0f}});
  const torch::Tensor log_std = torch::log(torch::tensor({0.5f, 2.0f}));
  const double expected = -0.5 - std::log(0.5) - 0.5 - std::log(2.0) - kLog2Pi;
  EXPECT_NEAR(log_probability(actions, mean, log_std).item<double>(), expected, 1e-6);
}

TEST(Losses, Entropy) {
  // (1 + log(2 pi)) / 2 + log std for each hinge
  const torch::Tensor log_std = torch::log(torch::tensor({0.5f, 3.0f}));
  const double expected = 1 + kLog2Pi + std::log(1.5);
  EXPECT_NEAR(entropy(log_std).item<double>(), expected, 1e-6);
}

TEST(Losses, ValueLossIsHalfTheMeanSquare) {
  const torch::Tensor values = torch::tensor({1.0f, 2.0f}), returns = torch::tensor({2.0f, 5.0f});
  EXPECT_NEAR(value_loss(values, returns).item<double>(), (1.0 + 9.0) / 4, 1e-6);
}

TEST(Losses, DivergenceAndClipFraction) {
  const torch::Tensor log_ratio = torch::log(torch::tensor({1.0f, 1.5f, 0.9f, 0.5f}));
  const double expected = (0 + 0.5 - std::log(1.5) - 0.1 - std::log(0.9) - 0.5 - std::log(0.5)) / 4;
  EXPECT_NEAR(kl_estimate(log_ratio).item<double>(), expected, 1e-6);
  EXPECT_NEAR(clip_fraction(log_ratio, 0.2).item<double>(), 0.5, 1e-6);
}

}  // namespace
}  // namespace threelink_tests

// The fused update against LibTorch's autograd.
#include <cmath>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "random_update.hpp"
#include "threelink_agent/training/backend.hpp"
#include "threelink_agent/training/fused_update.hpp"

namespace threelink_tests {
namespace {

using threelink_sim::Isa;

void expect_same_gradient(const TrainConfig& config, std::uint32_t key, Isa isa,
                          double tolerance = 1e-5) {
  const Rollout rollout = random_rollout(config, key);
  const Advantages advantages = random_advantages(rollout, key);
  FusedUpdate fused(config, 1, isa);
  const auto torch = make_ppo_update(Backend::kLibtorch, config, 1);
  const UpdateStatistics actual = fused.run(rollout, advantages, 0, {1e-3, 1e-3});
  const UpdateStatistics expected = torch->run(rollout, advantages, 0, {1e-3, 1e-3});
  EXPECT_NEAR(actual.policy_loss, expected.policy_loss, 1e-5);
  EXPECT_NEAR(actual.value_loss, expected.value_loss, 1e-5);
  EXPECT_NEAR(actual.kl, expected.kl, 1e-5);
  EXPECT_NEAR(actual.clip_fraction, expected.clip_fraction, 1e-6);
  EXPECT_GT(actual.clip_fraction, 0.2);  // the clipped branches were taken

  const std::vector<Eigen::VectorXf> mean = list(fused.state().mean);
  std::size_t tensor = 0;
  visit(torch->state().mean, [&](const std::string& name, const Eigen::VectorXf& values) {
    EXPECT_LE((mean[tensor++] - values).norm(), tolerance * values.norm())
        << name << ", " << threelink_sim::to_string(isa);
  });
}

TEST(FusedUpdate, GradientIsThatOfAutograd) {
  for (Isa isa : threelink_sim::available_isas())
    for (std::uint32_t key = 0; key < 3; ++key) {
      TrainConfig config = one_step();
      config.seed = key;
      expect_same_gradient(config, key, isa);
      config.exploration.learned = true;
      config.update.entropy_weight = 0.01;
      expect_same_gradient(config, key, isa);
    }
}

TEST(FusedUpdate, GradientOfOtherShapes) {
  for (Isa isa : threelink_sim::available_isas()) {
    expect_same_gradient(one_step({5}), 1, isa);
    expect_same_gradient(one_step({3, 70, 17}), 2, isa);
    expect_same_gradient(one_step({64, 64}, 2), 3, isa);
    expect_same_gradient(one_step({32, 48}, 7), 4, isa);
    TrainConfig homing = one_step();  // the critic is shown more than the actor
    homing.goal.points = threelink_sim::PointsGoal{0.5, 0.1, 0.1, 0.1, 1};
    homing.environment.observation = threelink_sim::ObservationKind::kTarget;
    expect_same_gradient(homing, 6, isa);
    // Log-probabilities are about 60 here, and their roundings, 31 of 2^-24 * 60, are relative
    // errors of the ratio.
    expect_same_gradient(one_step({128, 256}, 32), 5, isa, 31 * 0x1p-24 * 60);
  }
}

TEST(FusedUpdate, StatisticsAreThoseOfLibTorchForMinibatchesOfAllSizes) {
  const TrainConfig config = several_steps();
  const Rollout rollout = random_rollout(config, 0);
  const Advantages advantages = random_advantages(rollout, 0);
  FusedUpdate fused(config, 1);
  const UpdateStatistics actual = fused.run(rollout, advantages, 0, {1e-3, 1e-3});
  const UpdateStatistics expected =
      make_ppo_update(Backend::kLibtorch, config, 1)->run(rollout, advantages, 0, {1e-3, 1e-3});
  EXPECT_NEAR(actual.policy_loss, expected.policy_loss, 1e-5);
  EXPECT_NEAR(actual.value_loss, expected.value_loss, 1e-5);
  EXPECT_NEAR(actual.kl, expected.kl, 1e-5);
  EXPECT_NEAR(actual.clip_fraction, expected.clip_fraction, 1e-6);
}

double distance(const LearnerTensors& a, const LearnerTensors& b) {
  const std::vector<Eigen::VectorXf> of_a = list(a), of_b = list(b);
  double square = 0;
  for (std::size_t i = 0; i < of_a.size(); ++i) square += (of_a[i] - of_b[i]).squaredNorm();
  return std::sqrt(square);
}

// Rounding errors grow in the course of a training. How fast is seen from LibTorch itself, started
// from weights that differ in their last bit.
TEST(FusedUpdate, FiftyUpdatesStayAsCloseToLibTorchAsRoundingAllows) {
  const TrainConfig config = several_steps();
  const auto torch = make_ppo_update(Backend::kLibtorch, config, 1);
  const auto rounded = make_ppo_update(Backend::kLibtorch, config, 1);
  FusedUpdate fused(config, 1);
  LearnerState start = torch->state();
  for (Linear& layer : start.parameters.actor) layer.weight *= 1 + 0x1p-23f;
  for (Linear& layer : start.parameters.critic) layer.weight *= 1 + 0x1p-23f;
  rounded->restore(start);

  const LearnerTensors reference = after_updates(*torch, config, 0, 50).parameters;
  const double by_rounding = distance(after_updates(*rounded, config, 0, 50).parameters, reference);
  const double actual = distance(after_updates(fused, config, 0, 50).parameters, reference);
  EXPECT_LT(actual, 10 * by_rounding);
  EXPECT_LT(actual, 1e-2 * distance(reference, initial_state(config).parameters));
}

}  // namespace
}  // namespace threelink_tests

// The fused update against LibTorch's autograd, and against itself.
#include "threelink_agent/training/fused_update.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <memory>
#include <string>

#include <gtest/gtest.h>

#include "threelink_agent/training/backend.hpp"
#include "threelink_sim/random.hpp"

namespace threelink_tests {
namespace {

using namespace threelink_agent;
using threelink_sim::Isa;

// An update of one step of Adam on all samples, whose first moment is a tenth of the gradient.
TrainConfig one_step(const std::vector<int>& hidden = {64, 64}, int links = 3) {
  TrainConfig config = load_train_config(THREELINK_CONFIG "/train_vfs.yaml");
  config.hidden = hidden;
  config.environment.model.links = links;
  config.environment.steps = 37;
  config.update.episodes = 5;
  config.update.minibatch = 5 * 37;
  config.update.epochs = 1;
  config.update.max_gradient_norm = 1e9;
  if (links % 2 == 0) config.symmetry.canonical = Symmetry::kNone;
  return config;
}

// Numbers that no swimmer gave: all ranges of the loss are met.
Rollout random_rollout(const TrainConfig& config, std::uint32_t key) {
  Rollout rollout(config.environment, static_cast<int>(config.update.episodes));
  threelink_sim::Random random(key, threelink_sim::Stream::kStart, 0);
  for (auto* array : {&rollout.observations, &rollout.actions})
    for (float& value : *array) value = static_cast<float>(random.normal());
  // About the log-probability under the initial policy, so that ratios are around 1.
  const float log_std = std::log(0.6f);
  const std::size_t n = rollout.log_probs.size();
  for (std::size_t i = 0; i < n; ++i) {
    double log_prob = 0.3 * random.normal();
    for (int j = 0; j < rollout.hinges; ++j) {
      const double z = rollout.actions[j * n + i] / 0.6;
      log_prob += -0.5 * z * z - log_std - 0.918938533;
    }
    rollout.log_probs[i] = static_cast<float>(log_prob);
  }
  return rollout;
}

Advantages random_advantages(const Rollout& rollout, std::uint32_t key) {
  threelink_sim::Random random(key, threelink_sim::Stream::kStart, 1);
  Advantages result;
  for (std::size_t i = 0; i < rollout.log_probs.size(); ++i) {
    result.advantages.push_back(static_cast<float>(random.normal()));
    result.returns.push_back(static_cast<float>(random.normal()));
  }
  return result;
}

// Calls visit(name, values) for every parameter tensor.
void visit(const LearnerTensors& tensors,
           const std::function<void(const std::string&, const Eigen::VectorXf&)>& visit) {
  const auto network = [&](const std::string& name, const std::vector<Linear>& layers) {
    for (std::size_t l = 0; l < layers.size(); ++l) {
      const auto& weight = layers[l].weight;
      visit(name + " weight " + std::to_string(l),
            Eigen::Map<const Eigen::VectorXf>(weight.data(), weight.size()));
      visit(name + " bias " + std::to_string(l), layers[l].bias);
    }
  };
  network("actor", tensors.actor);
  visit("log_std", tensors.log_std);
  network("critic", tensors.critic);
}

std::vector<Eigen::VectorXf> list(const LearnerTensors& tensors) {
  std::vector<Eigen::VectorXf> all;
  visit(tensors, [&](const std::string&, const Eigen::VectorXf& values) { all.push_back(values); });
  return all;
}

void expect_equal(const LearnerState& actual, const LearnerState& expected) {
  EXPECT_EQ(actual.adam_steps, expected.adam_steps);
  for (auto part : {&LearnerState::parameters, &LearnerState::mean, &LearnerState::variance})
    EXPECT_EQ(list(actual.*part), list(expected.*part));
}

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
    homing.homing = HomingConfig{threelink_sim::ObservationKind::kDirection, 0.5, 0.1, 0.1, 0.1, 1};
    homing.environment.observation = threelink_sim::ObservationKind::kTarget;
    expect_same_gradient(homing, 6, isa);
    // Log-probabilities are about 60 here, and their roundings, 31 of 2^-24 * 60, are relative
    // errors of the ratio.
    expect_same_gradient(one_step({128, 256}, 32), 5, isa, 31 * 0x1p-24 * 60);
  }
}

// A realistic run of several epochs and minibatches, the last of them smaller.
TrainConfig several_steps() {
  TrainConfig config = one_step();
  config.update.epochs = 3;
  config.update.minibatch = 50;
  config.update.max_gradient_norm = 0.5;
  return config;
}

LearnerState after_updates(PpoUpdate& ppo, const TrainConfig& config, int first, int last) {
  for (int update = first; update < last; ++update) {
    const Rollout rollout = random_rollout(config, update);
    ppo.run(rollout, random_advantages(rollout, update), update, {1e-3, 1e-3});
  }
  return ppo.state();
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

TEST(FusedUpdate, ThreadsDoNotChangeTheResult) {
  const TrainConfig config = several_steps();
  FusedUpdate one(config, 1);
  const LearnerState expected = after_updates(one, config, 0, 5);
  for (int threads : {2, 3, 8, 20}) {
    FusedUpdate many(config, threads);
    expect_equal(after_updates(many, config, 0, 5), expected);
  }
}

TEST(FusedUpdate, InstructionSetsWithFusedMultiplyAddGiveEqualBits) {
  const TrainConfig config = several_steps();
  std::vector<LearnerState> states;
  for (Isa isa : threelink_sim::available_isas()) {
    if (!threelink_sim::kernels(isa).fused) continue;
    FusedUpdate update(config, 1, isa);
    states.push_back(after_updates(update, config, 0, 5));
    expect_equal(states.back(), states.front());
  }
  if (states.size() < 2) GTEST_SKIP() << "this processor has fewer than two of them";
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

TEST(PpoUpdate, ARestoredStateGoesOnToTheSameBits) {
  for (Backend backend : {Backend::kFused, Backend::kLibtorch})
    for (bool learned : {false, true}) {
      TrainConfig config = several_steps();
      config.exploration.learned = learned;
      const auto whole = make_ppo_update(backend, config, 1);
      const LearnerState half = after_updates(*whole, config, 0, 2);
      const LearnerState expected = after_updates(*whole, config, 2, 4);
      const auto resumed = make_ppo_update(backend, config, 1);
      resumed->restore(half);
      expect_equal(resumed->state(), half);
      expect_equal(after_updates(*resumed, config, 2, 4), expected);
    }
}

TEST(PpoUpdate, BackendsStartFromTheSameState) {
  const TrainConfig config = several_steps();
  expect_equal(make_ppo_update(Backend::kFused, config, 1)->state(), initial_state(config));
  expect_equal(make_ppo_update(Backend::kLibtorch, config, 1)->state(), initial_state(config));
}

TEST(Backend, NamesAreStrict) {
  EXPECT_EQ(backend_from_string("fused"), Backend::kFused);
  EXPECT_EQ(backend_from_string("libtorch"), Backend::kLibtorch);
  EXPECT_THROW(backend_from_string("Fused"), std::invalid_argument);
}

}  // namespace
}  // namespace threelink_tests

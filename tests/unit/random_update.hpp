// Updates on numbers that no swimmer gave, for the tests of the backends.
#pragma once

#include <cmath>
#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "threelink_agent/training/advantage.hpp"
#include "threelink_agent/training/learner_state.hpp"
#include "threelink_agent/training/ppo_update.hpp"
#include "threelink_agent/training/train_config.hpp"
#include "threelink_sim/random.hpp"

namespace threelink_tests {

using namespace threelink_agent;

// An update of one step of Adam on all samples, whose first moment is a tenth of the gradient.
inline TrainConfig one_step(const std::vector<int>& hidden = {64, 64}, int links = 3) {
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
inline Rollout random_rollout(const TrainConfig& config, std::uint32_t key) {
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

inline Advantages random_advantages(const Rollout& rollout, std::uint32_t key) {
  threelink_sim::Random random(key, threelink_sim::Stream::kStart, 1);
  Advantages result;
  for (std::size_t i = 0; i < rollout.log_probs.size(); ++i) {
    result.advantages.push_back(static_cast<float>(random.normal()));
    result.returns.push_back(static_cast<float>(random.normal()));
  }
  return result;
}

// Calls visit(name, values) for every parameter tensor.
inline void visit(const LearnerTensors& tensors,
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

inline std::vector<Eigen::VectorXf> list(const LearnerTensors& tensors) {
  std::vector<Eigen::VectorXf> all;
  visit(tensors, [&](const std::string&, const Eigen::VectorXf& values) { all.push_back(values); });
  return all;
}

inline void expect_equal(const LearnerState& actual, const LearnerState& expected) {
  EXPECT_EQ(actual.adam_steps, expected.adam_steps);
  for (auto part : {&LearnerState::parameters, &LearnerState::mean, &LearnerState::variance})
    EXPECT_EQ(list(actual.*part), list(expected.*part));
}

// A realistic run of several epochs and minibatches, the last of them smaller.
inline TrainConfig several_steps() {
  TrainConfig config = one_step();
  config.update.epochs = 3;
  config.update.minibatch = 50;
  config.update.max_gradient_norm = 0.5;
  return config;
}

inline LearnerState after_updates(PpoUpdate& ppo, const TrainConfig& config, int first, int last) {
  for (int update = first; update < last; ++update) {
    const Rollout rollout = random_rollout(config, update);
    ppo.run(rollout, random_advantages(rollout, update), update, {1e-3, 1e-3});
  }
  return ppo.state();
}

}  // namespace threelink_tests

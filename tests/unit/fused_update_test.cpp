// The fused update against itself; fused_against_libtorch_test.cpp has the rest.
#include "threelink_agent/training/fused_update.hpp"

#include <vector>

#include <gtest/gtest.h>

#include "available_backends.hpp"
#include "random_update.hpp"

namespace threelink_tests {
namespace {

using threelink_sim::Isa;

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

TEST(PpoUpdate, ARestoredStateGoesOnToTheSameBits) {
  for (Backend backend : available_backends())
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
  for (Backend backend : available_backends())
    expect_equal(make_ppo_update(backend, config, 1)->state(), initial_state(config));
}

TEST(Backend, NamesAreStrict) {
  EXPECT_EQ(backend_from_string("fused"), Backend::kFused);
  EXPECT_EQ(backend_from_string("libtorch"), Backend::kLibtorch);
  EXPECT_THROW(backend_from_string("Fused"), std::invalid_argument);
}

}  // namespace
}  // namespace threelink_tests

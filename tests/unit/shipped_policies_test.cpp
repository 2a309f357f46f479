// The policies in config/policies are what docs/learning.md says of them.
#include <cmath>
#include <fstream>
#include <iterator>

#include <gtest/gtest.h>

#include "threelink_agent/evaluate.hpp"
#include "threelink_agent/policy.hpp"
#include "threelink_agent/training/train_config.hpp"

namespace threelink_tests {
namespace {

using namespace threelink_agent;

const std::string kConfig = THREELINK_CONFIG;

std::string text_of(const std::string& path) {
  std::ifstream file(path);
  return {std::istreambuf_iterator<char>(file), {}};
}

TEST(Vfs, SwimsAtTheOptimalSpeedFromEveryStart) {
  const Policy policy = Policy::load(kConfig + "/policies/vfs.safetensors");
  const Evaluation evaluation = evaluate(policy, 300, 1);
  for (const StartResult& start : evaluation.starts) {
    EXPECT_GT(start.speed, 0.01290) << start.theta_2;  // the optimum is 0.0129154
    EXPECT_LT(start.speed, 0.01292) << start.theta_2;
    EXPECT_TRUE(start.success) << start.theta_2;
  }
  EXPECT_EQ(evaluation.success_rate, 1);
}

TEST(Vfs, WasTrainedWithTheShippedConfiguration) {
  const Policy policy = Policy::load(kConfig + "/policies/vfs.safetensors");
  EXPECT_EQ(policy.metadata().config, to_yaml(load_train_config(kConfig + "/train_vfs.yaml")));
  EXPECT_NE(text_of(kConfig + "/../docs/learning.md").find(policy.sha256()), std::string::npos);
}

}  // namespace
}  // namespace threelink_tests

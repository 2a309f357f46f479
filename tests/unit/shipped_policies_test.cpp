// The policies in config/policies are what docs/learning.md says of them.
#include <cmath>
#include <cstdint>
#include <fstream>
#include <iterator>

#include <gtest/gtest.h>

#include "threelink_agent/evaluate.hpp"
#include "threelink_agent/policy.hpp"
#include "threelink_agent/training/train_config.hpp"
#include "threelink_agent/training/trainer.hpp"
#include "threelink_sim/stroke.hpp"

namespace threelink_tests {
namespace {

using namespace threelink_agent;

const std::string kConfig = THREELINK_CONFIG;

std::string text_of(const std::string& path) {
  std::ifstream file(path);
  return {std::istreambuf_iterator<char>(file), {}};
}

TEST(ShippedPolicies, VfsSwimsAtTheOptimalSpeedFromEveryStart) {
  const Policy policy = Policy::load(kConfig + "/policies/vfs.safetensors");
  for (RandomStarts starts : {RandomStarts::kBent, RandomStarts::kStraight}) {
    const Evaluation evaluation = evaluate(policy, 300, 1, starts);
    for (const StartResult& start : evaluation.starts) {
      EXPECT_GT(start.speed, 0.01290) << start.theta_2;  // the optimum is 0.0129154
      EXPECT_LT(start.speed, 0.01292) << start.theta_2;
      EXPECT_TRUE(start.success) << start.theta_2;
    }
    EXPECT_EQ(evaluation.success_rate, 1);
    EXPECT_GT(evaluation.theta_s, 0);
    EXPECT_LT(evaluation.theta_s, 0.5 * threelink_sim::kPi / 180);
  }
}

TEST(ShippedPolicies, ThoseOfMoreLinksSwimAtTheOptimalSpeed) {
  struct Case {
    int links;
    double optimum, share;  // with 40 pieces
    double period;          // [steps]
  };
  for (const Case& expected : {Case{4, 0.021862, 0.999, 55.04}, Case{5, 0.030367, 0.998, 48.69},
                               Case{6, 0.038681, 0.999, 41.72}}) {
    const std::string name = "vfs_n" + std::to_string(expected.links);
    const Policy policy = Policy::load(kConfig + "/policies/" + name + ".safetensors");
    EXPECT_EQ(policy.metadata().links, expected.links);
    EXPECT_EQ(policy.metadata().symmetry, Symmetry::kReversal);
    const Evaluation evaluation = evaluate(policy, 300, 1);
    for (const StartResult& start : evaluation.starts) {
      EXPECT_GT(start.speed, expected.share * expected.optimum) << name << " " << start.theta_2;
      EXPECT_LT(start.speed, threelink_sim::fastest_speed(expected.links)) << name;
      EXPECT_NEAR(start.period_steps, expected.period, 1.5) << name;
      EXPECT_TRUE(start.success) << name << " " << start.theta_2;
    }
    EXPECT_GE(evaluation.success_rate, 0.99) << name;
  }
}

TEST(ShippedPolicies, ObjectivesAreNearlyOptimal) {
  struct Case {
    std::string name;
    double c, optimum;  // of v - c P / 6
  };
  for (const Case& expected :
       {Case{"vfs", 0, 0.0129154}, Case{"eas_c1", 1, 0.011346}, Case{"eas_c2", 2, 0.010001},
        Case{"eas", 3, 0.008790}, Case{"eas_c4", 4, 0.007691}}) {
    const Policy policy = Policy::load(kConfig + "/policies/" + expected.name + ".safetensors");
    const TrainConfig config = parse_train_config(policy.metadata().config, expected.name);
    EXPECT_EQ(config.environment.c, expected.c);
    const Evaluation evaluation = evaluate(policy, 100, 0);
    EXPECT_GT(objective(evaluation, config.environment), 0.998 * expected.optimum) << expected.name;
    EXPECT_GE(evaluation.success_rate, 0.99) << expected.name;
    for (const StartResult& start : evaluation.starts) EXPECT_TRUE(start.success) << expected.name;
  }
}

TEST(ShippedPolicies, HomingOnesCruiseAsFastAsTheyShould) {
  using threelink_sim::ObservationKind;
  for (const auto& [name, observation] :
       {std::pair{"homing", ObservationKind::kTarget},
        std::pair{"homing_direction", ObservationKind::kDirection}}) {
    const Policy policy = Policy::load(kConfig + "/policies/" + name + ".safetensors");
    EXPECT_EQ(policy.metadata().observation, observation);
    EXPECT_TRUE(policy.metadata().sampled);
    EXPECT_GT(evaluate(policy, 0, 0).speed, 0.996 * 0.0129154) << name;
  }
}

TEST(ShippedPolicies, WereTrainedAsTheDocumentationSays) {
  const std::string learning = text_of(kConfig + "/../docs/learning.md");
  for (const char* name :
       {"vfs", "eas_c1", "eas_c2", "eas", "eas_c4", "homing", "homing_direction"}) {
    const Policy policy = Policy::load(kConfig + "/policies/" + name + ".safetensors");
    EXPECT_NE(learning.find(policy.sha256()), std::string::npos) << name;
  }
  const auto config_of = [](const std::string& name) {
    const std::string path = kConfig + "/policies/" + name + ".safetensors";
    return to_yaml(parse_train_config(Policy::load(path).metadata().config, path));
  };
  EXPECT_EQ(config_of("vfs"), to_yaml(load_train_config(kConfig + "/train_vfs.yaml")));
  struct Eas {
    std::string name;
    double c;
    std::uint64_t seed;
  };
  for (const Eas& expected :
       {Eas{"eas_c1", 1, 1}, Eas{"eas_c2", 2, 0}, Eas{"eas", 3, 2}, Eas{"eas_c4", 4, 1}}) {
    TrainConfig eas = load_train_config(kConfig + "/train_eas.yaml");
    eas.environment.c = expected.c;
    eas.seed = expected.seed;
    EXPECT_EQ(config_of(expected.name), to_yaml(eas)) << expected.name;
  }
  EXPECT_EQ(config_of("homing"), to_yaml(load_train_config(kConfig + "/train_homing.yaml")));
  TrainConfig direction = load_train_config(kConfig + "/train_homing_direction.yaml");
  direction.seed = 2;
  EXPECT_EQ(config_of("homing_direction"), to_yaml(direction));
}

}  // namespace
}  // namespace threelink_tests

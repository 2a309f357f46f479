// The strict reader of training configurations.
#include "threelink_agent/training/train_config.hpp"

#include <iterator>
#include <random>
#include <regex>
#include <string>

#include <gtest/gtest.h>

namespace threelink_tests {
namespace {

using namespace threelink_agent;

const std::string kValid = R"(
seed: 3
episodes: 400
evaluate_every: 5
environment: {links: 3, gamma: 0.5, dt: 0.1, b: 6.0, c: 1.5, steps: 200}
hidden: [64, 32]
symmetry: {canonical: reversal, mirror: true}
exploration: {learned: false, std: 0.6, std_final: 0.3, decay_fraction: 0.8}
advantage: {discount: 0.99, lambda: 0.95, bootstrap_at_time_limit: true, normalise: false}
update:
  episodes: 40
  epochs: 10
  minibatch: 1000
  clip: 0.2
  entropy_weight: 0.0
  max_gradient_norm: 0.5
  actor_learning_rate: 1.0e-3
  critic_learning_rate: 2.0e-3
  final_learning_rate: 0.1
)";

std::string with(const std::string& found, const std::string& put) {
  std::string yaml = kValid;
  const std::size_t at = yaml.find(found);
  EXPECT_NE(at, std::string::npos) << found;
  return yaml.replace(at, found.size(), put);
}

TEST(TrainConfig, TakesAnyNumberOfLinksWithReversal) {
  for (int links = 2; links <= 8; ++links) {
    const std::string value = "links: " + std::to_string(links);
    const TrainConfig config = parse_train_config(with("links: 3", value), "test");
    EXPECT_EQ(config.environment.model.links, links);
    EXPECT_EQ(config.symmetry.canonical, Symmetry::kReversal);
  }
}

TEST(TrainConfig, ReadsEveryKey) {
  const TrainConfig config = parse_train_config(kValid, "test");
  EXPECT_EQ(config.seed, 3u);
  EXPECT_EQ(config.episodes, 400u);
  EXPECT_EQ(config.evaluate_every, 5u);
  EXPECT_EQ(config.environment.model.links, 3);
  EXPECT_EQ(config.environment.c, 1.5);
  EXPECT_EQ(config.environment.steps, 200u);
  EXPECT_EQ(config.hidden, (std::vector<int>{64, 32}));
  EXPECT_EQ(config.symmetry.canonical, Symmetry::kReversal);
  EXPECT_TRUE(config.symmetry.mirror);
  EXPECT_EQ(config.exploration.std_final, 0.3);
  EXPECT_EQ(config.advantage.lambda, 0.95);
  EXPECT_FALSE(config.advantage.normalise);
  EXPECT_EQ(config.update.minibatch, 1000u);
  EXPECT_EQ(config.update.actor_learning_rate, 1e-3);
  EXPECT_EQ(config.update.final_learning_rate, 0.1);
  EXPECT_EQ(config.updates(), 10u);
}

TEST(TrainConfig, VersionTwoHasTheJointLimitAndVersionOneMeansItsDefault) {
  const TrainConfig old = parse_train_config(kValid, "test");
  EXPECT_EQ(old.environment.model.joint_limit, threelink_sim::Model().joint_limit);
  const std::string yaml = "version: 2\nobservation: direction\ngoal: {kind: direction}\n" +
                           with("dt: 0.1,", "dt: 0.1, joint_limit: 1.5,");
  const TrainConfig config = parse_train_config(yaml, "test");
  EXPECT_EQ(config.environment.model.joint_limit, 1.5);
  EXPECT_EQ(to_yaml(config).rfind("version: 2\n", 0), 0u);
  const auto difference = first_difference(old, config);
  ASSERT_TRUE(difference);
  EXPECT_EQ(difference->name, "environment.joint_limit");
  EXPECT_EQ(difference->b, "1.5");
}

TEST(TrainConfig, WrittenAndReadBackIsTheSame) {
  TrainConfig config = parse_train_config(kValid, "test");
  config.update.actor_learning_rate = 1e-5;
  config.environment.b = 7;
  const std::string yaml = to_yaml(config);
  const TrainConfig again = parse_train_config(yaml, "test");
  EXPECT_EQ(to_yaml(again), yaml);
  EXPECT_EQ(again.update.actor_learning_rate, 1e-5);
  // In ROS 1, 7 would be a whole number and 1e-05 a string.
  EXPECT_NE(yaml.find("  b: 7.0\n"), std::string::npos) << yaml;
  EXPECT_NE(yaml.find("  actor_learning_rate: 1.0e-05\n"), std::string::npos) << yaml;
}

const char* const kHoming = R"(
homing:
  observation: direction
  direction_share: 0.7
  nearest: 0.001
  farthest: 0.5
  threshold: 0.002
  bonus: 1.5
)";

TEST(TrainConfig, HomingIsASectionThatMayBeLeftOut) {
  using threelink_sim::ObservationKind;
  const TrainConfig without = parse_train_config(kValid, "test");
  EXPECT_FALSE(without.goal.has_target());
  EXPECT_EQ(without.environment.observation, ObservationKind::kDirection);
  const TrainConfig with = parse_train_config(kValid + kHoming, "test");
  ASSERT_TRUE(with.goal.points);
  EXPECT_EQ(with.observation, ObservationKind::kDirection);
  EXPECT_EQ(with.environment.observation, ObservationKind::kTarget);  // the critic's
  EXPECT_EQ(with.goal.points->direction_share, 0.7);
  EXPECT_EQ(with.goal.points->threshold, 0.002);
  EXPECT_EQ(to_yaml(parse_train_config(to_yaml(with), "test")), to_yaml(with));

  for (const bool swapped : {false, true}) {
    const auto difference =
        swapped ? first_difference(with, without) : first_difference(without, with);
    ASSERT_TRUE(difference);
    EXPECT_EQ(difference->name, "goal.kind");
    EXPECT_EQ(swapped ? difference->b : difference->a, "\"direction\"");
    EXPECT_EQ(swapped ? difference->a : difference->b, "\"points\"");
  }
}

TEST(TrainConfig, RefusesHomingThatCannotBe) {
  const auto refusal = [](const std::string& found, const std::string& put) -> std::string {
    std::string yaml = kValid + kHoming;
    try {
      parse_train_config(yaml.replace(yaml.find(found), found.size(), put), "test");
    } catch (const ConfigError& error) {
      return error.what();
    }
    return "accepted";
  };
  const auto expect = [&](const std::string& found, const std::string& put,
                          const std::string& message) {
    EXPECT_NE(refusal(found, put).find(message), std::string::npos) << refusal(found, put);
  };
  expect("bonus: 1.5", "bonus: -1.0", "homing.bonus = -1.0: must be in [0, 1000000]");
  expect("  bonus: 1.5\n", "", "homing.bonus: missing");
  expect("bonus: 1.5", "bonus: 1.5\n  bonnus: 1.0", "homing.bonnus: unknown key");
  expect("direction_share: 0.7", "direction_share: 1.1",
         "homing.direction_share = 1.1: must be in");
  expect("nearest: 0.001", "nearest: 0.0", "homing.nearest = 0.0: must be in");
  expect("farthest: 0.5", "farthest: 0.0005",
         "goal.farthest = 0.0005: must be at least goal.nearest = 0.001");
  expect("threshold: 0.002", "threshold: .nan", "homing.threshold = .nan: must be finite");
  expect("observation: direction", "observation: camera",
         "homing.observation = camera: must be one of: direction, target");
  expect(kHoming, "\nhoming: 1\n", "homing = 1: must be a map of keys to values");
}

TEST(TrainConfig, LearnedStdHasNoSchedule) {
  const std::string learned =
      with("{learned: false, std: 0.6, std_final: 0.3, decay_fraction: 0.8}",
           "{learned: true, std: 0.6}");
  const TrainConfig config = parse_train_config(learned, "test");
  EXPECT_TRUE(config.exploration.learned);
  EXPECT_EQ(to_yaml(config).find("std_final"), std::string::npos);
}

struct Refusal {
  const char* found;
  const char* put;
  const char* message;  // regular expression
};

const Refusal kRefusals[] = {
    // Unknown, missing, twice, of the wrong form
    {"clip: 0.2", "clp: 0.2", "update.clp: unknown key .*update.clip"},
    {"seed: 3", "sead: 3", "sead: unknown key .*seed"},
    {"dt: 0.1, ", "dt: 0.1, joint_limit: 2.0, ",
     "environment.joint_limit = 2.0: is a key of version 2"},
    {"seed: 3\n", "", "seed: missing"},
    {"lambda: 0.95, ", "", "advantage.lambda: missing"},
    {"std_final: 0.3, ", "", "exploration.std_final: missing"},
    {"seed: 3\n", "seed: 3\nseed: 4\n", "line 3, column 1: seed: given twice"},
    {"clip: 0.2", "clip: 0.2\n  clip: 0.3", "clip: given twice"},
    {"symmetry: {", "advantage: {lambda: 1.0}\nsymmetry: {", "advantage: given twice"},
    {"learned: false", "learned: true", "exploration.(std_final|decay_fraction): unknown key"},
    {"epochs: 10", "epochs: {a: 10}", "update.epochs.a: unknown key .*update.epochs"},
    {"hidden: [64, 32]", "hidden: {a: 64}", "hidden.a: unknown key"},
    {"symmetry: {canonical: reversal, mirror: true}", "symmetry: 1", "symmetry: unknown key"},
    {"seed: 3", "seed: [3", "test: is not YAML: line "},
    {"seed: 3", "learning_rate: 3", "learning_rate: unknown key .*update.actor_learning_rate"},
    {"seed: 3", "hiden: 3", "hiden: unknown key .*hidden"},
    {"clip: 0.2", "clip: 0.2\n  lambda: 1.0", "update.lambda: unknown key .*advantage.lambda"},
    {"seed: 3", "seed: &a {b: *a}", "test: line .*anchors"},
    {"seed: 3", "seed: !!int ' 5'", "test: line .*tags"},
    {"seed: 3", "seed: 3\n---\nseed: 4", "a second document"},
    {"seed: 3", "symmetry.mirror: true\nseed: 3", "symmetry.mirror: given twice"},
    {kValid.c_str(), "- 1", "must be a map"},
    {kValid.c_str(), "", "must be a map"},
    {"seed: 3", "version: 1\nseed: 3", "version = 1: must be in \\[2, 2\\]"},
    {"seed: 3", "version: 3\nseed: 3", "version = 3: must be in \\[2, 2\\]"},
    {"seed: 3", "version: 2\nseed: 3", "environment.joint_limit: missing"},
    {"seed: 3", "seed: 3\nhoming: {}", "homing.observation: missing"},
    {"seed: 3", "seed: 3\nnothing: {}", "nothing: unknown key"},
    {"seed: 3", "seed: 3\ngoal: {kind: points}", "goal: is a key of version 2"},
    {"seed: 3", "version: 2\nseed: 3\nhoming: {bonus: 1.0}", "homing: is of version 1"},
    // Type
    {"1.0e-3", "'1.0e-3'", "update.actor_learning_rate = .*a number"},
    {"1.0e-3", "fast", "update.actor_learning_rate = fast: must be a number"},
    {"1.0e-3", "", "update.actor_learning_rate = .*a number"},
    {"1.0e-3", "~", "update.actor_learning_rate = .*a number"},
    {"1.0e-3", "[1.0]", "update.actor_learning_rate = .*a number"},
    {"epochs: 10", "epochs: 10.0", "update.epochs = 10.0: must be a whole number"},
    {"epochs: 10", "epochs: 1e1", "update.epochs = 1e1: must be a whole number"},
    {"epochs: 10", "epochs: 99999999999999999999", "update.epochs = 9+: must be a whole number"},
    {"epochs: 10", "epochs: 4294967297", "update.epochs = 4294967297: must be in"},
    {"mirror: true", "mirror: 1", "symmetry.mirror = 1: must be true or false"},
    {"mirror: true", "mirror: \"true\"", "symmetry.mirror = .*true or false"},
    {"[64, 32]", "64", "hidden = 64: must be a list"},
    {"[64, 32]", "[64, 3.2]", "hidden\\[1\\] = 3.2: must be a whole number"},
    {"canonical: reversal", "canonical: reversed", "symmetry.canonical = reversed.*reversal"},
    {"seed: 3", "seed: 0x10", "seed = 0x10: must be written in decimal"},
    {"epochs: 10", "epochs: 010", "update.epochs = 010: must be written in decimal"},
    {"epochs: 10", "epochs: ten", "update.epochs = ten: must be a whole number"},
    {"epochs: 10", "epochs: 10 # \nepochs: 11", "test: "},
    {"canonical: reversal", "canonical: [reversal]", "symmetry.canonical = .*: must be text"},
    // What YAML 1.1 takes for text
    {"1.0e-3", "1e-3", "update.actor_learning_rate = 1e-3: .*write 1.0e-3, which"},
    {"1.0e-3", "1e-05", "update.actor_learning_rate = 1e-05: .*write 1.0e-05, which"},
    {"b: 6.0", "b: 1.0e1", "environment.b = 1.0e1: .*write 1.0e\\+1, which"},
    {"b: 6.0", "b: 6E0", "environment.b = 6E0: .*write 6.0E\\+0, which"},
    // Range
    {"seed: 3", "seed: -1", "seed = -1: must be in"},
    {"seed: 3", "seed: 9223372036854775808", "seed = 9223372036854775808: .*2\\^63"},
    {"episodes: 400", "episodes: 0", "episodes = 0: must be in"},
    {"episodes: 400", "episodes: 200000000", "episodes = 200000000: must be in"},
    {"evaluate_every: 5", "evaluate_every: 0", "evaluate_every = 0: must be in"},
    {"links: 3", "links: 1", "environment.links = 1: must be in"},
    {"links: 3", "links: 33", "environment.links = 33: must be in"},
    {"gamma: 0.5", "gamma: 0.0", "environment.gamma = 0.*: must be in"},
    {"dt: 0.1", "dt: 1.5", "environment.dt = 1.5: must be in"},
    {"b: 6.0", "b: -6.0", "environment.b = -6.*: must be in"},
    {"c: 1.5", "c: -0.1", "environment.c = -0.1: must be in"},
    {"steps: 200", "steps: 0", "environment.steps = 0: must be"},
    {"[64, 32]", "[]", "hidden = 0 layers: must be"},
    {"[64, 32]", "[64, 0]", "hidden\\[1\\] = 0: must be in"},
    {"[64, 32]", "[64, 257]", "hidden\\[1\\] = 257: must be in"},
    {"[64, 32]", "[8, 8, 8, 8, 8, 8, 8, 8, 8]", "hidden = 9 layers: must be"},
    {"std: 0.6", "std: 0.0", "exploration.std = 0.*: must be in"},
    {"std_final: 0.3", "std_final: 11.0", "exploration.std_final = 11.*: must be in"},
    {"decay_fraction: 0.8", "decay_fraction: 0.0", "exploration.decay_fraction = 0.*: must be in"},
    {"discount: 0.99", "discount: 1.0", "advantage.discount = 1.*: must be in"},
    {"lambda: 0.95", "lambda: 1.01", "advantage.lambda = 1.01: must be in"},
    {"  episodes: 40", "  episodes: 0", "update.episodes = 0: must be in"},
    {"  episodes: 40", "  episodes: 60000", "update.episodes = 60000: must be at most 50000"},
    {"epochs: 10", "epochs: 1001", "update.epochs = 1001: must be in"},
    {"minibatch: 1000", "minibatch: 8001", "update.minibatch = 8001: must be in \\[1, 8000\\]"},
    {"clip: 0.2", "clip: 1.0", "update.clip = 1.*: must be in"},
    {"entropy_weight: 0.0", "entropy_weight: 0.01", "update.entropy_weight = 0.01: .*learned"},
    {"max_gradient_norm: 0.5", "max_gradient_norm: 0",
     "update.max_gradient_norm = 0.*: must be in"},
    {"1.0e-3", "0.0", "update.actor_learning_rate = 0.*: must be in"},
    {"2.0e-3", "1.1", "update.critic_learning_rate = 1.1: must be in"},
    {"final_learning_rate: 0.1", "final_learning_rate: 2.0",
     "update.final_learning_rate = 2.*: must be in"},
    // Not finite
    {"clip: 0.2", "clip: .nan", "update.clip = .nan: must be finite"},
    {"b: 6.0", "b: .inf", "environment.b = .inf: must be finite"},
    {"2.0e-3", "-.inf", "update.critic_learning_rate = -.inf: must be finite"},
    {"discount: 0.99", "discount: .nan", "advantage.discount = .nan: must be finite"},
    {"dt: 0.1", "dt: 1e999", "environment.dt = "},
};

static_assert(std::size(kRefusals) >= 60);

TEST(TrainConfig, RefusesWithFileKeyValueAndBound) {
  for (const Refusal& refusal : kRefusals) {
    const std::string yaml = with(refusal.found, refusal.put);
    try {
      parse_train_config(yaml, "test");
      ADD_FAILURE() << "taken: " << refusal.put;
    } catch (const ConfigError& error) {
      const std::string message = error.what();
      EXPECT_EQ(message.rfind("test: ", 0), 0u) << message;
      EXPECT_TRUE(std::regex_search(message, std::regex(refusal.message)))
          << refusal.put << " gives: " << message;
    }
  }
}

TEST(TrainConfig, PeersAreToldKeysButNoValues) {
  for (const Refusal& refusal : kRefusals) {
    try {
      parse_train_config(with(refusal.found, refusal.put), "test");
    } catch (const ConfigError& error) {
      const std::string& told = error.for_peers();
      EXPECT_EQ(told.rfind("test: ", 0), 0u) << told;
      EXPECT_FALSE(std::regex_search(told, std::regex("^test: \\S+ = "))) << told;
    }
  }
  for (const std::string yaml : {"secret", "secret: 1", "{secret: 1, secret: 2}", "[secret]",
                                 "seed: secret", "hidden: secret", "symmetry: {mirror: secret}",
                                 "symmetry: {canonical: secret}", "*secret", "\"\\secret\""}) {
    try {
      parse_train_config(yaml, "test");
      ADD_FAILURE() << yaml;
    } catch (const ConfigError& error) {
      EXPECT_EQ(error.for_peers().find("secret"), std::string::npos) << error.for_peers();
    }
  }
}

TEST(TrainConfig, HostileTextsEndInTime) {
  std::string bomb = "a0: &a0 [x]\n";
  for (int i = 1; i < 25; ++i)
    bomb += "a" + std::to_string(i) + ": &a" + std::to_string(i) + " [*a" + std::to_string(i - 1) +
            ", *a" + std::to_string(i - 1) + "]\n";
  for (const std::string& yaml :
       {bomb, std::string(60'000, '['), std::string(65'537, 'x'), "a: " + std::string(60'000, '-'),
        std::string(60'000, '\n') + "seed: 1", "seed: \"" + std::string(60'000, 'x') + "\""}) {
    try {
      parse_train_config(yaml, "test");
      ADD_FAILURE() << yaml.substr(0, 20);
    } catch (const ConfigError& error) {
      EXPECT_LT(std::string(error.what()).size(), 300u) << error.what();
    }
  }
}

TEST(TrainConfig, AMissingFileIsNamed) {
  try {
    load_train_config("/nowhere/train.yaml");
    FAIL();
  } catch (const ConfigError& error) {
    EXPECT_STREQ(error.what(), "/nowhere/train.yaml: cannot open: No such file or directory");
  }
  EXPECT_THROW(load_train_config("/dev/zero"), ConfigError);
  EXPECT_THROW(load_train_config("/"), ConfigError);
}

TEST(TrainConfig, AThousandMangledFilesAreTakenOrRefusedAndNothingElse) {
  std::mt19937 random(0);
  const std::string letters =
      "{}[]:,-#&*!|>'\"%@` \n\t\xff"
      "09eE.~x";
  for (int i = 0; i < 1000; ++i) {
    std::string yaml = kValid;
    for (int change = random() % 4; change >= 0; --change) {
      const std::size_t at = random() % yaml.size();
      switch (random() % 3) {
        case 0:
          yaml[at] = letters[random() % letters.size()];
          break;
        case 1:
          yaml.insert(at, 1, letters[random() % letters.size()]);
          break;
        default:
          yaml.erase(at, random() % 20);
      }
    }
    try {
      parse_train_config(yaml, "test").validate();
    } catch (const ConfigError&) {
    }
  }
}

TEST(TrainConfig, TheFirstDifferenceIsNamed) {
  const TrainConfig config = parse_train_config(kValid, "test");
  EXPECT_FALSE(first_difference(config, config));
  TrainConfig other = config;
  other.update.clip = 0.3;
  other.exploration.learned = true;
  const auto difference = first_difference(config, other);
  ASSERT_TRUE(difference);
  EXPECT_EQ(difference->name, "exploration.learned");
  EXPECT_EQ(difference->a, "false");
  EXPECT_EQ(difference->b, "true");
}

TEST(TrainConfig, ShippedOnesAreValid) {
  const TrainConfig config = load_train_config(THREELINK_CONFIG "/train_vfs.yaml");
  EXPECT_EQ(config.environment.c, 0);
  for (const auto& [file, observation] :
       {std::pair{"/train_homing.yaml", threelink_sim::ObservationKind::kTarget},
        std::pair{"/train_homing_direction.yaml", threelink_sim::ObservationKind::kDirection}})
    EXPECT_EQ(load_train_config(THREELINK_CONFIG + std::string(file)).observation, observation);
}

TEST(TrainConfig, ThePapersSettingsAreThePapers) {
  const TrainConfig config = load_train_config(THREELINK_CONFIG "/train_paper.yaml");
  EXPECT_EQ(config.episodes, 100'000u);                                 // N_E
  EXPECT_EQ(config.environment.steps, 200u);                            // N_s
  EXPECT_EQ(config.update.episodes, 40u);                               // M
  EXPECT_EQ(config.update.episodes * config.environment.steps, 8000u);  // N_u
  EXPECT_EQ(config.environment.b, 6);
  EXPECT_EQ(config.environment.c, 0);
  EXPECT_EQ(config.advantage.discount, 0.99);  // Gamma
  EXPECT_EQ(config.advantage.lambda, 1);       // R_k - V_k
  EXPECT_FALSE(config.advantage.bootstrap_at_time_limit);
  EXPECT_EQ(config.update.clip, 0.2);             // epsilon
  EXPECT_EQ(config.update.entropy_weight, 0.01);  // chi
  EXPECT_EQ(config.symmetry.canonical, Symmetry::kNone);
  EXPECT_FALSE(config.symmetry.mirror);
}

}  // namespace
}  // namespace threelink_tests

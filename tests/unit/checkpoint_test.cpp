// Checkpoints as bytes: they come back as they were, and what is damaged or foreign is refused.
#include "threelink_agent/training/checkpoint.hpp"

#include <cstring>
#include <limits>
#include <random>

#include <gtest/gtest.h>

#include "small_training.hpp"
#include "threelink_agent/safetensors.hpp"

namespace threelink_tests {
namespace {

using namespace threelink_agent;

// After two updates and an evaluation.
const Checkpoint& sample() {
  static const Checkpoint checkpoint = [] {
    const TrainConfig config = small();
    Trainer trainer = trainer_of(config);
    for (int update = 0; update < 2; ++update) trainer.update();
    return Checkpoint{config, "fused", trainer.state(), 12345, 0.1 + 0.2};
  }();
  return checkpoint;
}

// "accepted", or why not.
std::string refusal(const std::string& bytes, const TrainConfig& config = small()) {
  try {
    parse_checkpoint(bytes, "FILE", config);
    return "accepted";
  } catch (const CheckpointError& error) {
    return error.what();
  }
}

// Of the sample after a change that leaves the hashes right.
template <class Change>
std::string refusal_after(Change change) {
  std::string hash;
  Container container = parse_container(serialize(sample()), hash);
  change(container);
  return refusal(serialize(container).bytes);
}

TEST(Checkpoint, ComesBackAsItWas) {
  const std::string bytes = serialize(sample());
  const Checkpoint back = parse_checkpoint(bytes, "FILE", small());
  EXPECT_EQ(serialize(back), bytes);
  EXPECT_EQ(back.state.update, 2u);
  EXPECT_EQ(back.state.learner.adam_steps, sample().state.learner.adam_steps);
  EXPECT_GT(back.state.learner.adam_steps, 0u);
  EXPECT_EQ(back.state.best->policy.sha256(), sample().state.best->policy.sha256());
  EXPECT_EQ(back.state.best->score, sample().state.best->score);
  EXPECT_EQ(back.metrics_bytes, 12345u);
  EXPECT_EQ(back.seconds, 0.1 + 0.2);
  EXPECT_EQ(back.backend, "fused");
}

TEST(Checkpoint, HoldsTheTensorsUnderTheirPyTorchNames) {
  std::string hash;
  const Container container = parse_container(serialize(sample()), hash);
  EXPECT_EQ(container.tensors.size(), 3u * (6 + 1 + 6) + 7);
  for (const char* name : {"actor.0.weight", "log_std", "critic.4.bias", "adam.mean.actor.2.bias",
                           "adam.variance.critic.0.weight", "best.actor.4.weight", "best.log_std"})
    EXPECT_EQ(container.tensors.count(name), 1u) << name;
  EXPECT_EQ(container.tensors.at("actor.0.weight").shape, (TensorShape{16, 4}));
  EXPECT_EQ(container.metadata.at("format"), "threelink-checkpoint-1");
}

TEST(Checkpoint, BeforeTheFirstEvaluationThereIsNoBestPolicy) {
  Trainer trainer = trainer_of(small());
  trainer.update();
  const Checkpoint back =
      parse_checkpoint(serialize({small(), "fused", trainer.state(), 0, 0}), "FILE", small());
  EXPECT_FALSE(back.state.best);
}

TEST(Checkpoint, AThousandFlippedBitsAreRefused) {
  const std::string bytes = serialize(sample());
  std::mt19937 random(0);
  std::uniform_int_distribution<std::size_t> bit(0, 8 * bytes.size() - 1);
  int refused = 0;
  for (int i = 0; i < 1000; ++i) {
    const std::size_t flipped = bit(random);
    std::string damaged = bytes;
    damaged[flipped / 8] ^= static_cast<char>(1 << flipped % 8);
    refused += refusal(damaged) != "accepted";
  }
  EXPECT_EQ(refused, 1000);
}

TEST(Checkpoint, TruncationsAreRefused) {
  const std::string bytes = serialize(sample());
  for (std::size_t size = 0; size < bytes.size(); size += 97)
    ASSERT_NE(refusal(bytes.substr(0, size)), "accepted") << size;
  EXPECT_NE(refusal(bytes.substr(0, bytes.size() - 1)), "accepted");
  EXPECT_NE(refusal(bytes + '\0'), "accepted");
}

TEST(Checkpoint, TenOtherArchitecturesAreRefusedWithBothShapes) {
  struct Case {
    std::vector<int> hidden;
    int links;
    const char* message;
  };
  for (const Case& other :
       {Case{{32, 16}, 3, "actor.0.weight has shape (16, 4), expected (32, 4)"},
        Case{{16, 32}, 3, "actor.2.weight has shape (16, 16), expected (32, 16)"},
        Case{{16}, 3, "actor.2.weight has shape (16, 16), expected (2, 16)"},
        Case{{16, 16, 16}, 3, "actor.4.weight has shape (2, 16), expected (16, 16)"},
        Case{{64, 64}, 3, "actor.0.weight has shape (16, 4), expected (64, 4)"},
        Case{{8}, 3, "actor.0.weight has shape (16, 4), expected (8, 4)"},
        Case{{1}, 3, "actor.0.weight has shape (16, 4), expected (1, 4)"},
        Case{{256, 256}, 3, "actor.0.weight has shape (16, 4), expected (256, 4)"},
        Case{{16, 16}, 5, "actor.0.weight has shape (16, 4), expected (16, 6)"},
        Case{{16, 16}, 7, "actor.0.weight has shape (16, 4), expected (16, 8)"}}) {
    TrainConfig config = small();
    config.hidden = other.hidden;
    config.environment.model.links = other.links;
    EXPECT_EQ(refusal(serialize(sample()), config), std::string("FILE: ") + other.message);
  }
}

TEST(Checkpoint, AnotherConfigurationIsRefusedWithItsFirstKey) {
  TrainConfig config = small();
  config.update.clip = 0.25;
  config.update.final_learning_rate = 0.5;
  EXPECT_EQ(refusal(serialize(sample()), config),
            "FILE: update.clip = 0.2, but the training has 0.25");
}

TEST(Checkpoint, UnsoundTensorsAreRefused) {
  const auto put = [](const char* name, float value) {
    return refusal_after([&](Container& container) {
      std::memcpy(&container.tensors.at(name).bytes[4], &value, sizeof(value));
    });
  };
  for (const char* name : {"actor.0.weight", "critic.2.bias", "log_std", "adam.mean.actor.0.weight",
                           "adam.variance.critic.4.weight", "best.actor.2.weight"})
    for (float value :
         {std::numeric_limits<float>::quiet_NaN(), -std::numeric_limits<float>::infinity()})
      EXPECT_NE(put(name, value).find(std::string(name) + " has the value"), std::string::npos);
  EXPECT_NE(put("adam.variance.actor.2.weight", -1).find("below 0"), std::string::npos);
  EXPECT_NE(put("best.actor.2.weight", 2e6F).find("not within"), std::string::npos);
  EXPECT_EQ(refusal_after([](Container& c) { c.tensors.erase("adam.mean.log_std"); }),
            "FILE: adam.mean.log_std is missing");
  EXPECT_EQ(refusal_after([](Container& c) { c.tensors["more"] = c.tensors["log_std"]; }),
            "FILE: more of shape (2) is not known");
}

TEST(Checkpoint, CountersAndTextsAreChecked) {
  struct Case {
    const char* key;
    const char* value;  // null: missing
    const char* part;
  };
  for (const Case& wrong :
       {Case{"format", "threelink-policy-1", "threelink-checkpoint-1"},
        Case{"update", "4", "[0, 3]"}, Case{"update", "-1", "[0, 3]"},
        Case{"update", "1.5", "whole"}, Case{"update", "two", "number"},
        Case{"update", nullptr, "missing"}, Case{"adam_steps", "19", "[0, 18]"},
        Case{"poisoned", "3", "[0, 2]"}, Case{"poisoned_in_a_row", "1", "[0, 0]"},
        Case{"metrics_bytes", "1e3", "whole"}, Case{"seconds", "-1", "[0,"},
        Case{"seconds", "null", "number"}, Case{"best_score", "nan", "number"},
        Case{"best_score", nullptr, "not known"}, Case{"backend", nullptr, "missing"},
        Case{"config", "seed: 0", "episodes: missing"}, Case{"note", "x", "not known"}}) {
    const std::string text = refusal_after([&](Container& container) {
      if (wrong.value)
        container.metadata[wrong.key] = wrong.value;
      else
        container.metadata.erase(wrong.key);
    });
    EXPECT_NE(text.find(wrong.part), std::string::npos) << wrong.key << ": " << text;
  }
}

}  // namespace
}  // namespace threelink_tests

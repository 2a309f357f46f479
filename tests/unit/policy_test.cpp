// Policies: what they answer, and which files are refused.
#include "threelink_agent/policy.hpp"

#include <cmath>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <limits>
#include <new>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "random_policy.hpp"
#include "threelink_agent/safetensors.hpp"
#include "threelink_agent/symmetry.hpp"
#include "threelink_sim/files.hpp"

namespace {
std::size_t allocations = 0;
}
// Not to be inlined: the compiler would see free() of what it takes for new memory, and warn.
[[gnu::noinline]] void* operator new(std::size_t size) {
  ++allocations;
  if (void* memory = std::malloc(size)) return memory;
  throw std::bad_alloc();
}
// The C++ library's own form of this calls the one above; that of AddressSanitizer does not.
[[gnu::noinline]] void* operator new(std::size_t size, const std::nothrow_t&) noexcept {
  ++allocations;
  return std::malloc(size);
}
[[gnu::noinline]] void operator delete(void* memory) noexcept { std::free(memory); }
[[gnu::noinline]] void operator delete(void* memory, std::size_t) noexcept { std::free(memory); }

namespace threelink_tests {
namespace {

using namespace threelink_agent;
using threelink_sim::ObservationKind;

// --- What a policy answers -----------------------------------------------------------------------

TEST(Policy, AnswersWithTheClippedMeanOfItsNetwork) {
  const Policy policy = random_policy(1, Symmetry::kNone);
  constexpr std::size_t kCount = 200;
  const std::vector<double> observations = random_observations(kCount, 2, 1);
  int clipped = 0;
  for (std::size_t i = 0; i < kCount; ++i) {
    double observation[4], rates[2];
    float x[4], y[2];
    for (int k = 0; k < 4; ++k) {
      observation[k] = observations[k * kCount + i];
      x[k] = static_cast<float>(observation[k]);
    }
    policy.act(observation, rates);
    policy.actor().forward(x, y);
    for (int j = 0; j < 2; ++j) {
      EXPECT_EQ(rates[j], std::fmax(-1, std::fmin(1, static_cast<double>(y[j]))));
      clipped += std::abs(y[j]) > 1;
    }
  }
  EXPECT_GT(clipped, 10);
}

TEST(Policy, ReversalSwapsTheEndsWhereCosIsNegative) {
  for (int links : {2, 3, 4, 5, 8}) {
    const int hinges = links - 1;
    const Policy plain = random_policy(2, Symmetry::kNone, links);
    const Policy symmetric = random_policy(2, Symmetry::kReversal, links);
    for (double cosine : {0.3, 0.0, -0.0, -1e-300, -0.3}) {
      std::vector<double> observation = random_observations(1, hinges, 3);
      observation[0] = cosine;
      std::vector<double> expected(hinges), rates(hinges);
      symmetric.act(observation.data(), rates.data());
      if (cosine < 0) {
        std::vector<double> turned = {-observation[0], -observation[1]};
        for (int j = hinges; j >= 1; --j) turned.push_back(-observation[1 + j]);
        std::vector<double> seen(hinges);
        plain.act(turned.data(), seen.data());
        for (int j = 1; j <= hinges; ++j) expected[j - 1] = -seen[links - j - 1];
      } else {
        plain.act(observation.data(), expected.data());
      }
      EXPECT_EQ(rates, expected) << cosine;
    }
  }
}

TEST(Policy, ABatchHasTheBitsOfSingleAnswers) {
  for (const auto kind : {ObservationKind::kDirection, ObservationKind::kTarget})
    for (Symmetry symmetry : {Symmetry::kNone, Symmetry::kReversal}) {
      const Policy policy = random_policy(3, symmetry, 3, kind);
      std::vector<float> scratch;
      for (std::size_t n : {1, 7, 40, 103}) {
        const std::vector<double> observations = random_observations(n, 2, n, kind);
        std::vector<double> rates(2 * n), observation(policy.observation_size());
        policy.act(n, observations.data(), rates.data(), scratch);
        for (std::size_t i = 0; i < n; ++i) {
          double single[2];
          for (std::size_t k = 0; k < observation.size(); ++k)
            observation[k] = observations[k * n + i];
          policy.act(observation.data(), single);
          for (int j = 0; j < 2; ++j)
            ASSERT_EQ(std::memcmp(&single[j], &rates[j * n + i], sizeof(double)), 0);
        }
      }
    }
}

TEST(Policy, SamplesNoiseOfItsStdThatTheKeyAloneDecides) {
  const Policy wide = random_policy(3);
  const Policy policy(wide.metadata(), wide.actor(), Eigen::Vector2f(-4, -5));
  const std::vector<double> observation = {0.6, 0.8, 0.9, -0.9};
  double mean[2];
  policy.act(observation.data(), mean);
  for (double rate : mean) ASSERT_LT(std::abs(rate), 0.9);  // so that nothing is clipped
  constexpr int n = 4000;
  double sum[2] = {}, squares[2] = {}, product = 0;
  for (std::uint32_t step = 0; step < n; ++step) {
    double rates[2], again[2], z[2];
    policy.sample(observation.data(), {5, 1 + step % 3, step}, rates);
    policy.sample(observation.data(), {5, 1 + step % 3, step}, again);
    ASSERT_EQ(std::memcmp(rates, again, sizeof(rates)), 0);
    for (int j = 0; j < 2; ++j) {
      z[j] = (rates[j] - mean[j]) / std::exp(j == 0 ? -4 : -5);
      sum[j] += z[j];
      squares[j] += z[j] * z[j];
    }
    product += z[0] * z[1];
  }
  // Five standard deviations of the mean of n independent ones.
  for (int j = 0; j < 2; ++j) {
    EXPECT_NEAR(sum[j] / n, 0, 5 / std::sqrt(n));
    EXPECT_NEAR(squares[j] / n, 1, 5 * std::sqrt(2.0 / n));
  }
  EXPECT_NEAR(product / n, 0, 5 / std::sqrt(n));
  for (const ActionKey other : {ActionKey{6, 1, 0}, ActionKey{5, 2, 0}, ActionKey{5, 1, 1}}) {
    double one[2], two[2];
    policy.sample(observation.data(), {5, 1, 0}, one);
    policy.sample(observation.data(), other, two);
    EXPECT_NE(one[0], two[0]);
  }
}

TEST(Policy, ABatchOfSamplesHasTheBitsOfSingleOnes) {
  for (Symmetry symmetry : {Symmetry::kNone, Symmetry::kReversal}) {
    const Policy policy = random_policy(3, symmetry);
    std::vector<float> scratch;
    constexpr std::size_t n = 41;
    const std::vector<double> observations = random_observations(n, 2, n);
    std::vector<ActionKey> keys;
    for (std::uint32_t i = 0; i < n; ++i) keys.push_back({9, i / 3, i});
    std::vector<double> rates(2 * n);
    policy.sample(n, observations.data(), keys.data(), rates.data(), scratch);
    for (std::size_t i = 0; i < n; ++i) {
      double observation[4], single[2];
      for (int k = 0; k < 4; ++k) observation[k] = observations[k * n + i];
      policy.sample(observation, keys[i], single);
      for (int j = 0; j < 2; ++j)
        ASSERT_EQ(std::memcmp(&single[j], &rates[j * n + i], sizeof(double)), 0);
    }
  }
}

TEST(Policy, AnswersWithoutAllocating) {
  const Policy policy = random_policy(4);
  const std::vector<double> observation = random_observations(1, 2, 4);
  double rates[2];
  const std::size_t before = allocations;
  for (std::uint32_t i = 0; i < 100; ++i) {
    policy.act(observation.data(), rates);
    policy.sample(observation.data(), {1, 2, i}, rates);
  }
  EXPECT_EQ(allocations, before);
}

TEST(Policy, StaysFiniteAtTheBounds) {
  std::vector<Linear> layers = random_layers({4, 256, 256, 2}, 5);
  for (Linear& layer : layers) {
    layer.weight.setConstant(kMaxParameter);
    layer.weight.leftCols(2).setConstant(-kMaxParameter);
  }
  const Policy policy({}, Mlp(layers), Eigen::VectorXf::Zero(2));
  const double observation[4] = {-kMaxObservation, kMaxObservation, kMaxObservation,
                                 -kMaxObservation};
  double rates[2];
  policy.act(observation, rates);
  EXPECT_LE(std::abs(rates[0]), 1);
  EXPECT_LE(std::abs(rates[1]), 1);
}

// --- Files ---------------------------------------------------------------------------------------

TEST(PolicyFile, ComesBackAsItWas) {
  PolicyMetadata metadata;
  metadata.links = 5;
  metadata.dt = 0.1 + 0.2;
  metadata.gamma = 1.0 / 3;
  metadata.symmetry = Symmetry::kReversal;
  metadata.observation = ObservationKind::kTarget;
  metadata.sampled = true;
  metadata.config = "a: 1\nb: \"\xc3\xa9\"\n";
  const Policy policy(metadata, Mlp(random_layers({9, 32, 4}, 6)), Eigen::VectorXf::Random(4));
  const std::string path = testing::TempDir() + "/policy_test.safetensors";
  policy.save(path);
  const Policy back = Policy::load(path);
  std::filesystem::remove(path);

  EXPECT_EQ(back.serialize(), policy.serialize());
  EXPECT_EQ(back.sha256(), policy.sha256());
  EXPECT_EQ(back.sha256().size(), 64u);
  EXPECT_EQ(back.id(), policy.sha256().substr(0, 16));
  EXPECT_EQ(back.metadata().links, 5);
  EXPECT_EQ(back.metadata().dt, metadata.dt);
  EXPECT_EQ(back.metadata().gamma, metadata.gamma);
  EXPECT_EQ(back.metadata().symmetry, Symmetry::kReversal);
  EXPECT_EQ(back.metadata().observation, ObservationKind::kTarget);
  EXPECT_TRUE(back.metadata().sampled);
  EXPECT_EQ(back.metadata().config, metadata.config);
  EXPECT_EQ(back.log_std(), policy.log_std());
  ASSERT_EQ(back.actor().layers().size(), 2u);
  EXPECT_EQ(back.actor().layers()[1].weight, policy.actor().layers()[1].weight);
  EXPECT_EQ(back.actor().layers()[1].bias, policy.actor().layers()[1].bias);
}

std::string refusal(const std::string& bytes) {
  try {
    Policy::parse(bytes, "FILE");
  } catch (const PolicyError& error) {
    return error.what();
  }
  return "accepted";
}

TEST(PolicyFile, AThousandFlippedBitsAreRefused) {
  const std::string bytes = random_policy(7).serialize();
  threelink_sim::Random random(7, threelink_sim::Stream::kExploration, 0);
  for (int i = 0; i < 1000; ++i) {
    const std::uint32_t bit = random.below(static_cast<std::uint32_t>(8 * bytes.size()));
    std::string flipped = bytes;
    flipped[bit / 8] ^= static_cast<char>(1 << bit % 8);
    ASSERT_EQ(refusal(flipped).substr(0, 6), "FILE: ") << "bit " << bit;
  }
}

TEST(PolicyFile, EveryTruncationIsRefused) {
  const std::string bytes = random_policy(8).serialize();
  for (std::size_t size = 0; size < bytes.size(); ++size)
    ASSERT_EQ(refusal(bytes.substr(0, size)).substr(0, 6), "FILE: ") << size << " bytes";
}

TEST(PolicyFile, PeersAreToldNothingOfWhatIsInAFile) {
  std::string hash;
  Container odd = parse_container(random_policy(8).serialize(), hash), other = odd;
  odd.metadata["secret"] = "secret";
  other.metadata["format"] = "secret";
  for (const std::string& bytes :
       {std::string("secret: the first line\n"), serialize(odd).bytes, serialize(other).bytes}) {
    try {
      Policy::parse(bytes, "FILE");
      FAIL();
    } catch (const PolicyError& error) {
      EXPECT_EQ(error.for_peers().substr(0, 6), "FILE: ");
      EXPECT_EQ(error.for_peers().find("secret"), std::string::npos) << error.for_peers();
    }
  }
}

// The refusal of a policy of which something was changed; sound as a container.
template <class Change>
std::string refusal_after(Change change) {
  std::string hash;
  Container container = parse_container(random_policy(9).serialize(), hash);
  change(container);
  return refusal(serialize(container).bytes);
}

Tensor zeros(const TensorShape& shape) {
  std::size_t count = 1;
  for (std::size_t size : shape) count *= size;
  return Tensor::of(shape, std::vector<float>(count).data());
}

TEST(PolicyFile, WrongShapesAreRefusedAndNamed) {
  struct Case {
    const char* tensor;
    TensorShape shape;
    const char* expected;
  };
  for (const Case& wrong :
       {Case{"actor.0.weight", {64, 5}, "(64, 4)"}, Case{"actor.0.weight", {4, 64}, "(4, 4)"},
        Case{"actor.0.weight", {256}, "(256, 4)"}, Case{"actor.0.weight", {64, 4, 1}, "(64, 4)"},
        Case{"actor.0.weight", {300, 4}, "1 to 256"}, Case{"actor.0.weight", {0, 4}, "1 to 256"},
        Case{"actor.0.bias", {63}, "(64)"}, Case{"actor.2.weight", {64, 32}, "(64, 64)"},
        Case{"actor.4.weight", {3, 64}, "(2, 64)"}, Case{"actor.4.bias", {2, 1}, "(2)"},
        Case{"log_std", {3}, "(2)"}, Case{"log_std", {}, "(2)"}}) {
    const std::string text = refusal_after(
        [&](Container& container) { container.tensors[wrong.tensor] = zeros(wrong.shape); });
    EXPECT_NE(text.find("FILE: " + std::string(wrong.tensor)), std::string::npos) << text;
    EXPECT_NE(text.find("has shape " + to_string(wrong.shape)), std::string::npos) << text;
    EXPECT_NE(text.find(wrong.expected), std::string::npos) << text;
  }
}

TEST(PolicyFile, MissingUnknownAndUnsoundTensorsAreRefused) {
  for (const char* name : {"actor.0.weight", "actor.0.bias", "actor.4.bias", "log_std"})
    EXPECT_EQ(refusal_after([&](Container& c) { c.tensors.erase(name); }),
              "FILE: " + std::string(name) + " is missing");
  EXPECT_EQ(refusal_after([](Container& c) {
              c.tensors["critic.0.weight"] = zeros({64, 4});
            }),
            "FILE: critic.0.weight of shape (64, 4) is not known");
  const double doubles[2] = {0, 0};
  EXPECT_EQ(refusal_after([&](Container& c) { c.tensors["log_std"] = Tensor::of({2}, doubles); }),
            "FILE: log_std: dtype F64, expected F32");
  for (float value :
       {std::numeric_limits<float>::quiet_NaN(), -std::numeric_limits<float>::infinity(), 2e6F}) {
    for (const char* name : {"actor.0.weight", "actor.2.bias", "log_std"}) {
      const std::string text = refusal_after([&](Container& container) {
        std::memcpy(&container.tensors[name].bytes[4], &value, sizeof(value));
      });
      EXPECT_NE(text.find(std::string(name) + " has the value"), std::string::npos) << text;
    }
  }
}

TEST(PolicyFile, WrongMetadataIsRefusedAndNamed) {
  struct Case {
    const char* key;
    const char* value;  // null: missing
    const char* part;
  };
  for (const Case& wrong :
       {Case{"format", "threelink-policy-2", "threelink-policy-1"},
        Case{"format", nullptr, "missing"}, Case{"observation", "camera", "direction"},
        Case{"observation", nullptr, "missing"}, Case{"action", "torques", "hinge_rates"},
        Case{"links", "3.5", "whole"}, Case{"links", "1e30", "whole"},
        Case{"links", "three", "number"}, Case{"links", "1", "[2, 32]"},
        Case{"dt", "0", "[0.001, 1]"}, Case{"dt", "nan", "number"}, Case{"dt", "0.1s", "number"},
        Case{"dt", nullptr, "missing"}, Case{"gamma", "-0.5", "[0.001, 10]"},
        Case{"symmetry", "rotation", "reversal"}, Case{"actions", "guessed", "sampled"},
        Case{"config", nullptr, "missing"}, Case{"symetry", "none", "not known"}}) {
    const std::string text = refusal_after([&](Container& container) {
      if (wrong.value)
        container.metadata[wrong.key] = wrong.value;
      else
        container.metadata.erase(wrong.key);
    });
    EXPECT_NE(text.find(wrong.key), std::string::npos) << text;
    EXPECT_NE(text.find(wrong.part), std::string::npos) << text;
  }
  EXPECT_EQ(refusal_after([](Container& c) { c.metadata["links"] = "4"; }),
            "FILE: actor.0.weight has shape (64, 4), expected (64, 5)");
  EXPECT_EQ(refusal_after([](Container& c) { c.metadata["links"] = "5"; }),
            "FILE: actor.0.weight has shape (64, 4), expected (64, 6)");
  EXPECT_EQ(refusal_after([](Container& c) { c.metadata.erase("symmetry"); }), "accepted");
}

TEST(PolicyFile, APolicyThatDoesNotFitItsSwimmerCannotBeMade) {
  PolicyMetadata metadata;
  metadata.links = 5;
  EXPECT_THROW(Policy(metadata, Mlp(random_layers({4, 64, 2}, 1)), Eigen::VectorXf::Zero(2)),
               PolicyError);
  metadata.links = 3;
  EXPECT_THROW(Policy(metadata, Mlp(random_layers({4, 64, 2}, 1)), Eigen::VectorXf::Zero(3)),
               PolicyError);
  metadata.config = "\xff";  // no UTF-8
  EXPECT_THROW(Policy(metadata, Mlp(random_layers({4, 64, 2}, 1)), Eigen::VectorXf::Zero(2)),
               PolicyError);
}

TEST(PolicyFile, AFileThatIsNotThereIsNamed) {
  try {
    Policy::load("/nowhere/policy.safetensors");
    FAIL();
  } catch (const PolicyError& error) {
    EXPECT_NE(std::string(error.what()).find("/nowhere/policy.safetensors: cannot open"),
              std::string::npos)
        << error.what();
  }
}

}  // namespace
}  // namespace threelink_tests

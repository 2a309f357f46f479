// The generator against its published vectors, and the distributions built on it.
#include "threelink_sim/random.hpp"

#include <cmath>
#include <cstring>
#include <vector>

#include <gtest/gtest.h>

#include "threelink_sim/isa.hpp"
#include "threelink_sim/kernel/kernels.hpp"

namespace threelink_tests {
namespace {

using namespace threelink_sim;

struct KnownAnswer {
  std::uint32_t counter[4], key[2], words[4];
};

// Philox4x32-10 known answers of the Random123 distribution (kat_vectors).
const KnownAnswer kKnownAnswers[] = {
    {{0, 0, 0, 0}, {0, 0}, {0x6627e8d5, 0xe169c58d, 0xbc57ac4c, 0x9b00dbd8}},
    {{0xffffffff, 0xffffffff, 0xffffffff, 0xffffffff},
     {0xffffffff, 0xffffffff},
     {0x408f276d, 0x41c83b0e, 0xa20bc7c6, 0x6d5451fd}},
    {{0x243f6a88, 0x85a308d3, 0x13198a2e, 0x03707344},
     {0xa4093822, 0x299f31d0},
     {0xd16cfe09, 0x94fdcceb, 0x5001e420, 0x24126ea1}},
};

TEST(Random, PhiloxGivesThePublishedVectors) {
  for (Isa isa : available_isas())
    for (const KnownAnswer& known : kKnownAnswers) {
      std::uint32_t words[4];
      kernels(isa).philox(1, known.key, known.counter, words);
      for (int w = 0; w < 4; ++w) EXPECT_EQ(words[w], known.words[w]) << to_string(isa);
    }
}

TEST(Random, EveryPartOfTheKeyMatters) {
  const double first = Random(0, Stream::kStart, 0, 0).uniform();
  EXPECT_EQ(Random(0, Stream::kStart, 0, 0).uniform(), first);
  EXPECT_NE(Random(1, Stream::kStart, 0, 0).uniform(), first);
  EXPECT_NE(Random(std::uint64_t{1} << 32, Stream::kStart, 0, 0).uniform(), first);
  EXPECT_NE(Random(0, Stream::kTarget, 0, 0).uniform(), first);
  EXPECT_NE(Random(0, Stream::kStart, 1, 0).uniform(), first);
  EXPECT_NE(Random(0, Stream::kStart, 0, 1).uniform(), first);
}

// n draws: mean and variance of samples within five standard errors.
TEST(Random, UniformsAndNormalsHaveTheirMoments) {
  constexpr int kDraws = 200000;
  Random random(3, Stream::kTarget, 7);
  double sum = 0, squares = 0, normal_sum = 0, normal_squares = 0, fourth = 0;
  for (int i = 0; i < kDraws; ++i) {
    const double u = random.uniform();
    ASSERT_GT(u, 0);
    ASSERT_LT(u, 1);
    sum += u;
    squares += u * u;
    const double z = random.normal();
    normal_sum += z;
    normal_squares += z * z;
    fourth += z * z * z * z;
  }
  const double error = 5 / std::sqrt(kDraws);
  EXPECT_NEAR(sum / kDraws, 0.5, error * std::sqrt(1.0 / 12));
  EXPECT_NEAR(squares / kDraws, 1.0 / 3, error * std::sqrt(1.0 / 5 - 1.0 / 9));
  EXPECT_NEAR(normal_sum / kDraws, 0, error);
  EXPECT_NEAR(normal_squares / kDraws, 1, error * std::sqrt(2.0));
  EXPECT_NEAR(fourth / kDraws, 3, error * std::sqrt(96.0));
}

TEST(Random, PairsOfNormalsAreUncorrelated) {
  constexpr int kPairs = 100000;
  std::vector<std::uint32_t> counters(4 * kPairs);
  for (int i = 0; i < kPairs; ++i) counters[4 * i] = i;
  const std::uint32_t key[2] = {9, 0};
  std::vector<double> normals(2 * kPairs);
  kernels().normals(kPairs, key, counters.data(), normals.data());
  double product = 0;
  for (int i = 0; i < kPairs; ++i) product += normals[2 * i] * normals[2 * i + 1];
  EXPECT_NEAR(product / kPairs, 0, 5 / std::sqrt(kPairs));
}

TEST(Random, NormalsAgreeToTheBitOnEveryInstructionSet) {
  constexpr int kPairs = 1003;  // no multiple of a pack
  std::vector<std::uint32_t> counters(4 * kPairs);
  for (int i = 0; i < 4 * kPairs; ++i) counters[i] = 2654435761u * i;
  const std::uint32_t key[2] = {1, 2};
  std::vector<double> expected(2 * kPairs), other(2 * kPairs);
  kernels().normals(kPairs, key, counters.data(), expected.data());
  for (Isa isa : available_isas()) {
    if (kernels(isa).fused != kernels().fused) continue;
    kernels(isa).normals(kPairs, key, counters.data(), other.data());
    EXPECT_EQ(std::memcmp(expected.data(), other.data(), sizeof(double) * expected.size()), 0);
    for (int i = 0; i < kPairs; ++i) {
      double pair[2];
      kernels(isa).normals(1, key, &counters[4 * i], pair);
      ASSERT_EQ(pair[0], expected[2 * i]);
      ASSERT_EQ(pair[1], expected[2 * i + 1]);
    }
  }
}

TEST(Random, BelowIsUniformOverItsRange) {
  Random random(5, Stream::kMinibatch, 0);
  constexpr int kBound = 7, kDraws = 70000;
  int counts[kBound] = {};
  for (int i = 0; i < kDraws; ++i) {
    const std::uint32_t value = random.below(kBound);
    ASSERT_LT(value, static_cast<std::uint32_t>(kBound));
    ++counts[value];
  }
  // Binomial with mean 10000 and standard deviation 93: five of them.
  for (int count : counts) EXPECT_NEAR(count, kDraws / kBound, 465);
}

TEST(Kernels, SineAndCosineAreAccurate) {
  for (Isa isa : available_isas()) {
    double worst = 0;
    for (int i = -100000; i <= 100000; ++i) {
      const double angle = i * 1e-3 * (1 + 1e-8 * i * i);
      double sine, cosine;
      kernels(isa).sincos(1, &angle, &sine, &cosine);
      worst =
          std::max({worst, std::abs(sine - std::sin(angle)), std::abs(cosine - std::cos(angle))});
    }
    EXPECT_LT(worst, 2.3e-16) << to_string(isa);
  }
}

}  // namespace
}  // namespace threelink_tests

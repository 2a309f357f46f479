// The kernels of the fused update against values worked out by hand and in double precision.
#include <cmath>
#include <vector>

#include <gtest/gtest.h>

#include "threelink_agent/kernel/gradient.hpp"
#include "threelink_agent/mlp.hpp"
#include "threelink_agent/training/gaussian.hpp"
#include "threelink_sim/isa.hpp"
#include "threelink_sim/random.hpp"

namespace threelink_tests {
namespace {

using namespace threelink_agent;
using threelink_sim::Isa;

class GradientKernelsTest : public testing::TestWithParam<Isa> {
 protected:
  const GradientKernels& kernels_ = gradient_kernels(GetParam());
};
INSTANTIATE_TEST_SUITE_P(EveryIsa, GradientKernelsTest,
                         testing::ValuesIn(threelink_sim::available_isas()),
                         [](const auto& info) { return threelink_sim::to_string(info.param); });

// The loss of two hinges with std 0.5 and 2, epsilon 0.2, for samples of given z, log p_old and
// advantage.
struct Loss {
  explicit Loss(const GradientKernels& kernels) : kernels(kernels) {}

  void set(int i, float z_1, float z_2, float log_prob, float advantage) {
    mean[i] = 0.25f;
    mean[kLossBlock + i] = -1;
    actions[i] = mean[i] + 0.5f * z_1;
    actions[kLossBlock + i] = mean[kLossBlock + i] + 2 * z_2;
    log_probs[i] = log_prob;
    advantages[i] = advantage;
  }
  // With z = 0 and a given ratio.
  void set_ratio(int i, float ratio, float advantage) {
    set(i, 0, 0, log_density(0, log_std[0]) + log_density(0, log_std[1]) - std::log(ratio),
        advantage);
  }
  void run() {
    kernels.policy_loss({2, 0.2f, log_std, inverse_std, mean, actions, log_probs, advantages, z,
                         log_ratio, loss, slope});
  }

  const GradientKernels& kernels;
  const float log_std[2] = {std::log(0.5f), std::log(2.0f)}, inverse_std[2] = {2, 0.5f};
  alignas(64) float mean[2 * kLossBlock] = {}, actions[2 * kLossBlock] = {}, z[2 * kLossBlock] = {},
                             log_probs[kLossBlock] = {},
                             advantages[kLossBlock] = {}, log_ratio[kLossBlock] = {},
                             loss[kLossBlock] = {}, slope[kLossBlock] = {};
};

TEST_P(GradientKernelsTest, LogRatioIsTheSumOverHinges) {
  Loss p(kernels_);
  p.set(3, 1, -2, -1.5f, 1);
  p.run();
  EXPECT_FLOAT_EQ(p.z[3], 1);
  EXPECT_FLOAT_EQ(p.z[kLossBlock + 3], -2);
  // -z_1^2/2 - log 0.5 - z_2^2/2 - log 2 - log(2 pi) + 1.5
  EXPECT_NEAR(p.log_ratio[3], -0.5 - 2 - std::log(2 * std::acos(-1.0)) + 1.5, 1e-6);
}

TEST_P(GradientKernelsTest, RatioIsClippedAtBothEdgesWhereTheAdvantagePushesOutwards) {
  struct Case {
    float ratio, advantage, loss, slope;
  };
  // slope = d loss / d log r: -r A, or 0 where the bounded term is the smaller one
  const std::vector<Case> cases{
      {1.0f, 2, -2, -2},         {1.19f, 2, -2.38f, -2.38f},
      {0.81f, -2, 1.62f, 1.62f}, {1.3f, 2, -2.4f, 0},
      {1.3f, -2, 2.6f, 2.6f},    {0.7f, -2, 1.6f, 0},
      {0.7f, 2, -1.4f, -1.4f},   {1.3f, 0, 0, 0},
  };
  Loss p(kernels_);
  for (std::size_t i = 0; i < cases.size(); ++i)
    p.set_ratio(static_cast<int>(i), cases[i].ratio, cases[i].advantage);
  p.run();
  for (std::size_t i = 0; i < cases.size(); ++i) {
    EXPECT_NEAR(p.loss[i], cases[i].loss, 1e-6) << cases[i].ratio << ' ' << cases[i].advantage;
    EXPECT_NEAR(p.slope[i], cases[i].slope, 1e-6) << cases[i].ratio << ' ' << cases[i].advantage;
  }
}

TEST_P(GradientKernelsTest, RatioIsWithinSomeUlpOfTheExponential) {
  Loss p(kernels_);
  for (double from = -60; from < 60; from += 60.0 / 997) {
    for (int i = 0; i < kLossBlock; ++i)
      p.set_ratio(i, std::exp(static_cast<float>(from + 0.001 * i)), -1);  // loss = max(r, 1 - eps)
    p.run();
    for (int i = 0; i < kLossBlock; ++i) {
      const double ratio = std::exp(static_cast<double>(p.log_ratio[i]));
      EXPECT_NEAR(p.loss[i] / std::max(ratio, 0.8), 1, 4e-7) << p.log_ratio[i];
    }
  }
}

TEST_P(GradientKernelsTest, NotANumberStaysOne) {
  Loss p(kernels_);
  p.set(0, NAN, 0, 0, 1);
  p.set(1, 0, 0, 0, NAN);
  p.run();
  for (int i : {0, 1}) EXPECT_TRUE(std::isnan(p.loss[i]) && std::isnan(p.slope[i]));
}

// A network of one layer with random weights.
struct Layer {
  Layer(int inputs, int outputs, std::uint32_t key)
      : random(key, threelink_sim::Stream::kInitialisation, 0) {
    linear.weight.resize(outputs, inputs);
    linear.bias.resize(outputs);
    for (int i = 0; i < linear.weight.size(); ++i)
      linear.weight.data()[i] = static_cast<float>(random.uniform(-1, 1));
    for (int j = 0; j < outputs; ++j) linear.bias[j] = static_cast<float>(random.uniform(-1, 1));
    layout = packed_layout({linear});
    packed = AlignedFloats(packed_size(layout));
    pack({linear}, layout, packed.data());
  }
  // (samples, stride) of random numbers in the first `columns` columns.
  AlignedFloats rows(int samples, int columns, int stride) {
    AlignedFloats values(std::size_t(samples) * stride);
    for (int i = 0; i < samples; ++i)
      for (int k = 0; k < columns; ++k)
        values.data()[i * stride + k] = static_cast<float>(random.uniform(-1, 1));
    return values;
  }
  threelink_sim::Random random;
  Linear linear;
  std::vector<PackedLayer> layout;
  AlignedFloats packed;
};

int rounded(int columns) { return (columns + kPackedFloats - 1) / kPackedFloats * kPackedFloats; }

const std::vector<std::vector<int>> kShapes{{4, 64}, {64, 64}, {64, 2}, {64, 1},   {7, 5},
                                            {1, 1},  {33, 70}, {17, 4}, {256, 256}};
constexpr int kSamples = 61;  // no whole number of tiles

TEST_P(GradientKernelsTest, ForwardIsThatOfTheNetworkToTheBit) {
  for (const auto& shape : kShapes) {
    Layer layer(shape[0], shape[1], 1);
    const int x_stride = rounded(shape[0]), y_stride = rounded(shape[1]);
    const AlignedFloats x = layer.rows(kSamples, shape[0], x_stride);
    AlignedFloats y(std::size_t(kSamples) * y_stride);
    kernels_.forward(layer.layout[0], layer.packed.data(), kSamples, x.data(), x_stride, false,
                     y.data());
    const Mlp mlp({layer.linear}, GetParam());
    std::vector<float> expected(shape[1]);
    for (int i = 0; i < kSamples; ++i) {
      mlp.forward(x.data() + i * x_stride, expected.data());
      for (int j = 0; j < shape[1]; ++j) EXPECT_EQ(y.data()[i * y_stride + j], expected[j]);
    }
  }
}

TEST_P(GradientKernelsTest, BackwardAndAccumulateAreTheSumsInDouble) {
  for (const auto& shape : kShapes) {
    const int inputs = shape[0], outputs = shape[1];
    Layer layer(inputs, outputs, 2);
    const int x_stride = rounded(inputs), y_stride = rounded(outputs);
    const AlignedFloats x = layer.rows(kSamples, inputs, x_stride);
    const AlignedFloats dy = layer.rows(kSamples, outputs, y_stride);
    AlignedFloats weights(std::size_t(outputs) * x_stride);
    for (int j = 0; j < outputs; ++j)
      for (int k = 0; k < inputs; ++k) weights.data()[j * x_stride + k] = layer.linear.weight(j, k);
    AlignedFloats dx(std::size_t(kSamples) * x_stride), gradient(layer.packed.size());
    kernels_.backward(layer.layout[0], weights.data(), kSamples, dy.data(), x.data(), x_stride,
                      dx.data());
    for (int i = 0; i < kSamples; ++i)
      for (int k = 0; k < inputs; ++k) {
        double sum = 0;
        for (int j = 0; j < outputs; ++j)
          sum += double(dy.data()[i * y_stride + j]) * layer.linear.weight(j, k);
        const double h = x.data()[i * x_stride + k];
        // A chain of n fused multiply-adds of numbers below 1: n^2 / 2 roundings of 2^-24 at most,
        // and sqrt(n) n of them at most in practice.
        EXPECT_NEAR(dx.data()[i * x_stride + k], sum * (1 - h * h), 1e-7 * outputs);
      }

    // In two parts: it adds to what is there.
    kernels_.accumulate(layer.layout[0], 40, dy.data(), x.data(), x_stride, gradient.data());
    kernels_.accumulate(layer.layout[0], kSamples - 40, dy.data() + 40 * y_stride,
                        x.data() + 40 * x_stride, x_stride, gradient.data());
    const std::vector<Linear> actual = unpack(layer.layout, gradient.data());
    for (int j = 0; j < outputs; ++j) {
      double bias = 0;
      for (int i = 0; i < kSamples; ++i) bias += dy.data()[i * y_stride + j];
      EXPECT_NEAR(actual[0].bias[j], bias, 1e-7 * kSamples);
      for (int k = 0; k < inputs; ++k) {
        double sum = 0;
        for (int i = 0; i < kSamples; ++i)
          sum += double(dy.data()[i * y_stride + j]) * x.data()[i * x_stride + k];
        EXPECT_NEAR(actual[0].weight(j, k), sum, 1e-7 * kSamples);
      }
    }
  }
}

TEST_P(GradientKernelsTest, AdamTakesTheStepOfThePaper) {
  constexpr int n = 32;
  alignas(64) float p[n], m[n], v[n], g[n];
  double p_2[n], m_2[n], v_2[n];
  threelink_sim::Random random(3, threelink_sim::Stream::kInitialisation, 0);
  for (int i = 0; i < n; ++i) {
    p_2[i] = p[i] = static_cast<float>(random.normal());
    m_2[i] = m[i] = v_2[i] = v[i] = 0;
  }
  for (int t = 1; t <= 5; ++t) {
    for (int i = 0; i < n; ++i)
      g[i] = static_cast<float>(random.normal() * std::pow(10, i % 6 - 5));
    const double rate = 1e-3, scale = 0.5;
    kernels_.adam({n, p, m, v, g, static_cast<float>(scale),
                   static_cast<float>(rate / (1 - std::pow(0.9, t))),
                   static_cast<float>(std::sqrt(1 - std::pow(0.999, t)))});
    for (int i = 0; i < n; ++i) {
      m_2[i] = 0.9 * m_2[i] + 0.1 * scale * g[i];
      v_2[i] = 0.999 * v_2[i] + 0.001 * scale * scale * g[i] * g[i];
      const double m_hat = m_2[i] / (1 - std::pow(0.9, t));
      const double v_hat = v_2[i] / (1 - std::pow(0.999, t));
      p_2[i] -= rate * m_hat / (std::sqrt(v_hat) + 1e-8);
      EXPECT_NEAR(p[i], p_2[i], 1e-6) << t;
    }
  }
}

TEST(Gaussian, LogDensityAndEntropy) {
  const double log_2_pi = std::log(2 * std::acos(-1.0));
  EXPECT_NEAR(log_density(1, std::log(0.5f)), -0.5 - std::log(0.5) - log_2_pi / 2, 1e-6);
  EXPECT_NEAR(log_density(-1, std::log(2.0f)), -0.5 - std::log(2.0) - log_2_pi / 2, 1e-6);
  EXPECT_NEAR(gaussian_entropy(std::log(3.0f)), (1 + log_2_pi) / 2 + std::log(3.0), 1e-6);
}

}  // namespace
}  // namespace threelink_tests

// The network: against a reference in double, one sample against batches, every instruction set.
#include "threelink_agent/mlp.hpp"

#include <cmath>
#include <cstring>
#include <limits>
#include <stdexcept>
#include <vector>

#include <gtest/gtest.h>

#include "random_policy.hpp"

namespace threelink_tests {
namespace {

using namespace threelink_agent;
using threelink_sim::Isa;

constexpr double kUnit = 0x1p-24;           // relative error of one float operation
constexpr double kTanhError = 6 * 0x1p-23;  // relative, what the header promises

std::vector<float> random_inputs(int inputs, std::size_t n) {
  threelink_sim::Random random(5, threelink_sim::Stream::kStart, 0);
  std::vector<float> values(inputs * n);
  for (float& value : values) value = static_cast<float>(2 * random.normal());
  return values;
}

// Networks of all sorts of widths, odd ones included.
std::vector<std::vector<int>> shapes() {
  return {{4, 64, 64, 2}, {4, 2}, {1, 1, 1}, {7, 33, 17, 5}, {5, 100, 31}, {256, 256, 256}};
}

TEST(Mlp, AgreesWithTheReferenceInDouble) {
  for (const std::vector<int>& shape : shapes()) {
    const std::vector<Linear> layers = random_layers(shape, 1);
    const Mlp mlp(layers);
    const std::vector<float> input = random_inputs(shape.front(), 1);
    Eigen::VectorXd x =
        Eigen::Map<const Eigen::VectorXf>(input.data(), input.size()).cast<double>();
    // Bound on the error of x: a chain of n fused operations errs by at most n units of the sum of
    // magnitudes, tanh does not amplify errors.
    Eigen::VectorXd error = Eigen::VectorXd::Zero(x.size());
    for (std::size_t l = 0; l < layers.size(); ++l) {
      const Eigen::MatrixXd w = layers[l].weight.cast<double>();
      const Eigen::VectorXd b = layers[l].bias.cast<double>();
      error = (w.cwiseAbs() * error +
               1.01 * (w.cols() + 1) * kUnit * (w.cwiseAbs() * x.cwiseAbs() + b.cwiseAbs()))
                  .eval();
      x = (w * x + b).eval();
      if (l + 1 < layers.size()) {
        x = x.array().tanh().matrix().eval();
        error += kTanhError * x.cwiseAbs();
      }
    }
    std::vector<float> output(mlp.outputs());
    mlp.forward(input.data(), output.data());
    for (int j = 0; j < mlp.outputs(); ++j) {
      EXPECT_NEAR(output[j], x[j], error[j]) << shape.size() << " layers, output " << j;
      EXPECT_LT(error[j], 0.01);  // a bound that proves something
    }
  }
}

TEST(Mlp, TanhIsWithinSixUlp) {
  Linear identity;
  identity.weight.setOnes(1, 1);
  identity.bias.setZero(1);
  const Mlp mlp({identity, identity});
  const auto tanh_of = [&](float x) {
    float y;
    mlp.forward(&x, &y);
    return y;
  };
  double worst = 0;
  for (double exponent = -30; exponent < 4; exponent += 1e-4) {
    const auto x = static_cast<float>(std::exp2(exponent));
    const auto exact = static_cast<float>(std::tanh(static_cast<double>(x)));
    const float ulp = exact - std::nextafter(exact, 0.0F);
    const float y = tanh_of(x);
    worst = std::fmax(worst, std::abs(y - std::tanh(static_cast<double>(x))) / ulp);
    ASSERT_EQ(tanh_of(-x), -y);
  }
  EXPECT_LE(worst, 6);
  EXPECT_EQ(tanh_of(0), 0);
  for (float x : {20.0F, 1e10F, 3e38F}) EXPECT_NEAR(tanh_of(x), 1, 2.4e-7);
}

TEST(Mlp, OneSampleABatchAndEveryInstructionSetAgreeToTheBit) {
  for (const std::vector<int>& shape : shapes()) {
    for (std::size_t n : {1, 2, 15, 16, 31, 33, 64, 101}) {
      const std::vector<float> input = random_inputs(shape.front(), n);
      std::vector<float> fused;  // output of the first instruction set with fused multiply-adds
      for (Isa isa : threelink_sim::available_isas()) {
        const Mlp mlp(random_layers(shape, 2), isa);
        std::vector<float> output(n * mlp.outputs(), NAN);
        mlp.forward(n, input.data(), output.data());
        for (std::size_t i = 0; i < n; ++i) {
          std::vector<float> x(mlp.inputs()), y(mlp.outputs());
          for (int k = 0; k < mlp.inputs(); ++k) x[k] = input[k * n + i];
          mlp.forward(x.data(), y.data());
          for (int j = 0; j < mlp.outputs(); ++j)
            ASSERT_EQ(std::memcmp(&y[j], &output[j * n + i], sizeof(float)), 0)
                << to_string(isa) << ", sample " << i << " of " << n;
        }
        if (!threelink_sim::kernels(isa).fused) continue;
        if (fused.empty()) fused = output;
        ASSERT_EQ(std::memcmp(fused.data(), output.data(), output.size() * sizeof(float)), 0)
            << to_string(isa);
      }
    }
  }
}

TEST(Mlp, ACopyDoesNotDependOnTheOriginal) {
  const std::vector<float> input = random_inputs(4, 1);
  float expected[2], output[2];
  Mlp copy;
  {
    const Mlp original(random_layers({4, 64, 64, 2}, 3));
    original.forward(input.data(), expected);
    copy = original;
  }
  copy.forward(input.data(), output);
  EXPECT_EQ(std::memcmp(output, expected, sizeof(output)), 0);
}

void expect_refused(const std::vector<Linear>& layers, const std::string& part) {
  try {
    Mlp mlp(layers);
    FAIL() << "accepted; expected: " << part;
  } catch (const std::invalid_argument& error) {
    EXPECT_NE(std::string(error.what()).find(part), std::string::npos) << error.what();
  }
}

TEST(Mlp, RefusesLayersThatDoNotFit) {
  expect_refused({}, "none");
  expect_refused(random_layers({4, 257, 2}, 1), "(257, 4)");
  std::vector<Linear> layers = random_layers({4, 64, 64, 2}, 1);
  layers[1].weight.setZero(64, 63);
  expect_refused(layers, "(64, 63) must be (64, 64)");
  layers = random_layers({4, 64, 64, 2}, 1);
  layers[2].bias.setZero(3);
  expect_refused(layers, "bias of 3");
  layers = random_layers({4, 64, 64, 2}, 1);
  layers[0].weight(3, 1) = std::numeric_limits<float>::quiet_NaN();
  expect_refused(layers, "not finite");
}

}  // namespace
}  // namespace threelink_tests

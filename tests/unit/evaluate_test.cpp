// The measures of a policy, on policies made by hand of which they are known.
#include "threelink_agent/evaluate.hpp"

#include <cmath>

#include <gtest/gtest.h>

#include "random_policy.hpp"
#include "threelink_sim/environment.hpp"

namespace threelink_tests {
namespace {

using namespace threelink_agent;
using threelink_sim::kPi;

// Swims, and never steers: r_1 = g (alpha_2 + p(alpha_1)), r_2 = g (-alpha_1 + p(alpha_2)), where
// p(a) = 2 tanh(a) - a pushes outwards up to |a| = 1.9, so that the angles run round the origin,
// clockwise. A small bias gets it off the straight shape. Linear terms are tanh(a / 100) * 100.
Policy stroke_policy(double gain) {
  Linear hidden, output;
  hidden.weight.setZero(4, 4);
  hidden.bias.setZero(4);
  hidden.weight(0, 2) = hidden.weight(1, 3) = 1;
  hidden.weight(2, 2) = hidden.weight(3, 3) = 0.01F;
  output.weight.resize(2, 4);
  output.weight << 2, 0, -100, 100, 0, 2, -100, -100;
  output.bias.resize(2);
  output.bias << 0.01F, 0;
  output.weight *= static_cast<float>(gain);
  output.bias *= static_cast<float>(gain);
  return Policy({}, Mlp({hidden, output}), Eigen::VectorXf::Zero(2));
}

// Turns both hinges to their limits and stays there.
Policy stuck_policy() {
  Linear layer;
  layer.weight.setZero(2, 4);
  layer.bias.setOnes(2);
  return Policy({}, Mlp({layer}), Eigen::VectorXf::Zero(2));
}

TEST(Evaluate, MeasuresAStrokeThatNeverSteers) {
  const Policy policy = stroke_policy(10);
  const Evaluation evaluation = evaluate(policy, 0, 0);
  ASSERT_EQ(evaluation.starts.size(), 3u);
  const StartResult& ahead = evaluation.starts[0];

  // The same by other means: displacement and work over many strokes, long after the start; the
  // swimmer turns a little in each stroke, so its speed is along its mean heading.
  threelink_sim::Environment environment(policy.metadata().environment(), 1);
  std::vector<double> observation(4), rates(2), x{0}, y{0}, work{0}, crossings;
  for (int step = 0; step < kEvaluationSteps; ++step) {
    environment.observe(observation.data());
    const double alpha_2 = environment.batch().alpha(1)[0];
    policy.act(observation.data(), rates.data());
    environment.step(rates.data());
    const double next = environment.batch().alpha(1)[0];
    // alpha_2 rises through zero once a stroke.
    if (alpha_2 < 0 && next >= 0) crossings.push_back(step + alpha_2 / (alpha_2 - next));
    x.push_back(environment.batch().x()[0]);
    y.push_back(environment.batch().y()[0]);
    work.push_back(work.back() + environment.batch().work()[0]);
  }
  const std::size_t n = crossings.size();
  ASSERT_GT(n, 12u);
  const double period = (crossings[n - 1] - crossings[n - 6]) / 5;
  EXPECT_NEAR(ahead.period_steps, period, 0.1);
  // Strokes do not last whole steps: half a step of the centroid's 0.002 in 500 steps of 0.1.
  const double speed = (x[1465] - x[965]) / 50;
  EXPECT_NEAR(ahead.speed, speed, 0.05 * speed);
  EXPECT_GT(ahead.speed, 0.004);
  EXPECT_LT(ahead.speed, 0.0129154);  // the optimum
  const double power = (work[1465] - work[965]) / 50;
  EXPECT_NEAR(ahead.efficiency, 0.5 * speed * speed / power, 0.1 * ahead.efficiency);
  EXPECT_TRUE(ahead.success);

  // Its path turns with the start, which it does not mend.
  EXPECT_NEAR(evaluation.starts[1].speed, ahead.speed * std::cos(kPi / 3), 1e-3);
  EXPECT_NEAR(evaluation.starts[2].speed, 0, 1e-3);
  for (int i : {1, 2}) {
    EXPECT_NEAR(evaluation.starts[i].period_steps, ahead.period_steps, 1e-6);
    EXPECT_EQ(evaluation.starts[i].steering_steps, kEvaluationSteps);
    EXPECT_TRUE(std::isnan(evaluation.starts[i].theta_s));
    EXPECT_FALSE(evaluation.starts[i].success);
  }
  EXPECT_DOUBLE_EQ(
      evaluation.speed,
      (evaluation.starts[0].speed + evaluation.starts[1].speed + evaluation.starts[2].speed) / 3);
  EXPECT_TRUE(std::isnan(evaluation.success_rate));
  EXPECT_TRUE(std::isnan(evaluation.theta_s));
}

TEST(Evaluate, AStuckPolicyHasNoSpeedAndNoSuccess) {
  const Evaluation evaluation = evaluate(stuck_policy(), 20, 3);
  for (const StartResult& start : evaluation.starts) {
    EXPECT_EQ(start.speed, 0);
    EXPECT_EQ(start.efficiency, 0);
    EXPECT_TRUE(std::isnan(start.period_steps));
    EXPECT_FALSE(start.success);
  }
  EXPECT_EQ(evaluation.speed, 0);
  EXPECT_EQ(evaluation.success_rate, 0);
}

TEST(Evaluate, IsDeterministicAndKeyedBySeedAndTrial) {
  const Policy policy = stroke_policy(10);
  const Evaluation a = evaluate(policy, 200, 1), b = evaluate(policy, 200, 1);
  EXPECT_EQ(a.success_rate, b.success_rate);
  EXPECT_EQ(a.speed, b.speed);
  // Headings are uniform, and a stroke that never steers succeeds within 2.5 degrees of 180.
  EXPECT_LT(a.success_rate, 0.08);
  EXPECT_EQ(a.trials, 200);
  EXPECT_EQ(evaluate(policy, 0, 1).speed, a.speed);
}

}  // namespace
}  // namespace threelink_tests

// Scalar and batch, and every instruction set with fused multiply-adds, are equal to the bit.
#include "threelink_sim/batch.hpp"

#include <cstring>
#include <vector>

#include <gtest/gtest.h>

#include "threelink_sim/environment.hpp"
#include "threelink_sim/isa.hpp"
#include "threelink_sim/random.hpp"

namespace threelink_tests {
namespace {

using namespace threelink_sim;

// 21 lanes: whole packs of every width, and a rest.
constexpr std::size_t kLanes = 21;
constexpr int kSteps = 100;

std::vector<double> rates_of_step(int hinges, int step) {
  std::vector<double> rates(kLanes * hinges);
  Random random(11, Stream::kExploration, 0,
                step / 20);  // kept for 20 steps, so that limits matter
  for (double& rate : rates) rate = random.uniform(-1.4, 1.4);
  return rates;
}

// Every number that a batch holds after kSteps, with the work of all steps.
std::vector<double> run_batch(const Model& model, const Kernels& kernels) {
  Batch batch(model, kLanes, kernels);
  for (std::size_t i = 0; i < kLanes; ++i) batch.set_state(i, random_start(model, 12, i));
  std::vector<double> work(kLanes);
  for (int k = 0; k < kSteps; ++k) {
    const std::vector<double> rates = rates_of_step(model.hinges(), k);
    std::copy(rates.begin(), rates.end(), batch.rates(0));
    batch.advance(0.1, substeps(model, 0.1, 1.4));
    for (std::size_t i = 0; i < kLanes; ++i) work[i] += batch.work()[i];
  }
  std::vector<double> all = work;
  for (std::size_t i = 0; i < kLanes; ++i) {
    const SwimmerState state = batch.state(i);
    all.insert(all.end(), {state.centroid.x(), state.centroid.y(), state.heading});
    all.insert(all.end(), state.alpha.data(), state.alpha.data() + state.alpha.size());
  }
  return all;
}

bool same_bits(const std::vector<double>& a, const std::vector<double>& b) {
  return a.size() == b.size() && std::memcmp(a.data(), b.data(), a.size() * sizeof(double)) == 0;
}

TEST(Batch, EqualsTheSingleSwimmerToTheBit) {
  for (int links : {2, 3, 5, 8}) {
    Model model;
    model.links = links;
    Batch batch(model, kLanes);
    std::vector<SwimmerState> single;
    for (std::size_t i = 0; i < kLanes; ++i) {
      single.push_back(random_start(model, 12, i));
      batch.set_state(i, single[i]);
    }
    const int sub = substeps(model, 0.1, 1.4);
    for (int k = 0; k < kSteps; ++k) {
      const std::vector<double> rates = rates_of_step(model.hinges(), k);
      std::copy(rates.begin(), rates.end(), batch.rates(0));
      batch.advance(0.1, sub);
      for (std::size_t i = 0; i < kLanes; ++i) {
        HingeVector wanted(model.hinges());
        for (int j = 0; j < model.hinges(); ++j) wanted[j] = rates[j * kLanes + i];
        const StepResult result = advance(model, single[i], wanted, 0.1, sub);
        ASSERT_EQ(batch.work()[i], result.work);
        ASSERT_EQ(batch.dx()[i], result.displacement.x());
        ASSERT_EQ(batch.dy()[i], result.displacement.y());
        const SwimmerState lane = batch.state(i);
        ASSERT_EQ(lane.centroid, single[i].centroid) << "lane " << i << " step " << k;
        ASSERT_EQ(lane.heading, single[i].heading);
        ASSERT_EQ(lane.alpha, single[i].alpha);
        for (int j = 0; j < model.hinges(); ++j) ASSERT_EQ(batch.rates(j)[i], result.rates[j]);
      }
    }
  }
}

TEST(Batch, InstructionSetsAgreeToTheBit) {
  for (int links : {3, 5}) {
    Model model;
    model.links = links;
    const std::vector<double> expected = run_batch(model, kernels());
    for (Isa isa : available_isas()) {
      if (kernels(isa).fused == kernels().fused) {
        EXPECT_TRUE(same_bits(run_batch(model, kernels(isa)), expected)) << to_string(isa);
      } else {
        // Without fused multiply-adds last bits differ, and 100 steps spread them.
        const std::vector<double> others = run_batch(model, kernels(isa));
        for (std::size_t q = 0; q < expected.size(); ++q)
          EXPECT_NEAR(others[q], expected[q], 1e-12) << to_string(isa);
      }
    }
  }
}

TEST(Batch, MeetsTheLimitInSomeLanes) {
  // Guards the tests above against running without a single cut rate.
  const Model model;
  Batch batch(model, kLanes);
  for (std::size_t i = 0; i < kLanes; ++i) batch.set_state(i, random_start(model, 12, i));
  int cut = 0;
  for (int k = 0; k < kSteps; ++k) {
    const std::vector<double> rates = rates_of_step(2, k);
    std::copy(rates.begin(), rates.end(), batch.rates(0));
    batch.advance(0.1, substeps(model, 0.1, 1.4));
    for (std::size_t q = 0; q < 2 * kLanes; ++q) cut += batch.rates(0)[q] != rates[q];
  }
  EXPECT_GT(cut, 50);
}

TEST(Environment, OneLaneEqualsManyToTheBit) {
  EnvironmentConfig config;
  config.c = 3;
  Environment many(config, kLanes);
  std::vector<Environment> one(kLanes, Environment(config, 1));
  for (std::size_t i = 0; i < kLanes; ++i) {
    const SwimmerState start = random_start(config.model, 13, i);
    const Eigen::Vector2d p = Eigen::Vector2d(1.0, 0.3 * i).normalized();
    many.reset(i, start);
    many.set_direction(i, p);
    one[i].reset(0, start);
    one[i].set_direction(0, p);
  }
  std::vector<double> observations(4 * kLanes);
  for (int k = 0; k < kSteps; ++k) {
    const std::vector<double> rates = rates_of_step(2, k);
    many.step(rates.data());
    many.observe(observations.data());
    for (std::size_t i = 0; i < kLanes; ++i) {
      const double own_rates[2] = {rates[i], rates[kLanes + i]};
      one[i].step(own_rates);
      ASSERT_EQ(one[i].rewards()[0], many.rewards()[i]);
      double own[4];
      one[i].observe(own);
      for (int q = 0; q < 4; ++q) ASSERT_EQ(own[q], observations[q * kLanes + i]);
    }
  }
}

TEST(Environment, ObservesAndRewardsAsDefined) {
  EnvironmentConfig config;
  config.c = 3;
  Environment environment(config, 1);
  SwimmerState start;
  start.heading = 0.4;
  start.alpha = (HingeVector(2) << 0.3, -0.2).finished();
  environment.reset(0, start);
  const double theta_t = 1.1;
  environment.set_direction(0, {std::cos(theta_t), std::sin(theta_t)});
  double observation[4];
  environment.observe(observation);
  EXPECT_NEAR(observation[0], std::cos(0.4 - theta_t), 1e-15);
  EXPECT_NEAR(observation[1], std::sin(0.4 - theta_t), 1e-15);
  EXPECT_EQ(observation[2], 0.3);
  EXPECT_EQ(observation[3], -0.2);

  const double rates[2] = {2.0, -0.5};  // the first is clipped to 1
  environment.step(rates);
  SwimmerState expected = start;
  const StepResult step =
      advance(config.model, expected, (HingeVector(2) << 1.0, -0.5).finished(), config.dt, 1);
  EXPECT_EQ(environment.batch().state(0).centroid, expected.centroid);
  const double progress =
      step.displacement.x() * std::cos(theta_t) + step.displacement.y() * std::sin(theta_t);
  EXPECT_NEAR(environment.rewards()[0], config.b * progress - config.c * step.work, 1e-16);
}

TEST(Environment, RandomStartsAreKeyedAndWithinTheLimits) {
  const Model model;
  const SwimmerState start = random_start(model, 0, 5);
  EXPECT_EQ(random_start(model, 0, 5).heading, start.heading);
  EXPECT_NE(random_start(model, 0, 6).heading, start.heading);
  EXPECT_NE(random_start(model, 1, 5).heading, start.heading);
  Eigen::Vector3d lowest = Eigen::Vector3d::Constant(9), highest = -lowest;
  for (int episode = 0; episode < 2000; ++episode) {
    const SwimmerState s = random_start(model, 0, episode);
    const Eigen::Vector3d angles(s.heading, s.alpha[0], s.alpha[1]);
    lowest = lowest.cwiseMin(angles);
    highest = highest.cwiseMax(angles);
  }
  // 2000 uniform draws reach within 1 % of both ends but with probability 6 * 0.99^2000 < 2e-8.
  const Eigen::Vector3d bound(kPi, model.joint_limit, model.joint_limit);
  EXPECT_TRUE((highest.array() <= bound.array()).all());
  EXPECT_TRUE((lowest.array() >= -bound.array()).all());
  EXPECT_TRUE((highest.array() > 0.98 * bound.array()).all());
  EXPECT_TRUE((lowest.array() < -0.98 * bound.array()).all());
}

TEST(Environment, RefusesValuesOutOfBounds) {
  const auto refused = [](EnvironmentConfig config, const std::string& field) {
    try {
      config.validate();
      ADD_FAILURE() << field << " was accepted";
    } catch (const std::invalid_argument& error) {
      EXPECT_NE(std::string(error.what()).find(field), std::string::npos) << error.what();
    }
  };
  EnvironmentConfig config;
  config.dt = 0;
  refused(config, "dt = 0");
  config = {};
  config.b = -1;
  refused(config, "b = -1");
  config = {};
  config.c = NAN;
  refused(config, "c = nan");
  config = {};
  config.steps = 0;
  refused(config, "steps = 0");
}

}  // namespace
}  // namespace threelink_tests

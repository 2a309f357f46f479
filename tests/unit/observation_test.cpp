// What the agent is shown.
#include "threelink_sim/observation.hpp"

#include <cmath>
#include <limits>
#include <stdexcept>

#include <gtest/gtest.h>

#include "threelink_sim/environment.hpp"
#include "threelink_sim/isa.hpp"

namespace threelink_sim {
namespace {

TEST(TargetDirection, IsAUnitVectorForEveryFiniteTarget) {
  const Eigen::Vector2d centroid(0.5, -0.25), previous(0, 1);
  const TargetDirection near = target_direction(centroid, {3.5, 3.75}, previous);
  EXPECT_NEAR(near.p.x(), 0.6, 1e-15);
  EXPECT_NEAR(near.p.y(), 0.8, 1e-15);
  EXPECT_NEAR(near.distance, 5, 1e-14);

  constexpr double kMax = std::numeric_limits<double>::max();
  for (const Eigen::Vector2d& target :
       {Eigen::Vector2d(kMax, -kMax), Eigen::Vector2d(1e308, 1), Eigen::Vector2d(0.5, -1e200)}) {
    const TargetDirection far = target_direction(centroid, target, previous);
    EXPECT_NEAR(far.p.norm(), 1, 1e-15);
    EXPECT_TRUE(std::isfinite(far.distance));
    EXPECT_GT(far.distance, 1e199);
  }
  const TargetDirection tiny = target_direction({0, 0}, {0, -5e-324}, previous);
  EXPECT_EQ(tiny.p, Eigen::Vector2d(0, -1));
  EXPECT_EQ(tiny.distance, 5e-324);
}

TEST(TargetDirection, OnTheCentroidIsThePreviousOne) {
  const TargetDirection here = target_direction({1, 2}, {1, 2}, {0.6, 0.8});
  EXPECT_EQ(here.p, Eigen::Vector2d(0.6, 0.8));
  EXPECT_EQ(here.distance, 0);
}

TEST(Observation, NamesAreStrict) {
  for (ObservationKind kind : {ObservationKind::kDirection, ObservationKind::kTarget})
    EXPECT_EQ(observation_kind_from_string(to_string(kind)), kind);
  EXPECT_THROW(observation_kind_from_string("Target"), std::invalid_argument);
}

EnvironmentConfig config(ObservationKind kind) {
  EnvironmentConfig config;
  config.observation = kind;
  return config;
}

TEST(Observation, OfATargetIsTheDirectionAndHowNearItIs) {
  Environment direction(config(ObservationKind::kDirection), 1);
  Environment target(config(ObservationKind::kTarget), 1);
  ASSERT_EQ(direction.observation_size(), 4);
  ASSERT_EQ(target.observation_size(), 7);
  SwimmerState state;
  state.centroid = {1, 2};
  state.heading = 0.4;
  state.alpha = (HingeVector(2) << 0.3, -0.2).finished();
  struct Case {
    double distance, clipped;  // [L]
  };
  for (const Case& c : {Case{0.03, 0.03}, Case{0.001, 0.001}, Case{1e-4, 5e-4}, Case{0, 5e-4},
                        Case{0.4, 0.4}, Case{3, 0.5}, Case{1e300, 0.5}}) {
    double four[4], seven[7];
    for (Environment* environment : {&direction, &target}) {
      environment->reset(0, state);
      environment->aim(0,
                       state.centroid + c.distance * Eigen::Vector2d(std::cos(1.1), std::sin(1.1)));
    }
    direction.observe(four);
    target.observe(seven);
    for (int k = 0; k < 4; ++k) EXPECT_EQ(seven[k], four[k]);
    const double weight = std::tanh(c.clipped / 0.1);
    EXPECT_NEAR(seven[4], weight * four[0], 1e-13) << c.distance;
    EXPECT_NEAR(seven[5], weight * four[1], 1e-13) << c.distance;
    EXPECT_NEAR(seven[6], (std::log(c.clipped) + 4) / 2, 1e-12) << c.distance;
  }
}

TEST(Observation, TakesTheAxisOfTheMiddle) {
  for (int links = 2; links <= 8; ++links) {
    EnvironmentConfig swimmer = config(ObservationKind::kDirection);
    swimmer.model.links = links;
    Environment environment(swimmer, 5);  // more than one, since lanes go in packs
    std::vector<double> seen(5 * (links + 1));
    std::vector<SwimmerState> states;
    for (std::uint32_t i = 0; i < 5; ++i) {
      states.push_back(random_start(swimmer.model, 4, i));
      environment.reset(i, states[i]);
      environment.set_direction(i, {std::cos(0.7), std::sin(0.7)});
    }
    environment.observe(seen.data());
    for (int i = 0; i < 5; ++i) {
      const LinkVector theta = link_angles(swimmer.model, states[i]);
      const double axis = (theta[(links - 1) / 2] + theta[links / 2]) / 2;
      EXPECT_NEAR(seen[i], std::cos(axis - 0.7), 1e-14) << links;
      EXPECT_NEAR(seen[5 + i], std::sin(axis - 0.7), 1e-14) << links;
      // Of an odd number it is the heading itself, to the bit.
      double sine, cosine;
      kernels().sincos(1, &states[i].heading, &sine, &cosine);
      if (links % 2 == 0) continue;
      EXPECT_EQ(seen[i], cosine * std::cos(0.7) + sine * std::sin(0.7)) << links;
    }
  }
}

TEST(Observation, ADirectionIsATargetFarAway) {
  Environment environment(config(ObservationKind::kTarget), 1);
  double far[7], infinite[7];
  environment.aim(0, {1e9, 0});
  environment.observe(far);
  environment.set_direction(0, {1, 0});
  environment.observe(infinite);
  for (int k = 0; k < 7; ++k) EXPECT_EQ(infinite[k], far[k]) << k;
  EXPECT_NEAR(infinite[4], std::tanh(5), 1e-15);
}

TEST(Observation, HasTheSameBitsInEveryLaneAndInstructionSet) {
  constexpr std::size_t kLanes = 21;
  const auto observe = [](Isa isa, std::size_t first, std::size_t lanes) {
    Environment environment(config(ObservationKind::kTarget), lanes, kernels(isa));
    for (std::size_t i = 0; i < lanes; ++i) {
      environment.reset(i, random_start(environment.config().model, 3, first + i));
      environment.aim(i, {1e-4 * std::exp(0.4 * (first + i)), 1e-3});
    }
    std::vector<double> values(7 * lanes);
    environment.observe(values.data());
    return values;
  };
  const std::vector<double> all = observe(isa_in_use(), 0, kLanes);
  for (std::size_t i = 0; i < kLanes; ++i) {
    const std::vector<double> one = observe(isa_in_use(), i, 1);
    for (int k = 0; k < 7; ++k) EXPECT_EQ(one[k], all[k * kLanes + i]);
  }
  if (!kernels(isa_in_use()).fused) return;
  for (Isa isa : available_isas())
    if (kernels(isa).fused) {
      EXPECT_EQ(observe(isa, 0, kLanes), all) << to_string(isa);
    }
}

}  // namespace
}  // namespace threelink_sim

// Obstacles: nothing gets in, and what contacts do to energy.
#include <cmath>
#include <vector>

#include <gtest/gtest.h>

#include "small_world.hpp"
#include "threelink_sim/environment.hpp"
#include "threelink_sim/random.hpp"

namespace threelink_tests {
namespace {

using namespace threelink_sim;

const std::string kBox =
    "obstacles:\n"
    "  - {kind: half_plane, point: [-0.6, 0.0], normal: [1.0, 0.0]}\n"
    "  - {kind: half_plane, point: [0.6, 0.0], normal: [-1.0, 0.0]}\n"
    "  - {kind: half_plane, point: [0.0, -0.6], normal: [0.0, 1.0]}\n"
    "  - {kind: half_plane, point: [0.0, 0.6], normal: [0.0, -1.0]}\n"
    "  - {kind: disc, center: [0.5, 0.5], radius: 0.2}\n"
    "  - {kind: disc, center: [-0.45, -0.5], radius: 0.15}\n";

TEST(Contact, NothingGetsIntoObstacles) {
  EnvironmentConfig config;
  config.world = world_of(kBox);
  constexpr std::size_t kLanes = 100;
  Environment environment(config, kLanes);
  ContactSolver contacts(*config.world, config.model);
  for (std::size_t i = 0; i < kLanes; ++i)
    environment.reset(i, random_start(config, 3, static_cast<std::uint32_t>(i)));
  Random random(1, Stream::kStart, 0);
  std::vector<double> rates(2 * kLanes);
  double deepest = 0;
  int touched = 0;
  for (int k = 0; k < 10'000; ++k) {
    // Half of them swim, and half do at random what they do for a while.
    for (std::size_t i = 0; i < rates.size(); ++i)
      if (i % 2 == 0)
        rates[i] = std::sin(0.09 * k + (i < kLanes ? 0.0 : 1.2));
      else if (k % 20 == 0)
        rates[i] = random.uniform(-1, 1);
    environment.step(rates.data());
    for (std::size_t i = 0; i < kLanes; ++i) {
      const int presses = environment.record(i).contact.contacts;
      if (presses == 0) continue;
      ++touched;
      deepest = std::min(deepest, contacts.gap(environment.batch().state(i), 0.0));
    }
  }
  EXPECT_GT(touched, 10'000);
  EXPECT_GT(deepest, -0.01 / 100);
}

TEST(Contact, FarObstaclesChangeNoBit) {
  EnvironmentConfig still, far;
  far.world = world_of("obstacles: [{kind: disc, center: [50.0, 0.0], radius: 1.0}]");
  Environment a(still, 1), b(far, 1);
  for (int k = 0; k < 200; ++k) {
    const double rates[] = {std::sin(0.1 * k), std::cos(0.1 * k)};
    a.step(rates);
    b.step(rates);
  }
  EXPECT_EQ(a.centroid(0), b.centroid(0));
  EXPECT_EQ(a.record(0).work, b.record(0).work);
}

TEST(Contact, MirroredWorldMirrorsTheMotion) {
  const Model model;
  SwimmerState start, mirrored;
  start.centroid = {0, 0.15};
  start.heading = 0.3;
  start.alpha = HingeVector(2);
  start.alpha << 0.5, -0.4;
  mirrored = start;
  mirrored.centroid.y() *= -1;
  mirrored.heading *= -1;
  mirrored.alpha *= -1;
  WorldSwimmer a(
      "obstacles: [{kind: disc, center: [0.6, 0.5], radius: 0.2}, {kind: capsule, from: "
      "[-1.0, 0.7], to: [1.0, 0.8], radius: 0.0}]",
      model, start);
  WorldSwimmer b(
      "obstacles: [{kind: disc, center: [0.6, -0.5], radius: 0.2}, {kind: capsule, from: "
      "[-1.0, -0.7], to: [1.0, -0.8], radius: 0.0}]",
      model, mirrored);
  int touched = 0;
  for (int k = 0; k < 400; ++k) {
    HingeVector rates(2);
    rates << std::sin(0.12 * k), std::sin(0.12 * k + 1.2);
    a.step(rates);
    b.step(-rates);
    touched += a.stepper().contact(0).contacts > 0;
  }
  EXPECT_GT(touched, 5);
  EXPECT_NEAR(a.state().centroid.x(), b.state().centroid.x(), 1e-9);
  EXPECT_NEAR(a.state().centroid.y(), -b.state().centroid.y(), 1e-9);
  EXPECT_NEAR(a.state().heading, -b.state().heading, 1e-9);
}

// A straight swimmer across the flow is held by a wall: the wall's force is its drag, U of one unit
// of C_perp over the length 1.
TEST(Contact, WallHoldsASwimmerAgainstItsDrag) {
  const Model model;
  SwimmerState start;
  start.centroid = {-0.2, 0};
  start.heading = kPi / 2;
  start.alpha = HingeVector::Zero(2);
  WorldSwimmer swimmer(
      "flow: [{kind: uniform, U: [0.02, 0.0]}]\n"
      "obstacles: [{kind: half_plane, point: [0.0, 0.0], normal: [-1.0, 0.0]}]",
      model, start);
  for (int k = 0; k < 300; ++k) swimmer.step(HingeVector::Zero(2));
  const ContactRecord& contact = swimmer.stepper().contact(0);
  EXPECT_EQ(contact.contacts, 4);  // its joints
  EXPECT_NEAR(contact.force.x(), -0.02, 1e-9);
  EXPECT_NEAR(contact.force.y(), 0, 1e-12);
  EXPECT_NEAR(swimmer.state().centroid.x(), -0.01, 1e-5);  // the link's radius
  const double before = swimmer.state().centroid.x(), dissipated = swimmer.dissipation();
  swimmer.step(HingeVector::Zero(2));
  EXPECT_NEAR(swimmer.state().centroid.x(), before, 1e-12);
  // The flow past it: U^2 of one unit of C_perp.
  EXPECT_NEAR(swimmer.dissipation() - dissipated, 0.02 * 0.02 * 0.1, 1e-9);
}

// Energy: hinges + contacts = dissipation in still water. Obstacles at rest take energy only, and
// as the step is implicit, a little of it: what the hinges spend is no less than what is
// dissipated.
TEST(Contact, ObstaclesAtRestGiveNoEnergy) {
  const Model model;
  SwimmerState start;
  start.alpha = HingeVector::Zero(2);
  WorldSwimmer swimmer(kBox, model, start);
  Random random(8, Stream::kStart, 0);
  HingeVector rates(2);
  double contact_work = 0;
  for (int k = 0; k < 20'000; ++k) {
    if (k % 10 == 0) rates << random.uniform(-1, 1), random.uniform(-1, 1);
    const double work = swimmer.work(), dissipation = swimmer.dissipation();
    swimmer.step(rates);
    const double step = (swimmer.dissipation() - dissipation) - (swimmer.work() - work);
    contact_work += step;
  }
  EXPECT_LE(contact_work, 0);
  EXPECT_GT(contact_work, -0.05 * swimmer.work());
}

TEST(Contact, JammedHingesStall) {
  // The diagonal of this box is shorter than a straight swimmer.
  const Model model;
  SwimmerState start;
  start.heading = kPi / 2;
  start.alpha = HingeVector(2);
  start.alpha << 0.4, -0.4;
  WorldSwimmer swimmer(
      "obstacles:\n"
      "  - {kind: half_plane, point: [0.0, -0.485], normal: [0.0, 1.0]}\n"
      "  - {kind: half_plane, point: [0.0, 0.485], normal: [0.0, -1.0]}\n"
      "  - {kind: half_plane, point: [-0.145, 0.0], normal: [1.0, 0.0]}\n"
      "  - {kind: half_plane, point: [0.145, 0.0], normal: [-1.0, 0.0]}\n",
      model, start);
  HingeVector straighten(2);
  straighten << -1, 1;
  double slowest = 1;
  for (int k = 0; k < 12; ++k) {
    swimmer.step(straighten);
    slowest = std::min(slowest, std::abs(swimmer.applied_rate(0)));
  }
  EXPECT_LT(slowest, 0.5);
  EXPECT_GT(swimmer.stepper().contact(0).contacts, 1);
}

TEST(Contact, StartsThatTouchAreRefused) {
  const Model model;
  SwimmerState start;
  start.alpha = HingeVector::Zero(2);
  EXPECT_THROW(
      WorldSwimmer("obstacles: [{kind: disc, center: [0.0, 0.1], radius: 0.2}]", model, start),
      std::invalid_argument);
  EXPECT_THROW(
      WorldSwimmer("obstacles: [{kind: half_plane, point: [0.0, 0.2], normal: [0.0, 1.0]}]", model,
                   start),
      std::invalid_argument);
  EXPECT_NO_THROW(
      WorldSwimmer("obstacles: [{kind: disc, center: [0.0, 0.3], radius: 0.2}]", model, start));
}

TEST(Contact, RandomStartsAreFree) {
  EnvironmentConfig config;
  config.world = world_of("obstacles: [{kind: disc, center: [0.0, 0.25], radius: 0.1}]");
  ContactSolver contacts(*config.world, config.model);
  int others = 0;
  for (std::uint32_t episode = 0; episode < 100; ++episode) {
    const SwimmerState start = random_start(config, 1, episode);
    EXPECT_GE(contacts.gap(start, 1.0), 0);
    others += start.heading != random_start(config.model, 1, episode).heading;
  }
  EXPECT_GT(others, 10) << "some had to be drawn again";
  EXPECT_LT(others, 100);
}

}  // namespace
}  // namespace threelink_tests

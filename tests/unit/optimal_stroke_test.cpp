// The search for optimal strokes: known optima found from scratch, within the bounds, or refused.
#include "threelink_sim/optimal_stroke.hpp"

#include <cmath>

#include <gtest/gtest.h>

namespace threelink_tests {
namespace {

using namespace threelink_sim;

// Optima for three links and gamma = 1/2, found elsewhere with 240 pieces, to all digits given.
constexpr double kSpeed = 0.0129154, kPeriod = 7.219, kEfficiency = 0.012364;

OptimalStroke find(const StrokeSearch& search) {
  const auto nothing = [](const Climb&) {};
  return find_optimal_stroke(search, nothing, nothing);
}

StrokeSearch small(Objective objective, int pieces) {
  StrokeSearch search;
  search.objective = objective;
  search.pieces = pieces;
  search.starts = 2;
  return search;
}

// Closed, within the bounds, and without a turn; and what the search says is what play gives.
void expect_sound(const StrokeSearch& search, const OptimalStroke& optimum) {
  EXPECT_NO_THROW(optimum.stroke.validate());
  const StrokeMeasures played = measure(optimum.stroke);
  EXPECT_NEAR(played.rotation, 0, 2e-8);
  EXPECT_EQ(optimum.value, objective_value(search, played));
  double refined = 0;
  for (const Climb& climb : optimum.climbs)
    if (climb.name == "refinement") refined = std::max(refined, climb.value);
  EXPECT_NEAR(optimum.value, refined, 1e-7 * refined);
  EXPECT_EQ(optimum.climbs.front().name, "start 1");
  EXPECT_EQ(optimum.climbs.back().name, "refinement");
  EXPECT_GT(optimum.climbs.back().history.size(), 3u);
}

double fastest_rate(const Stroke& stroke) {
  double fastest = 0;
  for (const HingeVector& rates : stroke.rates)
    fastest = std::max(fastest, rates.cwiseAbs().maxCoeff());
  return fastest;
}

TEST(OptimalStroke, Speed) {
  const StrokeSearch search = small(Objective::kSpeed, 100);
  const OptimalStroke optimum = find(search);
  expect_sound(search, optimum);
  EXPECT_NEAR(optimum.value, kSpeed, 1e-4 * kSpeed);
  EXPECT_NEAR(optimum.stroke.period(), kPeriod, 2e-3);
  // The hinges' angles are triangle waves: almost all rates are at a bound.
  int saturated = 0;
  for (const HingeVector& rates : optimum.stroke.rates)
    saturated += rates.cwiseAbs().minCoeff() > 1 - 1e-6;
  EXPECT_GE(saturated, 96);
}

TEST(OptimalStroke, Efficiency) {
  // Rates that are held for a piece cost 0.6 % at 40 pieces, and as the square of their length.
  const StrokeSearch search = small(Objective::kEfficiency, 100);
  const OptimalStroke optimum = find(search);
  expect_sound(search, optimum);
  EXPECT_NEAR(optimum.value, kEfficiency, 1.1e-3 * kEfficiency);
  EXPECT_DOUBLE_EQ(fastest_rate(optimum.stroke), 1.0);
}

TEST(OptimalStroke, EnergyAware) {
  StrokeSearch search = small(Objective::kEnergyAware, 80);
  search.c = 3;
  const OptimalStroke optimum = find(search);
  expect_sound(search, optimum);
  const StrokeMeasures m = measure(optimum.stroke);
  EXPECT_NEAR(m.speed, 0.012241, 4e-4 * 0.012241);
  EXPECT_NEAR(m.power, 0.006892, 1e-3 * 0.006892);
  EXPECT_NEAR(optimum.stroke.period(), 7.470, 5e-3);
}

TEST(OptimalStroke, GivenStepLength) {
  StrokeSearch search = small(Objective::kSpeed, 40);
  search.dt = 0.1;
  const OptimalStroke optimum = find(search);
  expect_sound(search, optimum);
  EXPECT_EQ(optimum.stroke.dt, 0.1);
  EXPECT_EQ(optimum.stroke.pieces(), 72);
  EXPECT_NEAR(optimum.value, kSpeed, 1e-4 * kSpeed);
}

TEST(OptimalStroke, JointLimit) {
  StrokeSearch search = small(Objective::kSpeed, 60);
  search.model.joint_limit = 1;
  const OptimalStroke optimum = find(search);
  expect_sound(search, optimum);
  double largest = 0;
  for (const HingeVector& angles : hinge_angles(optimum.stroke))
    largest = std::max(largest, angles.cwiseAbs().maxCoeff());
  EXPECT_NEAR(largest, 1, 1e-6);
  EXPECT_LT(optimum.value, 0.9 * kSpeed);
  EXPECT_GT(optimum.value, measure(square_stroke(search.model, -1, 1, 4)).speed);
}

TEST(OptimalStroke, FourLinks) {
  StrokeSearch search = small(Objective::kSpeed, 32);
  search.model.links = 4;
  search.starts = 1;
  const OptimalStroke optimum = find(search);
  expect_sound(search, optimum);
  // tests/data/reference/n_link.json: a wave of amplitude 0.8, as fast as unit rates allow.
  const double wave = 0.0592027221865336 / (2 * kPi * 0.8);
  EXPECT_GT(optimum.value, wave);
}

// With 40 pieces, as found elsewhere: half-period symmetric strokes, by L-BFGS from random waves.
TEST(OptimalStroke, MoreLinks) {
  struct Case {
    int links;
    double speed, period;
  };
  for (const Case& c : {Case{4, 0.021862, 5.504}, Case{5, 0.030367, 4.869}}) {
    StrokeSearch search = small(Objective::kSpeed, 40);
    search.model.links = c.links;
    const OptimalStroke optimum = find(search);
    expect_sound(search, optimum);
    EXPECT_NEAR(optimum.value, c.speed, 1e-6) << c.links;
    EXPECT_NEAR(optimum.stroke.period(), c.period, 1e-3) << c.links;
    EXPECT_LT(optimum.value, fastest_speed(c.links)) << "rates that are held for longer";
  }
  StrokeSearch search = small(Objective::kEfficiency, 40);
  search.model.links = 4;
  const OptimalStroke optimum = find(search);
  expect_sound(search, optimum);
  EXPECT_NEAR(optimum.value, 0.029975, 1e-6);
}

// The refinement varies few of the rates. Nothing is lost: all of them, varied at once on a grid
// that allows it, lead to the same value.
TEST(OptimalStroke, FewerUnknownsFindTheSame) {
  StrokeSearch search = small(Objective::kEnergyAware, 24);  // as the starts of six links: all vary
  search.model.links = 6;
  const OptimalStroke optimum = find(search);
  expect_sound(search, optimum);
  double of_starts = 0;
  for (const Climb& climb : optimum.climbs)
    if (climb.name != "refinement") of_starts = std::max(of_starts, climb.value);
  EXPECT_NEAR(optimum.value, of_starts, 1e-6 * of_starts);
  // Of four links on twice as many pieces: the value that a climb with all rates reaches.
  StrokeSearch four = small(Objective::kSpeed, 80);
  four.model.links = 4;
  EXPECT_NEAR(find(four).value, 0.02186631, 2e-8);
}

TEST(OptimalStroke, SameSeedSameStroke) {
  const StrokeSearch search = small(Objective::kSpeed, 20);
  EXPECT_EQ(find(search).stroke.rates, find(search).stroke.rates);
}

TEST(OptimalStroke, Refusals) {
  const auto refused = [](auto change, const std::string& text) {
    StrokeSearch search;
    change(search);
    try {
      find(search);
      ADD_FAILURE() << "accepted, and should say: " << text;
    } catch (const std::invalid_argument& error) {
      EXPECT_NE(std::string(error.what()).find(text), std::string::npos) << error.what();
    }
  };
  refused([](StrokeSearch& s) { s.model.links = 2; }, "links = 2");
  refused([](StrokeSearch& s) { s.model.gamma = 0; }, "gamma = 0");
  refused([](StrokeSearch& s) { s.b = 0; }, "b = 0");
  refused([](StrokeSearch& s) { s.c = -1; }, "c = -1");
  refused([](StrokeSearch& s) { s.c = 25; }, "c = 25: must be in [0, 4 b] = [0, 24]");
  refused([](StrokeSearch& s) { s.c = NAN; }, "c = nan");
  refused([](StrokeSearch& s) { s.pieces = 7; }, "pieces = 7");
  refused([](StrokeSearch& s) { s.dt = 2; }, "dt = 2");
  refused([](StrokeSearch& s) { s.starts = 0; }, "starts = 0");
  refused(
      [](StrokeSearch& s) {
        s.model.joint_limit = 0.3;  // the best period is short
        s.dt = 1;
        s.starts = 1;
      },
      "must have 8 to 1000 pieces");
}

}  // namespace
}  // namespace threelink_tests

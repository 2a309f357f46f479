// The diffusing target: statistics, repeatability, outcome, refusals.
#include "threelink_tasks/pursuit.hpp"

#include <cmath>
#include <functional>
#include <limits>
#include <stdexcept>
#include <string>
#include <vector>

#include <gtest/gtest.h>

namespace {

using Eigen::Vector2d;
using threelink_tasks::Outcome;
using threelink_tasks::Pursuit;
using threelink_tasks::PursuitParameters;

const Vector2d kFarAway(-100, -100);

std::vector<Vector2d> path(Pursuit& task, std::uint64_t seed, std::uint32_t episode, int steps,
                           const Vector2d& centroid = kFarAway) {
  task.reset(seed, episode);
  std::vector<Vector2d> targets;
  for (int k = 0; k <= steps; ++k) {
    task.observe(centroid);
    targets.push_back(task.target());
  }
  return targets;
}

TEST(PursuitTest, StartsAsThePaperSays) {
  Pursuit task{PursuitParameters()};
  const threelink_tasks::Start start = task.start();
  EXPECT_EQ(start.x_1, Vector2d(1, 0));
  EXPECT_EQ(start.theta_1, 0);
  EXPECT_EQ(start.alpha.size(), 0);  // straight
  task.reset(0, 1);
  EXPECT_EQ(task.observe(kFarAway), Outcome::kRunning);
  EXPECT_EQ(task.target(), Vector2d(1.5, 0.5));
}

// Steps of n independent normals of variance s^2 = 2 D dt: the mean of n squares has the standard
// deviation s^2 sqrt(2 / n), the mean of n products of independent ones s^2 / sqrt(n), and the mean
// itself s / sqrt(n). Five of each are passed once in 1.7 million times; the seed is fixed.
TEST(PursuitTest, StepsHaveTheVarianceOfTheDiffusivity) {
  PursuitParameters parameters;
  parameters.speed = 0.0128;
  constexpr int kEpisodes = 20, kSteps = 5000, n = kEpisodes * kSteps;
  const double variance = 2 * parameters.diffusivity * parameters.dt;
  const Vector2d drift = parameters.speed * parameters.dt * Vector2d(std::sqrt(0.75), 0.5);
  Pursuit task(parameters);
  double xx = 0, yy = 0, xy = 0, before = 0;
  Vector2d sum(0, 0), last(0, 0);
  for (int episode = 1; episode <= kEpisodes; ++episode) {
    const std::vector<Vector2d> targets = path(task, 3, episode, kSteps);
    for (int k = 1; k <= kSteps; ++k) {
      const Vector2d step = targets[k] - targets[k - 1] - drift;
      sum += step;
      xx += step.x() * step.x();
      yy += step.y() * step.y();
      xy += step.x() * step.y();
      before += step.x() * last.x();
      last = step;
    }
  }
  EXPECT_NEAR(xx / n, variance, 5 * variance * std::sqrt(2.0 / n));
  EXPECT_NEAR(yy / n, variance, 5 * variance * std::sqrt(2.0 / n));
  EXPECT_NEAR(xy / n, 0, 5 * variance / std::sqrt(n));
  EXPECT_NEAR(before / n, 0, 5 * variance / std::sqrt(n));
  EXPECT_NEAR(sum.x() / n, 0, 5 * std::sqrt(variance / n));
  EXPECT_NEAR(sum.y() / n, 0, 5 * std::sqrt(variance / n));
}

TEST(PursuitTest, GoesStraightOnWithoutDiffusion) {
  PursuitParameters parameters;
  parameters.diffusivity = 0;
  parameters.speed = 0.5;
  Pursuit task(parameters);
  const Vector2d end = path(task, 0, 1, 100).back();
  // 100 steps of 0.05 at 30 degrees; 100 roundings of numbers below 8.
  EXPECT_NEAR(end.x(), 1.5 + 5 * std::sqrt(0.75), 1e-13);
  EXPECT_NEAR(end.y(), 0.5 + 5 * 0.5, 1e-13);
}

TEST(PursuitTest, PathDependsOnSeedAndEpisodeAlone) {
  Pursuit task{PursuitParameters()};
  const std::vector<Vector2d> first = path(task, 7, 2, 500);
  EXPECT_NE(path(task, 7, 3, 500), first);
  EXPECT_NE(path(task, 8, 2, 500), first);
  // Whatever was played before, in whichever object, wherever the swimmer is.
  EXPECT_EQ(path(task, 7, 2, 500, {3, 4}), first);
  Pursuit other{PursuitParameters()};
  EXPECT_EQ(path(other, 7, 2, 500), first);
}

TEST(PursuitTest, CapturesNearTheTarget) {
  PursuitParameters parameters;
  parameters.diffusivity = 0;
  Pursuit task(parameters);
  task.reset(0, 1);
  EXPECT_EQ(task.observe({1.5, 0.5 - 0.0011}), Outcome::kRunning);
  EXPECT_EQ(task.observe({1.5, 0.5 - 0.0009}), Outcome::kCaptured);
}

TEST(PursuitTest, TimesOutInTheLastStateUnlessItCaptures) {
  PursuitParameters parameters;
  parameters.max_steps = 3;
  parameters.diffusivity = 0;
  for (const bool captures : {false, true}) {
    Pursuit task(parameters);
    task.reset(0, 1);
    for (int k = 0; k < 3; ++k) EXPECT_EQ(task.observe(kFarAway), Outcome::kRunning) << k;
    EXPECT_EQ(task.observe(captures ? parameters.target : kFarAway),
              captures ? Outcome::kCaptured : Outcome::kTimedOut);
  }
}

TEST(PursuitTest, RefusesImpossibleParametersByName) {
  const double infinite = std::numeric_limits<double>::infinity(), nan = infinite - infinite;
  const std::vector<std::pair<std::string, std::function<void(PursuitParameters&)>>> cases = {
      {"start", [=](auto& p) { p.start.x() = nan; }},
      {"target", [=](auto& p) { p.target.y() = infinite; }},
      {"heading", [=](auto& p) { p.heading = nan; }},
      {"speed", [](auto& p) { p.speed = -0.1; }},
      {"speed", [=](auto& p) { p.speed = infinite; }},
      {"diffusivity", [](auto& p) { p.diffusivity = -1e-9; }},
      {"dt", [](auto& p) { p.dt = 0; }},
      {"max_steps", [](auto& p) { p.max_steps = 0; }},
      {"max_steps", [](auto& p) { p.max_steps = std::uint64_t{1} << 32; }},
      {"threshold", [](auto& p) { p.capture.threshold = 0; }},
      {"capture_between_steps", [](auto& p) { p.capture.between_steps = true; }},
  };
  for (const auto& [name, spoil] : cases) {
    PursuitParameters parameters;
    spoil(parameters);
    try {
      Pursuit task(parameters);
      ADD_FAILURE() << name << " was accepted";
    } catch (const std::invalid_argument& error) {
      EXPECT_EQ(std::string(error.what()).find(name), 0u) << error.what();
    }
  }
  PursuitParameters at_rest;
  at_rest.diffusivity = 0;
  at_rest.capture.between_steps = true;
  EXPECT_NO_THROW(Pursuit{at_rest});
}

}  // namespace

// Every task: where its target is, by hand; when it ends; what it refuses; its record.
#include <cmath>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "make_task.hpp"
#include "threelink_sim/plugins.hpp"

namespace {

using Eigen::Vector2d;
using threelink_tasks::Outcome;
using threelink_tasks::Start;
using threelink_tasks::Task;
using threelink_tests::make_task;

constexpr double kPi = threelink_sim::kPi;
const Vector2d kFarAway(-100, -100);

// The targets of states 0 .. steps.
std::vector<Vector2d> targets(Task& task, std::uint64_t seed, std::uint32_t episode, int steps,
                              const Vector2d& centroid = kFarAway) {
  task.reset(seed, episode);
  std::vector<Vector2d> targets;
  for (int k = 0; k <= steps; ++k) {
    task.observe(centroid);
    targets.push_back(task.target());
  }
  return targets;
}

std::string refusal(const std::string& name, const std::string& yaml) {
  try {
    make_task(name, yaml);
  } catch (const threelink_sim::UsageError& error) {
    return error.what();
  }
  return "";
}

void expect_near(const Vector2d& a, const Vector2d& b, double tolerance) {
  EXPECT_NEAR((a - b).norm(), 0, tolerance) << a.transpose() << " and " << b.transpose();
}

// --- All of them ---------------------------------------------------------------------------------

const std::vector<std::pair<std::string, std::string>> kTasks = {
    {"clicked_point", "{}"},
    {"direction", "{direction: 0.7}"},
    {"path", "{curve: figure_eight, v_ratio: 0.3}"},
    {"path", "{points: [[0.1, 0], [1, 2], [3, 3.3]], closed: true}"},
    {"point", "{}"},
    {"pursuit", "{v_ratio: 0.37, diffusivity: 1.0e-4}"},
    {"waypoints", "{rotation: 0.1}"},
    {"waypoints", "{random_star: true}"},
    {"waypoints", "{points: [[0.1, 1e-5], [0.3333333333333333, -2]]}"},
};

TEST(Tasks, TheirRecordMakesThemAgainToTheBit) {
  for (const auto& [name, yaml] : kTasks) {
    constexpr double v_m = 0.1 / 3;
    threelink_sim::ParameterMap parameters("p", YAML::Load(yaml));
    const auto task = threelink_tasks::make_task(name, parameters, {0.1, v_m});
    const std::string config = "task:\n  name: " + name + "\n  seed: 18446744073709551615\n" +
                               "  policy: \"a: b\"\n  v_m: " + threelink_sim::yaml_number(v_m) +
                               "\n" + parameters.effective("  ") + "simulator:\n  dt: 0.1\n";
    const auto again = threelink_tasks::make_task(YAML::Load(config));
    EXPECT_EQ(targets(*again, 5, 2, 300), targets(*task, 5, 2, 300)) << config;
    EXPECT_EQ(again->waypoints(), task->waypoints()) << config;
    EXPECT_EQ(again->start().x_1, task->start().x_1);
    EXPECT_EQ(again->start().random, task->start().random);
  }
}

TEST(Tasks, DependOnSeedAndEpisodeAlone) {
  for (const auto& [name, yaml] : {kTasks[4], kTasks[5], kTasks[7]}) {
    const auto task = make_task(name, yaml);
    const std::vector<Vector2d> first = targets(*task, 7, 2, 50);
    EXPECT_NE(targets(*task, 7, 3, 50), first) << name;
    EXPECT_NE(targets(*task, 8, 2, 50), first) << name;
    EXPECT_EQ(targets(*task, 7, 2, 50, {-30, 4}), first) << name;
    EXPECT_EQ(targets(*make_task(name, yaml), 7, 2, 50), first) << name;
  }
}

TEST(Tasks, TimeOutInTheLastState) {
  for (const std::string name : {"clicked_point", "direction", "path", "point", "waypoints"}) {
    const auto task = make_task(name, "{max_steps: 3}");
    task->reset(0, 1);
    for (int k = 0; k < 3; ++k) EXPECT_EQ(task->observe(kFarAway), Outcome::kRunning) << name << k;
    EXPECT_EQ(task->observe(kFarAway), Outcome::kTimedOut) << name;
  }
}

TEST(Tasks, StartStraightWhereTheyAreTold) {
  const Start paper = make_task("waypoints")->start();
  EXPECT_EQ(paper.x_1, Vector2d(1, 0));
  EXPECT_EQ(paper.theta_1, 0);
  EXPECT_EQ(paper.alpha.size(), 0);  // straight
  EXPECT_FALSE(paper.random);
  EXPECT_EQ(make_task("path", "{start_x: -2, start_y: 0.25}")->start().x_1, Vector2d(-2, 0.25));
  EXPECT_TRUE(make_task("point")->start().random);
}

TEST(Tasks, RefuseBadParametersByName) {
  const std::vector<std::tuple<std::string, std::string, std::string>> cases = {
      {"purssuit", "{}", "there is no task \"purssuit\"; the nearest one is \"pursuit\""},
      {"pursuit", "{}", "p/v_ratio is missing"},
      {"pursuit", "{v_ratio: -0.1}", "p/v_ratio = -0.1 (double): must be in [0, 100]"},
      {"pursuit", "{v_ratio: 0, capture_between_steps: true}",
       "p/capture_between_steps = true (bool): needs a target at rest"},
      {"pursuit", "{v_ratio: 0, target_heading: .nan}", "p/target_heading = nan (double)"},
      {"waypoints", "{treshold: 1}", "nearest one is p/threshold"},
      {"waypoints", "{threshold: 0}", "p/threshold = 0 (int): must be in [1e-09, 1000]"},
      {"waypoints", "{max_steps: 0}", "p/max_steps = 0 (int): must be in [1, "},
      {"waypoints", "{max_steps: \"10\"}", "must be a whole number; write it without quotes"},
      {"waypoints", "{points: []}", "p/points = a list: must hold at least one"},
      {"waypoints", "{points: [[1]]}", "entry 0 must be a pair [x, y]"},
      {"waypoints", "{points: [[1, a]]}", "must be a number"},
      {"waypoints", "{points: /no/such/file}", "/no/such/file: cannot open"},
      {"waypoints", "{points: [[1, 2]], radius: 1}", "p/radius: no such parameter"},
      {"waypoints", "{random_star: true, radius: 1}", "p/radius: no such parameter"},
      {"path", "{points: [[1, 1], [1, 1]]}", "must hold two different ones at least"},
      {"path", "{curve: square}", "must be one of: circle, figure_eight"},
      {"path", "{capture_between_steps: true}", "needs a target at rest"},
      {"point", "{start_x: 1}", "p/start_x: no such parameter"},
      {"point", "{min_distance: 0.6}", "must not be less than min_distance"},
      {"clicked_point", "{clicks: -1}", "p/clicks = -1 (int)"},
      {"direction", "{threshold: 1}", "p/threshold: no such parameter"},
      {"direction", "{max_steps: 1, max_steps: 2}", "p/max_steps: given twice"},
      {"direction", "[1]", "p = a list: must be a dictionary"},
  };
  for (const auto& [name, yaml, message] : cases)
    EXPECT_NE(refusal(name, yaml).find(message), std::string::npos)
        << name << yaml << ": " << refusal(name, yaml);
  EXPECT_NO_THROW(
      make_task("pursuit", "{v_ratio: 0, diffusivity: 0, capture_between_steps: true}"));
}

// --- direction -----------------------------------------------------------------------------------

TEST(DirectionTask, StaysFarAwayInItsDirection) {
  const auto task = make_task("direction", "{direction: " + std::to_string(kPi / 3) + "}");
  task->reset(0, 1);
  for (const Vector2d& centroid : {Vector2d(0, 0), Vector2d(3, -7)}) {
    EXPECT_EQ(task->observe(centroid), Outcome::kRunning);
    expect_near(task->target(), centroid + Vector2d(500, 1000 * std::sqrt(0.75)), 1e-3);
  }
}

// --- waypoints -----------------------------------------------------------------------------------

TEST(WaypointsTask, StarHasTheTenPointsOfThePaper) {
  const auto points = make_task("waypoints")->waypoints();
  ASSERT_EQ(points.size(), 10u);
  const Vector2d centre(0.5, 0);  // R = 1 from the start (1.5, 0)
  for (int j = 1; j <= 10; ++j) {
    const double radius = j % 2 == 0 ? 1 : 0.382;
    expect_near(points[j - 1],
                centre + radius * Vector2d(std::cos(j * kPi / 5), std::sin(j * kPi / 5)), 1e-15);
  }
  expect_near(points[9], {1.5, 0}, 1e-15);
  const auto turned =
      make_task("waypoints", "{start_x: 2, radius: 2, rotation: 0.3, inner_ratio: 0.5}");
  expect_near(turned->waypoints()[9], {2.5, 0}, 1e-15);
  expect_near(turned->waypoints()[0] - Vector2d(2.5, 0),
              2 * (0.5 * Vector2d(std::cos(0.3 + kPi / 5), std::sin(0.3 + kPi / 5)) -
                   Vector2d(std::cos(0.3), std::sin(0.3))),
              1e-15);
}

TEST(WaypointsTask, RandomStarsKeepTheirShapeAndBounds) {
  const auto task = make_task("waypoints", "{random_star: true}");
  for (int episode = 1; episode <= 200; ++episode) {
    task->reset(1, episode);
    const auto points = task->waypoints();
    expect_near(points[9], {1.5, 0}, 1e-14);
    const Vector2d centre = (points[1] + points[3] + points[5] + points[7] + points[9]) / 5;
    const double radius = (points[1] - centre).norm();
    EXPECT_GE(radius, 0.7 - 1e-12);
    EXPECT_LE(radius, 1.3 + 1e-12);
    EXPECT_NEAR((points[0] - centre).norm(), 0.382 * radius, 1e-12);
  }
}

TEST(WaypointsTask, GoesOnOnceAPointIsReachedAndIsCapturedWithTheLast) {
  const auto task =
      make_task("waypoints", "{points: [[1, 0], [1.05, 0], [2, 0], [3, 0]], threshold: 0.1}");
  task->reset(0, 1);
  EXPECT_EQ(task->observe({0, 0}), Outcome::kRunning);
  EXPECT_EQ(task->target(), Vector2d(1, 0));
  EXPECT_EQ(task->waypoint(), 0u);
  task->observe({0.88, 0});
  EXPECT_EQ(task->waypoint(), 0u);
  task->observe({0.92, 0});
  EXPECT_EQ(task->waypoint(), 1u);
  EXPECT_EQ(task->target(), Vector2d(1.05, 0));
  task->observe({3, 0});  // not its turn
  EXPECT_EQ(task->waypoint(), 1u);
  task->observe({1.0, 0});
  EXPECT_EQ(task->waypoint(), 2u);
  EXPECT_EQ(task->observe({2, 0.05}), Outcome::kRunning);
  EXPECT_EQ(task->observe({3, 0.05}), Outcome::kCaptured);
  EXPECT_EQ(task->waypoint(), 4u);
  EXPECT_EQ(task->target(), Vector2d(3, 0));
  task->reset(0, 2);
  EXPECT_EQ(task->waypoint(), 0u);
  // Two points within the threshold count in one state.
  task->observe({1.02, 0});
  EXPECT_EQ(task->waypoint(), 2u);
}

// --- point ---------------------------------------------------------------------------------------

TEST(PointTask, LiesAtALogUniformDistanceAndAnyBearing) {
  const auto task = make_task("point", "{min_distance: 0.01, max_distance: 1.0}");
  constexpr int n = 2000;
  int near = 0, left = 0, below = 0;
  for (int episode = 1; episode <= n; ++episode) {
    task->reset(2, episode);
    const Vector2d target = task->waypoints().at(0);
    EXPECT_GE(target.norm(), 0.01);
    EXPECT_LE(target.norm(), 1.0);
    near += target.norm() < 0.1;  // half of the logarithms
    left += target.x() < 0;
    below += target.y() < 0;
  }
  // Five standard deviations of a fair coin.
  const double five = 5 * std::sqrt(n / 4.0);
  for (const int count : {near, left, below}) EXPECT_NEAR(count, n / 2, five);
}

TEST(PointTask, IsCapturedThere) {
  const auto task = make_task("point", "{threshold: 0.01}");
  task->reset(2, 1);
  const Vector2d target = task->waypoints().at(0);
  EXPECT_EQ(task->observe(target + Vector2d(0.011, 0)), Outcome::kRunning);
  EXPECT_EQ(task->target(), target);
  EXPECT_EQ(task->observe(target + Vector2d(0.009, 0)), Outcome::kCaptured);
  EXPECT_EQ(task->waypoint(), 1u);
}

// --- path ----------------------------------------------------------------------------------------

TEST(PathTask, CircleGoesRoundAtItsSpeed) {
  // 2 pi R = 2 pi in 100 steps of v dt = 2 pi / 100.
  const auto task =
      make_task("path", "{radius: 1, center_x: 2, center_y: 3, v_ratio: 1}", 2 * kPi / 100 / 0.1);
  const std::vector<Vector2d> round = targets(*task, 0, 1, 125);
  // A chain of 1000 pieces is shorter by 1e-5 of the circle.
  expect_near(round[0], {3, 3}, 1e-15);
  expect_near(round[25], {2, 4}, 2e-5);
  expect_near(round[50], {1, 3}, 4e-5);
  expect_near(round[125], {2, 4}, 1.3e-4);
}

TEST(PathTask, FigureEightCrossesItsCentre) {
  const auto task =
      make_task("path", "{curve: figure_eight, center_x: 0, center_y: 0, v_ratio: 1}", 0.01);
  const std::vector<Vector2d> way = targets(*task, 0, 1, 3500);
  EXPECT_EQ(way[0], Vector2d(0, 0));
  double length = 0, highest = 0, leftmost = 0;
  for (std::size_t k = 1; k < way.size(); ++k) {
    EXPECT_NEAR((way[k] - way[k - 1]).norm(), 0.001, 1e-6);
    length += (way[k] - way[k - 1]).norm();
    highest = std::max(highest, way[k].y());
    leftmost = std::min(leftmost, way[k].x());
  }
  EXPECT_NEAR(length, 3.5, 1e-3);  // once round is 6.0972 R = 3.0486
  EXPECT_NEAR(highest, 0.25, 1e-4);
  EXPECT_NEAR(leftmost, -0.5, 1e-4);
}

TEST(PathTask, ChainStopsAtItsEndUnlessItIsClosed) {
  const std::string points = "points: [[0, 0], [3, 0], [3, 4]]";
  const auto open = make_task("path", "{v_ratio: 1, " + points + "}", 10);  // 1 L a step
  const std::vector<Vector2d> way = targets(*open, 0, 1, 9);
  expect_near(way[2], {2, 0}, 1e-12);
  expect_near(way[5], {3, 2}, 1e-12);
  EXPECT_EQ(way[8], Vector2d(3, 4));
  EXPECT_EQ(way[9], Vector2d(3, 4));
  const auto closed = make_task("path", "{v_ratio: 1, closed: true, " + points + "}", 10);
  const std::vector<Vector2d> round = targets(*closed, 0, 1, 14);
  expect_near(round[9], {1.8, 2.4}, 1e-12);  // 2 of 5 back
  expect_near(round[14], {2, 0}, 1e-12);     // 12 once round
}

TEST(PathTask, EndsAtCaptureOnlyIfItShould) {
  for (const bool ends : {true, false}) {
    const auto task = make_task("path", "{v_ratio: 0, max_steps: 2, ends_at_capture: " +
                                            std::string(ends ? "true" : "false") + "}");
    task->reset(0, 1);
    EXPECT_EQ(task->observe(kFarAway), Outcome::kRunning);
    EXPECT_EQ(task->observe({2, 1}), ends ? Outcome::kCaptured : Outcome::kRunning);
  }
}

// --- clicked_point -------------------------------------------------------------------------------

TEST(ClickedPointTask, GoesWhereItIsTold) {
  const auto task = make_task("clicked_point", "{clicks: 2, threshold: 0.1}");
  EXPECT_TRUE(task->takes_points());
  task->reset(0, 1);
  EXPECT_EQ(task->observe({1.5, 0}), Outcome::kRunning);
  EXPECT_EQ(task->target(), Vector2d(1.5, 0));
  EXPECT_EQ(task->waypoint(), 0u);  // the start is no click
  task->take_point({2, 0});
  EXPECT_EQ(task->target(), Vector2d(2, 0));
  task->take_point({3, 0});
  EXPECT_EQ(task->observe({2, 0}), Outcome::kRunning);
  EXPECT_EQ(task->waypoint(), 0u);
  EXPECT_EQ(task->observe({3, 0}), Outcome::kRunning);
  EXPECT_EQ(task->waypoint(), 1u);
  EXPECT_EQ(task->observe({3, 0}), Outcome::kRunning);
  EXPECT_EQ(task->waypoint(), 1u);  // a point counts once
  task->take_point({4, 0});
  EXPECT_EQ(task->observe({4, 0}), Outcome::kCaptured);
}

// --- pursuit -------------------------------------------------------------------------------------

TEST(PursuitTask, StartsAsThePaperSays) {
  const auto task = make_task("pursuit", "{v_ratio: 0}");
  task->reset(0, 1);
  EXPECT_EQ(task->observe(kFarAway), Outcome::kRunning);
  EXPECT_EQ(task->target(), Vector2d(1.5, 0.5));
}

// Steps of n independent normals of variance s^2 = 2 D dt: the mean of n squares has the standard
// deviation s^2 sqrt(2 / n), the mean of n products of independent ones s^2 / sqrt(n), and the mean
// itself s / sqrt(n). Five of each are passed once in 1.7 million times; the seed is fixed.
TEST(PursuitTask, StepsHaveTheVarianceOfTheDiffusivity) {
  constexpr int kEpisodes = 20, kSteps = 5000, n = kEpisodes * kSteps;
  constexpr double v_m = 0.0128, variance = 2 * 5.0e-5 * 0.1;
  const Vector2d drift = v_m * 0.1 * Vector2d(std::sqrt(0.75), 0.5);
  const auto task = make_task("pursuit", "{v_ratio: 1}", v_m);
  double xx = 0, yy = 0, xy = 0, before = 0;
  Vector2d sum(0, 0), last(0, 0);
  for (int episode = 1; episode <= kEpisodes; ++episode) {
    const std::vector<Vector2d> way = targets(*task, 3, episode, kSteps);
    for (int k = 1; k <= kSteps; ++k) {
      const Vector2d step = way[k] - way[k - 1] - drift;
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

TEST(PursuitTask, GoesStraightOnWithoutDiffusion) {
  const auto task = make_task("pursuit", "{v_ratio: 2, diffusivity: 0}", 0.25);
  // 100 steps of 0.05 at 30 degrees; 100 roundings of numbers below 8.
  expect_near(targets(*task, 0, 1, 100).back(), {1.5 + 5 * std::sqrt(0.75), 0.5 + 5 * 0.5}, 1e-13);
}

TEST(PursuitTask, CapturesNearTheTargetInTheLastStateToo) {
  const auto task = make_task("pursuit", "{v_ratio: 0, diffusivity: 0, max_steps: 1}");
  task->reset(0, 1);
  EXPECT_EQ(task->observe({1.5, 0.5 - 0.0011}), Outcome::kRunning);
  EXPECT_EQ(task->observe({1.5, 0.5 - 0.0009}), Outcome::kCaptured);
}

// --- Plug-ins ------------------------------------------------------------------------------------

TEST(Plugins, ATaskOfAnotherPackageIsPlayedLikeOurOwn) {
  threelink_sim::load_plugins();
  const auto task = make_task("pendulum", "{amplitude: 2, period: 40, threshold: 0.1}");
  const std::vector<Vector2d> way = targets(*task, 0, 1, 300);
  EXPECT_EQ(way[0], Vector2d(1.5, 0.5));
  expect_near(way[100], {3.5, 0.5}, 1e-12);
  expect_near(way[300], {-0.5, 0.5}, 1e-12);
  EXPECT_NE(refusal("pendulum", "{periode: 40}").find("nearest one is p/period"),
            std::string::npos);
}

}  // namespace

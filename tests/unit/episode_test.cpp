// Whole episodes in one process.
#include "threelink_tasks/episode.hpp"

#include <stdexcept>
#include <vector>

#include <gtest/gtest.h>

#include "make_task.hpp"
#include "random_policy.hpp"

namespace {

using Eigen::Vector2d;
using threelink_sim::Environment;
using threelink_sim::EnvironmentConfig;
using threelink_tasks::EpisodeMeasures;
using threelink_tasks::EpisodeResult;
using threelink_tasks::EpisodeStep;
using threelink_tasks::Outcome;
using threelink_tests::make_task;
using threelink_tests::random_policy;

constexpr int kSteps = 200;

struct Played {
  EpisodeResult result;
  std::vector<EpisodeStep> steps;
};

Played play(std::uint64_t seed, bool sampled = false) {
  const auto task = make_task("pursuit", "{v_ratio: 0, max_steps: " + std::to_string(kSteps) + "}");
  Environment environment(EnvironmentConfig(), 1);
  const auto policy = random_policy(1);
  Played played;
  played.result =
      threelink_tasks::run_episode(*task, environment, policy, seed, 1, sampled,
                                   [&](const EpisodeStep& step) { played.steps.push_back(step); });
  return played;
}

TEST(EpisodeTest, ShowsEveryStateOnce) {
  const Played played = play(0);
  ASSERT_EQ(played.steps.size(), kSteps + 1u);
  for (std::size_t k = 0; k < played.steps.size(); ++k) {
    EXPECT_EQ(played.steps[k].step, k);
    EXPECT_EQ(played.steps[k].rates.size(), k < kSteps ? 2 : 0);
  }
  // x_1 = (1, 0) and straight: the centroid is half a swimmer on.
  EXPECT_NEAR((played.steps[0].state.centroid - Vector2d(1.5, 0)).norm(), 0, 1e-15);
  EXPECT_EQ(played.steps[0].state.heading, 0);
  EXPECT_EQ(played.steps[0].target, Vector2d(1.5, 0.5));

  EXPECT_EQ(played.result.outcome, Outcome::kTimedOut);
  const EpisodeStep& last = played.steps.back();
  EXPECT_EQ(played.result.measures.steps, kSteps);
  EXPECT_EQ(played.result.measures.distance, (last.target - last.state.centroid).norm());
}

TEST(EpisodeTest, RepeatsToTheBit) {
  for (const bool sampled : {false, true}) {
    const Played one = play(5, sampled), again = play(5, sampled), other = play(6, sampled);
    bool differs = false;
    for (std::size_t k = 0; k < one.steps.size(); ++k) {
      EXPECT_EQ(one.steps[k].state.centroid, again.steps[k].state.centroid);
      EXPECT_EQ(one.steps[k].state.heading, again.steps[k].state.heading);
      EXPECT_EQ(one.steps[k].state.alpha, again.steps[k].state.alpha);
      EXPECT_EQ(one.steps[k].target, again.steps[k].target);
      differs |= one.steps[k].state.centroid != other.steps[k].state.centroid;
    }
    EXPECT_TRUE(differs);
  }
  EXPECT_NE(play(5, false).steps[1].state.centroid, play(5, true).steps[1].state.centroid);
}

TEST(EpisodeTest, MeasuresTimeDistanceAndNetSpeed) {
  const EpisodeMeasures start = threelink_tasks::measure(0, 0.1, {1, 1}, {1, 1}, {4, 5});
  EXPECT_EQ(start.distance, 5);
  EXPECT_EQ(start.mean_speed, 0);
  const EpisodeMeasures later = threelink_tasks::measure(10, 0.5, {1, 1}, {1, 3}, {1, 4});
  EXPECT_EQ(later.steps, 10u);
  EXPECT_EQ(later.time, 5);
  EXPECT_EQ(later.distance, 1);
  EXPECT_EQ(later.mean_speed, 0.4);
}

TEST(EpisodeTest, RefusesWhatDoesNotFit) {
  const auto task = make_task("pursuit", "{v_ratio: 0}");
  const auto policy = random_policy(1);
  const auto ignore = [](const EpisodeStep&) {};
  Environment two_lanes(EnvironmentConfig(), 2);
  EXPECT_THROW(threelink_tasks::run_episode(*task, two_lanes, policy, 0, 1, false, ignore),
               std::invalid_argument);
  EnvironmentConfig four_links;
  four_links.model.links = 4;
  Environment longer(four_links, 1);
  EXPECT_THROW(threelink_tasks::run_episode(*task, longer, policy, 0, 1, false, ignore),
               std::invalid_argument);
}

}  // namespace

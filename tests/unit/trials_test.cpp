// Many episodes side by side are the episodes one by one, to the bit.
#include "threelink_tasks/trials.hpp"

#include <gtest/gtest.h>

#include "make_task.hpp"
#include "random_policy.hpp"

namespace {

using threelink_tasks::EpisodeStep;
using threelink_tasks::Outcome;
using threelink_tasks::Trial;
using threelink_tasks::TrialsConfig;
using threelink_tests::make_task;

struct Case {
  const char* task;
  const char* parameters;
  bool sampled;
};

// A policy that nobody trained, and wide thresholds: some are captured soon, others never.
const Case kCases[] = {
    {"point", "{threshold: 0.05, max_steps: 300}", false},
    {"point", "{threshold: 0.05, max_steps: 300}", true},
    {"waypoints", "{random_star: true, threshold: 0.45, max_steps: 400}", true},
    {"pursuit", "{v_ratio: 0.5, threshold: 0.4, max_steps: 400}", false},
};

TEST(Trials, HaveTheBitsOfSingleEpisodes) {
  const auto policy = threelink_tests::random_policy(4);
  for (const Case& c : kCases) {
    TrialsConfig config;
    config.seed = 6;
    config.trials = 37;
    config.sampled = c.sampled;
    config.lanes = 16;  // so that lanes are used again, and left over in the end
    const auto make = [&] { return make_task(c.task, c.parameters); };
    const std::vector<Trial> trials = run_trials(make, policy, config);
    ASSERT_EQ(trials.size(), 37u);
    int captured = 0;
    for (int i = 0; i < config.trials; ++i) {
      const auto task = make();
      threelink_sim::Environment environment(policy.metadata().environment(), 1);
      const auto single = threelink_tasks::run_episode(*task, environment, policy, config.seed,
                                                       i + 1, c.sampled, [](const EpisodeStep&) {});
      EXPECT_EQ(trials[i].outcome, single.outcome) << c.task << i;
      EXPECT_EQ(trials[i].measures.steps, single.measures.steps) << c.task << i;
      EXPECT_EQ(trials[i].measures.distance, single.measures.distance) << c.task << i;
      EXPECT_EQ(trials[i].measures.mean_speed, single.measures.mean_speed) << c.task << i;
      captured += single.outcome == Outcome::kCaptured;
    }
    if (c.task == std::string("point")) {
      EXPECT_GT(captured, 3);
      EXPECT_LT(captured, 34);
    }
  }
}

TEST(Trials, DoNotDependOnTheNumberOfLanes) {
  const auto policy = threelink_tests::random_policy(4);
  const auto make = [] { return make_task("point", "{threshold: 0.05, max_steps: 200}"); };
  TrialsConfig config;
  config.trials = 20;
  config.sampled = true;
  std::vector<std::vector<Trial>> all;
  for (const std::size_t lanes : {1, 3, 64}) {
    config.lanes = lanes;
    all.push_back(run_trials(make, policy, config));
  }
  for (int i = 0; i < config.trials; ++i)
    for (const auto& trials : all)
      EXPECT_EQ(trials[i].measures.distance, all[0][i].measures.distance) << i;
}

TEST(Trials, MeasureTheWayThroughTheWaypoints) {
  const auto policy = threelink_tests::random_policy(4);
  TrialsConfig config;
  config.trials = 1;
  const auto length = [&](const char* task, const char* parameters) {
    const auto make = [&] { return make_task(task, parameters); };
    return run_trials(make, policy, config)[0].path_length;
  };
  // From the centroid's start at (1.5, 0).
  EXPECT_NEAR(length("waypoints", "{points: [[4.5, 4], [4.5, 5]], max_steps: 1}"), 6, 1e-12);
  EXPECT_EQ(length("pursuit", "{v_ratio: 0, max_steps: 1}"), 0);
}

}  // namespace

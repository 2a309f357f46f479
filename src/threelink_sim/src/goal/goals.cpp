#include "threelink_sim/goal/goals.hpp"

#include <algorithm>

#include "goal_kinds.hpp"
#include "threelink_sim/nearest_name.hpp"
#include "threelink_sim/task/task_factory.hpp"

namespace threelink_sim {
namespace {

void begin_episode(Environment& environment, std::size_t i, std::uint64_t seed,
                   std::uint32_t episode) {
  environment.reset(i, random_start(environment.config(), seed, episode), {seed, episode});
}

class DirectionGoals : public Goals {
 public:
  explicit DirectionGoals(Environment& environment) : environment_(environment) {}

  void after_step(std::uint32_t /*k*/, float* rewards, std::uint8_t* captured) override {
    std::copy_n(environment_.rewards(), environment_.lanes(), rewards);
    std::fill_n(captured, environment_.lanes(), 0);
  }

 private:
  Environment& environment_;
};

}  // namespace

GoalConfig read_goal(ParameterMap& section, double dt) {
  GoalConfig goal;
  const std::string kind = section.text("kind");
  if (kind == "points") {
    PointsGoal::fields(goal.points.emplace(), FieldReader(section));
  } else if (kind != "direction" && section.has("kind")) {
    TaskGoal& task = goal.task.emplace();
    task.task = kind;
    if (!has_task(kind))
      section.refuse("kind",
                     "must be direction, points, or the name of a task; the nearest one is " +
                         nearest_name(kind, task_names()));
    TaskGoal::fields(task, FieldReader(section));
    const std::size_t own = section.effective_values().size();
    make_task(kind, section, {dt, task.v_m});
    const auto& values = section.effective_values();
    task.parameters.assign(values.begin() + own, values.end());
  }
  return goal;
}

std::unique_ptr<Goals> make_goals(const GoalConfig& config, std::uint64_t seed,
                                  std::uint32_t first_episode, Environment& environment) {
  if (config.task) return make_task_goals(*config.task, seed, first_episode, environment);
  for (std::size_t i = 0; i < environment.lanes(); ++i)
    begin_episode(environment, i, seed, first_episode + static_cast<std::uint32_t>(i));
  if (config.points) return make_points_goals(*config.points, seed, first_episode, environment);
  return std::make_unique<DirectionGoals>(environment);
}

}  // namespace threelink_sim

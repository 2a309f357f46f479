// A task as a goal: played over and over. Once the swimmer has done what it should, the task begins
// anew, and the swimmer is back at the start: attempt n of episode e is the task's episode
// e + n kAttempt. Its own time limit counts for nothing: that of the training ends the episode.
#include <utility>
#include <vector>

#include "goal_kinds.hpp"
#include "threelink_sim/task/task_factory.hpp"

namespace threelink_sim {
namespace {

// More than a training has episodes, so that attempts of different episodes are different.
constexpr std::uint32_t kAttempt = 100'000'007;

class TaskGoals : public Goals {
 public:
  TaskGoals(const TaskGoal& config, std::uint64_t seed, std::uint32_t first_episode,
            Environment& environment)
      : config_(config), seed_(seed), environment_(environment) {
    const YAML::Node values = YAML::Load(to_yaml(config.parameters));
    for (std::size_t i = 0; i < environment.lanes(); ++i) {
      ParameterMap parameters("goal", values);
      lanes_.push_back({make_task(config.task, parameters, {environment.config().dt, config.v_m}),
                        first_episode + static_cast<std::uint32_t>(i)});
      begin(i);
    }
  }

  void after_step(std::uint32_t /*k*/, float* rewards, std::uint8_t* captured) override {
    const double b = environment_.config().b, c = environment_.config().c;
    for (std::size_t i = 0; i < lanes_.size(); ++i) {
      Task& task = *lanes_[i].task;
      const double before = environment_.distance(i);
      const double work = environment_.effort(i);
      environment_.aim(i, task.target());
      const double now = environment_.distance(i);
      captured[i] = task.observe(environment_.centroid(i)) == Outcome::kCaptured;
      rewards[i] = static_cast<float>(b * (before - now) - c * work + captured[i] * config_.bonus);
      if (captured[i]) {
        lanes_[i].episode += kAttempt;
        begin(i);
      } else {
        environment_.aim(i, task.target());
      }
    }
  }

 private:
  struct Lane {
    std::unique_ptr<Task> task;
    std::uint32_t episode;  // the task's
  };

  void begin(std::size_t i) {
    auto& [task, episode] = lanes_[i];
    task->reset(seed_, episode);
    SwimmerState start = start_state(environment_.config(), task->start(), seed_, episode);
    if (config_.random_start) {
      const Eigen::Vector2d centroid = start.centroid;
      start = random_start(environment_.config(), seed_, episode);
      start.centroid = centroid;
    }
    environment_.reset(i, start, {seed_, episode});
    task->observe(environment_.centroid(i));
    environment_.aim(i, task->target());
  }

  TaskGoal config_;
  std::uint64_t seed_;
  Environment& environment_;
  std::vector<Lane> lanes_;
};

}  // namespace

std::unique_ptr<Goals> make_task_goals(const TaskGoal& config, std::uint64_t seed,
                                       std::uint32_t first_episode, Environment& environment) {
  return std::make_unique<TaskGoals>(config, seed, first_episode, environment);
}

}  // namespace threelink_sim

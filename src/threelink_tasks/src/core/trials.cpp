#include "threelink_tasks/trials.hpp"

#include <algorithm>

#include "play.hpp"
#include "threelink_agent/actor.hpp"

namespace threelink_tasks {
namespace {

using threelink_agent::ActionKey;
using threelink_agent::Policy;
using threelink_sim::Environment;

double path_length(const Task& task, Eigen::Vector2d from) {
  double length = 0;
  for (const Eigen::Vector2d& point : task.waypoints()) {
    length += (point - from).norm();
    from = point;
  }
  return length;
}

threelink_sim::EnvironmentConfig environment_of(const Policy& policy, const TrialsConfig& config) {
  threelink_sim::EnvironmentConfig environment = policy.metadata().environment();
  environment.world = config.world;
  return environment;
}

class Trials {
 public:
  Trials(const TaskMaker& make, const Policy& policy, const TrialsConfig& config)
      : config_(config),
        trials_(config.trials),
        lanes_(std::min<std::size_t>(config.lanes, config.trials)),
        environment_(environment_of(policy, config), lanes_.size()),
        actor_(policy) {
    require_fit(policy, environment_.config());
    for (std::size_t i = 0; i < lanes_.size(); ++i) {
      lanes_[i].task = make();
      start_next(i);
    }
  }

  std::vector<Trial> run() {
    while (true) {
      for (std::size_t i = 0; i < lanes_.size(); ++i)
        while (lanes_[i].playing && !observe(i)) start_next(i);
      const auto playing = std::count_if(lanes_.begin(), lanes_.end(),
                                         [](const Lane& lane) { return lane.playing; });
      if (playing == 0) return std::move(trials_);
      if (2 * static_cast<std::size_t>(playing) <= lanes_.size()) compact(playing);
      step();
    }
  }

 private:
  struct Lane {
    std::unique_ptr<Task> task;
    bool playing = false;
    std::uint32_t episode = 0;
    std::uint32_t step = 0;
    Eigen::Vector2d first_centroid = {0.0, 0.0};  // [L]
  };

  void start_next(std::size_t i) {
    Lane& lane = lanes_[i];
    lane.playing = started_ < static_cast<std::uint32_t>(config_.trials);
    if (!lane.playing) return;
    lane.episode = ++started_;
    lane.step = 0;
    lane.task->reset(config_.seed, lane.episode);
    environment_.reset(i,
                       threelink_sim::start_state(environment_.config(), lane.task->start(),
                                                  config_.seed, lane.episode),
                       {config_.seed, lane.episode});
    lane.first_centroid = environment_.centroid(i);
  }

  // False if the lane's episode is over.
  bool observe(std::size_t i) {
    Lane& lane = lanes_[i];
    const Eigen::Vector2d here = environment_.centroid(i);
    const Outcome outcome = lane.task->observe(here);
    const Eigen::Vector2d target = lane.task->target();
    if (outcome == Outcome::kRunning && !environment_.left_grid(i)) {
      environment_.aim(i, target);
      return true;
    }
    trials_[lane.episode - 1] = {
        outcome, measure(lane.step, environment_.config().dt, lane.first_centroid, here, target),
        path_length(*lane.task, lane.first_centroid)};
    return false;
  }

  // Those that play move together, into an environment of their number.
  void compact(std::size_t playing) {
    Environment smaller(environment_.config(), playing);
    std::vector<Lane> rest;
    for (std::size_t i = 0; i < lanes_.size(); ++i) {
      if (!lanes_[i].playing) continue;
      smaller.resume(rest.size(), environment_.batch().state(i), {config_.seed, lanes_[i].episode},
                     lanes_[i].step);
      smaller.set_direction(rest.size(), environment_.direction(i));
      smaller.aim(rest.size(), lanes_[i].task->target());
      rest.push_back(std::move(lanes_[i]));
    }
    lanes_ = std::move(rest);
    environment_ = std::move(smaller);
  }

  void step() {
    keys_.clear();
    for (const Lane& lane : lanes_) keys_.push_back({config_.seed, lane.episode, lane.step});
    environment_.step(actor_.act(environment_, config_.sampled ? keys_.data() : nullptr));
    for (Lane& lane : lanes_) ++lane.step;
  }

  TrialsConfig config_;
  std::vector<Trial> trials_;
  std::vector<Lane> lanes_;
  Environment environment_;
  std::uint32_t started_ = 0;  // episodes
  threelink_agent::Actor actor_;
  std::vector<ActionKey> keys_;
};

}  // namespace

std::vector<Trial> run_trials(const TaskMaker& make, const Policy& policy,
                              const TrialsConfig& config) {
  return Trials(make, policy, config).run();
}

}  // namespace threelink_tasks

#include "threelink_tasks/episode.hpp"

#include <stdexcept>
#include <vector>

#include <fmt/format.h>

#include "play.hpp"
#include "threelink_agent/actor.hpp"

namespace threelink_tasks {

EpisodeMeasures measure(std::uint64_t step, double dt, const Eigen::Vector2d& first_centroid,
                        const Eigen::Vector2d& centroid, const Eigen::Vector2d& target) {
  EpisodeMeasures measures;
  measures.steps = step;
  measures.time = static_cast<double>(step) * dt;
  measures.distance = (target - centroid).norm();
  if (step > 0) measures.mean_speed = (centroid - first_centroid).norm() / measures.time;
  return measures;
}

EpisodeResult run_episode(Task& task, threelink_sim::Environment& environment,
                          const threelink_agent::Policy& policy, std::uint64_t seed,
                          std::uint32_t episode, bool sampled,
                          const std::function<void(const EpisodeStep&)>& watch) {
  const threelink_sim::EnvironmentConfig& config = environment.config();
  if (environment.lanes() != 1)
    throw std::invalid_argument(
        fmt::format("lanes = {}: an episode is played in one", environment.lanes()));
  require_fit(policy, config);
  task.reset(seed, episode);
  environment.reset(0, threelink_sim::start_state(config, task.start(), seed, episode),
                    {seed, episode});

  threelink_agent::Actor actor(policy);
  EpisodeStep now{0, environment.batch().state(0), {}, {}};
  const Eigen::Vector2d first_centroid = now.state.centroid;
  while (true) {
    const Outcome outcome = task.observe(now.state.centroid);
    now.target = task.target();
    now.rates.resize(0);
    if (outcome == Outcome::kRunning) {
      environment.aim(0, now.target);
      const threelink_agent::ActionKey key{seed, episode, static_cast<std::uint32_t>(now.step)};
      const double* rates = actor.act(environment, sampled ? &key : nullptr);
      now.rates = threelink_sim::HingeVector::Map(rates, policy.hinges());
    }
    watch(now);
    if (outcome != Outcome::kRunning)
      return {outcome,
              measure(now.step, config.dt, first_centroid, now.state.centroid, now.target)};
    environment.step(now.rates.data());
    now.state = environment.batch().state(0);
    ++now.step;
  }
}

}  // namespace threelink_tasks

#include "threelink_tasks/episode.hpp"

#include <stdexcept>
#include <vector>

#include <fmt/format.h>

#include "threelink_sim/lockstep.hpp"

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
                          std::uint32_t episode,
                          const std::function<void(const EpisodeStep&)>& watch) {
  const threelink_sim::EnvironmentConfig& config = environment.config();
  if (environment.lanes() != 1)
    throw std::invalid_argument(
        fmt::format("lanes = {}: an episode is played in one", environment.lanes()));
  if (policy.hinges() != config.model.hinges() ||
      policy.observation_size() != direction_observation_size(config.model))
    throw std::invalid_argument(
        fmt::format("the policy turns {} numbers into {} rates: {} links have {} and {}",
                    policy.observation_size(), policy.hinges(), config.model.links,
                    direction_observation_size(config.model), config.model.hinges()));

  task.reset(seed, episode);
  const Start start = task.start();
  threelink_sim::HingeVector alpha = start.alpha;
  if (alpha.size() == 0) alpha.setZero(config.model.hinges());
  environment.reset(0, state_from_free_end(config.model, start.x_1, start.theta_1, alpha));

  std::vector<double> observation(policy.observation_size());
  EpisodeStep now{0, environment.batch().state(0), {}, {}};
  const Eigen::Vector2d first_centroid = now.state.centroid;
  while (true) {
    const Outcome outcome = task.observe(now.state.centroid);
    now.target = task.target();
    now.rates.resize(0);
    if (outcome == Outcome::kRunning) {
      environment.set_direction(0, threelink_sim::target_direction(now.state.centroid, now.target,
                                                                   environment.direction(0))
                                       .p);
      environment.observe(observation.data());
      now.rates.resize(policy.hinges());
      policy.act(observation.data(), now.rates.data());
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

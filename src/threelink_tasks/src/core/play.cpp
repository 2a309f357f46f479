#include "play.hpp"

#include <stdexcept>

#include <fmt/format.h>

#include "threelink_sim/lockstep.hpp"

namespace threelink_tasks {

void require_fit(const threelink_agent::Policy& policy,
                 const threelink_sim::EnvironmentConfig& config) {
  const int observation_size = direction_observation_size(config.model);
  if (policy.hinges() == config.model.hinges() && policy.observation_size() == observation_size)
    return;
  throw std::invalid_argument(
      fmt::format("the policy turns {} numbers into {} rates: {} links have {} and {}",
                  policy.observation_size(), policy.hinges(), config.model.links, observation_size,
                  config.model.hinges()));
}

threelink_sim::SwimmerState start_state(const threelink_sim::Model& model, const Start& start,
                                        std::uint64_t seed, std::uint32_t episode) {
  if (start.random) return random_start(model, seed, episode);
  threelink_sim::HingeVector alpha = start.alpha;
  if (alpha.size() == 0) alpha.setZero(model.hinges());
  return state_from_free_end(model, start.x_1, start.theta_1, alpha);
}

void aim(threelink_sim::Environment& environment, std::size_t i, const Eigen::Vector2d& target) {
  const auto to_target =
      threelink_sim::target_direction(centroid(environment, i), target, environment.direction(i));
  environment.set_direction(i, to_target.p);
}

}  // namespace threelink_tasks

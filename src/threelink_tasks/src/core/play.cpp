#include "play.hpp"

#include <stdexcept>

#include <fmt/format.h>

namespace threelink_tasks {

void require_fit(const threelink_agent::Policy& policy,
                 const threelink_sim::EnvironmentConfig& config) {
  const threelink_agent::PolicyMetadata& metadata = policy.metadata();
  if (metadata.links == config.model.links && metadata.observation == config.observation) return;
  throw std::invalid_argument(
      fmt::format("the policy takes the observation \"{}\" of {} links: here it is \"{}\" of {}",
                  to_string(metadata.observation), metadata.links, to_string(config.observation),
                  config.model.links));
}

threelink_sim::SwimmerState start_state(const threelink_sim::Model& model, const Start& start,
                                        std::uint64_t seed, std::uint32_t episode) {
  if (start.random) return random_start(model, seed, episode);
  threelink_sim::HingeVector alpha = start.alpha;
  if (alpha.size() == 0) alpha.setZero(model.hinges());
  return state_from_free_end(model, start.x_1, start.theta_1, alpha);
}

}  // namespace threelink_tasks

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

}  // namespace threelink_tasks

// What playing one episode and playing many have in common.
#pragma once

#include "threelink_agent/policy.hpp"
#include "threelink_sim/environment.hpp"
#include "threelink_tasks/task.hpp"

namespace threelink_tasks {

// Throws std::invalid_argument if the policy is for another swimmer or another observation.
void require_fit(const threelink_agent::Policy& policy,
                 const threelink_sim::EnvironmentConfig& config);

threelink_sim::SwimmerState start_state(const threelink_sim::Model& model, const Start& start,
                                        std::uint64_t seed, std::uint32_t episode);

// [L] centroid of lane i.
inline Eigen::Vector2d centroid(const threelink_sim::Environment& environment, std::size_t i) {
  return {environment.batch().x()[i], environment.batch().y()[i]};
}

}  // namespace threelink_tasks

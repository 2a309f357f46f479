// What playing one episode and playing many have in common.
#pragma once

#include "threelink_agent/policy.hpp"
#include "threelink_sim/environment.hpp"

namespace threelink_tasks {

// Throws std::invalid_argument if the policy is for another swimmer or another observation.
void require_fit(const threelink_agent::Policy& policy,
                 const threelink_sim::EnvironmentConfig& config);

}  // namespace threelink_tasks

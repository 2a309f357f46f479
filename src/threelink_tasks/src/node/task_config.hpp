// The task node's parameters; config/pursuit.yaml is their manual.
#pragma once

#include <cstdint>
#include <string>

#include "threelink_agent/policy.hpp"
#include "threelink_sim/node/simulator_config.hpp"
#include "threelink_tasks/pursuit.hpp"

namespace threelink_tasks {

struct TaskConfig {
  int episodes;
  std::uint64_t seed;
  bool record;           // wait for a recorder
  double start_timeout;  // [s] wall time, for what has to be there before an episode can start
  std::string policy_file;
  std::string policy_sha256;
  double v_m;      // [L/T0] speed of that policy
  double v_ratio;  // speed of the target / v_m
  PursuitParameters pursuit;
  threelink_sim::SimulatorConfig simulator;  // as the simulator's own parameters say

  // Everything above as YAML, for the record.
  std::string yaml() const;
};

// Throws ParameterError.
TaskConfig read_task_config(threelink_sim::Parameters& parameters);

}  // namespace threelink_tasks

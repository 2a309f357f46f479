// The task node's parameters, and what an episode is played with; config/pursuit.yaml and its
// siblings are the manual.
#pragma once

#include <cstdint>
#include <memory>
#include <string>

#include "threelink_sim/node/parameters.hpp"
#include "threelink_sim/node/simulator_config.hpp"
#include "threelink_tasks/task.hpp"

namespace threelink_tasks {

struct PolicyInfo {
  std::string file;
  std::string sha256;
  double v_m = 0;        // [L/T0] its speed
  bool sampled = false;  // how it is best played: with sampled actions, else with their mean
  threelink_sim::EnvironmentConfig swimmer;  // that it was trained for

  // Throws threelink_agent::PolicyError.
  static PolicyInfo of(const std::string& file);
};

// What an episode is played with.
struct Assignment {
  std::string name;  // of the task
  std::shared_ptr<Task> task;
  std::string parameters;  // of the task, effective, as lines of YAML
  std::uint64_t seed = 0;
  PolicyInfo policy;
};

struct PlayerConfig {
  int episodes = 1;          // 0: those that clients of the action ask for
  bool record = true;        // wait for a recorder
  double start_timeout = 0;  // [s] wall time, for what has to be there before an episode can start
  threelink_sim::SimulatorConfig simulator;  // as the simulator's own parameters say
  std::string surroundings;                  // simulator's and agent's parameters, as YAML
  bool allow_other_swimmer = false;          // than the one that a policy was trained for

  // Throws threelink_agent::PolicyError if the simulator's swimmer is another one, and may not be.
  void require_swimmer_of(const PolicyInfo& policy) const;
  // Everything as YAML, for the record: what make_task() and a replay need.
  std::string yaml(const Assignment& assignment) const;
};

struct TaskNodeConfig {
  PlayerConfig player;
  Assignment assignment;  // of the episodes that the node plays by itself
};

// Throws ParameterError.
TaskNodeConfig read_task_node_config(threelink_sim::Parameters& parameters);

// Fills name, task and parameters of an assignment whose policy is set. Calls finish(). Throws
// UsageError.
void assign_task(const std::string& name, threelink_sim::ParameterMap& parameters, double dt,
                 Assignment& assignment);

}  // namespace threelink_tasks

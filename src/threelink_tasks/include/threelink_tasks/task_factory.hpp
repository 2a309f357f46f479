// Tasks by name.
#pragma once

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include <yaml-cpp/yaml.h>

#include "threelink_tasks/task.hpp"

namespace threelink_tasks {

// Adds a task to those below; a name that is taken is given anew.
using TaskMaker = std::function<std::unique_ptr<Task>()>;
void register_task(const std::string& name, const TaskMaker& make);

// All names, sorted: those of this package, and what was registered.
std::vector<std::string> task_names();

// The task of that name, with its parameters taken; the caller calls parameters.finish(). Throws
// threelink_sim::UsageError that names the nearest task if there is none, and ParameterError.
std::unique_ptr<Task> make_task(const std::string& name, threelink_sim::ParameterMap& parameters,
                                const TaskContext& context);

// The task of an episode that was played, from threelink_msgs/Episode's `config`:
//   task:       name, seed, policy, v_m, and the task's parameters
//   simulator:  dt
// It has the same targets, to the bit.
std::unique_ptr<Task> make_task(const YAML::Node& config);

}  // namespace threelink_tasks

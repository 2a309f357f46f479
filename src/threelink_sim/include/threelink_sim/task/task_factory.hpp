/// @file
/// A registry of tasks by name.
#pragma once

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include <yaml-cpp/yaml.h>

#include "threelink_sim/task/task.hpp"

namespace threelink_sim {

/// Makes a task that is not configured yet.
using TaskMaker = std::function<std::unique_ptr<Task>()>;
/// Registers a task; a registered name is replaced.
void register_task(const std::string& name, const TaskMaker& make);

/// Adds a source of tasks: `find` is called once, when an unknown name or the list of names is
/// first requested, and registers the tasks that it finds.
void register_task_source(const std::function<void()>& find);

/// All names in alphabetical order: those of this package and the registered ones.
std::vector<std::string> task_names();

/// Whether a task of that name exists.
bool has_task(const std::string& name);

/// Makes and configures the task of that name; the caller then calls parameters.finish(). Throws
/// UsageError that names the nearest known task for an unknown name, and ParameterError.
std::unique_ptr<Task> make_task(const std::string& name, ParameterMap& parameters,
                                const TaskContext& context);

/// Makes the task of a recorded episode from `config` of threelink_msgs/Episode:
///   task:       name, seed, policy, v_m, and the task's parameters
///   simulator:  dt
/// It has the same targets to the bit.
std::unique_ptr<Task> make_task(const YAML::Node& config);

}  // namespace threelink_sim

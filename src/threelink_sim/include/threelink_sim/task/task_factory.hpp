/// @file
/// Tasks by name.
#pragma once

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include <yaml-cpp/yaml.h>

#include "threelink_sim/task/task.hpp"

namespace threelink_sim {

/// Adds a task to those below; a name that is taken is given anew.
using TaskMaker = std::function<std::unique_ptr<Task>()>;
void register_task(const std::string& name, const TaskMaker& make);

/// Where other tasks come from: `find` is called once, as soon as a name is asked for that is not
/// there, or all names, and registers what it finds.
void register_task_source(const std::function<void()>& find);

/// All names, sorted: those of this package, and what was registered.
std::vector<std::string> task_names();

bool has_task(const std::string& name);

/// The task of that name, with its parameters taken; the caller calls parameters.finish(). Throws
/// UsageError that names the nearest task if there is none, and ParameterError.
std::unique_ptr<Task> make_task(const std::string& name, ParameterMap& parameters,
                                const TaskContext& context);

/// The task of an episode that was played, from threelink_msgs/Episode's `config`:
///   task:       name, seed, policy, v_m, and the task's parameters
///   simulator:  dt
/// It has the same targets, to the bit.
std::unique_ptr<Task> make_task(const YAML::Node& config);

}  // namespace threelink_sim

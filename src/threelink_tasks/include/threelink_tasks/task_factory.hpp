/// @file
/// The registry of tasks under the names of this package.
#pragma once

#include "threelink_sim/task/task_factory.hpp"
#include "threelink_tasks/task.hpp"

namespace threelink_tasks {

using threelink_sim::make_task;
using threelink_sim::register_task;
using threelink_sim::task_names;
using threelink_sim::TaskMaker;

}  // namespace threelink_tasks

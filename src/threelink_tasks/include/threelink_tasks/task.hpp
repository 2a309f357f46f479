/// @file
/// The interface of a task under the names that plug-ins use.
#pragma once

#include "threelink_sim/task/task.hpp"

namespace threelink_tasks {

using threelink_sim::Outcome;
using threelink_sim::Start;
using threelink_sim::Task;
using threelink_sim::TaskContext;

}  // namespace threelink_tasks

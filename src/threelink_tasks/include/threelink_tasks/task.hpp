/// @file
/// What a task is; the names by which task plug-ins know it.
#pragma once

#include "threelink_sim/task/task.hpp"

namespace threelink_tasks {

using threelink_sim::Outcome;
using threelink_sim::Start;
using threelink_sim::Task;
using threelink_sim::TaskContext;

}  // namespace threelink_tasks

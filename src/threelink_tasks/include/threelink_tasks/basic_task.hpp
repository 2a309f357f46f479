/// @file
/// The base class of tasks under the names that plug-ins use.
#pragma once

#include "threelink_sim/task/basic_task.hpp"
#include "threelink_tasks/task.hpp"

namespace threelink_tasks {

using threelink_sim::BasicTask;
using threelink_sim::Capture;
using threelink_sim::CaptureParameters;
using threelink_sim::kPosition;
using threelink_sim::segment_distance;
using threelink_sim::unit_vector;

}  // namespace threelink_tasks

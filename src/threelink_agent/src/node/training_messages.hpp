// The messages of a distributed training as what the core knows them for.
#pragma once

#include <ros/time.h>
#include <threelink_msgs/EpisodeBatch.h>
#include <threelink_msgs/WorkerStatus.h>

#include "threelink_agent/distributed/episode_batch.hpp"
#include "threelink_agent/distributed/worker_roster.hpp"

namespace threelink_agent {

WorkerStatus from_message(const threelink_msgs::WorkerStatus& message);
threelink_msgs::WorkerStatus to_message(const WorkerStatus& status);

// Both move the arrays.
EpisodeBatch from_message(threelink_msgs::EpisodeBatch&& message);
threelink_msgs::EpisodeBatch to_message(EpisodeBatch&& batch);

// A training may run beside simulation time, or without any: its stamps are wall time.
ros::Time wall_time();

}  // namespace threelink_agent

// The topic training_status: after each update, and once a second of wall time.
#pragma once

#include <functional>

#include <ros/node_handle.h>
#include <ros/publisher.h>
#include <ros/steady_timer.h>
#include <threelink_msgs/TrainingStatus.h>

#include "progress.hpp"
#include "threelink_agent/training/trainer.hpp"
#include "threelink_sim/mutex.hpp"

namespace threelink_agent {

class StatusPublisher {
 public:
  // add_workers fills in what the message says of workers; called from several threads.
  explicit StatusPublisher(std::function<void(threelink_msgs::TrainingStatus&)> add_workers);

  // The arguments are those of RunHooks::on_update.
  void on_update(const Trainer& trainer, const UpdateReport* report, const Progress& progress);

  // As of now; `updates` is 0 as long as the training has not begun.
  threelink_msgs::TrainingStatus status() const;

 private:
  void publish();

  std::function<void(threelink_msgs::TrainingStatus&)> add_workers_;
  mutable threelink_sim::Mutex mutex_;  // of status_
  threelink_msgs::TrainingStatus status_ GUARDED_BY(mutex_);
  ros::NodeHandle node_;
  ros::Publisher publisher_;
  ros::SteadyTimer timer_;
};

}  // namespace threelink_agent

// What ties a training to its workers over topics; docs/distributed.md has the protocol.
#pragma once

#include <memory>
#include <mutex>

#include <ros/node_handle.h>
#include <ros/spinner.h>
#include <ros/steady_timer.h>
#include <threelink_msgs/EpisodeBatch.h>
#include <threelink_msgs/TrainingStatus.h>
#include <threelink_msgs/WorkerStatus.h>

#include "progress.hpp"
#include "threelink_agent/distributed/remote_rollouts.hpp"
#include "threelink_agent/training/trainer.hpp"
#include "threelink_sim/node/diagnostics.hpp"

namespace threelink_agent {

// The training runs in the thread of its owner; messages, timers and diagnostics in another one.
class Learner : private RemoteRollouts::Wire {
 public:
  Learner(const TrainConfig& config, const RemoteRollouts::Settings& settings);
  ~Learner() override;

  RolloutSource& rollouts() { return rollouts_; }

  // report: of the last update; null before the first one of this process.
  void on_update(const Trainer& trainer, const UpdateReport* report, const Progress& progress);

 private:
  using Diagnostics = threelink_sim::Diagnostics;

  void send_policy(std::uint64_t version, const std::string& bytes) override;
  void send(std::uint64_t session, const Update& update,
            const Dispatcher::Sending& sending) override;

  void on_worker(const threelink_msgs::WorkerStatus& message);
  void on_episodes(const boost::shared_ptr<threelink_msgs::EpisodeBatch>& message);
  void publish_status();
  void report(Diagnostics::Status& status);

  RemoteRollouts rollouts_;
  std::mutex mutex_;  // of status_
  threelink_msgs::TrainingStatus status_;

  ros::NodeHandle node_;
  Diagnostics diagnostics_;
  ros::Publisher policy_publisher_, leases_publisher_, status_publisher_;
  ros::Subscriber worker_subscriber_, episodes_subscriber_;
  ros::SteadyTimer status_timer_;
  ros::AsyncSpinner spinner_;
};

}  // namespace threelink_agent

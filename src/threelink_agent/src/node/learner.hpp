// What ties a training to its workers over topics; docs/distributed.md has the protocol.
#pragma once

#include <array>
#include <functional>

#include <ros/node_handle.h>
#include <threelink_msgs/EpisodeBatch.h>
#include <threelink_msgs/WorkerStatus.h>

#include "run_training.hpp"
#include "status_publisher.hpp"
#include "threelink_agent/distributed/remote_rollouts.hpp"
#include "threelink_sim/node/diagnostics.hpp"
#include "threelink_sim/node/intake.hpp"
#include "threelink_sim/node/parameters.hpp"

namespace threelink_agent {

// ~worker_timeout, ~lease_timeout, ~lease_episodes and ~replay.
RemoteRollouts::Settings read_remote_settings(threelink_sim::Parameters& given);

// Raises the soft limit of open files to the hard one, for a worker takes four connections; to be
// called first in main(), since roscpp looks at the limit when it starts.
void allow_many_connections();

// Says which machines can connect to this node.
void log_reach();

// Serves in the global callback queue, while the training runs in a thread of its own.
class Learner : public RolloutSource, private RemoteRollouts::Wire {
 public:
  Learner(const TrainConfig& config, const RemoteRollouts::Settings& settings,
          std::function<bool()> keep_going);

  Rollout play(const Play& play, int episodes) override { return rollouts_.play(play, episodes); }
  StatusPublisher& status() { return status_publisher_; }

 private:
  using Diagnostics = threelink_sim::Diagnostics;

  void send_policy(std::uint64_t version, const std::string& bytes) override;
  void send(std::uint64_t session, const Update& update,
            const Dispatcher::Sending& sending) override;

  void on_worker(const ros::MessageEvent<threelink_msgs::WorkerStatus const>& event);
  void on_episodes(const ros::MessageEvent<threelink_msgs::EpisodeBatch const>& event);
  void add_workers(threelink_msgs::TrainingStatus& status);
  void report(Diagnostics::Status& status);

  RemoteRollouts rollouts_;
  StatusPublisher status_publisher_;
  ros::NodeHandle node_;
  Diagnostics diagnostics_;
  Diagnostics::Counter& strange_statuses_;
  Diagnostics::Counter& refused_statuses_;
  std::array<threelink_sim::QuietLog, kVerdicts> batch_logs_;
  threelink_sim::QuietLog aside_log_;
  ros::Publisher policy_publisher_, leases_publisher_;
  ros::Subscriber worker_subscriber_, episodes_subscriber_;
};

}  // namespace threelink_agent

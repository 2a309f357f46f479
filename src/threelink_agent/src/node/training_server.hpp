// The action `train`: trainings that clients ask for, one at a time.
#pragma once

#include <condition_variable>
#include <functional>
#include <optional>
#include <string>

#include <actionlib/server/action_server.h>
#include <ros/callback_queue.h>
#include <ros/spinner.h>
#include <threelink_msgs/TrainAction.h>

#include "run_training.hpp"
#include "threelink_agent/distributed/remote_rollouts.hpp"
#include "threelink_sim/mutex.hpp"
#include "threelink_sim/node/diagnostics.hpp"
#include "threelink_sim/node/quiet_log.hpp"

namespace threelink_agent {

// A goal is accepted once its settings and its folder are found good, and rejected otherwise, or
// while another training runs: that one may have worked for hours.
class TrainingServer {
 public:
  // plot: draw learning_curve.png at the end of each.
  TrainingServer(int threads, bool plot, const RemoteRollouts::Settings& remote);

  // Trains what is asked for until the node has to end; returns the exit status.
  int run();

 private:
  using Server = actionlib::ActionServer<threelink_msgs::TrainAction>;
  using Goal = Server::GoalHandle;
  using Result = threelink_msgs::TrainResult;
  using Diagnostics = threelink_sim::Diagnostics;

  void on_goal(Goal goal);
  void on_cancel(const Goal& goal);
  void report(Diagnostics::Status& status);

  std::optional<Goal> next();  // waits a while for it
  // Returns what tells the client how it ended.
  std::function<void()> train(Goal goal);
  bool keep_going();

  RunSettings settings_of(const threelink_msgs::TrainGoal& goal) const;

  int threads_;
  bool plot_;
  RemoteRollouts::Settings remote_;
  threelink_sim::Mutex mutex_;  // of goal_ and cancelled_
  std::condition_variable_any changed_;
  std::optional<Goal> goal_
      GUARDED_BY(mutex_);  // until its training has ended, and before its client knows
  bool cancelled_ GUARDED_BY(mutex_) = false;
  Diagnostics diagnostics_;
  threelink_sim::QuietLog rejected_log_, failed_log_;
  ros::CallbackQueue queue_;
  std::optional<Server> server_;
  ros::AsyncSpinner spinner_;
};

}  // namespace threelink_agent

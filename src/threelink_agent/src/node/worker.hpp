// The worker node: plays leased episodes; docs/distributed.md has the protocol.
#pragma once

#include <chrono>
#include <condition_variable>
#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <string>

#include <ros/node_handle.h>
#include <ros/spinner.h>
#include <ros/steady_timer.h>
#include <threelink_msgs/Leases.h>
#include <threelink_msgs/PolicyWeights.h>

#include "threelink_agent/distributed/lease_player.hpp"
#include "threelink_agent/distributed/worker_roster.hpp"
#include "threelink_sim/mutex.hpp"
#include "threelink_sim/node/diagnostics.hpp"
#include "threelink_sim/node/intake.hpp"

namespace threelink_agent {

// It holds one lease at most, and nothing that would be missed: it can be killed at any moment.
class Worker {
 public:
  // source: where its episodes are played, by so many threads; learner: namespace of the learner's
  // topics; step_cost [us] of sleep for each environment step, for tests of scaling.
  Worker(std::unique_ptr<RolloutSource> source, int threads, const std::string& learner = "",
         double step_cost = 0);
  ~Worker();

  // Plays until the node has to end.
  int run();

 private:
  using Diagnostics = threelink_sim::Diagnostics;

  using Clock = std::chrono::steady_clock;

  // A node that publishes policies and leases. There is one learner; what strangers say stands
  // beside it, and is played only if it is a policy and a lease that fit together, in turns.
  struct Learner {
    std::string policy_bytes, policy;      // the newest, and its sha256
    std::optional<Assignment> assignment;  // not begun
    std::uint64_t session = 0;             // of the leases heard last
    std::string refused;                   // why it gives no leases
    Clock::time_point heard, played;       // when it said something, and when a lease was begun
    bool ready() const { return assignment && assignment->policy == policy; }
  };

  void on_policy(const ros::MessageEvent<threelink_msgs::PolicyWeights const>& event);
  void on_leases(const ros::MessageEvent<threelink_msgs::Leases const>& event);
  Learner& learner(const std::string& name) REQUIRES(mutex_);
  std::map<std::string, Learner>::iterator next_learner() REQUIRES(mutex_);
  void tell_what_is_held() REQUIRES(mutex_);
  void publish_status();
  void report(Diagnostics::Status& status, double seconds);

  // The next lease, once its policy is there; nothing if none came for a while.
  std::optional<Assignment> next();
  EpisodeBatch play(const Assignment& assignment);
  void hand_in(EpisodeBatch&& batch);

  LeasePlayer player_;
  double step_cost_;
  threelink_sim::QuietLog given_back_log_;

  threelink_sim::Mutex mutex_;  // of all down to given_back_
  std::condition_variable_any changed_;
  WorkerStatus status_ GUARDED_BY(mutex_);
  std::map<std::string, Learner> learners_ GUARDED_BY(mutex_);  // by the name of the node
  std::optional<Assignment> playing_ GUARDED_BY(mutex_);
  std::string playing_for_ GUARDED_BY(mutex_);  // name of its learner
  std::string given_back_ GUARDED_BY(mutex_);   // why the last lease was; empty if it was played
  threelink_sim::QuietLog refused_log_ GUARDED_BY(mutex_);
  threelink_sim::QuietLog load_log_ GUARDED_BY(mutex_);

  ros::NodeHandle node_;
  Diagnostics diagnostics_;
  Diagnostics::Counter& leases_given_back_;
  ros::Publisher status_publisher_, episodes_publisher_;
  ros::Subscriber policy_subscriber_, leases_subscriber_;
  ros::SteadyTimer status_timer_;
  ros::AsyncSpinner spinner_;
};

}  // namespace threelink_agent

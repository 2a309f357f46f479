// The agent node: a policy behind topics. It keeps no state between observations, so that it can be
// restarted at any moment and answers a repeated observation as before.
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include <ros/node_handle.h>
#include <ros/steady_timer.h>
#include <threelink_msgs/HingeRates.h>
#include <threelink_msgs/LoadPolicy.h>
#include <threelink_msgs/Observation.h>
#include <threelink_msgs/PolicyWeights.h>

#include "latency.hpp"
#include "swimmers.hpp"
#include "threelink_agent/policy.hpp"
#include "threelink_sim/mutex.hpp"
#include "threelink_sim/node/diagnostics.hpp"
#include "threelink_sim/node/direct_queue.hpp"
#include "threelink_sim/node/intake.hpp"

namespace threelink_agent {

struct AgentConfig {
  std::optional<bool> sampled;       // draw actions, or take their mean; else as each policy says
  std::uint64_t seed = 0;            // keys what is drawn
  bool follow = false;               // new policies play from the next episode on, not at once
  bool allow_other_swimmer = false;  // than the one that a policy was trained for
};

class Agent {
 public:
  // source: where the policy came from, for diagnostics.
  Agent(Policy policy, const std::string& source, const AgentConfig& config);

 private:
  using Diagnostics = threelink_sim::Diagnostics;

  // Answers without allocating, but for what roscpp does.
  void on_observation(const ros::MessageEvent<const threelink_msgs::Observation>& event);
  void on_policy(const threelink_msgs::PolicyWeights::ConstPtr& weights);
  void load(const threelink_msgs::PolicyWeights& weights);
  void on_load(threelink_sim::IntakeOfService<threelink_msgs::LoadPolicy>::Event& call);

  bool acceptable(const threelink_msgs::Observation& observation, const std::string& refusal)
      REQUIRES(mutex_);
  // Puts the policy that load() returns in the place of the old one, unless load() throws or it is
  // for another swimmer; returns what became of it.
  template <class Load>
  bool replace(const std::string& source, Load load, std::string& status);
  void put_in_use(Policy policy, const std::string& source) REQUIRES(mutex_);
  void look_for_the_simulator();
  void report(Diagnostics::Status& status, double seconds);

  // A training publishes many policies a second: one that follows looks at the newest, at times.
  // The node's own thread alone uses it.
  threelink_msgs::PolicyWeights::ConstPtr newest_;

  // Observations are answered in roscpp's network thread (see direct_queue.hpp), all else in the
  // node's own: this guards what both use, down to rates_.
  threelink_sim::Mutex mutex_;
  AgentConfig config_;
  Policy policy_ GUARDED_BY(mutex_);
  std::string source_ GUARDED_BY(mutex_);
  Swimmers swimmers_ GUARDED_BY(mutex_);
  struct Successor {
    Policy policy;
    std::string source;
  };
  std::optional<Successor> next_ GUARDED_BY(mutex_);    // with the next episode
  std::string refused_observation_ GUARDED_BY(mutex_);  // why the last one was; empty if it was not
  std::string refused_policy_ GUARDED_BY(mutex_);
  threelink_sim::QuietLog swimmer_log_ GUARDED_BY(mutex_);
  threelink_sim::QuietLog kind_log_ GUARDED_BY(mutex_);
  threelink_sim::QuietLog frame_log_ GUARDED_BY(mutex_);
  threelink_sim::QuietLog length_log_ GUARDED_BY(mutex_);
  threelink_sim::QuietLog range_log_ GUARDED_BY(mutex_);
  threelink_sim::QuietLog policy_log_ GUARDED_BY(mutex_);

  threelink_msgs::HingeRates rates_ GUARDED_BY(mutex_);  // filled anew for each observation
  std::uint64_t answers_ GUARDED_BY(mutex_) = 0;         // since the last report
  threelink_sim::Peer simulator_
      GUARDED_BY(mutex_);                  // whose observations count; any node's until it is known
  bool heard_ GUARDED_BY(mutex_) = false;  // the simulator, since it was looked for
  Latency latency_ GUARDED_BY(mutex_);     // likewise, from callback to published

  threelink_sim::DirectQueue direct_queue_;
  ros::NodeHandle node_;
  Diagnostics diagnostics_;
  Diagnostics::Counter& other_swimmer_;
  Diagnostics::Counter& wrong_kind_;
  Diagnostics::Counter& wrong_frame_;
  Diagnostics::Counter& strange_;
  Diagnostics::Counter& wrong_length_;
  Diagnostics::Counter& out_of_range_;
  Diagnostics::Counter& refused_policies_;
  Diagnostics::Counter& loaded_policies_;
  ros::Publisher rates_publisher_;
  ros::Subscriber observation_subscriber_, policy_subscriber_;
  ros::ServiceServer load_server_;
  ros::SteadyTimer follow_timer_, simulator_timer_;
};

}  // namespace threelink_agent

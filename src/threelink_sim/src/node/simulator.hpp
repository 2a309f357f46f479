// The simulator node: the swimmer behind topics. Physics is Environment's, order is Lockstep's;
// here is only what turns messages into calls and back.
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include <geometry_msgs/PointStamped.h>
#include <ros/message_event.h>
#include <ros/node_handle.h>
#include <tf2_ros/transform_broadcaster.h>
#include <threelink_msgs/Episode.h>
#include <threelink_msgs/HingeRates.h>
#include <threelink_msgs/Observation.h>
#include <threelink_msgs/Reset.h>
#include <threelink_msgs/SwimmerState.h>

#include "threelink_sim/mutex.hpp"
#include "threelink_sim/node/diagnostics.hpp"
#include "threelink_sim/node/direct_queue.hpp"
#include "threelink_sim/node/intake.hpp"
#include "threelink_sim/node/simulator_config.hpp"
#include "threelink_sim/node/swimmer_view.hpp"
#include "threelink_sim/node/throttle.hpp"
#include "threelink_sim/node/world_view.hpp"

namespace threelink_sim {

class Simulator {
 public:
  explicit Simulator(const SimulatorConfig& config);

  // Serves until the node has to end; returns the exit status.
  int run();

 private:
  using Time = Lockstep::Time;

  // Messages refused, by reason.
  class Refusals {
   public:
    Refusals(Diagnostics& diagnostics, const std::string& topic,
             const std::vector<Verdict>& reasons);
    // Counts the verdict; true if it is kAccepted.
    bool accept(Verdict verdict);

   private:
    std::map<Verdict, Diagnostics::Counter*> counters_;
  };

  template <class Message>
  using Event = ros::MessageEvent<Message const>;
  void on_reset(IntakeOfService<threelink_msgs::Reset>::Event& call);
  void on_target(const Event<geometry_msgs::PointStamped>& event);
  void on_rates(const Event<threelink_msgs::HingeRates>& event);
  void on_episode(const Event<threelink_msgs::Episode>& event);

  // Whether another node than `caller` plays an episode, and has said so.
  bool taken(const std::string& caller) const REQUIRES(mutex_);
  SwimmerState start_state(const threelink_msgs::Reset::Request& request) const REQUIRES(mutex_);
  // What is due: the step, the end of the patience with a silent peer, throttled output.
  void act() REQUIRES(mutex_);
  Time deadline() const REQUIRES(mutex_);
  void step(Time now) REQUIRES(mutex_);
  void abort_for_silence() REQUIRES(mutex_);
  // Ends the episode for a reason; `peer`: the topic on which somebody was silent, or empty.
  void abort(const std::string& peer, const std::string& reason) REQUIRES(mutex_);
  void publish_state() REQUIRES(mutex_);
  void publish_observation() REQUIRES(mutex_);
  void publish_standard() REQUIRES(mutex_);
  void publish_clock() REQUIRES(mutex_);
  void report(Diagnostics::Status& status, double seconds);

  // Guards all below: the main thread serves deadlines, service and diagnostics; the lock-step's
  // messages come in it too, or in the network thread when there is no pace to keep.
  Mutex mutex_;
  DirectQueue direct_queue_;

  SimulatorConfig config_;
  Environment environment_ GUARDED_BY(mutex_);
  Lockstep lockstep_ GUARDED_BY(mutex_);

  ros::NodeHandle node_;
  Diagnostics diagnostics_;
  Refusals refused_rates_, refused_targets_;
  Diagnostics::Counter& foreign_frames_;
  Diagnostics::Counter& strange_targets_;
  Diagnostics::Counter& strange_rates_;
  Diagnostics::Counter& strange_ends_;
  Diagnostics::Counter& refused_resets_;
  Diagnostics::Counter& watchdog_steps_;
  Diagnostics::Counter& aborts_;
  std::uint64_t steps_ = 0;             // since the last report
  std::uint64_t steps_in_contact_ = 0;  // likewise
  std::string abort_reason_;            // of the last episode; empty if it was not aborted

  // Of the episode: the node that began it, whether that has announced it on `episode`, and those
  // whose targets and hinge rates count.
  std::string owner_;
  bool announced_ = false;
  Peer task_, agent_;

  ros::Publisher clock_publisher_, state_publisher_, world_state_publisher_, observation_publisher_,
      joint_publisher_, pose_publisher_, abort_publisher_;
  tf2_ros::TransformBroadcaster transform_publisher_;
  SwimmerView view_;
  std::optional<WorldView> world_view_;  // if there is a world
  Throttle standard_throttle_, display_throttle_;

  // Filled anew for each step.
  threelink_msgs::SwimmerState state_;
  threelink_msgs::WorldState world_state_;
  threelink_msgs::Observation observation_;
  sensor_msgs::JointState joints_;
  geometry_msgs::PoseStamped pose_;
  geometry_msgs::TransformStamped transform_;

  ros::Subscriber target_subscriber_, rates_subscriber_, episode_subscriber_;
  ros::ServiceServer reset_server_;
};

}  // namespace threelink_sim

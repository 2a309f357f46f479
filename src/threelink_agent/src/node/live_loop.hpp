// Training episodes over the topics of the lock-step: played by the simulator node, or by a robot
// that speaks the same topics. This is agent and task in one.
#pragma once

#include <chrono>
#include <condition_variable>
#include <cstdint>
#include <optional>
#include <string>

#include <geometry_msgs/PointStamped.h>
#include <ros/node_handle.h>
#include <threelink_msgs/Episode.h>
#include <threelink_msgs/EpisodeAbort.h>
#include <threelink_msgs/HingeRates.h>
#include <threelink_msgs/Observation.h>
#include <threelink_msgs/Reset.h>
#include <threelink_msgs/SwimmerState.h>

#include "threelink_agent/distributed/live_episode.hpp"
#include "threelink_agent/training/rollout_source.hpp"
#include "threelink_sim/mutex.hpp"
#include "threelink_sim/node/diagnostics.hpp"
#include "threelink_sim/node/direct_queue.hpp"
#include "threelink_sim/node/intake.hpp"
#include "threelink_sim/node/simulator_config.hpp"

namespace threelink_agent {

struct LiveLoopConfig {
  std::string simulator;       // name of the node whose parameters say what swimmer there is
  bool exact = true;           // episodes must be those of collect(), to the bit
  double start_tolerance = 0;  // [rad] of each hinge angle at the start, if not exact
  double reset_timeout = 0;    // [s] wall time, for the start state to be taken
};

class LiveLoop : public RolloutSource {
 public:
  explicit LiveLoop(const LiveLoopConfig& config);

  // One episode after the other. Throws NoRollout with the first one that cannot be played to its
  // end, and Interrupted when the node has to end. Needs somebody who serves the global callback
  // queue.
  Rollout play(const Play& play, int episodes) override;
  // Whether somebody is there to play with.
  bool ready() override;

 private:
  using Clock = std::chrono::steady_clock;
  using Diagnostics = threelink_sim::Diagnostics;

  void check_swimmer(const Play& play);
  void expect_peers();
  void play_episode(const Play& play, int i, Rollout& rollout);
  threelink_msgs::SwimmerState reset(const threelink_sim::SwimmerState& start);
  // Turns the target, so that the swimmer is seen from the demanded side of it.
  void take_start(const threelink_sim::SwimmerState& demanded,
                  const threelink_msgs::SwimmerState& found) REQUIRES(mutex_);
  void wait_for_the_end();

  template <class Message>
  using Event = ros::MessageEvent<Message const>;
  void on_state(const Event<threelink_msgs::SwimmerState>& event);
  void on_observation(const Event<threelink_msgs::Observation>& event);
  void on_abort(const Event<threelink_msgs::EpisodeAbort>& event);
  void answer(const threelink_msgs::SwimmerState& state) REQUIRES(mutex_);
  bool accept(LiveEpisode::Verdict verdict, const char* what, std::uint64_t step) REQUIRES(mutex_);
  void give_up(const std::string& reason) REQUIRES(mutex_);
  void publish_episode(std::uint8_t status, const std::string& reason = "") REQUIRES(mutex_);
  void report(Diagnostics::Status& status, double seconds);

  LiveLoopConfig config_;
  threelink_sim::SimulatorConfig simulator_;

  // States and observations are answered in roscpp's network thread, play() waits in its caller's,
  // all else is in the node's own. Guards all down to target_.
  threelink_sim::Mutex mutex_;
  std::condition_variable_any changed_;                     // the episode is done, or given up
  std::optional<LiveEpisode> episode_ GUARDED_BY(mutex_);   // while it is played
  threelink_msgs::Episode description_ GUARDED_BY(mutex_);  // of it, or of the last one
  std::string given_up_ GUARDED_BY(mutex_);                 // why; empty if it was not
  Clock::time_point heard_ GUARDED_BY(mutex_);
  threelink_sim::Peer state_peer_ GUARDED_BY(mutex_);  // of this lease
  threelink_sim::Peer observation_peer_ GUARDED_BY(mutex_);
  threelink_sim::Peer abort_peer_ GUARDED_BY(mutex_);
  std::uint64_t steps_ GUARDED_BY(mutex_) = 0;             // since the last report
  Eigen::Vector2d to_target_ GUARDED_BY(mutex_);           // [L]
  threelink_msgs::HingeRates rates_ GUARDED_BY(mutex_);    // filled anew for each observation
  geometry_msgs::PointStamped target_ GUARDED_BY(mutex_);  // likewise

  threelink_sim::DirectQueue direct_queue_;
  ros::NodeHandle node_;
  Diagnostics diagnostics_;
  Diagnostics::Counter& played_;
  Diagnostics::Counter& episodes_given_up_;
  Diagnostics::Counter& refused_states_;
  Diagnostics::Counter& refused_observations_;
  Diagnostics::Counter& strange_states_;
  Diagnostics::Counter& strange_observations_;
  Diagnostics::Counter& strange_aborts_;
  ros::Publisher target_publisher_, rates_publisher_, episode_publisher_;
  ros::Subscriber state_subscriber_, observation_subscriber_, abort_subscriber_;
  ros::ServiceClient reset_;
};

}  // namespace threelink_agent

// Plays a task over topics, episode by episode: the task node's side of the lock-step.
#pragma once

#include <chrono>
#include <functional>
#include <optional>
#include <string>

#include <geometry_msgs/PointStamped.h>
#include <ros/node_handle.h>
#include <threelink_msgs/Episode.h>
#include <threelink_msgs/EpisodeAbort.h>
#include <threelink_msgs/Recording.h>
#include <threelink_msgs/SwimmerState.h>

#include "task_config.hpp"
#include "threelink_sim/mutex.hpp"
#include "threelink_sim/node/diagnostics.hpp"
#include "threelink_sim/node/direct_queue.hpp"
#include "threelink_sim/node/intake.hpp"
#include "threelink_sim/node/thinned_path.hpp"

namespace threelink_tasks {

struct PlayedEpisode {
  threelink_msgs::Episode episode;  // as published last
  double energy = 0;                // [C_perp L^3/T0] work done
  // The recorder's last word on it; nothing if it had none or there is no recorder.
  std::optional<threelink_msgs::Recording> recording;
};

class TaskPlayer {
 public:
  explicit TaskPlayer(const PlayerConfig& config);

  // Called some 20 times a second while an episode is played, with how it stands. Text that is not
  // empty breaks it off, and is the reason.
  using Watch = std::function<std::string(const threelink_msgs::Episode&)>;

  // Plays one episode, prints a line for it and returns once it is recorded. Returns nothing if the
  // node has to end before it starts. Throws std::runtime_error if it cannot start.
  std::optional<PlayedEpisode> play(const Assignment& assignment, const Watch& watch);

 private:
  using Clock = std::chrono::steady_clock;

  // Serves callbacks until the condition holds; false if it does not within the time, of which
  // little is left once the node has to end.
  bool wait_for(double seconds, const std::function<bool()>& condition);

  void wait_until_ready();
  // False if the node has to end before it starts.
  bool start_episode(const Assignment& assignment);
  // Ends the episode if the node has to end, the simulator is silent or somebody wants it ended;
  // false once it is over.
  bool watch(const Watch& watch);
  template <class Message>
  using Event = ros::MessageEvent<Message const>;
  void on_state(const Event<threelink_msgs::SwimmerState>& event);
  void on_abort(const Event<threelink_msgs::EpisodeAbort>& event);
  void on_recording(const Event<threelink_msgs::Recording>& event);
  void answer(const threelink_msgs::SwimmerState& state) REQUIRES(mutex_);
  void publish_target(const ros::Time& stamp) REQUIRES(mutex_);
  void show() REQUIRES(mutex_);
  void end_episode(std::uint8_t status, const std::string& reason = "") REQUIRES(mutex_);
  bool recorded() const;
  std::string line() const REQUIRES(mutex_);
  void report(threelink_sim::Diagnostics::Status& status, double seconds);

  PlayerConfig config_;
  double silence_limit_;  // [s] wall time without a state that ends an episode

  ros::NodeHandle node_;
  threelink_sim::Diagnostics diagnostics_;
  threelink_sim::Diagnostics::Counter& refused_states_;
  threelink_sim::Diagnostics::Counter& malformed_states_;
  threelink_sim::Diagnostics::Counter& strange_states_;
  threelink_sim::Diagnostics::Counter& strange_aborts_;
  threelink_sim::Diagnostics::Counter& strange_recordings_;
  threelink_sim::Diagnostics::Counter& refused_points_;

  // States are answered in roscpp's network thread; all else happens in the main one. Guards what
  // both use: from here to target_path_.
  threelink_sim::Mutex mutex_;
  Assignment assignment_ GUARDED_BY(mutex_);
  bool playing_ GUARDED_BY(mutex_) = false;
  threelink_msgs::Episode episode_ GUARDED_BY(mutex_);  // the one that is played or was played last
  double energy_ GUARDED_BY(mutex_) = 0;                // [C_perp L^3/T0] of that one
  std::uint64_t next_step_ GUARDED_BY(mutex_) = 0;      // of the state that is awaited
  std::uint64_t steps_ GUARDED_BY(mutex_) = 0;          // since the last report
  Eigen::Vector2d first_centroid_ GUARDED_BY(mutex_);   // [L]
  Clock::time_point heard_ GUARDED_BY(mutex_);          // when the simulator was heard last
  threelink_sim::Peer simulator_ GUARDED_BY(mutex_);    // whose states count
  geometry_msgs::PointStamped target_ GUARDED_BY(mutex_);
  threelink_sim::ThinnedPath target_path_ GUARDED_BY(mutex_);

  std::optional<std::uint32_t> shown_waypoint_;         // of this episode
  threelink_sim::Peer recorder_;                        // whose words count
  bool recorder_ready_ = false;                         // it has been heard
  std::optional<threelink_msgs::Recording> recording_;  // its word on this episode
  threelink_sim::DirectQueue direct_queue_;
  ros::Publisher target_publisher_, episode_publisher_, path_publisher_, waypoint_publisher_;
  ros::ServiceClient reset_;
  ros::Subscriber state_subscriber_, abort_subscriber_, recording_subscriber_;
};

}  // namespace threelink_tasks

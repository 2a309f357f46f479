// Plays a task over topics, episode by episode: the task node's side of the lock-step.
#pragma once

#include <chrono>
#include <functional>
#include <mutex>
#include <optional>
#include <string>

#include <geometry_msgs/PointStamped.h>
#include <ros/node_handle.h>
#include <threelink_msgs/Episode.h>
#include <threelink_msgs/EpisodeAbort.h>
#include <threelink_msgs/Recording.h>
#include <threelink_msgs/SwimmerState.h>

#include "task_config.hpp"
#include "threelink_sim/node/diagnostics.hpp"
#include "threelink_sim/node/direct_queue.hpp"
#include "threelink_sim/node/thinned_path.hpp"
#include "threelink_tasks/task.hpp"

namespace threelink_tasks {

class TaskPlayer {
 public:
  TaskPlayer(const TaskConfig& config, Task& task);

  // Plays all episodes and prints a line for each. Returns the exit status: kSuccess if every one
  // came to an outcome. Throws std::runtime_error if an episode could not start.
  int run();

 private:
  using Clock = std::chrono::steady_clock;

  // Serves callbacks until the condition holds; false if it does not within the time, of which
  // little is left once the node has to end.
  bool wait_for(double seconds, const std::function<bool()>& condition);

  void wait_until_ready();
  void start_episode();
  void play_episode();
  // Ends the episode if the node has to end or the simulator is silent; false once it is over.
  bool watch();
  void on_state(const threelink_msgs::SwimmerState& state);
  void on_abort(const threelink_msgs::EpisodeAbort& message);
  void on_recording(const threelink_msgs::Recording& message) { recording_ = message; }
  void answer(const threelink_msgs::SwimmerState& state);
  void publish_target(const ros::Time& stamp);
  void end_episode(std::uint8_t status, const std::string& reason = "");
  bool recorded() const;
  std::string line() const;
  void report(threelink_sim::Diagnostics::Status& status, double seconds);

  TaskConfig config_;
  Task& task_;
  double silence_limit_;  // [s] wall time without a state that ends an episode

  ros::NodeHandle node_;
  threelink_sim::Diagnostics diagnostics_;
  threelink_sim::Diagnostics::Counter& refused_states_;

  // States are answered in roscpp's network thread; all else happens in the main one. Guards what
  // both use: from here to target_path_.
  std::mutex mutex_;
  bool playing_ = false;
  threelink_msgs::Episode episode_;  // the one that is played or was played last
  std::uint64_t next_step_ = 0;      // of the state that is awaited
  std::uint64_t steps_ = 0;          // since the last report
  Eigen::Vector2d first_centroid_;   // [L]
  Clock::time_point heard_;          // when the simulator was heard last
  geometry_msgs::PointStamped target_;
  threelink_sim::ThinnedPath target_path_;

  bool any_aborted_ = false;
  std::optional<threelink_msgs::Recording> recording_;  // the recorder's last word
  threelink_sim::DirectQueue direct_queue_;
  ros::Publisher target_publisher_, episode_publisher_, path_publisher_;
  ros::ServiceClient reset_;
  ros::Subscriber state_subscriber_, abort_subscriber_, recording_subscriber_;
};

}  // namespace threelink_tasks

// Records every episode into a bag of its own.
//
// A recording begins with the Episode message that starts the episode, and ends after the one that
// ends it (or the simulator's abort) as soon as nothing more comes in. Messages are told apart by
// their stamps, which rise over all episodes; those that overtake the start message wait for it in
// early_. Latched messages that are older than the episode are repeated in each bag.
#pragma once

#include <chrono>
#include <deque>
#include <filesystem>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <ros/node_handle.h>
#include <tf2_msgs/TFMessage.h>
#include <threelink_msgs/Episode.h>
#include <threelink_msgs/EpisodeAbort.h>
#include <threelink_msgs/Recording.h>

#include "child_process.hpp"
#include "episode_recording.hpp"
#include "threelink_sim/node/diagnostics.hpp"

namespace threelink_tasks {

struct RecorderParameters {
  std::filesystem::path folder;  // of the bags; made if it is missing
  bool pictures = true;          // draw both trajectories of each episode
  BagQuotaParameters quota;
};

class Recorder {
 public:
  // Recovers what an earlier recorder left open, then subscribes.
  explicit Recorder(const RecorderParameters& parameters);

  // Records until the node has to end; an open bag is then closed within about a second.
  int run();

 private:
  using Clock = std::chrono::steady_clock;

  struct Early {
    ros::Time stamp;
    std::function<void()> record;
  };
  struct Finished {
    threelink_msgs::Recording recording;
    std::unique_ptr<ChildProcess> drawing;  // null if there is none
  };

  // Incoming messages.
  template <class Message>
  void listen(const std::string& topic);
  template <class Message>
  void on_message(const std::string& topic, const boost::shared_ptr<Message const>& message);
  // Latched ones that outlive an episode; `key` tells apart those that do not replace each other.
  template <class Message>
  void remember(const std::string& topic, const std::string& key,
                const boost::shared_ptr<Message const>& message);
  void on_episode(const threelink_msgs::EpisodeConstPtr& message);
  void on_abort(const threelink_msgs::EpisodeAbortConstPtr& message);

  void open_episode(const threelink_msgs::Episode& message);
  void close_episode(bool picture);

  void recover_leftovers();
  void announce_ready();
  void announce_finished();
  void end_open_episode();
  void report(threelink_sim::Diagnostics::Status& status);

  RecorderParameters parameters_;
  BagQuota quota_;
  ros::NodeHandle node_;
  threelink_sim::Diagnostics diagnostics_;
  RecordingCounters counters_;
  std::vector<ros::Subscriber> subscribers_;  // what has to be connected before an episode starts
  std::vector<ros::Subscriber> latched_subscribers_;  // what there may be or not
  ros::Publisher recording_;

  std::deque<Early> early_;
  std::map<std::string, std::function<void()>> latched_;  // records the message again
  std::optional<EpisodeRecording> open_;
  ros::Time last_start_;  // of the episode opened last
  std::optional<Clock::time_point> connected_since_;
  bool ready_ = false;
  std::deque<Finished> finished_;  // to be announced, in order
  std::string last_failure_;       // of the last bag; empty if it is well
};

}  // namespace threelink_tasks

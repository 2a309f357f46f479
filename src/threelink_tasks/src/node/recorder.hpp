// Records every episode into a bag of its own.
//
// A bag is opened by the Episode message that starts the episode, and closed after the one that
// ends it (or the simulator's abort) as soon as nothing more comes in. Messages are told apart by
// their stamps, which rise over all episodes; those that overtake the start message wait for it in
// early_.
#pragma once

#include <chrono>
#include <deque>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <ros/node_handle.h>
#include <tf2_msgs/TFMessage.h>
#include <threelink_msgs/Episode.h>
#include <threelink_msgs/EpisodeAbort.h>
#include <threelink_msgs/Recording.h>
#include <threelink_msgs/SwimmerState.h>

#include "bag_file.hpp"
#include "child_process.hpp"
#include "episode_index.hpp"
#include "threelink_sim/node/diagnostics.hpp"

namespace threelink_tasks {

struct RecorderParameters {
  std::filesystem::path folder;  // of the bags; made if it is missing
  bool pictures = true;          // draw both trajectories of each episode
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
  struct OpenEpisode {
    std::uint32_t number = 0;
    ros::Time start;
    std::unique_ptr<BagFile> bag;  // null if it could not be opened
    std::string failure;           // what went wrong with the bag
    EpisodeStory story;
    std::optional<std::uint64_t> last_state;       // step of the last one recorded
    std::uint64_t states_missing = 0;              // before that one
    std::optional<std::uint64_t> last_step;        // of the episode, once its end was announced
    std::optional<Clock::time_point> close_until;  // end announced: by then at the latest
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
  void on_static_transforms(const tf2_msgs::TFMessageConstPtr& message);
  void on_episode(const threelink_msgs::EpisodeConstPtr& message);
  void on_abort(const threelink_msgs::EpisodeAbortConstPtr& message);

  // The open episode.
  void open_episode(const threelink_msgs::Episode& message);
  template <class Message>
  void record(const std::string& topic, const ros::Time& stamp, const Message& message,
              bool latched = false);
  // False if the message repeats one that was recorded.
  bool is_new(const threelink_msgs::SwimmerState& message);
  template <class Message>
  bool is_new(const Message&) {
    return true;
  }
  void fail(const std::string& reason);
  void expect_end(std::uint64_t last_step);
  bool all_arrived() const;
  void close_episode(bool picture);

  void recover_leftovers();
  void announce_ready();
  void announce_finished();
  void end_open_episode();
  void report(threelink_sim::Diagnostics::Status& status);

  RecorderParameters parameters_;
  ros::NodeHandle node_;
  threelink_sim::Diagnostics diagnostics_;
  threelink_sim::Diagnostics::Counter& messages_;
  threelink_sim::Diagnostics::Counter& bags_;
  threelink_sim::Diagnostics::Counter& states_missing_;
  threelink_sim::Diagnostics::Counter& failures_;
  std::vector<ros::Subscriber> subscribers_;  // what has to be connected before an episode starts
  ros::Subscriber static_transform_subscriber_;
  ros::Publisher recording_;

  std::deque<Early> early_;
  std::vector<tf2_msgs::TFMessageConstPtr> static_transforms_;
  std::optional<OpenEpisode> open_;
  ros::Time last_start_;  // of the episode opened last
  Clock::time_point last_arrival_;
  std::optional<Clock::time_point> connected_since_;
  bool ready_ = false;
  std::deque<Finished> finished_;  // to be announced, in order
  std::string last_failure_;       // of the last bag; empty if it is well
};

}  // namespace threelink_tasks

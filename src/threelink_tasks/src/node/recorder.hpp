// Records every episode into a bag of its own.
//
// An Episode message that starts an episode is believed once a state agrees with it: the very state
// that it is about, or later ones of the same episode, if this node came late. The recording ends
// after the Episode message that ends it (or the simulator's abort) as soon as nothing more comes
// in. What overtakes the start waits for it in early_. Latched messages that are older than the
// episode are repeated in each bag.
#pragma once

#include <chrono>
#include <deque>
#include <filesystem>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include <ros/message_event.h>
#include <ros/node_handle.h>
#include <tf2_msgs/TFMessage.h>
#include <threelink_msgs/Episode.h>
#include <threelink_msgs/EpisodeAbort.h>
#include <threelink_msgs/Recording.h>
#include <threelink_msgs/SwimmerState.h>

#include "child_process.hpp"
#include "episode_recording.hpp"
#include "threelink_sim/node/diagnostics.hpp"
#include "threelink_sim/node/intake.hpp"

namespace threelink_tasks {

struct RecorderParameters {
  std::filesystem::path folder;  // of the bags; made if it is missing
  bool pictures = true;          // draw both trajectories of each episode
  BagQuotaParameters quota;
};

class Recorder {
 public:
  // Recovers what an earlier recorder left open, then subscribes. Throws threelink_sim::UsageError
  // if no file can be made in the folder.
  explicit Recorder(const RecorderParameters& parameters);

  // Records until the node has to end; an open bag is then closed within about a second.
  int run();

 private:
  using Clock = std::chrono::steady_clock;

  template <class Message>
  using Event = ros::MessageEvent<Message const>;

  using Record = EpisodeRecording::Record;

  struct Early {
    Record record;
    std::optional<std::uint32_t> episode;        // nothing if it is not numbered by episodes
    threelink_msgs::SwimmerStateConstPtr state;  // null if it is another message
    std::string publisher;                       // of a state
  };
  struct Candidate {  // may have started
    threelink_msgs::EpisodeConstPtr start;
    threelink_msgs::EpisodeConstPtr end;  // null if it has not ended yet
    std::string publisher;
    std::string refusal;  // why it is not recorded; empty if it is
    Clock::time_point heard;
  };
  struct Finished {
    threelink_msgs::Recording recording;
    std::unique_ptr<ChildProcess> drawing;  // null if there is none
  };

  // Incoming messages.
  template <class Message>
  void hear(const std::string& topic, std::size_t most_bytes,
            std::vector<ros::Subscriber>& subscribers,
            const std::function<void(const Event<Message>&)>& heard);
  template <class Message>
  void listen(const std::string& topic, std::vector<ros::Subscriber>& subscribers);
  template <class Message>
  void on_message(const std::string& topic, const boost::shared_ptr<Message const>& message);
  void on_state(const Event<threelink_msgs::SwimmerState>& event);
  // Latched ones that outlive an episode; `key` tells apart those that do not replace each other.
  template <class Message>
  void remember(const std::string& topic, const std::string& key,
                const boost::shared_ptr<Message const>& message);
  void on_episode(const Event<threelink_msgs::Episode>& event);
  void on_start(const Event<threelink_msgs::Episode>& event);
  void on_abort(const Event<threelink_msgs::EpisodeAbort>& event);
  void keep_early(Early message);

  bool is_start(const threelink_msgs::SwimmerState& state) const;
  // Opens the episode that a state is the start of; false if there is none.
  bool open_with(const threelink_msgs::SwimmerState& state, const std::string& publisher);
  // Opens an episode that began before this node did.
  void join_late();
  void open_episode(const Candidate& candidate, const std::string& simulator);
  void refuse_episode(const Candidate& candidate);
  void close_episode(bool picture);

  void refuse_folder(const std::string& reason);
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
  std::vector<ros::Subscriber> world_subscribers_;    // of the simulator, if it has a world
  std::vector<ros::Subscriber> latched_subscribers_;  // what there may be or not
  ros::Publisher recording_;

  std::deque<Early> early_;
  std::deque<Candidate> candidates_;
  std::set<std::string> warned_;           // reasons of refusals, each of which is logged once
  std::map<std::string, Record> latched_;  // records the message again
  std::optional<EpisodeRecording> open_;
  std::string task_, simulator_;                // nodes that started the episode opened last
  threelink_msgs::EpisodeConstPtr last_start_;  // of that one; null before
  std::optional<Clock::time_point> connected_since_;
  bool ready_ = false;
  std::deque<Finished> finished_;  // to be announced, in order
  std::string last_failure_;       // of the last bag; empty if it is well
};

}  // namespace threelink_tasks

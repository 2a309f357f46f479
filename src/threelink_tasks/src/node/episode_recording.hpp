// The recording of one episode: its bag, its row in the index, and what went wrong.
//
// If the bag cannot be written, that is told, and everything but the writing goes on. What belongs
// to the episode is told by its states: a message is of the episode once a state of its time, or of
// a later one, is there.
#pragma once

#include <chrono>
#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>

#include <ros/time.h>
#include <threelink_msgs/Episode.h>
#include <threelink_msgs/Recording.h>
#include <threelink_msgs/SwimmerState.h>

#include "bag_file.hpp"
#include "bag_quota.hpp"
#include "episode_index.hpp"
#include "state_sequence.hpp"
#include "threelink_sim/node/diagnostics.hpp"

namespace threelink_tasks {

// All recordings count on these.
struct RecordingCounters {
  explicit RecordingCounters(threelink_sim::Diagnostics& diagnostics);

  threelink_sim::Diagnostics::Counter& messages;
  threelink_sim::Diagnostics::Counter& bags;
  threelink_sim::Diagnostics::Counter& states_missing;
  threelink_sim::Diagnostics::Counter& messages_refused;
  threelink_sim::Diagnostics::Counter& episodes_refused;
  threelink_sim::Diagnostics::Counter& failures;
};

class EpisodeRecording {
 public:
  using State = threelink_msgs::SwimmerState;
  using Record = std::function<void(EpisodeRecording&)>;  // records a message
  using Ahead = std::multimap<ros::Time, Record>;
  template <class Message>
  using Pointer = boost::shared_ptr<Message const>;

  // `start` is recorded on that topic, and so is the end.
  EpisodeRecording(const std::filesystem::path& folder, const BagQuota& quota,
                   const std::string& topic, const threelink_msgs::EpisodeConstPtr& start,
                   RecordingCounters& counters);

  std::uint32_t episode() const { return start_->episode; }
  ros::Time start() const { return start_->header.stamp; }
  const std::string& failure() const { return failure_; }  // empty: all is well
  std::string bag() const { return bag_ ? bag_->path().string() : std::string(); }

  // Of earlier messages nothing is recorded. What is latched is latched again by `rosbag play`.
  template <class Message>
  void record(const std::string& topic, const ros::Time& stamp, const Pointer<Message>& message,
              bool latched = false);
  void record_state(const std::string& topic, const Pointer<State>& state);

  // The episode is said to end, in a state that is known or not. If it goes on, it was not so.
  void expect_end(const threelink_msgs::EpisodeConstPtr& end);
  void expect_end();
  // Whether the end was announced, and all that belongs to it is here or will not come any more.
  bool all_arrived() const;

  // To be called often: writes out what waits too long in memory, and watches over the quota.
  void tend();

  // Ends the bag, on this topic, with what is in it, and lists it. Returns what is to be announced.
  threelink_msgs::Recording close(const std::string& topic);
  // After that: what was stamped later than the last state, and may be of the next episode.
  const Ahead& ahead() const { return ahead_; }

 private:
  using Clock = std::chrono::steady_clock;

  template <class Message>
  void write(const std::string& topic, const ros::Time& stamp, const Message& message,
             bool latched);
  void take_state(const std::string& topic, const State& state);
  void release_ahead();
  void finish_states();
  std::string losses() const;
  void watch_quota();
  // `broken`: the file is in an unknown state, and nothing of it can be written any more.
  void fail(const std::string& reason, bool broken);
  void close_bag(const std::string& topic, threelink_msgs::Recording& recording);

  static constexpr std::size_t kMostAhead = 20000;  // messages

  std::filesystem::path folder_;
  const BagQuota& quota_;
  RecordingCounters& counters_;
  std::string episode_topic_, state_topic_;
  threelink_msgs::EpisodeConstPtr start_;
  std::unique_ptr<BagFile> bag_;
  std::string failure_;
  bool broken_ = false;
  EpisodeStory story_;
  StateSequence states_;
  std::uint64_t unwritten_ = 0;  // states that came after the bag had failed
  std::uint64_t refused_ = 0;    // messages that are not of the episode
  Ahead ahead_;
  threelink_msgs::EpisodeConstPtr end_;         // null while it is not announced, or unknown
  std::optional<Clock::time_point> announced_;  // when the end was
  Clock::time_point last_arrival_, last_state_arrival_;
  Clock::time_point quota_watched_;
};

template <class Message>
void EpisodeRecording::record(const std::string& topic, const ros::Time& stamp,
                              const Pointer<Message>& message, bool latched) {
  last_arrival_ = Clock::now();
  if (stamp < start()) return;
  if (stamp <= states_.stamp()) return write(topic, stamp, *message, latched);
  ahead_.emplace(stamp, [topic, stamp, message, latched](EpisodeRecording& recording) {
    recording.record(topic, stamp, message, latched);
  });
  if (ahead_.size() <= kMostAhead) return;
  ahead_.erase(std::prev(ahead_.end()));
  ++refused_;
  ++counters_.messages_refused;
}

template <class Message>
void EpisodeRecording::write(const std::string& topic, const ros::Time& stamp,
                             const Message& message, bool latched) {
  story_.hear(message);
  if (!failure_.empty()) return;
  try {
    if (latched) {
      bag_->write_latched(topic, stamp, message);
    } else {
      bag_->write(topic, stamp, message);
    }
    ++counters_.messages;
  } catch (const std::exception& error) {
    fail(error.what(), true);
  }
}

}  // namespace threelink_tasks

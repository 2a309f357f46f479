// The recording of one episode: its bag, its row in the index, and what went wrong.
//
// If the bag cannot be written, that is told, and everything but the writing goes on.
#pragma once

#include <chrono>
#include <cstdint>
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
#include "threelink_sim/node/diagnostics.hpp"

namespace threelink_tasks {

// All recordings count on these.
struct RecordingCounters {
  explicit RecordingCounters(threelink_sim::Diagnostics& diagnostics);

  threelink_sim::Diagnostics::Counter& messages;
  threelink_sim::Diagnostics::Counter& bags;
  threelink_sim::Diagnostics::Counter& states_missing;
  threelink_sim::Diagnostics::Counter& failures;
};

class EpisodeRecording {
 public:
  // `start` is not recorded yet.
  EpisodeRecording(const std::filesystem::path& folder, const BagQuota& quota,
                   const threelink_msgs::Episode& start, RecordingCounters& counters);

  std::uint32_t episode() const { return episode_; }
  ros::Time start() const { return start_; }
  const std::string& failure() const { return failure_; }  // empty: all is well
  std::string bag() const { return bag_ ? bag_->path().string() : std::string(); }

  // Of earlier messages, and of states that were recorded before, nothing is recorded. What is
  // latched is latched again by `rosbag play`.
  template <class Message>
  void record(const std::string& topic, const ros::Time& stamp, const Message& message,
              bool latched = false);

  // The end was announced: the episode ends in that state, or in one that nobody knows.
  void expect_end(std::optional<std::uint64_t> last_step);
  // Whether the end was announced, and all that belongs to it is here or will not come any more.
  bool all_arrived() const;

  // To be called often: writes out what waits too long in memory, and watches over the quota.
  void tend();

  // Ends the bag, on this topic, with what is in it, and lists it. Returns what is to be announced.
  threelink_msgs::Recording close(const std::string& topic);

 private:
  using Clock = std::chrono::steady_clock;

  // False if the message repeats one that was recorded.
  bool is_new(const threelink_msgs::SwimmerState& message);
  template <class Message>
  bool is_new(const Message&) {
    return true;
  }
  void watch_quota();
  // `broken`: the file is in an unknown state, and nothing of it can be written any more.
  void fail(const std::string& reason, bool broken);
  void close_bag(const std::string& topic, threelink_msgs::Recording& recording);

  std::filesystem::path folder_;
  const BagQuota& quota_;
  RecordingCounters& counters_;
  std::uint32_t episode_;
  ros::Time start_;
  std::unique_ptr<BagFile> bag_;
  std::string failure_;
  bool broken_ = false;
  EpisodeStory story_;
  std::optional<std::uint64_t> last_state_;       // step of the last one recorded
  std::uint64_t states_missing_ = 0;              // before that one
  std::optional<std::uint64_t> last_step_;        // of the episode, once its end was announced
  std::optional<Clock::time_point> close_until_;  // end announced: by then at the latest
  Clock::time_point last_arrival_;
  Clock::time_point quota_watched_;
};

template <class Message>
void EpisodeRecording::record(const std::string& topic, const ros::Time& stamp,
                              const Message& message, bool latched) {
  last_arrival_ = Clock::now();
  if (stamp < start_ || !is_new(message)) return;
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

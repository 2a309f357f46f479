// A bag of the recorder, read whole.
#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include <geometry_msgs/PointStamped.h>
#include <geometry_msgs/PoseStamped.h>
#include <sensor_msgs/JointState.h>
#include <tf2_msgs/TFMessage.h>
#include <threelink_msgs/Episode.h>
#include <threelink_msgs/EpisodeAbort.h>
#include <threelink_msgs/HingeRates.h>
#include <threelink_msgs/Observation.h>
#include <threelink_msgs/PolicyWeights.h>
#include <threelink_msgs/Recording.h>
#include <threelink_msgs/SwimmerState.h>
#include <threelink_msgs/WorldState.h>

#include "../core/bag_reader.hpp"
#include "../node/bag_contents.hpp"

namespace threelink_tasks {

template <class Message>
ros::Time stamp_of(const Message& message) {
  return message.header.stamp;
}
inline ros::Time stamp_of(const tf2_msgs::TFMessage& message) {
  return message.transforms.at(0).header.stamp;
}

// The messages of one topic in the order of the bag, to be taken one by one.
template <class Message>
class Track {
 public:
  void add(const boost::shared_ptr<Message const>& message) { messages_.push_back(message); }

  // The next one; null after the last.
  const Message* next() const {
    return taken_ < messages_.size() ? messages_[taken_].get() : nullptr;
  }
  // The next one, which is then taken, if it has that stamp; else null.
  const Message* take(const ros::Time& stamp) {
    const Message* message = next();
    if (!message || stamp_of(*message) != stamp) return nullptr;
    ++taken_;
    return message;
  }
  void skip_before(const ros::Time& stamp) {
    while (next() && stamp_of(*next()) < stamp) ++taken_;
  }
  const Message* first() const { return messages_.empty() ? nullptr : messages_.front().get(); }
  const std::vector<boost::shared_ptr<Message const>>& all() const { return messages_; }
  const Message* last() const { return messages_.empty() ? nullptr : messages_.back().get(); }

 private:
  std::vector<boost::shared_ptr<Message const>> messages_;
  std::size_t taken_ = 0;
};

struct RecordedBag {
  Track<threelink_msgs::Episode> episodes;
  Track<threelink_msgs::SwimmerState> states;
  Track<threelink_msgs::WorldState> world_states;
  Track<geometry_msgs::PointStamped> targets;
  Track<threelink_msgs::Observation> observations;
  Track<threelink_msgs::HingeRates> rates;
  Track<threelink_msgs::EpisodeAbort> aborts;
  Track<sensor_msgs::JointState> joint_states;
  Track<geometry_msgs::PoseStamped> poses;
  Track<tf2_msgs::TFMessage> transforms;  // world -> base_link
  Track<threelink_msgs::PolicyWeights> policies;
  std::map<std::string, std::uint64_t> others;  // messages that do not follow from the episode

  bool ours = false;                              // something in it is of an episode
  std::optional<threelink_msgs::Recording> seal;  // how the recorder ended the bag
  ros::Time seal_time;                            // in the bag
  std::string seal_namespace, episode_namespace;  // of their topics
  BagContents contents;                           // of all but the seal
};

// Throws BagError or another threelink_sim::UsageError, which name the path, if it cannot be read
// or is no bag of the recorder.
RecordedBag read_bag(const std::string& path);

}  // namespace threelink_tasks

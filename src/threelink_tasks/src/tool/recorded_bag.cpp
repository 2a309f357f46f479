#include "recorded_bag.hpp"

#include <algorithm>
#include <stdexcept>

#include <rosbag/bag.h>
#include <rosbag/view.h>
#include <sys/resource.h>

#include "threelink_sim/node/topics.hpp"

namespace threelink_tasks {
namespace {

namespace topics = threelink_sim::topics;
using rosbag::MessageInstance;

template <class Message>
boost::shared_ptr<Message const> read(const MessageInstance& instance) {
  boost::shared_ptr<Message const> message;
  try {
    message = instance.instantiate<Message>();
  } catch (const std::exception& error) {
    throw std::runtime_error(instance.getTopic() + ": a damaged message: " + error.what());
  }
  if (!message)
    throw std::runtime_error(instance.getTopic() + " is of another type, " +
                             instance.getDataType() + " with md5sum " + instance.getMD5Sum());
  return message;
}

bool is_base_link(const tf2_msgs::TFMessage& message) {
  return message.transforms.size() == 1 &&
         message.transforms[0].child_frame_id == threelink_sim::frames::kBaseLink;
}

// A damaged length of an array asks for up to 32 GB; a bag takes a few times its size.
void limit_memory(std::uintmax_t bag_size) {
  constexpr rlim_t kProgram = rlim_t{2} << 30, kTimes = 50;
  rlimit limit{};
  getrlimit(RLIMIT_AS, &limit);
  limit.rlim_cur = std::min<rlim_t>(limit.rlim_max, kProgram + kTimes * bag_size);
  setrlimit(RLIMIT_AS, &limit);
}

}  // namespace

RecordedBag read_bag(const std::string& path) {
  RecordedBag bag;
  rosbag::Bag file(path);
  limit_memory(file.getSize());
  std::vector<std::uint8_t> bytes;
  for (const MessageInstance& instance : rosbag::View(file)) {
    const std::string topic = instance.getTopic();
    const std::string name = topic.substr(topic.rfind('/') + 1);
    if (name == topics::kRecording) {
      bag.seal = *read<threelink_msgs::Recording>(instance);
      continue;
    }
    bytes.resize(instance.size());
    ros::serialization::OStream stream(bytes.data(), static_cast<std::uint32_t>(bytes.size()));
    instance.write(stream);
    bag.contents.add(topic, instance.getTime(), bytes.data(), bytes.size());

    const auto add_to = [&](auto& track, auto type) { track.add(read<decltype(type)>(instance)); };
    if (name == topics::kEpisode) {
      add_to(bag.episodes, threelink_msgs::Episode());
    } else if (name == topics::kState) {
      add_to(bag.states, threelink_msgs::SwimmerState());
    } else if (name == topics::kTarget) {
      add_to(bag.targets, geometry_msgs::PointStamped());
    } else if (name == topics::kObservation) {
      add_to(bag.observations, threelink_msgs::Observation());
    } else if (name == topics::kHingeRates) {
      add_to(bag.rates, threelink_msgs::HingeRates());
    } else if (name == topics::kAbort) {
      add_to(bag.aborts, threelink_msgs::EpisodeAbort());
    } else if (name == topics::kJointStates) {
      add_to(bag.joint_states, sensor_msgs::JointState());
    } else if (name == topics::kPose) {
      add_to(bag.poses, geometry_msgs::PoseStamped());
    } else if (topic == "/tf" && is_base_link(*read<tf2_msgs::TFMessage>(instance))) {
      add_to(bag.transforms, tf2_msgs::TFMessage());
    } else {
      if (name == topics::kPolicy) add_to(bag.policies, threelink_msgs::PolicyWeights());
      ++bag.others[topic];
    }
  }
  return bag;
}

}  // namespace threelink_tasks

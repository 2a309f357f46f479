#include "recorded_bag.hpp"

#include <algorithm>
#include <filesystem>
#include <set>

#include <boost/make_shared.hpp>
#include <fmt/format.h>
#include <sys/resource.h>
#include <visualization_msgs/MarkerArray.h>

#include "message_definition.hpp"
#include "threelink_sim/node/topics.hpp"

namespace threelink_tasks {
namespace {

namespace topics = threelink_sim::topics;
namespace traits = ros::message_traits;

// Throws BagError unless the connection has messages of that type, and says so.
template <class Message>
void check_type(const BagConnection& connection) {
  const std::string type = traits::datatype<Message>(), md5sum = traits::md5sum<Message>();
  if (connection.type != type || connection.md5sum != md5sum)
    throw BagError(fmt::format("{} is of another type, {} ({}), than {} ({})", connection.topic,
                               connection.type, connection.md5sum, type, md5sum));
  // By it other readers tell what the fields are.
  if (!same_definition(connection.definition, traits::definition<Message>()))
    throw BagError(fmt::format("{} has another definition of {} than its md5sum says",
                               connection.topic, type));
}

// `checked`: the connections of which the type is known to be right.
template <class Message>
boost::shared_ptr<Message const> read(const BagMessage& stored,
                                      std::set<const BagConnection*>& checked) {
  if (checked.insert(stored.connection).second) check_type<Message>(*stored.connection);
  auto message = boost::make_shared<Message>();
  try {
    // The stream writes nothing.
    auto* bytes = reinterpret_cast<std::uint8_t*>(const_cast<char*>(stored.data.data()));
    ros::serialization::IStream stream(bytes, static_cast<std::uint32_t>(stored.data.size()));
    ros::serialization::deserialize(stream, *message);
    if (stream.getLength() != 0) throw BagError("bytes after its end");
  } catch (const std::exception& error) {
    throw BagError(
        fmt::format("{}: a damaged message: {}", stored.connection->topic, error.what()));
  }
  return message;
}

ros::Time time_of(const BagMessage& stored) {
  return ros::Time(stored.time.seconds, stored.time.nanoseconds);
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

RecordedBag read_messages(const BagReader& reader) {
  RecordedBag bag;
  std::set<const BagConnection*> checked;
  for (const BagMessage& stored : reader.messages()) {
    const std::string& topic = stored.connection->topic;
    const std::string name = topic.substr(topic.rfind('/') + 1);
    bag.ours = bag.ours || stored.connection->type.rfind("threelink_msgs/", 0) == 0;
    if (name == topics::kRecording) {
      if (bag.seal) throw BagError(topic + ": more than one message ends the bag");
      bag.seal = *read<threelink_msgs::Recording>(stored, checked);
      bag.seal_time = time_of(stored);
      bag.seal_namespace = topic.substr(0, topic.size() - name.size());
      continue;
    }
    bag.contents.add(topic, time_of(stored),
                     reinterpret_cast<const std::uint8_t*>(stored.data.data()), stored.data.size());

    const auto add_to = [&](auto& track, auto type) {
      track.add(read<decltype(type)>(stored, checked));
    };
    if (name == topics::kEpisode) {
      bag.episode_namespace = topic.substr(0, topic.size() - name.size());
      add_to(bag.episodes, threelink_msgs::Episode());
    } else if (name == topics::kState) {
      add_to(bag.states, threelink_msgs::SwimmerState());
    } else if (name == topics::kWorldState) {
      add_to(bag.world_states, threelink_msgs::WorldState());
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
    } else if (topic == "/tf" && is_base_link(*read<tf2_msgs::TFMessage>(stored, checked))) {
      add_to(bag.transforms, tf2_msgs::TFMessage());
    } else {
      if (name == topics::kPolicy) add_to(bag.policies, threelink_msgs::PolicyWeights());
      if (name == topics::kWaypoints)
        check_type<visualization_msgs::MarkerArray>(*stored.connection);
      if (topic == "/tf_static") check_type<tf2_msgs::TFMessage>(*stored.connection);
      ++bag.others[topic];
    }
  }
  if (!bag.ours) throw BagError("it is no bag of the recorder: nothing in it is of an episode");
  return bag;
}

}  // namespace

RecordedBag read_bag(const std::string& path) {
  std::error_code unknown;
  limit_memory(std::filesystem::is_regular_file(path, unknown) ? std::filesystem::file_size(path)
                                                               : 0);
  const BagReader reader(path);
  try {
    return read_messages(reader);
  } catch (const BagError& error) {
    throw BagError(path + ": " + error.what());
  }
}

}  // namespace threelink_tasks

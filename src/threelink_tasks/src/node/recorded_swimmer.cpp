#include "recorded_swimmer.hpp"

#include <algorithm>
#include <cstdint>

#include <ros/serialization.h>
#include <threelink_msgs/Episode.h>
#include <yaml-cpp/yaml.h>

#include "threelink_sim/yaml.hpp"

namespace threelink_tasks {

threelink_sim::SimulatorConfig recorded_swimmer(const BagReader& bag) {
  using threelink_msgs::Episode;
  const auto start =
      std::find_if(bag.messages().begin(), bag.messages().end(), [](const BagMessage& message) {
        return message.connection->md5sum == ros::message_traits::md5sum<Episode>();
      });
  if (start == bag.messages().end()) throw BagError("it holds no episode");
  Episode episode;
  // The stream writes nothing.
  auto* bytes = reinterpret_cast<std::uint8_t*>(const_cast<char*>(start->data.data()));
  ros::serialization::IStream stream(bytes, static_cast<std::uint32_t>(start->data.size()));
  ros::serialization::deserialize(stream, episode);
  threelink_sim::ParameterMap parameters("simulator",
                                         threelink_sim::parse_yaml(episode.config)["simulator"]);
  return threelink_sim::read_simulator_config(parameters);
}

}  // namespace threelink_tasks

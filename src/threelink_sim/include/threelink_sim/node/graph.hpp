/// @file
/// Who is on the graph, as the master and the nodes themselves say.
#pragma once

#include <string>
#include <vector>

namespace threelink_sim {

/// Names of the nodes that publish a topic, or offer a service; empty if the master does not
/// answer.
std::vector<std::string> publishers_of(const std::string& topic);
std::vector<std::string> providers_of(const std::string& service);

/// The one node that offers a service and publishes a topic as well; empty if there is none. It is
/// the simulator, or a robot, where the service is `reset`: others on the topic are strangers.
std::string node_behind(const std::string& service, const std::string& topic);

/// What a publisher says of its topic when one connects to it.
struct TopicType {
  std::string datatype;  ///< empty: it did not say
  std::string md5sum;
};
/// Asks the node itself, and gives up after a second.
TopicType type_at_publisher(const std::string& node, const std::string& topic);

}  // namespace threelink_sim

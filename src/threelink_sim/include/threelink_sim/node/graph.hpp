/// @file
/// Queries of the ROS graph at the master and at nodes.
#pragma once

#include <string>
#include <vector>

namespace threelink_sim {

/// Names of the nodes that publish a topic; empty if the master does not answer.
std::vector<std::string> publishers_of(const std::string& topic);
/// Names of the nodes that offer a service; empty if the master does not answer.
std::vector<std::string> providers_of(const std::string& service);

/// The one node that both offers a service and publishes a topic; empty if there is none. For the
/// service `reset` it is the simulator or a robot; other publishers of the topic are not trusted.
std::string node_behind(const std::string& service, const std::string& topic);

/// Type of a topic as its publisher reports it on connection.
struct TopicType {
  std::string datatype;  ///< empty if it did not answer
  std::string md5sum;
};
/// Asks the node itself and gives up after one second.
TopicType type_at_publisher(const std::string& node, const std::string& topic);

}  // namespace threelink_sim

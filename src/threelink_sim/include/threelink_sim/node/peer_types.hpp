/// @file
/// Detection of publishers with another type than this node subscribes to. roscpp refuses their
/// connection silently, and the node would wait for them without a message.
#pragma once

#include <memory>
#include <string>

#include "threelink_sim/node/graph.hpp"

namespace threelink_sim {

/// From now on, publishers of `topic` (a resolved name) with another type are detected.
void expect_type(const std::string& topic, const TopicType& type);

/// A message "NODE publishes TOPIC as TYPE (md5sum ..), and this node takes TYPE (md5sum ..)";
/// empty if there is no such node, or if the topic has a publisher of the right type.
std::string other_type_on(const std::string& topic);

/// During its lifetime, looks every two seconds in a separate thread for such publishers of topics
/// without a connected publisher, and logs each once. run_node() has one.
class PeerTypes {
 public:
  PeerTypes();
  ~PeerTypes();

 private:
  class Watch;
  std::unique_ptr<Watch> watch_;
};

}  // namespace threelink_sim

/// @file
/// Publishers of another type than this node takes: roscpp refuses their connection without a word,
/// and the node would wait for them without knowing why.
#pragma once

#include <memory>
#include <string>

#include "threelink_sim/node/graph.hpp"

namespace threelink_sim {

/// From now on publishers of `topic`, resolved, that have another type are found.
void expect_type(const std::string& topic, const TopicType& type);

/// "NODE publishes TOPIC as TYPE (md5sum ..), and this node takes TYPE (md5sum ..)"; empty if there
/// is none, or if the topic has a publisher of the right type.
std::string other_type_on(const std::string& topic);

/// Looks for them while it lives, every other second, in a thread of its own, on topics of which
/// this node has no publisher; and logs each once. run_node() has one.
class PeerTypes {
 public:
  PeerTypes();
  ~PeerTypes();

 private:
  class Watch;
  std::unique_ptr<Watch> watch_;
};

}  // namespace threelink_sim

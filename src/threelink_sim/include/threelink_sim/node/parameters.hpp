/// @file
/// Strict reading of a node's private parameters.
#pragma once

#include <string>

#include <ros/node_handle.h>
#include <xmlrpcpp/XmlRpcValue.h>

#include "threelink_sim/node/node_main.hpp"
#include "threelink_sim/parameter_map.hpp"

namespace threelink_sim {

/// A ParameterMap of ROS parameters.
class Parameters : public ParameterMap {
 public:
  /// Reads all private parameters of this node at once.
  explicit Parameters(const ros::NodeHandle& private_handle);
  /// Reads a struct of values; `scope` is the prefix of their names in messages.
  Parameters(const std::string& scope, const XmlRpc::XmlRpcValue& values);
};

}  // namespace threelink_sim

/// @file
/// A node's private parameters, read strictly.
#pragma once

#include <string>

#include <ros/node_handle.h>
#include <xmlrpcpp/XmlRpcValue.h>

#include "threelink_sim/node/node_main.hpp"
#include "threelink_sim/parameter_map.hpp"

namespace threelink_sim {

class Parameters : public ParameterMap {
 public:
  /// Reads all private parameters of this node at once.
  explicit Parameters(const ros::NodeHandle& private_handle);
  /// From a struct of values; `scope` is what their names begin with in messages.
  Parameters(const std::string& scope, const XmlRpc::XmlRpcValue& values);
};

}  // namespace threelink_sim

/// @file
/// The swimmer of a node as ROS parameters, so that its peers can compare it with theirs: an
/// observation does not show it.
#pragma once

#include <optional>
#include <string>

#include "threelink_sim/environment.hpp"

namespace threelink_sim {

/// Sets the parameters links, gamma, joint_limit and dt of this node to the effective values, and
/// `world` to the whole text of the world, so that peers do not need its file.
void publish_swimmer_parameters(const EnvironmentConfig& config);

/// The swimmer of a node according to these parameters, with the defaults of config/swimmer.yaml;
/// nothing if the node has none of them, such as the driver of a robot. Throws ParameterError.
std::optional<EnvironmentConfig> swimmer_of_node(const std::string& node);

}  // namespace threelink_sim

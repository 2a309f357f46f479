/// @file
/// What swimmer a node moves, by its parameters, so that its peers can tell: an observation does
/// not show it.
#pragma once

#include <optional>
#include <string>

#include "threelink_sim/environment.hpp"

namespace threelink_sim {

/// Sets links, gamma, joint_limit and dt of this node to what they are, defaults too; and `world`
/// to the whole text of the world, so that nobody has to have its file.
void publish_swimmer_parameters(const EnvironmentConfig& config);

/// The swimmer that these parameters of a node tell of, by default that of config/swimmer.yaml;
/// nothing if it has none of them, as the driver of a robot. Throws ParameterError.
std::optional<EnvironmentConfig> swimmer_of_node(const std::string& node);

}  // namespace threelink_sim

#include "threelink_sim/node/swimmer_parameters.hpp"

#include <ros/param.h>

#include "threelink_sim/node/parameters.hpp"
#include "threelink_sim/node/simulator_config.hpp"

namespace threelink_sim {

void publish_swimmer_parameters(const EnvironmentConfig& config) {
  ros::param::set("~links", config.model.links);
  ros::param::set("~gamma", config.model.gamma);
  ros::param::set("~joint_limit", config.model.joint_limit);
  ros::param::set("~dt", config.dt);
  if (config.world) ros::param::set("~world", config.world->yaml());
}

std::optional<EnvironmentConfig> swimmer_of_node(const std::string& node) {
  Parameters parameters{ros::NodeHandle(node)};
  bool told = false;
  for (const char* name : {"links", "gamma", "joint_limit", "dt"})
    told = told || parameters.has(name);
  if (!told) return {};
  EnvironmentConfig config;
  read_swimmer(parameters, config);
  return config;
}

}  // namespace threelink_sim

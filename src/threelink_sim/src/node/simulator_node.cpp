// Runs the simulator node; see simulator.hpp.
#include <string>

#include <ros/master.h>
#include <ros/names.h>
#include <ros/this_node.h>

#include "simulator.hpp"
#include "threelink_sim/fields.hpp"
#include "threelink_sim/node/node_main.hpp"
#include "threelink_sim/node/parameters.hpp"
#include "threelink_sim/node/swimmer_parameters.hpp"
#include "threelink_sim/node/topics.hpp"
#include "threelink_sim/plugins.hpp"

namespace threelink_sim {
namespace {

constexpr char kHelp[] = R"(simulator_node: the swimmer, in lock-step with a task and an agent

usage: rosrun threelink_sim simulator_node [ROS remappings] | --help

Step k: publishes state(k), waits for target(k), publishes observation(k), waits for hinge_rates(k),
applies them for dt. Idle until the service `reset` starts an episode. docs/nodes.md has the details.

publishes
  state         threelink_msgs/SwimmerState     every step, latched
  world_state   threelink_msgs/WorldState       every step, latched; only with ~world
  observation   threelink_msgs/Observation      every step, latched
  joint_states  sensor_msgs/JointState          every step (*): hinge_1, hinge_2, ...
  pose          geometry_msgs/PoseStamped       every step (*): centroid, heading
  abort         threelink_msgs/EpisodeAbort     when a peer was silent for too long
  markers       visualization_msgs/MarkerArray  at ~display_rate
  swimmer_path  nav_msgs/Path                   at ~display_rate
  world_markers visualization_msgs/MarkerArray  at ~display_rate; only with ~world
  /tf           world -> base_link              at ~display_rate
  /clock        rosgraph_msgs/Clock             every step (*)
  /diagnostics  diagnostic_msgs/DiagnosticArray once a second of wall time
  (*) at most 200 times a second of wall time, at full speed ~display_rate; the last step always
subscribes to
  target        geometry_msgs/PointStamped      from the task: frame `world`, the state's stamp
  hinge_rates   threelink_msgs/HingeRates       from the agent
  episode       threelink_msgs/Episode          from the task: its end makes the simulator idle
service
  reset         threelink_msgs/Reset            starts the next episode
parameters (config/swimmer.yaml is their manual; defaults in brackets)
)";

std::string help() { return kHelp + field_help(SimulatorConfig(), "~"); }

// There must be one source of simulation time, of each that this one was remapped to.
void refuse_second_clock() {
  const std::string clock = ros::names::resolve(topics::kClock);
  XmlRpc::XmlRpcValue request, response, payload;
  request[0] = ros::this_node::getName();
  if (!ros::master::execute("getSystemState", request, response, payload, false)) return;
  XmlRpc::XmlRpcValue& publishers = payload[0];
  for (int i = 0; i < publishers.size(); ++i) {
    if (static_cast<std::string&>(publishers[i][0]) != clock) continue;
    for (int j = 0; j < publishers[i][1].size(); ++j) {
      const std::string node = publishers[i][1][j];
      if (node != ros::this_node::getName())
        throw UsageError(clock + " is already published by " + node +
                         ", and there can be one source of time only; end that node (if it is"
                         " dead: rosnode cleanup)");
    }
  }
}

int run() {
  load_plugins();  // as flows of the world
  Parameters parameters{ros::NodeHandle("~")};
  const SimulatorConfig config = read_simulator_config(parameters);
  refuse_second_clock();
  publish_swimmer_parameters(config.environment);
  return Simulator(config).run();
}

}  // namespace
}  // namespace threelink_sim

int main(int argc, char** argv) {
  return threelink_sim::run_node(argc, argv, {"simulator", threelink_sim::help()},
                                 threelink_sim::run);
}

// Runs the task node; see task_player.hpp.
#include "episode_server.hpp"
#include "task_player.hpp"
#include "threelink_sim/node/node_main.hpp"
#include "threelink_sim/plugins.hpp"

namespace threelink_tasks {
namespace {

constexpr char kHelp[] = R"(task_node: where the swimmer should go, and whether it got there

usage: rosrun threelink_tasks task_node [ROS remappings] | --help

For each episode: waits for simulator and recorder, resets the simulator, answers every state with a
target until it is captured or time is up, prints one line. docs/nodes.md has the details.

publishes
  target        geometry_msgs/PointStamped      every step, latched; stamp of the state it answers
  episode       threelink_msgs/Episode          start and end of each episode, latched
  target_path   nav_msgs/Path                   for rviz
  waypoints     visualization_msgs/MarkerArray  for rviz, latched
  /diagnostics  diagnostic_msgs/DiagnosticArray once a second of wall time
subscribes to
  state         threelink_msgs/SwimmerState     from the simulator
  abort         threelink_msgs/EpisodeAbort     from the simulator: a peer is silent
  recording     threelink_msgs/Recording        from the recorder
  /clicked_point  geometry_msgs/PointStamped    task clicked_point: from rviz, as is target_marker
calls
  reset         threelink_msgs/Reset            of the simulator
  load_policy   threelink_msgs/LoadPolicy       of the agent, for actions that bring a policy
action, with ~episodes 0
  run_episode   threelink_msgs/RunEpisode       plays an episode of any task
parameters (defaults in brackets)
  ~task    clicked_point, direction, path, point, pursuit, waypoints, or a plug-in's
  ~policy  ~seed [0]  ~episodes [1]  ~record [true]  ~start_timeout [30 s]
  ~simulator [simulator]  ~agent [agent]
  ~allow_other_swimmer  than the one that the policy was trained for, by links, gamma, dt, joint limit [false]
  and those of the task: docs/tasks.md, and config/pursuit.yaml, star.yaml, ...
exit status
  0 every episode was captured or timed out, or SIGINT or SIGTERM; 1 one was aborted or could not
  start; 2 bad parameters
)";

int play_all(TaskPlayer& player, const TaskNodeConfig& config) {
  const auto go_on = [](const threelink_msgs::Episode&) { return std::string(); };
  bool all_well = true;
  for (int i = 0; i < config.player.episodes && threelink_sim::running(); ++i) {
    const auto played = player.play(config.assignment, go_on);
    if (!threelink_sim::running()) break;  // the episode was ended with the node
    all_well &= played && played->episode.status != threelink_msgs::Episode::ABORTED;
  }
  return all_well ? threelink_sim::kSuccess : threelink_sim::kFailure;
}

int run() {
  threelink_sim::load_plugins();
  threelink_sim::Parameters parameters{ros::NodeHandle("~")};
  const TaskNodeConfig config = read_task_node_config(parameters);
  TaskPlayer player(config.player);
  if (config.player.episodes > 0) return play_all(player, config);
  return EpisodeServer(player, config).run();
}

}  // namespace
}  // namespace threelink_tasks

int main(int argc, char** argv) {
  return threelink_sim::run_node(argc, argv, {"task", threelink_tasks::kHelp},
                                 threelink_tasks::run);
}

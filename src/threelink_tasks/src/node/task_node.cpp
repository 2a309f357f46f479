// Runs the task node; see task_player.hpp.
#include "task_player.hpp"
#include "threelink_sim/node/node_main.hpp"

namespace threelink_tasks {
namespace {

constexpr char kHelp[] = R"(task_node: a moving target for the swimmer, and the referee

usage: rosrun threelink_tasks task_node [ROS remappings] | --help

For each episode: waits for simulator and recorder, resets the simulator, answers every state with a
target until it is captured or time is up, prints one line. docs/nodes.md has the details.

publishes
  target        geometry_msgs/PointStamped      every step, latched; stamp of the state it answers
  episode       threelink_msgs/Episode          start and end of each episode, latched
  target_path   nav_msgs/Path                   for rviz
  /diagnostics  diagnostic_msgs/DiagnosticArray once a second of wall time
subscribes to
  state         threelink_msgs/SwimmerState     from the simulator
  abort         threelink_msgs/EpisodeAbort     from the simulator: a peer is silent
  recording     threelink_msgs/Recording        from the recorder
calls
  reset         threelink_msgs/Reset            of the simulator
parameters (config/pursuit.yaml is their manual; defaults in brackets)
  ~policy  ~v_ratio  ~seed [0]  ~episodes [1]  ~record [true]  ~start_timeout [30 s]
  ~start_x [1 L]  ~start_y [0 L]  ~target_x [1.5 L]  ~target_y [0.5 L]  ~target_heading [pi/6 rad]
  ~diffusivity [5.0e-5 L^2/T0]  ~max_steps [50000]  ~threshold [0.001 L]
  ~capture_between_steps [false]  ~simulator [simulator]
exit status
  0 every episode was captured or timed out; 1 one was aborted or could not start; 2 bad parameters
)";

int run() {
  threelink_sim::Parameters parameters{ros::NodeHandle("~")};
  const TaskConfig config = read_task_config(parameters);
  Pursuit task(config.pursuit);
  return TaskPlayer(config, task).run();
}

}  // namespace
}  // namespace threelink_tasks

int main(int argc, char** argv) {
  return threelink_sim::run_node(argc, argv, {"task", threelink_tasks::kHelp},
                                 threelink_tasks::run);
}

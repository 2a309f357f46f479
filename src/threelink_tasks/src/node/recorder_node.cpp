// Runs the recorder node; see recorder.hpp.
#include "recorder.hpp"
#include "threelink_sim/node/parameters.hpp"

namespace threelink_tasks {
namespace {

constexpr char kHelp[] = R"(recorder_node: one bag for each episode

usage: rosrun threelink_tasks recorder_node [ROS remappings] | --help

Writes ~bag_dir/TASK_YYYY-mm-dd-HH-MM-SS_epNNNN.bag (".active" while it is open), a picture of both
trajectories beside it, and a row in ~bag_dir/episodes.csv. What a killed recorder left open is
recovered at the start. docs/nodes.md has the details.

records
  state, target, observation, hinge_rates, episode, abort, joint_states, pose, /tf, /tf_static
publishes
  recording     threelink_msgs/Recording        ready; written or failed, for each episode; latched
  /diagnostics  diagnostic_msgs/DiagnosticArray once a second of wall time
parameters (defaults in brackets)
  ~bag_dir      folder of the bags, made if it is missing; an absolute path
  ~picture      draw both trajectories after each episode [true]
)";

int run() {
  threelink_sim::Parameters parameters{ros::NodeHandle("~")};
  RecorderParameters recorder;
  recorder.folder = parameters.text("bag_dir");
  recorder.pictures = parameters.flag("picture", true);
  parameters.finish();
  if (!recorder.folder.is_absolute()) parameters.refuse("bag_dir", "must be an absolute path");
  return Recorder(recorder).run();
}

}  // namespace
}  // namespace threelink_tasks

int main(int argc, char** argv) {
  return threelink_sim::run_node(argc, argv, {"recorder", threelink_tasks::kHelp},
                                 threelink_tasks::run);
}

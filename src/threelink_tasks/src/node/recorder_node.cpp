// Runs the recorder node; see recorder.hpp.
#include "recorder.hpp"
#include "threelink_sim/node/node_main.hpp"
#include "threelink_sim/node/parameters.hpp"

namespace threelink_tasks {
namespace {

constexpr char kHelp[] = R"(recorder_node: one bag for each episode

usage: rosrun threelink_tasks recorder_node [ROS remappings] | --help

Writes ~bag_dir/TASK_YYYY-mm-dd-HH-MM-SS_epNNNN.bag (".active" while it is open), a picture of both
trajectories beside it, and a row in ~bag_dir/episodes.csv. What a killed recorder left open is
recovered at the start. docs/nodes.md has the details.

records
  state, target, observation, hinge_rates, episode, abort, joint_states, pose, /tf, and in each bag
  anew what is latched: /tf_static, policy
publishes
  recording     threelink_msgs/Recording        ready; written or failed, for each episode; latched
  /diagnostics  diagnostic_msgs/DiagnosticArray once a second of wall time
parameters (config/recorder.yaml is their manual; defaults in brackets)
  ~bag_dir      folder of the bags, made if it is missing; an absolute path
  ~picture      draw both trajectories after each episode [true]
  ~keep  ~max_total_mb  delete the oldest bags beyond so many, or so many 10^6 bytes [0: none]
  ~min_free_mb  leave as much of the disk to others [100]
)";

int run() {
  threelink_sim::Parameters parameters{ros::NodeHandle("~")};
  RecorderParameters recorder;
  recorder.folder = parameters.text("bag_dir");
  recorder.pictures = parameters.flag("picture", true);
  recorder.quota.keep = parameters.integer("keep", {0, 1000000}, recorder.quota.keep);
  recorder.quota.max_total_mb =
      parameters.real("max_total_mb", {0, 1e9}, recorder.quota.max_total_mb);
  recorder.quota.min_free_mb = parameters.real("min_free_mb", {0, 1e9}, recorder.quota.min_free_mb);
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

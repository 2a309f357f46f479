// Runs the training server; see training_server.hpp.
#include "learner.hpp"
#include "threelink_sim/node/node_main.hpp"
#include "threelink_sim/node/parameters.hpp"
#include "threelink_sim/plugins.hpp"
#include "training_server.hpp"

namespace threelink_agent {
namespace {

constexpr char kHelp[] = R"(training_server: trains policies that clients of its action ask for

usage: rosrun threelink_agent training_server __ns:=threelink [ROS remappings] | --help

One training at a time, in this process, or with worker nodes where the goal says so. The policy is
that of `train`, to the bit. Cancelling a goal, or ending this node, leaves a checkpoint, and a goal
with `resume` goes on from it. docs/distributed.md has an example.

action
  train            threelink_msgs/TrainAction       rejected with the reason: a bad configuration, a
                                                    folder that cannot be used, a training that runs
publishes, while it trains
  training_status  threelink_msgs/TrainingStatus    after each update and once a second, latched
  /diagnostics     diagnostic_msgs/DiagnosticArray  once a second of wall time, always
  and with workers, what learner_node publishes
parameters (defaults in brackets)
  ~threads         that play and update; the policy does not depend on them [1]
  ~plot         draw learning_curve.png at the end of each training [true]
  ~worker_timeout, ~lease_timeout, ~lease_episodes, ~replay
                   as those of learner_node [30, 60, 256, 1]
)";

int run() {
  threelink_sim::load_plugins();
  threelink_sim::Parameters given{ros::NodeHandle("~")};
  const int threads = given.integer("threads", {1, 1024}, 1);
  const bool plot = given.flag("plot", true);
  const RemoteRollouts::Settings remote = read_remote_settings(given);
  given.finish();
  log_reach();
  ros::AsyncSpinner spinner(1);
  spinner.start();
  return TrainingServer(threads, plot, remote).run();
}

}  // namespace
}  // namespace threelink_agent

int main(int argc, char** argv) {
  threelink_agent::allow_many_connections();
  return threelink_sim::run_node(argc, argv, {"training_server", threelink_agent::kHelp},
                                 threelink_agent::run);
}

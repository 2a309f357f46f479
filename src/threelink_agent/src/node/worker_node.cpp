// Runs the worker node; see worker.hpp.
#include <memory>

#include "threelink_sim/node/node_main.hpp"
#include "threelink_sim/node/parameters.hpp"
#include "threelink_sim/plugins.hpp"
#include "worker.hpp"

namespace threelink_agent {
namespace {

constexpr char kHelp[] = R"(worker_node: plays episodes for a learner

usage: rosrun threelink_agent worker_node __name:=NAME [ROS remappings] | --help

Everything that it plays with comes from the learner. It waits for one, and for the next one if that
goes away; it can be ended or killed at any moment. docs/distributed.md has the details.

publishes
  workers       threelink_msgs/WorkerStatus      once a second: who it is
  episodes      threelink_msgs/EpisodeBatch      the episodes of a lease
  /diagnostics  diagnostic_msgs/DiagnosticArray  once a second of wall time
subscribes to
  leases        threelink_msgs/Leases            from the learner: which episodes to play
  policy        threelink_msgs/PolicyWeights     from the learner: with which policy
parameters (defaults in brackets)
  ~threads      that play; the episodes do not depend on them [1]
  ~step_cost    [us] of sleep for each environment step, as if it were costly, for tests [0]
)";

int run() {
  threelink_sim::load_plugins();
  threelink_sim::Parameters parameters{ros::NodeHandle("~")};
  const int threads = parameters.integer("threads", {1, 1024}, 1);
  const double step_cost = parameters.real("step_cost", {0, 1e6}, 0);
  parameters.finish();
  return Worker(std::make_unique<LocalRollouts>(threads), threads, "", step_cost).run();
}

}  // namespace
}  // namespace threelink_agent

int main(int argc, char** argv) {
  constexpr double kPatience = 1;  // [s] a long lease is not played to its end
  return threelink_sim::run_node(argc, argv, {"worker", threelink_agent::kHelp, false, kPatience},
                                 threelink_agent::run);
}

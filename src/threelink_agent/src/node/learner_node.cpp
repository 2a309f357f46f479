// Runs the learner node; see learner.hpp.
#include <limits>
#include <memory>

#include <ros/console.h>
#include <ros/spinner.h>

#include "learner.hpp"
#include "run_training.hpp"
#include "threelink_agent/training/backend.hpp"
#include "threelink_agent/training/run_lock.hpp"
#include "threelink_sim/node/node_main.hpp"
#include "threelink_sim/node/parameters.hpp"
#include "threelink_sim/plugins.hpp"

namespace threelink_agent {
namespace {

constexpr char kHelp[] = R"(learner_node: trains a policy on episodes that workers play

usage: rosrun threelink_agent learner_node _config:=FILE _out:=DIR [ROS remappings] | --help

The policy is that of `train`, to the bit, whatever the workers. docs/distributed.md has the details.

publishes
  policy           threelink_msgs/PolicyWeights     the one to be played now, latched
  leases           threelink_msgs/Leases            which worker plays which episodes
  training_status  threelink_msgs/TrainingStatus    after each update and once a second, latched
  /diagnostics     diagnostic_msgs/DiagnosticArray  once a second of wall time
subscribes to
  workers          threelink_msgs/WorkerStatus      from the workers: who is there
  episodes         threelink_msgs/EpisodeBatch      from the workers: what they played
parameters (defaults in brackets)
  ~config          YAML file that holds every setting; required unless a run is resumed
  ~out             folder of the run, required; docs/learning.md says what is in it
  ~seed, ~episodes instead of the configuration's
  ~resume          go on from the newest checkpoint, or begin [false]
  ~backend         of the update: fused or libtorch [fused]
  ~threads         of the update; the policy does not depend on them [1]
  ~checkpoint_every  [updates] from one checkpoint to the next [1]
  ~plot            draw learning_curve.png at the end [true]
  ~worker_timeout  [s] without any worker, after which the node ends with status 1 [30]
  ~lease_timeout   [s] after which episodes that have not come are given to another worker [60]
  ~lease_episodes  of a lease, at most [256]
  ~replay          episodes of each batch that are played once more here before it is taken, so that
                   nobody's wrong numbers get in; 0 where a robot is among the workers [1]
exit status: 0 trained, or ended by SIGINT or SIGTERM; 1 failed; 2 wrong parameters or files;
  75 master lost. Whenever the run was begun, a checkpoint is left, and ~resume goes on.
)";

struct Parameters {
  RunSettings run;
  RemoteRollouts::Settings remote;
};

Parameters read_parameters() {
  threelink_sim::Parameters given{ros::NodeHandle("~")};
  constexpr int kMost = std::numeric_limits<int>::max();
  Parameters parameters;
  RunSettings& run = parameters.run;
  run.prefix = "~";
  run.config = given.text("config", "");
  run.out = given.text("out");
  if (given.has("seed")) run.seed = given.integer("seed", {0, kMost});
  if (given.has("episodes")) run.episodes = given.integer("episodes", {1, kMost});
  run.resume = given.flag("resume", false);
  run.backend = given.choice("backend", {to_string(Backend::kFused), to_string(Backend::kLibtorch)},
                             run.backend);
  run.threads = given.integer("threads", {1, 1024}, 1);
  run.checkpoint_every = given.integer("checkpoint_every", {1, 100000000}, 1);
  run.plot = given.flag("plot", true);
  parameters.remote = read_remote_settings(given);
  given.finish();
  return parameters;
}

int run() {
  threelink_sim::load_plugins();
  const Parameters parameters = read_parameters();
  log_reach();
  ros::AsyncSpinner spinner(1);
  spinner.start();
  Learner* learner = nullptr;  // the trainer's, who tells it of its updates
  RunHooks hooks;
  hooks.keep_going = [] { return threelink_sim::running(); };
  hooks.make_source = [&](const TrainConfig& config) {
    auto source = std::make_unique<Learner>(config, parameters.remote, hooks.keep_going);
    learner = source.get();
    return source;
  };
  hooks.on_update = [&](const Trainer& trainer, const UpdateReport* report,
                        const Progress& progress) {
    learner->status().on_update(trainer, report, progress);
  };
  try {
    if (!run_training(parameters.run, hooks).finished)
      ROS_WARN("ended before the training was; a checkpoint is in %s, and resume goes on from it",
               parameters.run.out.c_str());
  } catch (const ConfigError& error) {
    throw threelink_sim::UsageError(error.what());
  } catch (const RunFolderError& error) {
    throw threelink_sim::UsageError(std::string("~out ") + error.what());
  }
  return threelink_sim::kSuccess;
}

}  // namespace
}  // namespace threelink_agent

int main(int argc, char** argv) {
  threelink_agent::allow_many_connections();
  return threelink_sim::run_node(argc, argv, {"learner", threelink_agent::kHelp},
                                 threelink_agent::run);
}

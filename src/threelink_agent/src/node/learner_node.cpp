// Runs the learner node; see learner.hpp.
#include <limits>
#include <memory>
#include <optional>
#include <random>

#include <ros/console.h>

#include "learner.hpp"
#include "run_training.hpp"
#include "threelink_agent/distributed/fingerprint.hpp"
#include "threelink_agent/training/backend.hpp"
#include "threelink_agent/training/run_lock.hpp"
#include "threelink_sim/node/node_main.hpp"
#include "threelink_sim/node/parameters.hpp"

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
exit status: 0 trained, or ended by SIGINT or SIGTERM; 1 failed; 2 wrong parameters or files;
  75 master lost. Whenever the run was begun, a checkpoint is left, and ~resume goes on.
)";

struct Parameters {
  RunSettings run;
  RemoteRollouts::Settings remote;
};

std::chrono::nanoseconds seconds(double s) {
  return std::chrono::nanoseconds(static_cast<std::int64_t>(s * 1e9));
}

std::uint64_t draw_session() {
  std::random_device device;
  return (std::uint64_t{device()} << 32 | device()) | 1;  // not 0
}

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
  RemoteRollouts::Settings& remote = parameters.remote;
  remote.worker_timeout = seconds(given.real("worker_timeout", {0.1, 1e6}, 30));
  remote.dispatcher.lease_time = seconds(given.real("lease_timeout", {0.1, 1e6}, 60));
  remote.dispatcher.lease_episodes = given.integer("lease_episodes", {1, 1000000}, 256);
  remote.dispatcher.roster.session = draw_session();
  remote.dispatcher.roster.fingerprint = fingerprint();
  given.finish();
  return parameters;
}

// The trainer owns its source; the learner outlives it.
class Borrowed : public RolloutSource {
 public:
  explicit Borrowed(RolloutSource& source) : source_(source) {}
  Rollout play(const Play& play, int episodes) override { return source_.play(play, episodes); }

 private:
  RolloutSource& source_;
};

int run() {
  const Parameters parameters = read_parameters();
  std::unique_ptr<Learner> learner;
  RunHooks hooks;
  hooks.make_source = [&](const TrainConfig& config) {
    learner = std::make_unique<Learner>(config, parameters.remote);
    return std::make_unique<Borrowed>(learner->rollouts());
  };
  hooks.keep_going = [] { return threelink_sim::running(); };
  hooks.on_update = [&](const Trainer& trainer, const UpdateReport* report,
                        const Progress& progress) {
    learner->on_update(trainer, report, progress);
  };
  try {
    if (!run_training(parameters.run, hooks))
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
  return threelink_sim::run_node(argc, argv, {"learner", threelink_agent::kHelp},
                                 threelink_agent::run);
}

// Runs the agent node; see agent.hpp.
#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <utility>

#include <fmt/format.h>
#include <ros/callback_queue.h>
#include <ros/console.h>

#include "agent.hpp"
#include "live_loop.hpp"
#include "threelink_sim/node/intake.hpp"
#include "threelink_sim/node/node_main.hpp"
#include "threelink_sim/node/parameters.hpp"
#include "threelink_sim/node/topics.hpp"
#include "threelink_sim/plugins.hpp"
#include "worker.hpp"

namespace threelink_agent {
namespace {

constexpr char kHelp[] = R"(agent_node: answers each observation with the policy's action

usage: rosrun threelink_agent agent_node _policy:=FILE [ROS remappings] | --help

publishes
  hinge_rates   threelink_msgs/HingeRates       an answer to each observation, latched
  /diagnostics  diagnostic_msgs/DiagnosticArray once a second of wall time
subscribes to
  observation   threelink_msgs/Observation      from the simulator
  policy        threelink_msgs/PolicyWeights    from the learner: a policy to go on with
service
  load_policy   threelink_msgs/LoadPolicy       a policy file to go on with
parameters
  ~policy       path of a policy file, required
  ~follow       instead of ~policy: wait for the first policy of a learner; later ones play from the
                next episode on [false]
  ~sampled      draw actions from the policy's distribution instead of taking the mean [what the
                policy file says]
  ~seed         with episode and step it keys what is drawn [0]
  ~allow_other_swimmer  play for a swimmer whose gamma, dt or joint_limit is not that of the policy [false]

A policy that is damaged or for another swimmer is refused, and the one in use stays. What swimmer
there is say the parameters of the node that publishes the observations: links, gamma, joint_limit, dt.

With ~collect it plays training episodes for a learner instead, whatever swimmer answers on these
topics, and takes the part of the task as well: it subscribes to state and abort, publishes target
and episode, calls reset, and is a worker of the learner (see worker_node --help).
  ~collect          [false]; ~policy, ~sampled and ~seed then come from the learner
  ~learner          namespace of the learner's topics []
  ~simulator        node whose parameters say what swimmer there is [simulator]
  ~exact            the episodes must be those of any other worker, to the bit; false: a robot [true]
  ~start_tolerance  [rad] of each hinge angle at the start, if not exact [0.05]
  ~reset_timeout    [s] until reset has to answer [10]

docs/nodes.md has the details, docs/learning.md the format of the file.
)";

int collect(threelink_sim::Parameters& parameters) {
  const std::string learner = parameters.text("learner", "");
  LiveLoopConfig config;
  config.simulator = parameters.text("simulator", "simulator");
  config.exact = parameters.flag("exact", true);
  config.start_tolerance = parameters.real("start_tolerance", {0, 10}, 0.05);
  config.reset_timeout = parameters.real("reset_timeout", {0.1, 1e5}, 10);
  parameters.finish();
  constexpr int kThreads = 1;
  return Worker(std::make_unique<LiveLoop>(config), kThreads, learner).run();
}

// The first sound policy on the topic; nothing if the node has to end before.
std::optional<Policy> first_policy(std::string& source) {
  std::optional<Policy> first;
  ros::NodeHandle node;
  threelink_sim::QuietLog log;
  threelink_sim::Diagnostics diagnostics(
      "policy", "threelink_agent", [](threelink_sim::Diagnostics::Status& status, double) {
        status.summary(diagnostic_msgs::DiagnosticStatus::WARN, "there is no policy yet");
      });
  threelink_sim::Diagnostics::Counter& refused = diagnostics.refusals("policies refused");
  const auto take = [&](const ros::MessageEvent<threelink_msgs::PolicyWeights const>& event) {
    const threelink_msgs::PolicyWeights& weights = *event.getConstMessage();
    source = fmt::format("topic {}, version {}", threelink_sim::topics::kPolicy, weights.version);
    try {
      first = Policy::parse({weights.data.begin(), weights.data.end()}, source);
    } catch (const std::exception& error) {
      ++refused;
      log.error(fmt::format("refused: {}", error.what()));
    }
  };
  const ros::Subscriber subscriber = threelink_sim::subscribe<threelink_msgs::PolicyWeights>(
      node, threelink_sim::topics::kPolicy, 1, threelink_sim::message_size::kFile, &diagnostics,
      take);
  ROS_INFO("waiting for a policy on %s", subscriber.getTopic().c_str());
  while (!first && threelink_sim::running())
    ros::getGlobalCallbackQueue()->callAvailable(ros::WallDuration(0.1));
  return first;
}

int run() {
  threelink_sim::load_plugins();
  threelink_sim::Parameters parameters{ros::NodeHandle("~")};
  if (parameters.flag("collect", false)) return collect(parameters);
  AgentConfig config;
  config.follow = parameters.flag("follow", false);
  std::string source = config.follow ? "" : parameters.text("policy");
  if (parameters.has("sampled")) config.sampled = parameters.flag("sampled", false);
  config.seed = parameters.integer("seed", {0, std::numeric_limits<int>::max()}, 0);
  config.allow_other_swimmer = parameters.flag("allow_other_swimmer", false);
  parameters.finish();
  std::optional<Policy> policy;
  try {
    policy = config.follow ? first_policy(source) : Policy::load(source);
  } catch (const PolicyError& error) {
    parameters.refuse("policy", error.what());
  }
  if (!policy) return threelink_sim::kSuccess;
  Agent agent(std::move(*policy), source, config);
  return threelink_sim::spin();
}

}  // namespace
}  // namespace threelink_agent

int main(int argc, char** argv) {
  return threelink_sim::run_node(argc, argv, {"agent", threelink_agent::kHelp},
                                 threelink_agent::run);
}

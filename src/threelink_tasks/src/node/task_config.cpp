#include "task_config.hpp"

#include <limits>

#include <fmt/format.h>
#include <ros/names.h>
#include <ros/param.h>

#include "threelink_agent/evaluate.hpp"
#include "threelink_agent/policy.hpp"
#include "threelink_tasks/task_factory.hpp"

namespace threelink_tasks {
namespace {

using threelink_sim::ParameterMap;
using threelink_sim::Parameters;

constexpr int kMaxInt = std::numeric_limits<int>::max();
constexpr char kIndent[] = "  ";

threelink_sim::SimulatorConfig read_simulator(Parameters& parameters, std::string& yaml) {
  const std::string name = parameters.text("simulator", "simulator");
  const std::string resolved = ros::names::resolve(name);
  if (!ros::param::has(resolved))
    parameters.refuse("simulator", "there are no parameters of a node " + resolved);
  Parameters of_simulator{ros::NodeHandle(resolved)};
  const auto config = threelink_sim::read_simulator_config(of_simulator);
  // The bag holds the whole text of the world: a simulator that is still starting has only the name
  // of a file there.
  yaml += "simulator:\n";
  const auto& world = config.environment.world;
  for (const auto& [key, value] : of_simulator.effective_values())
    yaml += fmt::format("{}{}: {}\n", kIndent, key,
                        key == "world" && world ? threelink_sim::yaml_text(world->yaml()) : value);
  return config;
}

// How the agent acts, if it is one of ours.
void read_agent(Parameters& parameters, bool sampled, std::string& yaml) {
  const std::string resolved = ros::names::resolve(parameters.text("agent", "agent"));
  if (!ros::param::has(resolved)) return;
  Parameters of_agent{ros::NodeHandle(resolved)};
  of_agent.flag("sampled", sampled);
  of_agent.integer("seed", {0, kMaxInt}, 0);
  yaml += "agent:\n" + of_agent.effective(kIndent);
}

}  // namespace

PolicyInfo PolicyInfo::of(const std::string& file) {
  const auto policy = threelink_agent::Policy::load(file);
  return {file, policy.sha256(), threelink_agent::evaluate(policy, 0, 0).speed,
          policy.metadata().sampled, policy.metadata().environment()};
}

void PlayerConfig::require_swimmer_of(const PolicyInfo& policy) const {
  const threelink_sim::EnvironmentConfig& found = simulator.environment;
  const std::string difference = threelink_sim::swimmer_difference(found, policy.swimmer);
  // Other links are another number of observations.
  const bool playable = found.model.links == policy.swimmer.model.links;
  if (difference.empty() || (allow_other_swimmer && playable)) return;
  throw threelink_agent::PolicyError(fmt::format(
      "{}: the simulator has another swimmer than the policy was trained for: {}{}", policy.file,
      difference, playable ? " (~allow_other_swimmer plays it all the same)" : ""));
}

void assign_task(const std::string& name, ParameterMap& parameters, double dt,
                 Assignment& assignment) {
  assignment.name = name;
  assignment.task = make_task(name, parameters, {dt, assignment.policy.v_m});
  parameters.finish();
  assignment.parameters = parameters.effective(kIndent);
}

TaskNodeConfig read_task_node_config(Parameters& parameters) {
  TaskNodeConfig config;
  PlayerConfig& player = config.player;
  player.episodes = parameters.integer("episodes", {0, kMaxInt}, 1);
  player.record = parameters.flag("record", true);
  player.start_timeout = parameters.real("start_timeout", {0.1, 1e5}, 30.0);
  player.simulator = read_simulator(parameters, player.surroundings);

  config.assignment.seed = static_cast<std::uint64_t>(parameters.integer("seed", {0, kMaxInt}, 0));
  player.allow_other_swimmer = parameters.flag("allow_other_swimmer", false);
  const std::string policy = parameters.text("policy");
  try {
    config.assignment.policy = PolicyInfo::of(policy);
    player.require_swimmer_of(config.assignment.policy);
  } catch (const threelink_agent::PolicyError& error) {
    parameters.refuse("policy", error.what());
  }
  read_agent(parameters, config.assignment.policy.sampled, player.surroundings);
  const std::string task = parameters.choice("task", task_names());
  ParameterMap of_task = parameters.for_another_reader();
  assign_task(task, of_task, player.simulator.environment.dt, config.assignment);
  return config;
}

std::string PlayerConfig::yaml(const Assignment& assignment) const {
  return fmt::format(
      "task:\n  name: {}\n  seed: {}\n  policy: {}\n  v_m: {}\n{}{}", assignment.name,
      assignment.seed, threelink_sim::yaml_text(assignment.policy.file),
      threelink_sim::yaml_number(assignment.policy.v_m), assignment.parameters, surroundings);
}

}  // namespace threelink_tasks

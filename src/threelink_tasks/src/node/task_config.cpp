#include "task_config.hpp"

#include <limits>
#include <stdexcept>

#include <fmt/format.h>
#include <ros/names.h>
#include <ros/param.h>

#include "threelink_agent/evaluate.hpp"

namespace threelink_tasks {
namespace {

using threelink_sim::Parameters;
using threelink_sim::SimulatorConfig;

constexpr int kMaxInt = std::numeric_limits<int>::max();

// Far more than any swimmer covers, and little enough that nothing overflows.
constexpr threelink_sim::Range<double> kPosition{-1e6, 1e6};  // [L]
constexpr threelink_sim::Range<double> kSpeed{0, 1e3};        // [L/T0] and [L^2/T0]

SimulatorConfig read_simulator(Parameters& parameters) {
  const std::string name = parameters.text("simulator", "simulator");
  const std::string resolved = ros::names::resolve(name);
  if (!ros::param::has(resolved))
    parameters.refuse("simulator", "there are no parameters of a node " + resolved);
  Parameters of_simulator{ros::NodeHandle(resolved)};
  return threelink_sim::read_simulator_config(of_simulator);
}

Eigen::Vector2d read_point(Parameters& parameters, const std::string& name,
                           const Eigen::Vector2d& fallback) {
  const double x = parameters.real(name + "_x", kPosition, fallback.x());
  const double y = parameters.real(name + "_y", kPosition, fallback.y());
  return {x, y};
}

PursuitParameters read_pursuit(Parameters& parameters) {
  PursuitParameters pursuit;
  pursuit.start = read_point(parameters, "start", pursuit.start);
  pursuit.target = read_point(parameters, "target", pursuit.target);
  pursuit.heading = parameters.real("target_heading", {-10, 10}, pursuit.heading);
  pursuit.diffusivity = parameters.real("diffusivity", kSpeed, pursuit.diffusivity);
  pursuit.max_steps = static_cast<std::uint64_t>(
      parameters.integer("max_steps", {1, kMaxInt}, static_cast<int>(pursuit.max_steps)));
  pursuit.capture.threshold = parameters.real("threshold", {1e-9, 1e3}, pursuit.capture.threshold);
  pursuit.capture.between_steps =
      parameters.flag("capture_between_steps", pursuit.capture.between_steps);
  return pursuit;
}

// All digits, and as YAML wants it: 5.0e-05, since 5e-05 is text.
std::string number(double value) {
  std::string text = fmt::format("{}", value);
  const std::size_t e = text.find('e');
  if (e != std::string::npos && text.find('.') == std::string::npos) text.insert(e, ".0");
  return text;
}

}  // namespace

TaskConfig read_task_config(Parameters& parameters) {
  TaskConfig config;
  config.episodes = parameters.integer("episodes", {1, kMaxInt}, 1);
  config.seed = static_cast<std::uint64_t>(parameters.integer("seed", {0, kMaxInt}, 0));
  config.record = parameters.flag("record", true);
  config.start_timeout = parameters.real("start_timeout", {0.1, 1e5}, 30.0);
  config.policy_file = parameters.text("policy");
  config.v_ratio = parameters.real("v_ratio", {0, 100});
  config.pursuit = read_pursuit(parameters);
  config.simulator = read_simulator(parameters);
  parameters.finish();

  try {
    const auto policy = threelink_agent::Policy::load(config.policy_file);
    config.policy_sha256 = policy.sha256();
    config.v_m = threelink_agent::evaluate(policy, 0, 0).speed;
  } catch (const threelink_agent::PolicyError& error) {
    parameters.refuse("policy", error.what());
  }
  config.pursuit.dt = config.simulator.environment.dt;
  config.pursuit.speed = config.v_ratio * config.v_m;
  try {
    config.pursuit.validate();
  } catch (const std::invalid_argument& error) {
    throw threelink_sim::UsageError(error.what());
  }
  return config;
}

std::string TaskConfig::yaml() const {
  const threelink_sim::EnvironmentConfig& environment = simulator.environment;
  return fmt::format(
      R"(task:
  name: pursuit
  seed: {}
  policy: "{}"
  v_m: {}
  v_ratio: {}
  start_x: {}
  start_y: {}
  target_x: {}
  target_y: {}
  target_heading: {}
  diffusivity: {}
  max_steps: {}
  threshold: {}
  capture_between_steps: {}
simulator:
  links: {}
  gamma: {}
  joint_limit: {}
  dt: {}
  reward_b: {}
  reward_c: {}
  observation: {}
  length_scale: {}
  time_scale: {}
  realtime_factor: {}
  peer_timeout: {}
  watchdog_periods: {}
)",
      seed, policy_file, number(v_m), number(v_ratio), number(pursuit.start.x()),
      number(pursuit.start.y()), number(pursuit.target.x()), number(pursuit.target.y()),
      number(pursuit.heading), number(pursuit.diffusivity), pursuit.max_steps,
      number(pursuit.capture.threshold), pursuit.capture.between_steps, environment.model.links,
      number(environment.model.gamma), number(environment.model.joint_limit),
      number(environment.dt), number(environment.b), number(environment.c), simulator.observation,
      number(simulator.scales.length), number(simulator.scales.time),
      number(simulator.realtime_factor), number(simulator.peer_timeout),
      number(simulator.watchdog_periods));
}

}  // namespace threelink_tasks

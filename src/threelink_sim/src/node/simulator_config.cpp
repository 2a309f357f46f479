#include "threelink_sim/node/simulator_config.hpp"

#include <chrono>
#include <cmath>

#include <threelink_msgs/Observation.h>

namespace threelink_sim {
namespace {

Lockstep::Duration wall(double seconds) {
  return std::chrono::duration_cast<Lockstep::Duration>(std::chrono::duration<double>(seconds));
}

}  // namespace

Lockstep::Config SimulatorConfig::lockstep() const {
  Lockstep::Config config;
  config.hinges = environment.model.hinges();
  config.tick = static_cast<std::uint64_t>(std::llround(1e9 * step_time()));
  config.period = wall(step_period());
  config.peer_timeout = wall(peer_timeout);
  config.watchdog = wall(watchdog());
  return config;
}

void read_swimmer(ParameterMap& parameters, EnvironmentConfig& config) {
  config.model.links = parameters.integer("links", {2, kMaxLinks}, 3);
  config.model.gamma = parameters.real("gamma", {1e-3, 10}, 0.5);
  config.model.joint_limit = parameters.real("joint_limit", {1e-3, kPi}, 2 * kPi / 3);
  config.dt = parameters.real("dt", {1e-3, 1}, 0.1);
}

SimulatorConfig read_simulator_config(ParameterMap& parameters) {
  SimulatorConfig config;
  read_swimmer(parameters, config.environment);
  config.environment.b = parameters.real("reward_b", {1e-6, 1e6}, 6.0);
  config.environment.c = parameters.real("reward_c", {0, 1e6}, 0.0);
  using threelink_msgs::Observation;
  config.environment.observation = observation_kind_from_string(parameters.choice(
      "observation", {Observation::DIRECTION, Observation::TARGET}, Observation::DIRECTION));
  config.scales.length = parameters.real("length_scale", {1e-9, 1e6}, 1.0);
  config.scales.time = parameters.real("time_scale", {1e-3, 1e3}, 1.0);
  config.realtime_factor = parameters.real("realtime_factor", {0, 1e4}, 1.0);
  config.peer_timeout = parameters.real("peer_timeout", {0.1, 1e5}, 10.0);
  config.watchdog_periods = parameters.real("watchdog_periods", {1, 1e3}, 3.0);
  config.display_rate = parameters.real("display_rate", {0.1, 1e3}, 30.0);
  parameters.finish();
  return config;
}

}  // namespace threelink_sim

#include "threelink_sim/node/simulator_config.hpp"

#include <chrono>
#include <cmath>

#include "threelink_sim/fields.hpp"

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
  EnvironmentConfig::swimmer_fields(config, FieldReader(parameters));
}

SimulatorConfig read_simulator_config(ParameterMap& parameters) {
  SimulatorConfig config;
  SimulatorConfig::fields(config, FieldReader(parameters));
  parameters.finish();
  if (config.world.empty()) return config;
  try {
    config.environment.world = World::read(config.world, "world", "");
    config.environment.validate();
  } catch (const UsageError& error) {
    throw within<ParameterError>("world", error);
  }
  return config;
}

}  // namespace threelink_sim

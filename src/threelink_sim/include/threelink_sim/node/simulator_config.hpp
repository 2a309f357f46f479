// The simulator node's parameters; config/swimmer.yaml is their manual.
#pragma once

#include <string>

#include "threelink_sim/environment.hpp"
#include "threelink_sim/lockstep.hpp"
#include "threelink_sim/node/conversions.hpp"
#include "threelink_sim/node/parameters.hpp"

namespace threelink_sim {

struct SimulatorConfig {
  EnvironmentConfig environment;
  Scales scales;
  std::string observation;  // kind
  double realtime_factor;   // 0: as fast as possible
  double peer_timeout;      // [s] wall time
  double watchdog_periods;  // [action periods]
  double display_rate;      // [1/s] wall time

  // Length of an action step: simulation time [s].
  double step_time() const { return environment.dt * scales.time; }
  Lockstep::Config lockstep() const;
};

// Throws ParameterError.
SimulatorConfig read_simulator_config(Parameters& parameters);

}  // namespace threelink_sim

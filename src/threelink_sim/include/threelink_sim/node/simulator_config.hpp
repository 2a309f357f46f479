// The simulator node's parameters; config/swimmer.yaml is their manual.
#pragma once

#include <algorithm>

#include "threelink_sim/environment.hpp"
#include "threelink_sim/lockstep.hpp"
#include "threelink_sim/node/conversions.hpp"
#include "threelink_sim/parameter_map.hpp"

namespace threelink_sim {

struct SimulatorConfig {
  EnvironmentConfig environment;
  Scales scales;
  double realtime_factor = 0;   // 0: as fast as possible
  double peer_timeout = 0;      // [s] wall time
  double watchdog_periods = 0;  // [action periods]
  double display_rate = 0;      // [1/s] wall time

  // Length of an action step: simulation time [s], and wall time [s], 0 without a pace.
  double step_time() const { return environment.dt * scales.time; }
  double step_period() const { return realtime_factor > 0 ? step_time() / realtime_factor : 0; }
  // [s] wall time: watchdog_periods of the longer of the two, so that a simulation that runs faster
  // than real time does not trip over the jitter of the machine.
  double watchdog() const { return watchdog_periods * std::max(step_time(), step_period()); }
  // [s] wall time. The simulator reports silent peers after its peer_timeout; it is silent itself
  // if nothing has come for longer than that and than its pace explains.
  double silence_limit() const { return peer_timeout + watchdog() + step_period() + 2; }
  Lockstep::Config lockstep() const;
};

// The swimmer and its action step alone. Throws ParameterError.
void read_swimmer(ParameterMap& parameters, EnvironmentConfig& config);
// From the node's own parameters, or as they were recorded. Throws ParameterError.
SimulatorConfig read_simulator_config(ParameterMap& parameters);

}  // namespace threelink_sim

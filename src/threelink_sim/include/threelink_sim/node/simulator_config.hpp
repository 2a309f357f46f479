/// @file
/// The simulator node's parameters; config/swimmer.yaml is their manual.
#pragma once

#include <algorithm>

#include "threelink_sim/environment.hpp"
#include "threelink_sim/lockstep.hpp"
#include "threelink_sim/node/conversions.hpp"
#include "threelink_sim/parameter_map.hpp"

namespace threelink_sim {

struct SimulatorConfig {
  EnvironmentConfig environment;
  std::string world;  ///< of the environment: its file, or its text
  Scales scales;
  double realtime_factor = 1;
  double peer_timeout = 10;
  double watchdog_periods = 3;
  double display_rate = 30;

  template <class Self, class Visit>
  static void fields(Self& self, Visit&& visit) {
    EnvironmentConfig::swimmer_fields(self.environment, visit);
    EnvironmentConfig::reward_fields(self.environment, visit, "reward_b", "reward_c");
    visit("observation", self.environment.observation, "what the agent is shown");
    visit("world", self.world, "world file, or its text; empty: still water");
    visit("length_scale", self.scales.length, Range<double>{1e-9, 1e6}, "[m] of the length L");
    visit("time_scale", self.scales.time, Range<double>{1e-3, 1e3}, "[s] of the time T0");
    visit("realtime_factor", self.realtime_factor, Range<double>{0, 1e4},
          "[s of simulation / s of wall time] pace; 0: as fast as possible");
    visit("peer_timeout", self.peer_timeout, Range<double>{0.1, 1e5}, "[s] of wall time");
    visit("watchdog_periods", self.watchdog_periods, Range<double>{1, 1e3}, "[action periods]");
    visit("display_rate", self.display_rate, Range<double>{0.1, 1e3}, "[1/s] of wall time");
  }

  /// Length of an action step: simulation time [s], and wall time [s], 0 without a pace.
  double step_time() const { return environment.dt * scales.time; }
  double step_period() const { return realtime_factor > 0 ? step_time() / realtime_factor : 0; }
  /// [s] wall time: watchdog_periods of the longer of the two, so that a simulation that runs
  /// faster than real time does not trip over the jitter of the machine.
  double watchdog() const { return watchdog_periods * std::max(step_time(), step_period()); }
  /// [s] wall time. The simulator reports silent peers after its peer_timeout; it is silent itself
  /// if nothing has come for longer than that and than its pace explains.
  double silence_limit() const { return peer_timeout + watchdog() + step_period() + 2; }
  Lockstep::Config lockstep() const;
};

/// The swimmer and its action step alone. Throws ParameterError.
void read_swimmer(ParameterMap& parameters, EnvironmentConfig& config);
/// From the node's own parameters, or as they were recorded. Throws ParameterError.
SimulatorConfig read_simulator_config(ParameterMap& parameters);

}  // namespace threelink_sim

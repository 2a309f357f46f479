/// @file
/// The parameters of the simulator node, which config/swimmer.yaml explains.
#pragma once

#include <algorithm>

#include "threelink_sim/environment.hpp"
#include "threelink_sim/lockstep.hpp"
#include "threelink_sim/node/conversions.hpp"
#include "threelink_sim/parameter_map.hpp"

namespace threelink_sim {

/// The parameters.
struct SimulatorConfig {
  EnvironmentConfig environment;
  std::string world;  ///< world of the environment: its file, or its text
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

  /// [s] simulation time of an action step.
  double step_time() const { return environment.dt * scales.time; }
  /// [s] wall time of an action step; 0 without a pace.
  double step_period() const { return realtime_factor > 0 ? step_time() / realtime_factor : 0; }
  /// [s] wall time of the watchdog: watchdog_periods times the longer of the two, so that the
  /// jitter of the machine does not trip it in a simulation that is faster than real time.
  double watchdog() const { return watchdog_periods * std::max(step_time(), step_period()); }
  /// [s] wall time after which the simulator counts as silent. It reports silent peers after its
  /// peer_timeout; its own silence must exceed that time and the delay of its pace.
  double silence_limit() const { return peer_timeout + watchdog() + step_period() + 2; }
  Lockstep::Config lockstep() const;
};

/// Reads only the swimmer and its action step. Throws ParameterError.
void read_swimmer(ParameterMap& parameters, EnvironmentConfig& config);
/// Reads all parameters of the node or of a recording. Throws ParameterError.
SimulatorConfig read_simulator_config(ParameterMap& parameters);

}  // namespace threelink_sim

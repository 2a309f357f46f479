/// @file
/// Generalised advantage estimation (Schulman et al. 2016, arXiv:1506.02438).
#pragma once

#include <cstdint>
#include <vector>

#include "threelink_sim/range.hpp"

namespace threelink_agent {

/// Section `advantage` of a configuration.
struct AdvantageSettings {
  double discount = 0;
  double lambda = 0;
  /// Whether the value of the last state is added at the time limit, where the swimmer would swim
  /// on. Otherwise the return ends there, and a critic that cannot observe the time estimates it
  /// wrongly.
  bool bootstrap_at_time_limit = true;
  bool normalise = true;  ///< whether the caller applies normalise()

  template <class Self, class Visit>
  static void fields(Self& self, Visit&& visit) {
    using threelink_sim::Range;
    visit("discount", self.discount, Range<double>{0, 1, false, true}, "Gamma");
    visit("lambda", self.lambda, Range<double>{0, 1}, "of GAE; 1: Monte-Carlo returns");
    visit("bootstrap_at_time_limit", self.bootstrap_at_time_limit,
          "the time limit cuts the episode, but ends nothing");
    visit("normalise", self.normalise, "to mean 0 and deviation 1 in each update");
  }
};

/// Advantages and returns of a rollout.
struct Advantages {
  std::vector<float> advantages;  ///< (steps, episodes)
  std::vector<float> returns;     ///< (steps, episodes) targets of the critic, R_t
};

/// Generalised advantage estimation over `episodes` episodes of `steps` steps side by side; element
/// (t, i) of each array at [t * episodes + i].
///
///   delta_t = r_t + Gamma V_{t+1} - V_t,   A_t = delta_t + Gamma lambda A_{t+1},   R_t = A_t + V_t
///
/// with A_{steps} = 0, and V_{steps} = 0 if the time limit does not bootstrap. lambda = 1 without
/// bootstrap is the paper's R_k - V_k with Monte-Carlo returns. Where captured_t is 1, V_{t+1} and
/// A_{t+1} count as 0, because what follows is the path to another target.
///
/// rewards, captured (steps, episodes), values (steps + 1, episodes).
Advantages generalised_advantages(int steps, int episodes, const std::vector<float>& rewards,
                                  const std::vector<std::uint8_t>& captured,
                                  const std::vector<float>& values,
                                  const AdvantageSettings& settings);

/// Scales the advantages to mean 0 and standard deviation 1; constant advantages become 0.
void normalise(std::vector<float>& advantages);

}  // namespace threelink_agent

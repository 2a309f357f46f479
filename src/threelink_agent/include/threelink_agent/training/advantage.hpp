/// @file
/// How much better an action was than expected (Schulman et al. 2016, arXiv:1506.02438).
#pragma once

#include <cstdint>
#include <vector>

#include "threelink_sim/range.hpp"

namespace threelink_agent {

struct AdvantageSettings {
  double discount = 0;
  double lambda = 0;
  /// An episode that ran into the time limit has a future: its last state counts with its value.
  /// Without it the time limit is a true end, and a critic that cannot see the time goes astray.
  bool bootstrap_at_time_limit = true;
  bool normalise = true;  ///< for who calls normalise()

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

struct Advantages {
  std::vector<float> advantages;  ///< (steps, episodes)
  std::vector<float> returns;     ///< (steps, episodes) what the critic should have said
};

/// Generalised advantage estimation over `episodes` episodes of `steps` steps side by side; element
/// (t, i) of each array at [t * episodes + i].
///
///   delta_t = r_t + Gamma V_{t+1} - V_t,   A_t = delta_t + Gamma lambda A_{t+1},   R_t = A_t + V_t
///
/// with A_{steps} = 0, and V_{steps} = 0 if the time limit does not bootstrap. lambda = 1 without
/// bootstrap is the paper's R_k - V_k with Monte-Carlo returns. Where captured_t is 1, V_{t+1} and
/// A_{t+1} count as 0: what follows is another way, to another target.
///
/// rewards, captured (steps, episodes), values (steps + 1, episodes).
Advantages generalised_advantages(int steps, int episodes, const std::vector<float>& rewards,
                                  const std::vector<std::uint8_t>& captured,
                                  const std::vector<float>& values,
                                  const AdvantageSettings& settings);

/// To mean 0 and standard deviation 1; constant ones become 0.
void normalise(std::vector<float>& advantages);

}  // namespace threelink_agent

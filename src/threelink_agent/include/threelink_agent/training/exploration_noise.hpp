/// @file
/// The exploration noise of the actions.
#pragma once

#include <cstdint>
#include <vector>

#include "threelink_sim/random.hpp"

namespace threelink_agent {

/// Standard normals for one step of several consecutive episodes, keyed by (seed, episode, step).
class ExplorationNoise {
 public:
  ExplorationNoise(std::uint64_t seed, std::uint32_t first_episode, int episodes, int hinges);

  void draw(std::uint32_t step);
  /// The normal of the last draw(); episode counts from 0.
  float operator()(int hinge, int episode) const {
    return static_cast<float>(normals_[2 * draws_ * episode + hinge]);
  }

 private:
  std::uint32_t key_[2];
  int draws_;  ///< draws of an episode; each gives two normals
  std::vector<threelink_sim::RandomCounter> counters_;
  std::vector<double> normals_;
};

}  // namespace threelink_agent

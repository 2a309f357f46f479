// What a task is: where an episode starts, where the swimmer should go, and when it is over.
#pragma once

#include <cstdint>
#include <string>

#include <Eigen/Core>

#include "threelink_sim/model.hpp"

namespace threelink_tasks {

// Start of an episode in the paper's coordinates, fixed frame.
struct Start {
  Eigen::Vector2d x_1 = {0.0, 0.0};  // [L] free end of link 1
  double theta_1 = 0.0;              // [rad] its angle
  threelink_sim::HingeVector alpha;  // [rad] (N-1) hinge angles; empty: straight
};

enum class Outcome { kRunning, kCaptured, kTimedOut };

// One task, played over and over. An episode is one reset() and then one observe() for each state
// k = 0, 1, 2, ..., until the outcome is no longer kRunning. All randomness is keyed by (seed,
// episode, k): an episode comes out the same whatever was played before, in any process.
class Task {
 public:
  virtual ~Task() = default;

  virtual std::string name() const = 0;

  // Where the swimmer is put for each episode.
  virtual Start start() const = 0;

  virtual void reset(std::uint64_t seed, std::uint32_t episode) = 0;

  // Moves on to state k, with the swimmer's centroid [L] in it.
  virtual Outcome observe(const Eigen::Vector2d& centroid) = 0;

  // [L] where the swimmer should go, as of the state last observed; fixed frame.
  virtual Eigen::Vector2d target() const = 0;
};

}  // namespace threelink_tasks

/// @file
/// What a task is: where an episode starts, where the swimmer should go, and when it is over.
#pragma once

#include <cstdint>
#include <vector>

#include <Eigen/Core>

#include "threelink_sim/environment.hpp"
#include "threelink_sim/parameter_map.hpp"
#include "threelink_sim/swimmer.hpp"

namespace threelink_sim {

/// What a task may need to know of the swimmer that plays it.
struct TaskContext {
  double dt = 0.1;   ///< [T0] action step
  double v_m = 0.0;  ///< [L/T0] speed of the policy by threelink_agent::evaluate()
};

/// Start of an episode in the paper's coordinates, fixed frame.
struct Start {
  Eigen::Vector2d x_1 = {0.0, 0.0};  ///< [L] free end of link 1
  double theta_1 = 0.0;              ///< [rad] its angle
  HingeVector alpha;                 ///< [rad] (N-1) hinge angles; empty: straight
  /// Instead of all that random_start(config, seed, episode): the centroid at the
  /// origin, any heading, any shape.
  bool random = false;
};

/// Where that puts the swimmer.
SwimmerState start_state(const EnvironmentConfig& config, const Start& start, std::uint64_t seed,
                         std::uint32_t episode);

enum class Outcome { kRunning, kCaptured, kTimedOut };

/// One task, played over and over. configure() comes once and first. An episode is one reset() and
/// then one observe() for each state k = 0, 1, 2, ..., until the outcome is no longer kRunning. All
/// randomness is keyed by (seed, episode, k): an episode comes out the same whatever was played
/// before, in any process.
class Task {
 public:
  virtual ~Task() = default;

  /// Takes its parameters, all of them; whoever calls it calls parameters.finish(). Throws
  /// ParameterError.
  virtual void configure(ParameterMap& parameters, const TaskContext& context) = 0;

  /// Where the swimmer is put for each episode.
  virtual Start start() const = 0;

  virtual void reset(std::uint64_t seed, std::uint32_t episode) = 0;

  /// Moves on to state k, with the swimmer's centroid [L] in it.
  virtual Outcome observe(const Eigen::Vector2d& centroid) = 0;

  /// [L] where the swimmer should go, as of the state last observed; fixed frame.
  virtual Eigen::Vector2d target() const = 0;

  /// [L] fixed points to be reached in this order, as of the last reset(); none where the target
  /// moves. waypoint() is the number of those reached, and so the index of the next one.
  virtual std::vector<Eigen::Vector2d> waypoints() const { return {}; }
  virtual std::uint32_t waypoint() const { return 0; }

  /// Whether a user may set the target [L] while an episode runs. Then targets do not follow from
  /// the seed alone.
  virtual bool takes_points() const { return false; }
  virtual void take_point(const Eigen::Vector2d& /*point*/) {}
};

}  // namespace threelink_sim

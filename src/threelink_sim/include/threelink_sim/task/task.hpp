/// @file
/// The interface of a task: start, target and end of an episode.
#pragma once

#include <cstdint>
#include <vector>

#include <Eigen/Core>

#include "threelink_sim/environment.hpp"
#include "threelink_sim/parameter_map.hpp"
#include "threelink_sim/swimmer.hpp"

namespace threelink_sim {

/// Properties of the swimmer that a task may need.
struct TaskContext {
  double dt = 0.1;   ///< [T0] action step
  double v_m = 0.0;  ///< [L/T0] speed of the policy by threelink_agent::evaluate()
};

/// Start of an episode in the paper's coordinates, fixed frame.
struct Start {
  Eigen::Vector2d x_1 = {0.0, 0.0};  ///< [L] free end of link 1
  double theta_1 = 0.0;              ///< [rad] its angle
  HingeVector alpha;                 ///< [rad] (N-1) hinge angles; empty: straight
  /// If true, the above is replaced by random_start(config, seed, episode): centroid at the origin,
  /// random heading and shape.
  bool random = false;
};

/// The state of the swimmer for a start.
SwimmerState start_state(const EnvironmentConfig& config, const Start& start, std::uint64_t seed,
                         std::uint32_t episode);

/// State of an episode.
enum class Outcome { kRunning, kCaptured, kTimedOut };

/// A task that is played in any number of episodes. configure() must be called first, once. An
/// episode is one reset() and then one observe() for each state k = 0, 1, 2, ..., until the outcome
/// is not kRunning. All random numbers are keyed by (seed, episode, k): an episode is the same in
/// any process, whatever was played before.
class Task {
 public:
  virtual ~Task() = default;

  /// Reads all parameters of the task; the caller then calls parameters.finish(). Throws
  /// ParameterError.
  virtual void configure(ParameterMap& parameters, const TaskContext& context) = 0;

  /// The start of each episode.
  virtual Start start() const = 0;

  /// Begins episode `episode` of seed `seed`.
  virtual void reset(std::uint64_t seed, std::uint32_t episode) = 0;

  /// Proceeds to state k, in which the swimmer's centroid is at `centroid` [L].
  virtual Outcome observe(const Eigen::Vector2d& centroid) = 0;

  /// [L] position of the target in the state last observed, fixed frame.
  virtual Eigen::Vector2d target() const = 0;

  /// [L] fixed points that are to be reached in this order since the last reset(); empty if the
  /// target moves. waypoint() is the number of reached points and the index of the next one.
  virtual std::vector<Eigen::Vector2d> waypoints() const { return {}; }
  virtual std::uint32_t waypoint() const { return 0; }

  /// Whether a user may set the target [L] while an episode runs. In that case targets do not
  /// follow from the seed alone.
  virtual bool takes_points() const { return false; }
  virtual void take_point(const Eigen::Vector2d& /*point*/) {}
};

}  // namespace threelink_sim

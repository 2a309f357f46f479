/// @file
/// The goals of a training and their rewards.
///
///   direction  swim towards theta_T = 0 from a random start. A step earns the environment's
///              reward, b dx.p - c W; nothing is captured.
///   points     points at random distances, one after the other, from a random start
///              (points_goal.cpp).
///   a task     any task of task_factory.hpp, repeated within an episode (task_goal.cpp).
///
/// With a target, a step earns b (r_k - r_{k+1}) - c W, where r is the distance to the target's
/// position in state k, and a bonus for a capture. A capture ends the return, because what follows
/// is the path to another target.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>

#include "threelink_sim/environment.hpp"
#include "threelink_sim/fields.hpp"

namespace threelink_sim {

/// Points to reach one after the other.
struct PointsGoal {
  double direction_share = 0;
  double nearest = 0;
  double farthest = 0;
  double threshold = 0;
  double bonus = 0;

  template <class Self, class Visit>
  static void fields(Self& self, Visit&& visit) {
    visit("direction_share", self.direction_share, Range<double>{0, 1},
          "of the episodes, without points, towards theta_T = 0");
    visit("nearest", self.nearest, Range<double>{1e-9, 1e3},
          "[L] a point's distance when it is drawn: log-uniform, from this");
    visit("farthest", self.farthest, Range<double>{1e-9, 1e3}, "[L] to this, at any bearing");
    visit("threshold", self.threshold, Range<double>{1e-9, 1e3}, "[L] nearer than this: captured");
    visit("bonus", self.bonus, Range<double>{0, 1e6}, "reward of the capture");
  }
};

/// A task to play repeatedly.
struct TaskGoal {
  std::string task;  ///< name of the task
  double bonus = 0;
  double v_m = 0;
  bool random_start = false;
  FieldTexts parameters;  ///< parameters of the task: names, and values as YAML

  template <class Self, class Visit>
  static void fields(Self& self, Visit&& visit) {
    visit("bonus", self.bonus, Range<double>{0, 1e6}, "reward of the capture");
    visit("v_m", self.v_m, Range<double>{0, 1e6},
          "[L/T0] the speed that the task takes for the policy's");
    visit("random_start", self.random_start,
          "random heading and shape, with the centroid where the task starts");
  }
};

/// The goal: points, a task, or, with neither, a direction.
struct GoalConfig {
  std::optional<PointsGoal> points;
  std::optional<TaskGoal> task;

  std::string kind() const { return points ? "points" : task ? task->task : "direction"; }
  /// Whether there is a target at a finite distance, which only ObservationKind::kTarget shows.
  bool has_target() const { return points || task; }

  template <class Self, class Visit>
  static void fields(Self& self, Visit&& visit) {
    std::string kind = self.kind();
    visit("kind", kind, "direction, points, or the name of a task");
    if (self.points) PointsGoal::fields(*self.points, visit);
    if (self.task) TaskGoal::fields(*self.task, visit);
  }
};

/// Reads the section `goal` of a file; the caller calls finish(). Throws ParameterError, and
/// UsageError that names the nearest known task for an unknown name.
GoalConfig read_goal(ParameterMap& section, double dt);

/// The goals of episodes first .. first + lanes - 1 in the lanes of an environment. Random numbers
/// are keyed by (seed, episode, step): an episode does not depend on the others.
class Goals {
 public:
  virtual ~Goals() = default;

  /// Must be called after step k of all lanes and before state k + 1 is observed. Writes the
  /// rewards (lanes) of the step, and for each lane whether the step ended in a capture (0 or 1).
  virtual void after_step(std::uint32_t k, float* rewards, std::uint8_t* captured) = 0;
};

/// Places the swimmers at their starts and sets their targets. `environment` must outlive the
/// result.
std::unique_ptr<Goals> make_goals(const GoalConfig& config, std::uint64_t seed,
                                  std::uint32_t first_episode, Environment& environment);

}  // namespace threelink_sim

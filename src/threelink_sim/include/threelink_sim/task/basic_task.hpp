/// @file
/// A base class for tasks with a straight start, a time limit and capture.
#pragma once

#include "threelink_sim/task/capture.hpp"
#include "threelink_sim/task/task.hpp"

namespace threelink_sim {

/// [L] bounds of a coordinate: far larger than any path, and without overflow.
constexpr Range<double> kPosition{-1e6, 1e6};

/// (cos angle, sin angle), equal to the bit on every machine with fused multiply-adds.
Eigen::Vector2d unit_vector(double angle);

/// Base of a task. A subclass implements advance() and, if needed, begin() and configure().
class BasicTask : public Task {
 public:
  /// Reads max_steps, and start_x and start_y unless the start is random. An override must call it.
  void configure(ParameterMap& parameters, const TaskContext& context) override;

  Start start() const override { return start_; }
  void reset(std::uint64_t seed, std::uint32_t episode) final;
  Outcome observe(const Eigen::Vector2d& centroid) final;
  Eigen::Vector2d target() const final { return target_; }

 protected:
  explicit BasicTask(int default_max_steps = 50000) : max_steps_(default_max_steps) {}

  /// Called at the start of an episode, when seed() and episode() are set.
  virtual void begin() {}
  /// Sets target_ to its position in state k = `step`. Returns true if the swimmer has reached the
  /// goal of the task.
  virtual bool advance(std::uint32_t step, const Eigen::Vector2d& centroid) = 0;

  /// Reads threshold and capture_between_steps. The latter is refused if the target moves.
  void configure_capture(ParameterMap& parameters, bool target_moves);
  /// Reads NAME_x and NAME_y.
  static Eigen::Vector2d read_point(ParameterMap& parameters, const std::string& name,
                                    const Eigen::Vector2d& fallback);

  std::uint64_t seed() const { return seed_; }
  std::uint32_t episode() const { return episode_; }
  /// [L] centroid of the straight swimmer along x at the start.
  Eigen::Vector2d start_centroid() const { return start_.x_1 + Eigen::Vector2d(0.5, 0); }

  TaskContext context_;
  Start start_;
  Capture capture_{CaptureParameters()};
  Eigen::Vector2d target_ = {0.0, 0.0};  ///< [L]

 private:
  int max_steps_;
  std::uint64_t seed_ = 0;
  std::uint32_t episode_ = 0;
  std::uint32_t next_step_ = 0;  ///< k of the state that observe() takes next
};

}  // namespace threelink_sim

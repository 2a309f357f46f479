#include "threelink_sim/task/basic_task.hpp"

#include <limits>

#include "threelink_sim/kernel/kernels.hpp"

namespace threelink_sim {

Eigen::Vector2d unit_vector(double angle) {
  double sine, cosine;
  kernels().sincos(1, &angle, &sine, &cosine);
  return {cosine, sine};
}

Eigen::Vector2d BasicTask::read_point(ParameterMap& parameters, const std::string& name,
                                      const Eigen::Vector2d& fallback) {
  const double x = parameters.real(name + "_x", kPosition, fallback.x());
  const double y = parameters.real(name + "_y", kPosition, fallback.y());
  return {x, y};
}

void BasicTask::configure(ParameterMap& parameters, const TaskContext& context) {
  context_ = context;
  if (!start_.random) start_.x_1 = read_point(parameters, "start", {1, 0});
  max_steps_ = parameters.integer("max_steps", {1, std::numeric_limits<int>::max()}, max_steps_);
}

void BasicTask::configure_capture(ParameterMap& parameters, bool target_moves) {
  CaptureParameters capture;
  capture.threshold = parameters.real("threshold", {1e-9, 1e3}, capture.threshold);
  capture.between_steps = parameters.flag("capture_between_steps", capture.between_steps);
  if (capture.between_steps && target_moves)
    parameters.refuse("capture_between_steps", "needs a target at rest");
  capture_ = Capture(capture);
}

void BasicTask::reset(std::uint64_t seed, std::uint32_t episode) {
  seed_ = seed;
  episode_ = episode;
  next_step_ = 0;
  capture_.reset();
  begin();
}

Outcome BasicTask::observe(const Eigen::Vector2d& centroid) {
  const std::uint32_t step = next_step_++;
  if (advance(step, centroid)) return Outcome::kCaptured;
  return step < static_cast<std::uint32_t>(max_steps_) ? Outcome::kRunning : Outcome::kTimedOut;
}

}  // namespace threelink_sim

#include "threelink_tasks/pursuit.hpp"

#include <cmath>
#include <limits>
#include <stdexcept>

#include <fmt/format.h>

#include "threelink_sim/random.hpp"

namespace threelink_tasks {
namespace {

void require(bool valid, const char* field, double value, const char* bound) {
  if (!valid) throw std::invalid_argument(fmt::format("{} = {}: must be {}", field, value, bound));
}

void require_finite(const char* field, const Eigen::Vector2d& point) {
  if (!point.allFinite())
    throw std::invalid_argument(
        fmt::format("{} = ({}, {}): must be finite", field, point.x(), point.y()));
}

}  // namespace

void PursuitParameters::validate() const {
  require_finite("start", start);
  require_finite("target", target);
  require(std::isfinite(heading), "heading", heading, "finite");
  require(std::isfinite(speed) && speed >= 0, "speed", speed, ">= 0");
  require(std::isfinite(diffusivity) && diffusivity >= 0, "diffusivity", diffusivity, ">= 0");
  require(std::isfinite(dt) && dt > 0, "dt", dt, "> 0");
  // Steps are numbered by 32 bits where they key the random numbers.
  require(max_steps > 0 && max_steps <= std::numeric_limits<std::uint32_t>::max(), "max_steps",
          static_cast<double>(max_steps), "in [1, 2^32 - 1]");
  capture.validate();
  if (capture.between_steps && (speed > 0 || diffusivity > 0))
    throw std::invalid_argument(
        fmt::format("capture_between_steps = true: needs a target at rest, but its speed is {} and "
                    "its diffusivity {}",
                    speed, diffusivity));
}

Pursuit::Pursuit(const PursuitParameters& parameters)
    : parameters_((parameters.validate(), parameters)),
      drift_(parameters.speed * parameters.dt *
             Eigen::Vector2d(std::cos(parameters.heading), std::sin(parameters.heading))),
      sigma_(std::sqrt(2 * parameters.diffusivity * parameters.dt)),
      capture_(parameters.capture),
      target_(parameters.target) {}

Start Pursuit::start() const {
  Start start;
  start.x_1 = parameters_.start;
  return start;
}

void Pursuit::reset(std::uint64_t seed, std::uint32_t episode) {
  seed_ = seed;
  episode_ = episode;
  next_step_ = 0;
  target_ = parameters_.target;
  capture_.reset();
}

Outcome Pursuit::observe(const Eigen::Vector2d& centroid) {
  const std::uint32_t step = next_step_++;
  if (step > 0) {
    threelink_sim::Random random(seed_, threelink_sim::Stream::kTarget, episode_, step);
    const double n_x = random.normal();
    const double n_y = random.normal();
    target_ += drift_ + sigma_ * Eigen::Vector2d(n_x, n_y);
  }
  if (capture_.captured(centroid, target_)) return Outcome::kCaptured;
  return step < parameters_.max_steps ? Outcome::kRunning : Outcome::kTimedOut;
}

}  // namespace threelink_tasks

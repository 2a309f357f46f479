// Pursuit of a target that swims on its own and diffuses (the paper's section on diffusing
// targets).
//
// The target moves once per action step dt, straight ahead at its own speed and by a Brownian step:
//   x_T(k) = x_T(k-1) + v_T (cos phi, sin phi) dt + sigma (n_x, n_y),   sigma^2 = 2 D dt,
// with n_x, n_y standard normal and keyed by (seed, kTarget, episode, k): the target's path depends
// on nothing else, least of all on the swimmer.
#pragma once

#include "threelink_tasks/capture.hpp"
#include "threelink_tasks/task.hpp"

namespace threelink_tasks {

struct PursuitParameters {
  Eigen::Vector2d start = {1.0, 0.0};       // [L] the swimmer's x_1; it starts straight along x
  Eigen::Vector2d target = {1.5, 0.5};      // [L] x_T at step 0
  double heading = threelink_sim::kPi / 6;  // [rad] phi, direction of the target's own motion
  double speed = 0.0;                       // [L/T0] v_T, >= 0
  double diffusivity = 5.0e-5;              // [L^2/T0] D, >= 0
  double dt = 0.1;                          // [T0] action step, > 0
  std::uint64_t max_steps = 50000;          // the episode then ends as timed out, > 0
  CaptureParameters capture;                // between_steps needs a target at rest

  // Throws std::invalid_argument that names field, value and bound.
  void validate() const;
};

class Pursuit : public Task {
 public:
  explicit Pursuit(const PursuitParameters& parameters);

  std::string name() const override { return "pursuit"; }
  Start start() const override;
  void reset(std::uint64_t seed, std::uint32_t episode) override;
  Outcome observe(const Eigen::Vector2d& centroid) override;
  Eigen::Vector2d target() const override { return target_; }

 private:
  PursuitParameters parameters_;
  Eigen::Vector2d drift_;  // [L] the target's own way in one step
  double sigma_;           // [L] of its Brownian step, per axis
  Capture capture_;
  std::uint64_t seed_ = 0;
  std::uint32_t episode_ = 0;
  std::uint32_t next_step_ = 0;  // k of the state that observe() takes next
  Eigen::Vector2d target_;
};

}  // namespace threelink_tasks

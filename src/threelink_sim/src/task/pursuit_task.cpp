// pursuit: a target that swims on its own and diffuses (the paper's section on diffusing targets).
//
// The target moves once per action step dt, straight ahead at its own speed and by a Brownian step:
//   x_T(k) = x_T(k-1) + v_T (cos phi, sin phi) dt + sigma (n_x, n_y),   sigma^2 = 2 D dt,
// with v_T = v_ratio v_m, and n_x, n_y standard normal and keyed by (seed, kTarget, episode, k):
// the target's path depends on nothing else, least of all on the swimmer.
#include <cmath>

#include "builtin_tasks.hpp"
#include "threelink_sim/random.hpp"
#include "threelink_sim/task/basic_task.hpp"

namespace threelink_sim {
namespace {

class PursuitTask : public BasicTask {
 public:
  void configure(ParameterMap& parameters, const TaskContext& context) override {
    BasicTask::configure(parameters, context);
    const double v_ratio = parameters.real("v_ratio", {0, 100});
    target_start_ = read_point(parameters, "target", {1.5, 0.5});
    const double heading = parameters.real("target_heading", {-10, 10}, kPi / 6);
    const double diffusivity = parameters.real("diffusivity", {0, 1e3}, 5.0e-5);
    drift_ = v_ratio * context.v_m * context.dt * unit_vector(heading);
    sigma_ = std::sqrt(2 * diffusivity * context.dt);
    configure_capture(parameters, v_ratio > 0 || diffusivity > 0);
  }

 private:
  bool advance(std::uint32_t step, const Eigen::Vector2d& centroid) override {
    if (step == 0) {
      target_ = target_start_;
    } else {
      Random random(seed(), Stream::kTarget, episode(), step);
      const double n_x = random.normal();
      const double n_y = random.normal();
      target_ += drift_ + sigma_ * Eigen::Vector2d(n_x, n_y);
    }
    return capture_.captured(centroid, target_);
  }

  Eigen::Vector2d target_start_;  // [L] x_T(0)
  Eigen::Vector2d drift_;         // [L] the target's own way in one step
  double sigma_ = 0;              // [L] of its Brownian step, per axis
};

}  // namespace

std::unique_ptr<Task> make_pursuit() { return std::make_unique<PursuitTask>(); }

}  // namespace threelink_sim

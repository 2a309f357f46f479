// An episode once more, from its start and its hinge rates: what the simulator must have published.
#pragma once

#include <vector>

#include "threelink_sim/environment.hpp"

namespace threelink_tasks {

// State k, and what the step that led to it did.
struct ReplayedState {
  threelink_sim::SwimmerState state;
  threelink_sim::HingeVector
      rates;      // [1/T0] held in that step, after the joint limit; 0 in state 0
  double power;   // [C_perp L^3/T0^2] of these rates in the shape of state k
  double work;    // [C_perp L^3/T0] of that step
  double reward;  // [1] b dx.p - c W of that step
};

struct ReplayedObservation {
  std::vector<double> values;
  double theta_t;   // [rad] direction to the target
  double distance;  // [L] to it
};

class Replay {
 public:
  explicit Replay(const threelink_sim::EnvironmentConfig& config) : environment_(config, 1) {}

  // State 0 of an episode, or any other one to go on from; throws std::invalid_argument as
  // threelink_sim::validate does.
  void start(const threelink_sim::SwimmerState& state);

  ReplayedState state() const;

  // What the agent is shown once the task has answered with that target [L]; it defines the
  // direction of the next step's reward, too.
  ReplayedObservation observe(const Eigen::Vector2d& target);

  // rates (N-1) [1/T0] as commanded; finite.
  void step(const double* rates);

 private:
  threelink_sim::Environment environment_;
  bool stepped_ = false;  // since start()
};

}  // namespace threelink_tasks

#include "threelink_tasks/replay.hpp"

#include <cmath>

#include "threelink_sim/lockstep.hpp"

namespace threelink_tasks {

using threelink_sim::HingeVector;

void Replay::start(const threelink_sim::SwimmerState& state) {
  environment_.reset(0, state);
  stepped_ = false;
}

ReplayedState Replay::state() const {
  const threelink_sim::Batch& batch = environment_.batch();
  const threelink_sim::Model& model = batch.model();
  ReplayedState now;
  now.state = batch.state(0);
  now.rates = HingeVector::Zero(model.hinges());
  if (stepped_)
    for (int j = 0; j < model.hinges(); ++j) now.rates[j] = batch.rates(j)[0];
  now.power = body_motion(model, now.state.alpha, now.rates).power;
  now.work = stepped_ ? batch.work()[0] : 0;
  now.reward = stepped_ ? environment_.rewards()[0] : 0;
  return now;
}

ReplayedObservation Replay::observe(const Eigen::Vector2d& target) {
  const Eigen::Vector2d centroid(environment_.batch().x()[0], environment_.batch().y()[0]);
  const threelink_sim::TargetDirection to_target =
      threelink_sim::target_direction(centroid, target, environment_.direction(0));
  environment_.set_direction(0, to_target.p);
  ReplayedObservation observation;
  observation.values.resize(direction_observation_size(environment_.config().model));
  environment_.observe(observation.values.data());
  observation.theta_t = std::atan2(to_target.p.y(), to_target.p.x());
  observation.distance = to_target.distance;
  return observation;
}

void Replay::step(const double* rates) {
  environment_.step(rates);
  stepped_ = true;
}

}  // namespace threelink_tasks

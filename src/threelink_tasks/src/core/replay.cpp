#include "threelink_tasks/replay.hpp"

#include <cmath>

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
  environment_.aim(0, target);
  ReplayedObservation observation;
  observation.values.resize(environment_.observation_size());
  environment_.observe(observation.values.data());
  const Eigen::Vector2d p = environment_.direction(0);
  observation.theta_t = std::atan2(p.y(), p.x());
  observation.distance = environment_.distance(0);
  return observation;
}

void Replay::step(const double* rates) {
  environment_.step(rates);
  stepped_ = true;
}

}  // namespace threelink_tasks

#include "threelink_agent/actor.hpp"

namespace threelink_agent {

const double* Actor::act(const threelink_sim::Environment& environment, const ActionKey* keys) {
  const std::size_t lanes = environment.lanes();
  observations_.resize(lanes * policy_->observation_size());
  rates_.resize(lanes * policy_->hinges());
  environment.observe(observations_.data());
  policy_->sample(lanes, observations_.data(), keys, rates_.data(), scratch_);
  return rates_.data();
}

}  // namespace threelink_agent

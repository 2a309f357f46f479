/// @file
/// A policy in the loop with an environment:
///
///   Actor actor(policy);
///   while (..) environment.step(actor.act(environment));
#pragma once

#include <vector>

#include "threelink_agent/policy.hpp"
#include "threelink_sim/environment.hpp"

namespace threelink_agent {

class Actor {
 public:
  /// The policy must outlive it.
  explicit Actor(const Policy& policy) : policy_(&policy) {}

  /// The policy's rates for what is observed now, hinge j of lane i at [j * lanes + i] [1/T0]:
  /// their mean, or sampled with a key for each lane. Valid until the next call; allocates only if
  /// there are more lanes than ever before.
  const double* act(const threelink_sim::Environment& environment, const ActionKey* keys = nullptr);

 private:
  const Policy* policy_;
  std::vector<double> observations_, rates_;
  std::vector<float> scratch_;
};

}  // namespace threelink_agent

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

/// Computes the hinge rates of a policy for all lanes of an environment.
class Actor {
 public:
  /// The policy must outlive it.
  explicit Actor(const Policy& policy) : policy_(&policy) {}

  /// The policy's rates for the current observations [1/T0], hinge j of lane i at [j * lanes + i]:
  /// the mean, or samples if keys (lanes) are given. The result is valid until the next call.
  /// Allocates only if the number of lanes grows.
  const double* act(const threelink_sim::Environment& environment, const ActionKey* keys = nullptr);

 private:
  const Policy* policy_;
  std::vector<double> observations_, rates_;
  std::vector<float> scratch_;
};

}  // namespace threelink_agent

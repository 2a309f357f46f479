// What a policy's container holds: between Policy and the tensors of safetensors.hpp.
#pragma once

#include <vector>

#include "threelink_agent/policy.hpp"
#include "threelink_agent/safetensors.hpp"

namespace threelink_agent {

struct PolicyParts {
  PolicyMetadata metadata;
  std::vector<Linear> layers;
  Eigen::VectorXf log_std;
};

Container to_container(const PolicyParts& parts);

// The inverse. Checks that every key and tensor is there and known, shapes, bounds; throws
// PolicyError or ContainerError.
PolicyParts from_container(const Container& container);

}  // namespace threelink_agent

/// @file
/// The order in which an epoch visits its samples.
#pragma once

#include <cstdint>
#include <vector>

namespace threelink_agent {

/// A permutation of 0 .. samples-1 (Fisher and Yates), keyed by (seed, update, epoch). Minibatches
/// are consecutive pieces of it, so that an epoch visits each sample once.
std::vector<std::int64_t> shuffled(std::uint32_t samples, std::uint64_t seed, std::uint32_t update,
                                   std::uint32_t epoch);

}  // namespace threelink_agent

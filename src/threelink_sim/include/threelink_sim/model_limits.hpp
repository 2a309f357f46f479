/// @file
/// Bounds of the model that also size fixed arrays; free of includes, since the kernels use it.
#pragma once

namespace threelink_sim {

/// Largest number of links N.
constexpr int kMaxLinks = 32;
/// Largest number of hinges N-1.
constexpr int kMaxHinges = kMaxLinks - 1;

}  // namespace threelink_sim

/// @file
/// Bounds of the model that also size fixed arrays; free of includes, since the kernels use it.
#pragma once

namespace threelink_sim {

constexpr int kMaxLinks = 32;
constexpr int kMaxHinges = kMaxLinks - 1;

}  // namespace threelink_sim

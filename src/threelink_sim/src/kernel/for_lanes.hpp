// A kernel over n lanes: whole packs first, then the rest one by one.
#pragma once

#include <stddef.h>

#include "threelink_sim/kernel/lane.hpp"

namespace threelink_sim {
namespace THREELINK_ISA {

template <class Pack, class One>
inline void for_lanes(size_t n, Pack pack, One one) {
  constexpr size_t kWidth = LaneTraits<DoublePack>::kWidth;
  size_t lane = 0;
  for (; lane + kWidth <= n; lane += kWidth) pack(lane);
  for (; lane < n; ++lane) one(lane);
}

}  // namespace THREELINK_ISA
}  // namespace threelink_sim

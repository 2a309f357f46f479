// u = (U (1 - ((y - y0) / H)^2), 0): flow between two plates.
//
// Source: Batchelor, "An introduction to fluid dynamics", section 4.2. Exact check: a straight
// locked swimmer on the axis drifts with U along it, and with U (1 - 1 / (12 H^2)) across it.
#pragma once

#include "threelink_sim/kernel/flows.hpp"
#include "threelink_sim/kernel/lane.hpp"

namespace threelink_sim {
namespace THREELINK_ISA {

template <class R>
inline void add_velocity(const PoiseuilleFlow& flow, R /*t*/, R /*x*/, R y, R& u, R& /*v*/) {
  const R r = (y - all<R>(flow.y0)) * all<R>(1.0 / flow.H);
  u = fma(all<R>(-flow.U) * r, r, u + all<R>(flow.U));
}

}  // namespace THREELINK_ISA
}  // namespace threelink_sim

// u = Gamma / (2 pi) e_z x r / (r^2 + epsilon^2), r = X - x0: a vortex with a smooth core.
//
// Source: the regularisation of Kaufmann (1962) and Scully (1975). Exact check: turning the start
// about x0 turns the trajectory.
#pragma once

#include "threelink_sim/kernel/flows.hpp"
#include "threelink_sim/kernel/lane.hpp"

namespace threelink_sim {
namespace THREELINK_ISA {

template <class R>
inline void add_velocity(const VortexFlow& flow, R /*t*/, R x, R y, R& u, R& v) {
  constexpr double kInverseTwoPi = 0x1.45f306dc9c883p-3;
  const R rx = x - all<R>(flow.x0[0]), ry = y - all<R>(flow.x0[1]);
  const R squared = fma(rx, rx, fma(ry, ry, all<R>(flow.epsilon * flow.epsilon)));
  const R rate = all<R>(flow.Gamma * kInverseTwoPi) / squared;
  u = fma(-rate, ry, u);
  v = fma(rate, rx, v);
}

}  // namespace THREELINK_ISA
}  // namespace threelink_sim

// u = A (X - x0) + U. Uniform flow, rotation, shear and strain are of this kind.
//
// Source: any textbook of fluid mechanics; e.g. Batchelor, "An introduction to fluid dynamics",
// section 2.3. Exact check: under a uniform flow the motion is that in still water plus U t; under
// a rotation it is that in still water in the rotating frame; a rigid shape in a shear G turns with
// the period 4 pi / (G sqrt(1 - B^2)) (Jeffery 1922), see flow_test.
#pragma once

#include "threelink_sim/kernel/flows.hpp"
#include "threelink_sim/kernel/lane.hpp"

namespace threelink_sim {
namespace THREELINK_ISA {

template <class R>
inline void add_velocity(const LinearFlow& flow, R /*t*/, R x, R y, R& u, R& v) {
  const R rx = x - all<R>(flow.x0[0]), ry = y - all<R>(flow.x0[1]);
  u = u + fma(all<R>(flow.A[0][0]), rx, fma(all<R>(flow.A[0][1]), ry, all<R>(flow.U[0])));
  v = v + fma(all<R>(flow.A[1][0]), rx, fma(all<R>(flow.A[1][1]), ry, all<R>(flow.U[1])));
}

}  // namespace THREELINK_ISA
}  // namespace threelink_sim

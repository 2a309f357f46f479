// With X = x / size, Y = y / size, e = epsilon sin(omega t), f = e X^2 + (1 - 2 e) X:
//   u = pi A (-sin(pi f) cos(pi Y), cos(pi f) sin(pi Y) (2 e X + 1 - 2 e))
// Two vortices in 0 <= X <= 2, 0 <= Y <= 1, whose border swings about X = 1.
//
// Source: Shadden, Lekien & Marsden, "Definition and properties of Lagrangian coherent structures",
// Physica D 212 (2005). Exact check: nothing flows through X = 0, X = 2, Y = 0 and Y = 1.
#pragma once

#include "threelink_sim/kernel/flows.hpp"
#include "threelink_sim/kernel/lane.hpp"

namespace threelink_sim {
namespace THREELINK_ISA {

template <class R>
inline void add_velocity(const DoubleGyreFlow& flow, R t, R x, R y, R& u, R& v) {
  const R pi = all<R>(0x1.921fb54442d18p+1);
  const R X = x * all<R>(1.0 / flow.size), Y = y * all<R>(1.0 / flow.size);
  R swing, unused;
  sincos(t * all<R>(flow.omega), swing, unused);
  const R e = all<R>(flow.epsilon) * swing;
  const R linear = fma(all<R>(-2.0), e, all<R>(1.0));
  const R f = X * fma(e, X, linear);
  R sf, cf, sy, cy;
  sincos(pi * f, sf, cf);
  sincos(pi * Y, sy, cy);
  const R amplitude = pi * all<R>(flow.A);
  u = fma(-amplitude, sf * cy, u);
  v = fma(amplitude * cf, sy * fma(e + e, X, linear), v);
}

}  // namespace THREELINK_ISA
}  // namespace threelink_sim

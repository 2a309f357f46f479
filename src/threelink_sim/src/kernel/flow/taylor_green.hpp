// u = u0 (sin a cos b, -cos a sin b), a = k x + phase_0, b = k y + phase_1: a lattice of vortices
// of the width pi / k, each turning against its neighbours.
//
// Source: Taylor & Green, "Mechanism of the production of small eddies from large ones",
// Proc. R. Soc. A 158 (1937). Exact check: it repeats after 2 pi / k in x and in y.
//
// With sin a cos b = (sin(a + b) + sin(a - b)) / 2 and cos a sin b = (sin(a + b) - sin(a - b)) / 2
// two sines are enough; along a link, a + b and a - b change in proportion to the place on it, so
// that the sines at all Gauss points follow from those at its midpoint by addition theorems.
#pragma once

#include "threelink_sim/kernel/flows.hpp"
#include "threelink_sim/kernel/lane.hpp"

namespace threelink_sim {
namespace THREELINK_ISA {

template <class R>
inline void add_velocity(const TaylorGreenFlow& flow, R /*t*/, R x, R y, R& u, R& v) {
  const R a = fma(all<R>(flow.k), x, all<R>(flow.phase[0]));
  const R b = fma(all<R>(flow.k), y, all<R>(flow.phase[1]));
  R sum, difference, cosine;
  sincos(a + b, sum, cosine);
  sincos(a - b, difference, cosine);
  u = fma(all<R>(0.5 * flow.u0), sum + difference, u);
  v = fma(all<R>(-0.5 * flow.u0), sum - difference, v);
}

// At the Gauss points xi (tx, ty) from (x, y).
template <class R>
inline void add_along_link(const TaylorGreenFlow& flow, const KernelFlows& rule, R /*t*/, R x, R y,
                           R tx, R ty, R* u, R* v) {
  const R a = fma(all<R>(flow.k), x, all<R>(flow.phase[0]));
  const R b = fma(all<R>(flow.k), y, all<R>(flow.phase[1]));
  R sine_p, cosine_p, sine_m, cosine_m;
  sincos(a + b, sine_p, cosine_p);
  sincos(a - b, sine_m, cosine_m);
  const R half = all<R>(0.5 * flow.u0);
  const auto add = [&](int q, R plus, R minus) {
    u[q] = fma(half, plus + minus, u[q]);
    v[q] = fma(-half, plus - minus, v[q]);
  };
  const R step_p = all<R>(flow.k) * (tx + ty), step_m = all<R>(flow.k) * (tx - ty);
  for (int q = rule.points / 2 - 1; q >= 0; --q) {
    const int other = rule.points - 1 - q;
    R sp, cp, sm, cm;
    sincos(step_p * all<R>(rule.xi[other]), sp, cp);
    sincos(step_m * all<R>(rule.xi[other]), sm, cm);
    add(q, fma(sine_p, cp, -(cosine_p * sp)), fma(sine_m, cm, -(cosine_m * sm)));
    add(other, fma(sine_p, cp, cosine_p * sp), fma(sine_m, cm, cosine_m * sm));
  }
  if (rule.points % 2 == 1) add(rule.points / 2, sine_p, sine_m);
}

}  // namespace THREELINK_ISA
}  // namespace threelink_sim

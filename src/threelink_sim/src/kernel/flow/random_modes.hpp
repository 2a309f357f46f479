// u = sum over modes of (ux, uy) cos(kx x + ky y + omega t + phase), (ux, uy) at right angles to
// (kx, ky), so that nothing is compressed. How the modes are drawn: world/random_modes.cpp.
//
// Source: Kraichnan, "Diffusion by a random velocity field", Phys. Fluids 13 (1970). Exact check:
// no divergence; the mean square over places is u0^2.
#pragma once

#include "threelink_sim/kernel/flows.hpp"
#include "threelink_sim/kernel/lane.hpp"

namespace threelink_sim {
namespace THREELINK_ISA {

template <class R>
inline R phase_of(const FlowMode& mode, R t, R x, R y) {
  return fma(all<R>(mode.kx), x,
             fma(all<R>(mode.ky), y, fma(all<R>(mode.omega), t, all<R>(mode.phase))));
}

template <class R>
inline void add_velocity(const FlowMode& mode, R t, R x, R y, R& u, R& v) {
  R sine, cosine;
  sincos(phase_of(mode, t, x, y), sine, cosine);
  u = fma(all<R>(mode.ux), cosine, u);
  v = fma(all<R>(mode.uy), cosine, v);
}

// At the Gauss points xi (tx, ty) from (x, y), by addition theorems from the midpoint.
template <class R>
inline void add_along_link(const FlowMode& mode, const KernelFlows& rule, R t, R x, R y, R tx, R ty,
                           R* u, R* v) {
  R sine, cosine;
  sincos(phase_of(mode, t, x, y), sine, cosine);
  const auto add = [&](int q, R wave) {
    u[q] = fma(all<R>(mode.ux), wave, u[q]);
    v[q] = fma(all<R>(mode.uy), wave, v[q]);
  };
  const R step = fma(all<R>(mode.kx), tx, all<R>(mode.ky) * ty);
  for (int q = rule.points / 2 - 1; q >= 0; --q) {
    const int other = rule.points - 1 - q;
    R s, c;
    sincos(step * all<R>(rule.xi[other]), s, c);
    add(q, fma(cosine, c, sine * s));
    add(other, fma(cosine, c, -(sine * s)));
  }
  if (rule.points % 2 == 1) add(rule.points / 2, cosine);
}

}  // namespace THREELINK_ISA
}  // namespace threelink_sim

// The sum of all flows, at a place and along a link.
#pragma once

#include "flow/double_gyre.hpp"
#include "flow/grid.hpp"
#include "flow/linear.hpp"
#include "flow/poiseuille.hpp"
#include "flow/random_modes.hpp"
#include "flow/taylor_green.hpp"
#include "flow/vortex.hpp"

namespace threelink_sim {
namespace THREELINK_ISA {

// One lane after the other, for what looks up tables or calls code of the user's.
template <class R, class Velocity>
inline void add_one_by_one(R t, R x, R y, R& u, R& v, Velocity velocity) {
  constexpr int kLanes = LaneTraits<R>::kWidth;
  double times[kLanes], xs[kLanes], ys[kLanes], us[kLanes], vs[kLanes];
  store(t, times);
  store(x, xs);
  store(y, ys);
  for (int i = 0; i < kLanes; ++i) {
    double at_place[2];
    velocity(times[i], xs[i], ys[i], at_place);
    us[i] = at_place[0];
    vs[i] = at_place[1];
  }
  u = u + load<R>(us);
  v = v + load<R>(vs);
}

template <class R>
inline void add_velocity(const GridFlow& flow, R t, R x, R y, R& u, R& v) {
  add_one_by_one(t, x, y, u, v, [&](double time, double at_x, double at_y, double* velocity) {
    velocity_on_grid(flow, time, at_x, at_y, velocity);
  });
}

template <class R>
inline void add_velocity(const UserFlow& flow, R t, R x, R y, R& u, R& v) {
  add_one_by_one(t, x, y, u, v, [&](double time, double at_x, double at_y, double* velocity) {
    flow.velocity(flow.flow, time, at_x, at_y, velocity);
  });
}

// Flows without a shorter way along a link.
template <class R, class Flow>
inline void add_along_link(const Flow& flow, const KernelFlows& rule, R t, R x, R y, R tx, R ty,
                           R* u, R* v) {
  for (int q = 0; q < rule.points; ++q)
    add_velocity(flow, t, fma(tx, all<R>(rule.xi[q]), x), fma(ty, all<R>(rule.xi[q]), y), u[q],
                 v[q]);
}

template <class Visit>
inline void for_each_flow(const KernelFlows& flows, Visit visit) {
  const auto all_of = [&](const auto& list) {
    for (const auto& flow : list) visit(flow);
  };
  all_of(flows.linear);
  all_of(flows.poiseuille);
  all_of(flows.taylor_green);
  all_of(flows.vortex);
  all_of(flows.double_gyre);
  all_of(flows.modes);
  all_of(flows.grid);
  all_of(flows.user);
}

// [L/T0] at a place.
template <class R>
inline void flow_at(const KernelFlows& flows, R t, R x, R y, R& u, R& v) {
  u = v = R{};
  for_each_flow(flows, [&](const auto& flow) { add_velocity(flow, t, x, y, u, v); });
}

// [L/T0] at the Gauss points of a link with the midpoint (x, y) and half the link (tx, ty).
template <class R>
inline void flow_along_link(const KernelFlows& flows, R t, R x, R y, R tx, R ty, R* u, R* v) {
  for (int q = 0; q < flows.points; ++q) u[q] = v[q] = R{};
  for_each_flow(flows,
                [&](const auto& flow) { add_along_link(flow, flows, t, x, y, tx, ty, u, v); });
}

}  // namespace THREELINK_ISA
}  // namespace threelink_sim

// Stepping in an ambient flow u(X, t): the force per length is f = -(gamma tt + nn)(dX/dt - u).
//
// Symbols and units are those of swimmer_kernel.hpp; the flow is taken in the heading frame and in
// units of lambda. Of each link, over Gauss points xi in [-1, 1] with weights w of sum 2, at
// X = M + xi t:
//   U0 = 1/2 sum w u        U1 = 1/2 sum w xi (n . u)        U2 = 1/2 sum w u . (gamma tt + nn) u
// and, sums over links,
//   h_v = sum gamma U0 + beta n (n . U0)         h_w = sum gamma M x U0 + beta a (n . U0) + U1
//   h_G = sum gamma G . U0 + beta g (n . U0) + psi U1                    h_0 = sum U2
// The motion follows from K z = h - b, z = (V, Omega). The power of the hinges is
// P = l lambda^2 (b_0 + b . z - h_G), which may be negative: the flow then drives them. The
// dissipation is D = P - l lambda^2 (h . z + h_G - h_0) >= 0. In still water both are Phi.
//
// Since z depends on the pose now, the Gauss step is implicit. K and b are formed once at each
// node, as they depend on the shape alone; the poses at the nodes begin as those in still water,
// and improve by a factor of about dt |grad u| / 4 in each of a fixed number of sweeps, so that
// lanes agree to the bit.
#pragma once

#include "flow_kernel.hpp"
#include "swimmer_kernel.hpp"

namespace threelink_sim {
namespace THREELINK_ISA {

// Midpoints M and their velocities G, due to the shape alone.
template <class R, int N>
struct Chain {
  R mx[kSize<N>], my[kSize<N>], gx[kSize<N>], gy[kSize<N>];
};

template <class R, int N>
inline Chain<R, N> chain_of(int n, const Shape<R, N>& shape, const Turning<R, N>& turning) {
  const int h = n / 2;
  const R* psi = turning.psi;
  Chain<R, N> chain;
  chain.mx[h] = chain.my[h] = chain.gx[h] = chain.gy[h] = R{};
  const auto add_side = [&](int first, int last, int step) {
    const R sign = all<R>(step);
    for (int i = first; i != last; i += step) {
      const int k = i - step;
      chain.mx[i] = fma(sign, shape.c[k] + shape.c[i], chain.mx[k]);
      chain.my[i] = fma(sign, shape.s[k] + shape.s[i], chain.my[k]);
      chain.gx[i] = fma(-sign, fma(psi[k], shape.s[k], psi[i] * shape.s[i]), chain.gx[k]);
      chain.gy[i] = fma(sign, fma(psi[k], shape.c[k], psi[i] * shape.c[i]), chain.gy[k]);
    }
  };
  add_side(h + 1, n, 1);
  add_side(h - 1, -1, -1);
  return chain;
}

// h_v, h_w, h_G and h_0; symbols as above.
template <class R>
struct FlowMoments {
  R vx, vy, w, g, zero;
};

// What of a Gauss node depends on the shape alone.
template <class R, int N>
struct Node {
  Shape<R, N> shape;
  Chain<R, N> chain;
  Resistance<R> resistance;
  Elimination<R> elimination;
};

template <class R, int N>
inline Node<R, N> node_of(const KernelModel& model, const Shape<R, N>& shape,
                          const Turning<R, N>& turning) {
  Node<R, N> node;
  node.shape = shape;
  node.chain = chain_of<R, N>(links<N>(model.links), shape, turning);
  node.resistance = resistance(model, shape, turning);
  node.elimination = eliminate(node.resistance);
  return node;
}

// Of the swimmer with its centroid at (x, y) [L] and the heading's sine and cosine s, c, at t [T0].
template <class R, int N>
inline FlowMoments<R> flow_moments(const KernelModel& model, const KernelFlows& flows,
                                   const Node<R, N>& node, const Turning<R, N>& turning, R t, R x,
                                   R y, R s, R c) {
  const int n = links<N>(model.links);
  const R lambda = all<R>(0.5 / n), inverse_lambda = all<R>(2.0 * n);
  const R gamma = all<R>(model.gamma), beta = all<R>(1.0 - model.gamma), half = all<R>(0.5);
  const R share = all<R>(-0.5 / n / n);  // from the centroid to the heading link's midpoint
  const R hx = fma(share, fma(c, node.resistance.mx, -(s * node.resistance.my)), x);
  const R hy = fma(share, fma(s, node.resistance.mx, c * node.resistance.my), y);
  FlowMoments<R> h{};
  for (int i = 0; i < n; ++i) {
    const R ci = node.shape.c[i], si = node.shape.s[i];
    const R mx = node.chain.mx[i], my = node.chain.my[i];
    R u[KernelFlows::kMaxPoints], v[KernelFlows::kMaxPoints];
    flow_along_link(flows, t, fma(lambda, fma(c, mx, -(s * my)), hx),
                    fma(lambda, fma(s, mx, c * my), hy), lambda * fma(c, ci, -(s * si)),
                    lambda * fma(s, ci, c * si), u, v);
    // Along the link and across it.
    R along{}, across{}, turn{}, squares{};
    for (int q = 0; q < flows.points; ++q) {
      const R frame_u = fma(c, u[q], s * v[q]) * inverse_lambda;
      const R frame_v = fma(c, v[q], -(s * u[q])) * inverse_lambda;
      const R ut = fma(ci, frame_u, si * frame_v), un = fma(ci, frame_v, -(si * frame_u));
      const R w = half * all<R>(flows.weight[q]);
      along = fma(w, ut, along);
      across = fma(w, un, across);
      turn = fma(w * all<R>(flows.xi[q]), un, turn);
      squares = fma(w, fma(gamma * ut, ut, un * un), squares);
    }
    const R ux = fma(ci, along, -(si * across)), uy = fma(si, along, ci * across);  // U0
    const R a = fma(ci, mx, si * my);
    const R gx = node.chain.gx[i], gy = node.chain.gy[i];
    const R g = fma(ci, gy, -(si * gx));
    const R pressed = beta * across;
    h.vx = h.vx + fma(gamma, ux, -(pressed * si));
    h.vy = h.vy + fma(gamma, uy, pressed * ci);
    h.w = h.w + fma(gamma, fma(mx, uy, -(my * ux)), fma(pressed, a, turn));
    h.g = h.g + fma(gamma, fma(gx, ux, gy * uy), fma(pressed, g, turning.psi[i] * turn));
    h.zero = h.zero + squares;
  }
  return h;
}

// In units of lambda and l lambda^2.
template <class R>
struct FlowMotion {
  Velocity<R> velocity;  // of the centroid, heading frame
  R power, dissipation;
};

template <class R, int N>
inline FlowMotion<R> motion_in_flow(const KernelModel& model, const KernelFlows& flows,
                                    const Node<R, N>& node, const Turning<R, N>& turning, R t, R x,
                                    R y, R s, R c) {
  const Resistance<R>& r = node.resistance;
  const FlowMoments<R> h = flow_moments<R, N>(model, flows, node, turning, t, x, y, s, c);
  const Velocity<R> z = solve(r, node.elimination, r.bx - h.vx, r.by - h.vy, r.bw - h.w);
  FlowMotion<R> motion;
  motion.velocity = of_centroid(all<R>(1.0 / links<N>(model.links)), r, z);
  motion.power = fma(r.bx, z.vx, fma(r.by, z.vy, fma(r.bw, z.spin, r.b0 - h.g)));
  motion.dissipation =
      motion.power - fma(h.vx, z.vx, fma(h.vy, z.vy, fma(h.w, z.spin, h.g - h.zero)));
  return motion;
}

// 3-point Gauss-Legendre collocation: nodes c_j, matrix a_jk, weights kGaussB.
constexpr double kGaussNode[3] = {0.5 - kGaussOffset, 0.5, 0.5 + kGaussOffset};
constexpr double kGaussA[3][3] = {{5.0 / 36, 2.0 / 9 - kRoot15 / 15, 5.0 / 36 - kRoot15 / 30},
                                  {5.0 / 36 + kRoot15 / 24, 2.0 / 9, 5.0 / 36 - kRoot15 / 24},
                                  {5.0 / 36 + kRoot15 / 30, 2.0 / 9 + kRoot15 / 15, 5.0 / 36}};

// start + h sum_k weight_k rate_k
template <class R>
inline R collocate(R start, double h, const double weight[3], const R rate[3]) {
  return fma(all<R>(h * weight[0]), rate[0],
             fma(all<R>(h * weight[1]), rate[1], fma(all<R>(h * weight[2]), rate[2], start)));
}

// Pose [L, rad], and what led to it in units of l lambda^2.
template <class R>
struct Drift {
  R x, y, heading;
  R work, dissipation;
};

// From hinge angles alpha and a pose at the time t [T0], under rates that are held for dt.
template <class R, int N>
inline Drift<R> drift(const KernelModel& model, const KernelFlows& flows, int sweeps, double dt,
                      int substeps, const R* alpha, const R* rate, R t, R x, R y, R heading) {
  const int n = links<N>(model.links);
  const Turning<R, N> turning = turning_of<R, N>(n, rate);
  const double h = dt / substeps;
  const R lambda = all<R>(0.5 / n);
  Drift<R> way{x, y, heading, R{}, R{}};
  for (int substep = 0; substep < substeps; ++substep) {
    Node<R, N> node[3];
    R vx[3], vy[3], spin[3], power[3], dissipation[3];  // velocities in the frame of the heading
    R time[3];
    for (int j = 0; j < 3; ++j) {
      R angles[kSize<N>];
      const double place = h * (substep + kGaussNode[j]);
      for (int k = 0; k < n - 1; ++k) angles[k] = fma(rate[k], all<R>(place), alpha[k]);
      node[j] = node_of<R, N>(model, shape_of<R, N>(n, angles), turning);
      time[j] = t + all<R>(place);
      const Resistance<R>& r = node[j].resistance;
      const Velocity<R> still =
          of_centroid(all<R>(1.0 / n), r, solve(r, node[j].elimination, r.bx, r.by, r.bw));
      vx[j] = still.vx;
      vy[j] = still.vy;
      spin[j] = still.spin;
    }
    R fixed_x[3], fixed_y[3];  // velocities in the fixed frame [L/T0]
    const auto turn_into_fixed_frame = [&](int j, R s, R c) {
      fixed_x[j] = lambda * fma(c, vx[j], -(s * vy[j]));
      fixed_y[j] = lambda * fma(s, vx[j], c * vy[j]);
    };
    for (int j = 0; j < 3; ++j) {
      R s, c;
      sincos(collocate(way.heading, h, kGaussA[j], spin), s, c);
      turn_into_fixed_frame(j, s, c);
    }
    for (int sweep = 0; sweep < sweeps; ++sweep) {
      R at_x[3], at_y[3], at_heading[3];
      for (int j = 0; j < 3; ++j) {
        at_heading[j] = collocate(way.heading, h, kGaussA[j], spin);
        at_x[j] = collocate(way.x, h, kGaussA[j], fixed_x);
        at_y[j] = collocate(way.y, h, kGaussA[j], fixed_y);
      }
      for (int j = 0; j < 3; ++j) {
        R s, c;
        sincos(at_heading[j], s, c);
        const FlowMotion<R> m =
            motion_in_flow<R, N>(model, flows, node[j], turning, time[j], at_x[j], at_y[j], s, c);
        vx[j] = m.velocity.vx;
        vy[j] = m.velocity.vy;
        spin[j] = m.velocity.spin;
        power[j] = m.power;
        dissipation[j] = m.dissipation;
        turn_into_fixed_frame(j, s, c);
      }
    }
    way.x = collocate(way.x, h, kGaussB, fixed_x);
    way.y = collocate(way.y, h, kGaussB, fixed_y);
    way.heading = collocate(way.heading, h, kGaussB, spin);
    way.work = collocate(way.work, h, kGaussB, power);
    way.dissipation = collocate(way.dissipation, h, kGaussB, dissipation);
  }
  return way;
}

// One action step of one lane.
template <class R, int N>
inline void drift_lane(const DriftArgs& args, std::size_t lane) {
  const AdvanceArgs& step = args.step;
  const int n = links<N>(step.model.links);
  R alpha[kSize<N>], rate[kSize<N>], final_alpha[kSize<N>];
  for (int j = 0; j < n - 1; ++j) {
    alpha[j] = load<R>(step.alpha + j * step.stride + lane);
    rate[j] = load<R>(step.rates + j * step.stride + lane);
    cut_at_limit(all<R>(step.model.joint_limit), all<R>(step.dt), all<R>(1.0 / step.dt), alpha[j],
                 rate[j], final_alpha[j]);
    store(rate[j], step.rates + j * step.stride + lane);
    store(final_alpha[j], step.alpha + j * step.stride + lane);
  }
  const R x = load<R>(step.x + lane), y = load<R>(step.y + lane);
  const Drift<R> way =
      drift<R, N>(step.model, *args.flows, args.sweeps, step.dt, step.substeps, alpha, rate,
                  load<R>(args.time + lane), x, y, load<R>(step.heading + lane));
  const double unit = 0.25 / (static_cast<double>(n) * n * n);  // l lambda^2
  store(way.work * unit, step.work + lane);
  store(way.dissipation * unit, args.dissipation + lane);
  store(way.x - x, step.displacement + lane);
  store(way.y - y, step.displacement + step.stride + lane);
  store(way.x, step.x + lane);
  store(way.y, step.y + lane);
  store(way.heading, step.heading + lane);
}

template <class R, int N>
inline void motion_in_flow_lane(const FlowMotionArgs& args, std::size_t lane) {
  const MotionArgs& shape = args.shape;
  const int n = links<N>(shape.model.links);
  R alpha[kSize<N>], rate[kSize<N>];
  for (int j = 0; j < n - 1; ++j) {
    alpha[j] = load<R>(shape.alpha + j * shape.stride + lane);
    rate[j] = load<R>(shape.rates + j * shape.stride + lane);
  }
  const Turning<R, N> turning = turning_of<R, N>(n, rate);
  const Node<R, N> node = node_of<R, N>(shape.model, shape_of<R, N>(n, alpha), turning);
  R s, c;
  sincos(load<R>(args.heading + lane), s, c);
  const FlowMotion<R> m =
      motion_in_flow<R, N>(shape.model, *args.flows, node, turning, load<R>(args.time + lane),
                           load<R>(args.x + lane), load<R>(args.y + lane), s, c);
  const double lambda = 0.5 / n, unit = lambda * lambda / n;
  store(m.velocity.vx * lambda, shape.velocity + lane);
  store(m.velocity.vy * lambda, shape.velocity + shape.stride + lane);
  store(m.velocity.spin, shape.spin + lane);
  store(m.power * unit, shape.power + lane);
  store(m.dissipation * unit, args.dissipation + lane);
}

// Thermal motion over dt, at temperature kT [C_perp L^3/T0], in the shape that alpha gives: with
// the mobility about the centre of mobility c_m, where turning and moving are independent,
//   dtheta = sqrt(2 kT dt M_ww) xi_3,   dr = R(theta + dtheta / 2) chol(2 kT dt M_tt) xi_12;
// the body is turned by dtheta about c_m and moved by dr. In the Ito sense this has no drift.
// About c_m, M_tt = (l K_vv)^-1 and M_ww = determinant / (l lambda^2 pivot); c_m lies at
// lambda e_z x (M_vw / M_ww) from the heading link's midpoint, M_vw / M_ww = -K_vv^-1 K_vw.
template <class R, int N>
inline void shake_lane(const ThermalArgs& args, std::size_t lane) {
  const int n = links<N>(args.model.links);
  R alpha[kSize<N>], rate[kSize<N>];
  for (int j = 0; j < n - 1; ++j) {
    alpha[j] = load<R>(args.alpha + j * args.stride + lane);
    rate[j] = R{};
  }
  const Turning<R, N> turning = turning_of<R, N>(n, rate);
  const Resistance<R> r = resistance(args.model, shape_of<R, N>(n, alpha), turning);
  const Elimination<R> e = eliminate(r);
  const double lambda = 0.5 / n;
  const R inverse_determinant = e.inverse * e.pivot, share = all<R>(1.0 / n);
  // From the centroid to c_m, heading frame [L].
  const R to_x = lambda * fma(e.ky, inverse_determinant, -(share * r.mx));
  const R to_y = lambda * fma(-e.kx, inverse_determinant, -(share * r.my));

  const R strength = all<R>(2.0 * args.kT * args.dt * n);  // 2 kT dt / l
  const R turn = sqrt(strength * all<R>(1.0 / (lambda * lambda)) *
                      (e.determinant * e.determinant * e.inverse)) *
                 load<R>(args.normals + 2 * args.stride + lane);
  // chol(K_vv^-1), K_vv^-1 = (kyy, -kxy; -kxy, kxx) / determinant
  const R first = load<R>(args.normals + lane), second = load<R>(args.normals + args.stride + lane);
  const R scale = sqrt(strength);
  const R xx = sqrt(r.kyy * inverse_determinant);
  const R xy = -(r.kxy * inverse_determinant) / xx;
  const R yy = sqrt(all<R>(1.0) / r.kyy);
  const R move_x = scale * (xx * first), move_y = scale * fma(xy, first, yy * second);

  const R heading = load<R>(args.heading + lane);
  R s0, c0, sm, cm, s1, c1;
  sincos(heading, s0, c0);
  sincos(fma(all<R>(0.5), turn, heading), sm, cm);
  sincos(heading + turn, s1, c1);
  // The centroid: about c_m by `turn`, then the move.
  const R dx = fma(c0 - c1, to_x, fma(s1 - s0, to_y, fma(cm, move_x, -(sm * move_y))));
  const R dy = fma(s0 - s1, to_x, fma(c0 - c1, to_y, fma(sm, move_x, cm * move_y)));
  store(load<R>(args.x + lane) + dx, args.x + lane);
  store(load<R>(args.y + lane) + dy, args.y + lane);
  store(load<R>(args.displacement + lane) + dx, args.displacement + lane);
  store(load<R>(args.displacement + args.stride + lane) + dy,
        args.displacement + args.stride + lane);
  store(heading + turn, args.heading + lane);
}

}  // namespace THREELINK_ISA
}  // namespace threelink_sim

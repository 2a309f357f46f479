// Body velocity and stepping of the N-link swimmer, over a lane type (see kernel/lane.hpp).
//
// Resistive-force theory in the frame of the heading link h: origin at its midpoint, x along it. In
// units of half a link (lambda = 1/(2N)):
//   t_i, n_i    tangent (c_i, s_i) and normal (-s_i, c_i) of link i
//   M_i         its midpoint, M_h = 0
//   psi_i       its turning rate due to the shape alone, psi_h = 0
//   G_i         velocity of its midpoint due to the shape alone, G_h = 0
// A link moving with u = V + Omega e_z x M_i + G_i and turning with Omega + psi_i feels, divided by
// its length, the force -(gamma t t + n n) . u and the torque -(Omega + psi_i) / 3. With
// beta = 1 - gamma, a_i = t_i . M_i and g_i = n_i . G_i, zero force and torque read
// K (V, Omega) = -b, sums over links:
//   K_vv = N gamma I + beta sum n n                 b_v = sum gamma G + beta n g
//   K_vw = sum gamma e_z x M + beta n a             b_w = sum gamma M x G + beta a g + psi / 3
//   K_ww = sum gamma M.M + beta a a + 1/3
// and the power is Phi = l lambda^2 (b_0 + b . (V, Omega)), b_0 = sum gamma G.G + beta g g +
// psi^2/3. The centroid moves with V + (Omega e_z x sum M + sum G) / N.
#pragma once

#include "threelink_sim/kernel/kernels.hpp"
#include "threelink_sim/kernel/lane.hpp"
#include "threelink_sim/model_limits.hpp"

namespace threelink_sim {
namespace THREELINK_ISA {

// Number of links: a constant for N > 0, so that loops unroll; else the value at run time.
template <int N>
constexpr int links(int run_time) {
  return N > 0 ? N : run_time;
}
template <int N>
constexpr int kSize = N > 0 ? N : kMaxLinks;

// Orientation of each link relative to the heading link.
template <class R, int N>
struct Shape {
  R c[kSize<N>], s[kSize<N>];
};

// K, b and the sums of M and G; symbols as above.
template <class R>
struct Resistance {
  R kxx, kxy, kyy, kxw, kyw, kww;
  R bx, by, bw, b0;
  R mx, my, gx, gy;
};

// Turning rates of the links due to the shape, and the sums of psi and psi^2.
template <class R, int N>
struct Turning {
  R psi[kSize<N>];
  R sum, squares;
};

// Any number of links.
template <class R, int N>
inline Resistance<R> resistance(const KernelModel& model, const Shape<R, N>& shape,
                                const Turning<R, N>& turning) {
  const int n = links<N>(model.links);
  const int h = n / 2;
  const R* psi = turning.psi;
  const R gamma = all<R>(model.gamma), beta = all<R>(1.0 - model.gamma);
  const R third = all<R>(1.0 / 3.0);
  Resistance<R> r{};
  R ss{}, sc{}, sa{}, ca{}, sg{}, cg{}, m2{}, a2{}, mg{}, ag{}, gg{}, g2{};
  // Outwards from the heading link: M_{i+1} = M_i + t_i + t_{i+1}, and G likewise with psi n.
  const auto add_side = [&](int first, int last, int step) {
    const R sign = all<R>(step);
    R x{}, y{}, u{}, v{};
    for (int i = first; i != last; i += step) {
      const R c = shape.c[i], s = shape.s[i], p = psi[i];
      const R inner_c = shape.c[i - step], inner_s = shape.s[i - step], inner_p = psi[i - step];
      x = fma(sign, inner_c + c, x);
      y = fma(sign, inner_s + s, y);
      u = fma(-sign, fma(inner_p, inner_s, p * s), u);
      v = fma(sign, fma(inner_p, inner_c, p * c), v);
      const R a = fma(c, x, s * y);
      const R g = fma(c, v, -(s * u));
      r.mx = r.mx + x;
      r.my = r.my + y;
      r.gx = r.gx + u;
      r.gy = r.gy + v;
      ss = fma(s, s, ss);
      sc = fma(s, c, sc);
      sa = fma(s, a, sa);
      ca = fma(c, a, ca);
      sg = fma(s, g, sg);
      cg = fma(c, g, cg);
      m2 = fma(x, x, fma(y, y, m2));
      a2 = fma(a, a, a2);
      mg = fma(x, v, fma(-y, u, mg));
      ag = fma(a, g, ag);
      gg = fma(u, u, fma(v, v, gg));
      g2 = fma(g, g, g2);
    }
  };
  add_side(h + 1, n, 1);
  add_side(h - 1, -1, -1);
  r.kxx = fma(beta, ss, all<R>(n * model.gamma));
  r.kyy = fma(-beta, ss, all<R>(n));
  r.kxy = -(beta * sc);
  r.kxw = -fma(beta, sa, gamma * r.my);
  r.kyw = fma(beta, ca, gamma * r.mx);
  r.kww = fma(gamma, m2, fma(beta, a2, all<R>(n / 3.0)));
  r.bx = fma(-beta, sg, gamma * r.gx);
  r.by = fma(beta, cg, gamma * r.gy);
  r.bw = fma(gamma, mg, fma(beta, ag, third * turning.sum));
  r.b0 = fma(gamma, gg, fma(beta, g2, third * turning.squares));
  return r;
}

// Three links: the outer ones are hinged to the heading link itself, so that a = -+(1 + c),
// g = -+psi, sum G = sum n g, M x G = a g, G.G = psi^2, and gamma + beta = 1 folds the sums.
template <class R>
inline Resistance<R> resistance(const KernelModel& model, const Shape<R, 3>& shape,
                                const Turning<R, 3>& turning) {
  const R beta = all<R>(1.0 - model.gamma);
  const R c0 = shape.c[0], s0 = shape.s[0], c2 = shape.c[2], s2 = shape.s[2];
  const R p0 = turning.psi[0], p2 = turning.psi[2];
  const R one = all<R>(1.0);
  const R a0 = one + c0, a2 = one + c2;
  const R ss = beta * fma(s0, s0, s2 * s2);
  Resistance<R> r;
  r.mx = c2 - c0;
  r.my = s2 - s0;
  r.gx = fma(s0, p0, -(s2 * p2));
  r.gy = fma(c2, p2, -(c0 * p0));
  r.kxx = all<R>(3.0 * model.gamma) + ss;
  r.kyy = all<R>(3.0) - ss;
  r.kxy = -(beta * fma(s0, c0, s2 * c2));
  r.kxw = fma(beta, fma(s0, c0, -(s2 * c2)), -r.my);
  r.kyw = r.mx * fma(beta, c0 + c2, one);
  r.kww = fma(all<R>(2.0 * model.gamma), a0 + a2, fma(beta, fma(a0, a0, a2 * a2), one));
  r.bx = r.gx;
  r.by = r.gy;
  r.bw = fma(p0, a0, fma(p2, a2, all<R>(1.0 / 3.0) * turning.sum));
  r.b0 = all<R>(4.0 / 3.0) * turning.squares;
  return r;
}

template <class R>
struct Motion {
  R vx, vy;  // centroid velocity, frame of the heading link, in units of lambda
  R spin;    // turning rate Omega of the heading link
  R power;   // in units of l lambda^2
};

// Block elimination of V from K, with the 2x2 inverse as adjugate / determinant and one division.
template <class R>
struct Elimination {
  R determinant, kx, ky;
  R inverse, pivot;  // 1 / (determinant * pivot)
};

template <class R>
inline Elimination<R> eliminate(const Resistance<R>& r) {
  Elimination<R> e;
  e.determinant = fma(r.kxx, r.kyy, -(r.kxy * r.kxy));
  e.kx = fma(r.kyy, r.kxw, -(r.kxy * r.kyw));
  e.ky = fma(r.kxx, r.kyw, -(r.kxy * r.kxw));
  e.pivot = fma(e.determinant, r.kww, -fma(r.kxw, e.kx, r.kyw * e.ky));
  e.inverse = all<R>(1.0) / (e.determinant * e.pivot);
  return e;
}

// Of the heading link, in its frame.
template <class R>
struct Velocity {
  R vx, vy, spin;
};

// K (V, Omega) = -b
template <class R>
inline Velocity<R> solve(const Resistance<R>& r, const Elimination<R>& e, R bx, R by, R bw) {
  const R ux = fma(r.kyy, bx, -(r.kxy * by));
  const R uy = fma(r.kxx, by, -(r.kxy * bx));
  const R spin =
      fma(r.kxw, ux, fma(r.kyw, uy, -(e.determinant * bw))) * (e.inverse * e.determinant);
  const R negative_inverse = -(e.inverse * e.pivot);  // - 1 / determinant
  return {fma(e.kx, spin, ux) * negative_inverse, fma(e.ky, spin, uy) * negative_inverse, spin};
}

// The same of the swimmer's centroid.
template <class R>
inline Velocity<R> of_centroid(R share, const Resistance<R>& r, const Velocity<R>& v) {
  return {fma(share, fma(-v.spin, r.my, r.gx), v.vx), fma(share, fma(v.spin, r.mx, r.gy), v.vy),
          v.spin};
}

template <class R, int N>
inline Motion<R> body_motion(const KernelModel& model, const Shape<R, N>& shape,
                             const Turning<R, N>& turning) {
  const Resistance<R> r = resistance(model, shape, turning);
  const Velocity<R> v = solve(r, eliminate(r), r.bx, r.by, r.bw);
  const Velocity<R> centroid = of_centroid(all<R>(1.0 / links<N>(model.links)), r, v);
  return {centroid.vx, centroid.vy, v.spin,
          fma(r.bx, v.vx, fma(r.by, v.vy, fma(r.bw, v.spin, r.b0)))};
}

// The shape that the hinge angles give, and the turning rates that the hinge rates give.
template <class R, int N>
inline Shape<R, N> shape_of(int n, const R* alpha) {
  const int h = n / 2;
  Shape<R, N> shape;
  shape.c[h] = all<R>(1.0);
  shape.s[h] = R{};
  R phi{};
  for (int i = h + 1; i < n; ++i) {
    phi = phi + alpha[i - 1];
    sincos(phi, shape.s[i], shape.c[i]);
  }
  phi = R{};
  for (int i = h - 1; i >= 0; --i) {
    phi = phi - alpha[i];
    sincos(phi, shape.s[i], shape.c[i]);
  }
  return shape;
}

template <class R, int N>
inline Turning<R, N> turning_of(int n, const R* rate) {
  const int h = n / 2;
  Turning<R, N> turning;
  turning.psi[h] = turning.sum = turning.squares = R{};
  const auto add_link = [&](int i, R psi) {
    turning.psi[i] = psi;
    turning.sum = turning.sum + psi;
    turning.squares = fma(psi, psi, turning.squares);
  };
  for (int i = h + 1; i < n; ++i) add_link(i, turning.psi[i - 1] + rate[i - 1]);
  for (int i = h - 1; i >= 0; --i) add_link(i, turning.psi[i + 1] - rate[i]);
  return turning;
}

// A rate that would pass the joint limit is cut so that the angle lands exactly on it.
template <class R>
inline void cut_at_limit(R limit, R dt, R inverse_dt, R alpha, R& rate, R& final_alpha) {
  const R wanted = fma(rate, dt, alpha);
  final_alpha = select(wanted > limit, limit, select(wanted < -limit, -limit, wanted));
  rate = select(final_alpha != wanted, (final_alpha - alpha) * inverse_dt, rate);
}

// 3-point Gauss-Legendre collocation (order 6) on nodes early, middle, late: weights b, and the
// turn up to the middle node (a_1j) and from it to the outer nodes (a_0j - a_1j, a_2j - a_1j).
constexpr double kRoot15 = 3.872983346207417;
constexpr double kGaussOffset = kRoot15 / 10;  // of the outer nodes from the middle one
constexpr double kGaussB[3] = {5.0 / 18, 4.0 / 9, 5.0 / 18};
constexpr double kTurnToMiddle[3] = {5.0 / 36 + kRoot15 / 24, 2.0 / 9, 5.0 / 36 - kRoot15 / 24};
constexpr double kTurnToEarly[3] = {-kRoot15 / 24, -kRoot15 / 15, kRoot15 / 24 - kRoot15 / 30};
constexpr double kTurnToLate[3] = {kRoot15 / 30 - kRoot15 / 24, kRoot15 / 15, kRoot15 / 24};

// Motion at the three nodes of one Gauss step of length h around the middle angles alpha. Rates are
// constant, so that the outer nodes' sines follow by rotating each link by the small angle
// psi_i h kGaussOffset instead of anew.
template <class R, int N>
inline void motion_at_nodes(const KernelModel& model, double h, const R* alpha,
                            const Turning<R, N>& turning, Motion<R> motion[3]) {
  const int n = links<N>(model.links);
  const Shape<R, N> middle = shape_of<R, N>(n, alpha);
  Shape<R, N> early = middle, late = middle;
  for (int i = 0; i < n; ++i) {
    if (i == n / 2) continue;
    R s, c;
    small_sincos(turning.psi[i] * (h * kGaussOffset), s, c);
    early.c[i] = fma(middle.c[i], c, middle.s[i] * s);
    early.s[i] = fma(middle.s[i], c, -(middle.c[i] * s));
    late.c[i] = fma(middle.c[i], c, -(middle.s[i] * s));
    late.s[i] = fma(middle.s[i], c, middle.c[i] * s);
  }
  motion[0] = body_motion(model, early, turning);
  motion[1] = body_motion(model, middle, turning);
  motion[2] = body_motion(model, late, turning);
}

// h sum_j weight_j spin_j
template <class R>
inline R turn_of(double h, const double weight[3], const Motion<R> m[3]) {
  return fma(all<R>(h * weight[0]), m[0].spin,
             fma(all<R>(h * weight[1]), m[1].spin, all<R>(h * weight[2]) * m[2].spin));
}

// Where an action step leads, in the fixed frame and in units of lambda and l lambda^2.
template <class R>
struct Travel {
  R dx, dy;   // of the centroid
  R heading;  // at the end
  R work;
};

// From hinge angles alpha and a heading, under rates that are held for dt. Rates are constant and
// the body velocity depends on the shape alone, so that Gauss collocation on SE(2) is explicit:
// spins at the nodes give their headings, and displacement = h sum_i b_i R(heading_i) v_i.
template <class R, int N>
inline Travel<R> travel(const KernelModel& model, double dt, int substeps, const R* alpha,
                        const R* rate, R heading) {
  const int n = links<N>(model.links);
  const Turning<R, N> turning = turning_of<R, N>(n, rate);
  const double h = dt / substeps;
  R dx{}, dy{}, work{};
  for (int substep = 0; substep < substeps; ++substep) {
    R middle[kSize<N>];
    for (int j = 0; j < n - 1; ++j) middle[j] = fma(rate[j], all<R>(h * (substep + 0.5)), alpha[j]);
    Motion<R> m[3];
    motion_at_nodes(model, h, middle, turning, m);
    R early_s, early_c, late_s, late_c, s, c;
    small_sincos(turn_of(h, kTurnToEarly, m), early_s, early_c);
    small_sincos(turn_of(h, kTurnToLate, m), late_s, late_c);
    sincos(heading + turn_of(h, kTurnToMiddle, m), s, c);
    // Mean velocity in the frame of the middle node, with b_0 = b_2.
    const R outer = all<R>(h * kGaussB[0]), inner = all<R>(h * kGaussB[1]);
    const R forward =
        fma(early_c, m[0].vx, fma(-early_s, m[0].vy, fma(late_c, m[2].vx, -(late_s * m[2].vy))));
    const R sideways =
        fma(early_s, m[0].vx, fma(early_c, m[0].vy, fma(late_s, m[2].vx, late_c * m[2].vy)));
    const R ahead = fma(outer, forward, inner * m[1].vx);
    const R aside = fma(outer, sideways, inner * m[1].vy);
    dx = fma(c, ahead, fma(-s, aside, dx));
    dy = fma(s, ahead, fma(c, aside, dy));
    work = fma(outer, m[0].power + m[2].power, fma(inner, m[1].power, work));
    heading = heading + turn_of(h, kGaussB, m);
  }
  return {dx, dy, heading, work};
}

// One action step of one lane.
template <class R, int N>
inline void advance_lane(const AdvanceArgs& args, std::size_t lane) {
  const int n = links<N>(args.model.links);
  R alpha[kSize<N>], rate[kSize<N>], final_alpha[kSize<N>];
  for (int j = 0; j < n - 1; ++j) {
    alpha[j] = load<R>(args.alpha + j * args.stride + lane);
    rate[j] = load<R>(args.rates + j * args.stride + lane);
    cut_at_limit(all<R>(args.model.joint_limit), all<R>(args.dt), all<R>(1.0 / args.dt), alpha[j],
                 rate[j], final_alpha[j]);
    store(rate[j], args.rates + j * args.stride + lane);
    store(final_alpha[j], args.alpha + j * args.stride + lane);
  }
  const Travel<R> way =
      travel<R, N>(args.model, args.dt, args.substeps, alpha, rate, load<R>(args.heading + lane));

  const double lambda = 0.5 / n;
  const R dx = way.dx * lambda;
  const R dy = way.dy * lambda;
  store(way.work * (lambda * lambda / n), args.work + lane);
  store(dx, args.displacement + lane);
  store(dy, args.displacement + args.stride + lane);
  store(load<R>(args.x + lane) + dx, args.x + lane);
  store(load<R>(args.y + lane) + dy, args.y + lane);
  store(way.heading, args.heading + lane);
}

template <class R, int N>
inline void motion_lane(const MotionArgs& args, std::size_t lane) {
  const int n = links<N>(args.model.links);
  R alpha[kSize<N>], rate[kSize<N>];
  for (int j = 0; j < n - 1; ++j) {
    alpha[j] = load<R>(args.alpha + j * args.stride + lane);
    rate[j] = load<R>(args.rates + j * args.stride + lane);
  }
  const Turning<R, N> turning = turning_of<R, N>(n, rate);
  const Motion<R> m = body_motion(args.model, shape_of<R, N>(n, alpha), turning);
  const double lambda = 0.5 / n;
  store(m.vx * lambda, args.velocity + lane);
  store(m.vy * lambda, args.velocity + args.stride + lane);
  store(m.spin, args.spin + lane);
  store(m.power * (lambda * lambda / n), args.power + lane);
}

}  // namespace THREELINK_ISA
}  // namespace threelink_sim

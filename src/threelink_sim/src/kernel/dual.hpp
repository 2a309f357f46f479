// Dual numbers as a lane type: the physics, differentiated forwards (kernel/lane.hpp says what a
// lane is). Included by files that define THREELINK_ISA as a namespace of their own.
#pragma once

#include "threelink_sim/kernel/lane.hpp"

namespace threelink_sim {
namespace THREELINK_ISA {

// A value and its derivatives in kWidth directions.
struct Dual {
  static constexpr int kWidth = 4;  // all of them at once for three links: two angles, two rates
  double v = 0;
  double d[kWidth] = {};
};

template <>
struct LaneTraits<Dual> {
  using Scalar = double;
};

// Of value v, with derivatives p da + q db.
inline Dual chain(double v, double p, const Dual& a, double q, const Dual& b) {
  Dual r;
  r.v = v;
  for (int i = 0; i < Dual::kWidth; ++i) r.d[i] = p * a.d[i] + q * b.d[i];
  return r;
}

inline Dual operator+(const Dual& a, const Dual& b) { return chain(a.v + b.v, 1, a, 1, b); }
inline Dual operator-(const Dual& a, const Dual& b) { return chain(a.v - b.v, 1, a, -1, b); }
inline Dual operator*(const Dual& a, const Dual& b) { return chain(a.v * b.v, b.v, a, a.v, b); }
inline Dual operator/(const Dual& a, const Dual& b) {
  const double inverse = 1 / b.v, v = a.v * inverse;
  return chain(v, inverse, a, -v * inverse, b);
}
inline Dual operator-(const Dual& a) { return chain(-a.v, -1, a, 0, a); }
inline Dual operator*(const Dual& a, double k) { return chain(a.v * k, k, a, 0, a); }
inline Dual operator-(double k, const Dual& a) { return chain(k - a.v, -1, a, 0, a); }

inline Dual fma(const Dual& a, const Dual& b, const Dual& c) { return a * b + c; }

inline void sincos(const Dual& x, Dual& sine, Dual& cosine) {
  double s, c;
  sincos(x.v, s, c);
  sine = chain(s, c, x, 0, x);
  cosine = chain(c, -s, x, 0, x);
}

inline void small_sincos(const Dual& x, Dual& sine, Dual& cosine) {
  double s, c;
  small_sincos(x.v, s, c);
  sine = chain(s, c, x, 0, x);
  cosine = chain(c, -s, x, 0, x);
}

}  // namespace THREELINK_ISA
}  // namespace threelink_sim

/// @file
/// Lanes: the arithmetic of the physics and the networks, which are written once for all lane
/// types.
///
///
/// A function template over a lane type works on one sample (`double`, `float`) or on a SIMD pack
/// of them, and gives the same bits for each sample in both cases: packs only add, subtract,
/// multiply, divide, compare and fuse element by element, fusing is explicit (`fma`) and the
/// compiler is told not to fuse on its own (-ffp-contract=off), and sine, cosine, logarithm and
/// tanh are implemented here.
///
/// This header is compiled once for each instruction set, inside a namespace of that name, so that
/// no function built for AVX-512 can be linked into code that runs without it. For the same reason
/// it uses nothing of the standard library.
///
/// Before including it, define THREELINK_ISA as baseline, avx2 or avx512 (kernel files only).
#pragma once

#if !defined(THREELINK_ISA)
#error "define THREELINK_ISA before including lane.hpp"
#endif

#if defined(__x86_64__)
#include <immintrin.h>
#endif

namespace threelink_sim {
namespace THREELINK_ISA {

/// @var kRegister
/// Bytes in a SIMD register.
#if defined(__AVX512F__)
constexpr int kRegister = 64;
#elif defined(__AVX2__)
constexpr int kRegister = 32;
#else
constexpr int kRegister = 16;
#endif

typedef double DoublePack __attribute__((vector_size(kRegister)));
typedef float FloatPack __attribute__((vector_size(kRegister)));
typedef long long LongPack __attribute__((vector_size(kRegister)));
typedef int IntPack __attribute__((vector_size(kRegister)));

/// Narrow packs, for small numbers of components that would leave most of a register empty. A
/// narrow pack is the FloatPack itself if that is not wider.
typedef float QuadPack __attribute__((vector_size(16)));
#if defined(__AVX2__)
typedef float OctPack __attribute__((vector_size(32)));
#else
typedef QuadPack OctPack;
#endif

/// Scalar type, integer type of the same size, and number of lanes of a lane type.
template <class R>
struct LaneTraits;
/// A single double.
template <>
struct LaneTraits<double> {
  using Scalar = double;
  using Int = long long;
  static constexpr int kWidth = 1;
};
/// A single float.
template <>
struct LaneTraits<float> {
  using Scalar = float;
  using Int = int;
  static constexpr int kWidth = 1;
};
/// A register of doubles.
template <>
struct LaneTraits<DoublePack> {
  using Scalar = double;
  using Int = LongPack;
  static constexpr int kWidth = kRegister / 8;
};
/// A register of floats.
template <>
struct LaneTraits<FloatPack> {
  using Scalar = float;
  using Int = IntPack;
  static constexpr int kWidth = kRegister / 4;
};
#if defined(__AVX2__)
/// Four floats.
template <>
struct LaneTraits<QuadPack> {
  using Scalar = float;
  typedef int Int __attribute__((vector_size(16)));
  static constexpr int kWidth = 4;
};
#endif
#if defined(__AVX512F__)
/// Eight floats.
template <>
struct LaneTraits<OctPack> {
  using Scalar = float;
  typedef int Int __attribute__((vector_size(32)));
  static constexpr int kWidth = 8;
};
#endif

/// Integers of the same size as the lanes of R.
template <class R>
using Int = typename LaneTraits<R>::Int;

// a b + c, rounded once where the processor can.
#if defined(__FMA__)
constexpr bool kFused = true;
inline double fma(double a, double b, double c) { return __builtin_fma(a, b, c); }
inline float fma(float a, float b, float c) { return __builtin_fmaf(a, b, c); }
inline QuadPack fma(QuadPack a, QuadPack b, QuadPack c) {
  return (QuadPack)_mm_fmadd_ps((__m128)a, (__m128)b, (__m128)c);
}
#if defined(__AVX512F__)
inline DoublePack fma(DoublePack a, DoublePack b, DoublePack c) {
  return (DoublePack)_mm512_fmadd_pd((__m512d)a, (__m512d)b, (__m512d)c);
}
inline FloatPack fma(FloatPack a, FloatPack b, FloatPack c) {
  return (FloatPack)_mm512_fmadd_ps((__m512)a, (__m512)b, (__m512)c);
}
#else
inline DoublePack fma(DoublePack a, DoublePack b, DoublePack c) {
  return (DoublePack)_mm256_fmadd_pd((__m256d)a, (__m256d)b, (__m256d)c);
}
#endif
inline OctPack fma(OctPack a, OctPack b, OctPack c) {
  return (OctPack)_mm256_fmadd_ps((__m256)a, (__m256)b, (__m256)c);
}
#else
constexpr bool kFused = false;
template <class R>
inline R fma(R a, R b, R c) {
  return a * b + c;
}
#endif

/// Square root of each lane.
inline double sqrt(double x) { return __builtin_sqrt(x); }
inline float sqrt(float x) { return __builtin_sqrtf(x); }
#if defined(__AVX512F__)
inline DoublePack sqrt(DoublePack x) { return (DoublePack)_mm512_maskz_sqrt_pd(0xff, (__m512d)x); }
inline FloatPack sqrt(FloatPack x) { return (FloatPack)_mm512_maskz_sqrt_ps(0xffff, (__m512)x); }
#elif defined(__AVX2__)
inline DoublePack sqrt(DoublePack x) { return (DoublePack)_mm256_sqrt_pd((__m256d)x); }
inline FloatPack sqrt(FloatPack x) { return (FloatPack)_mm256_sqrt_ps((__m256)x); }
#else
inline DoublePack sqrt(DoublePack x) {
  return DoublePack{__builtin_sqrt(x[0]), __builtin_sqrt(x[1])};
}
inline FloatPack sqrt(FloatPack x) {
  return FloatPack{__builtin_sqrtf(x[0]), __builtin_sqrtf(x[1]), __builtin_sqrtf(x[2]),
                   __builtin_sqrtf(x[3])};
}
#endif

/// A pack with the same value in every lane.
template <class R>
inline R all(typename LaneTraits<R>::Scalar value) {
  return value - R{};
}

/// mask ? a : b for each lane. The mask is the result of a comparison.
template <class Mask, class R>
inline R select(Mask mask, R a, R b) {
  return mask ? a : b;
}

/// The smaller and the larger of two floats; x if either is NaN.
inline float min(float bound, float x) { return bound < x ? bound : x; }
inline float max(float bound, float x) { return bound > x ? bound : x; }
#if defined(__x86_64__)
inline QuadPack min(QuadPack bound, QuadPack x) {
  return (QuadPack)_mm_min_ps((__m128)bound, (__m128)x);
}
inline QuadPack max(QuadPack bound, QuadPack x) {
  return (QuadPack)_mm_max_ps((__m128)bound, (__m128)x);
}
#if defined(__AVX512F__)
inline FloatPack min(FloatPack bound, FloatPack x) {
  return (FloatPack)_mm512_maskz_min_ps(0xffff, (__m512)bound, (__m512)x);
}
inline FloatPack max(FloatPack bound, FloatPack x) {
  return (FloatPack)_mm512_maskz_max_ps(0xffff, (__m512)bound, (__m512)x);
}
#endif
#if defined(__AVX2__)
inline OctPack min(OctPack bound, OctPack x) {
  return (OctPack)_mm256_min_ps((__m256)bound, (__m256)x);
}
inline OctPack max(OctPack bound, OctPack x) {
  return (OctPack)_mm256_max_ps((__m256)bound, (__m256)x);
}
#endif
#else
inline QuadPack min(QuadPack bound, QuadPack x) { return bound < x ? bound : x; }
inline QuadPack max(QuadPack bound, QuadPack x) { return bound > x ? bound : x; }
#endif

/// Loads a lane from unaligned memory.
template <class R, class Scalar>
inline R load(const Scalar* from) {
  R value;
  __builtin_memcpy(&value, from, sizeof(R));
  return value;
}

/// Stores a lane to unaligned memory.
template <class R, class Scalar>
inline void store(R value, Scalar* to) {
  __builtin_memcpy(to, &value, sizeof(R));
}

/// The bits of a lane as integers.
template <class R>
inline Int<R> bits(R value) {
  Int<R> result;
  __builtin_memcpy(&result, &value, sizeof(R));
  return result;
}
/// The lane with these bits; the inverse of bits().
template <class R>
inline R from_bits(Int<R> value) {
  R result;
  __builtin_memcpy(&result, &value, sizeof(R));
  return result;
}

/// The bits of a whole number moved to the left. C++17 leaves `<<` undefined where a sign bit is
/// lost, for a number; for a pack, the compiler defines it.
inline long long shift_left(long long value, int by) {
  return (long long)((unsigned long long)value << by);
}
inline int shift_left(int value, int by) { return (int)((unsigned)value << by); }
template <class Pack>
inline Pack shift_left(Pack value, int by) {
  return value << by;
}

/// Sine and cosine of a double lane: error < 2.3e-16 for |x| < 1e5.
///
/// Cody and Waite: x = k pi/2 + r, |r| <= pi/4, with pi/2 in two parts of which the first is short
/// enough for k times it to be exact; then the minimax polynomials of fdlibm (k_sin.c, k_cos.c) in
/// r^2, and the quadrant k mod 4 swaps and signs them.
template <class R>
inline void sincos(R x, R& sine, R& cosine) {
  const R magic = all<R>(0x1.8p52);  // adding it rounds to the nearest integer
  const R rounded = fma(x, all<R>(0x1.45f306dc9c883p-1), magic);
  const Int<R> quadrant = bits(rounded);
  const R k = rounded - magic;
  R r = fma(k, all<R>(-0x1.921fb54400000p+0), x);
  r = fma(k, all<R>(-0x1.0b4611a626331p-34), r);
  const R z = r * r;
  R p = fma(z, all<R>(1.58969099521155010221e-10), all<R>(-2.50507602534068634195e-08));
  p = fma(z, p, all<R>(2.75573137070700676789e-06));
  p = fma(z, p, all<R>(-1.98412698298579493134e-04));
  p = fma(z, p, all<R>(8.33333333332248946124e-03));
  p = fma(z, p, all<R>(-1.66666666666666324348e-01));
  const R s = fma(z * r, p, r);
  R q = fma(z, all<R>(-1.13596475577881948265e-11), all<R>(2.08757232129817482790e-09));
  q = fma(z, q, all<R>(-2.75573143513906633035e-07));
  q = fma(z, q, all<R>(2.48015872894767294178e-05));
  q = fma(z, q, all<R>(-1.38888888888741095749e-03));
  q = fma(z, q, all<R>(4.16666666666666019037e-02));
  const R c = fma(z * z, q, fma(z, all<R>(-0.5), all<R>(1.0)));
  const auto odd = (quadrant & 1) != 0;
  const Int<R> sign_of_sine = shift_left(quadrant & 2, 62);
  const Int<R> sign_of_cosine = shift_left((quadrant + 1) & 2, 62);
  sine = from_bits<R>(bits(select(odd, c, s)) ^ sign_of_sine);
  cosine = from_bits<R>(bits(select(odd, s, c)) ^ sign_of_cosine);
}

/// Sine and cosine for |x| <= 0.3, by their Taylor series: error < 5e-14 at 0.3, < 2e-17 at 0.1.
template <class R>
inline void small_sincos(R x, R& sine, R& cosine) {
  const R z = x * x;
  R p = fma(z, all<R>(1.0 / 362880), all<R>(-1.0 / 5040));
  p = fma(z, p, all<R>(1.0 / 120));
  p = fma(z, p, all<R>(-1.0 / 6));
  sine = fma(z * x, p, x);
  R q = fma(z, all<R>(1.0 / 40320), all<R>(-1.0 / 720));
  q = fma(z, q, all<R>(1.0 / 24));
  q = fma(z, q, all<R>(-0.5));
  cosine = fma(z, q, all<R>(1.0));
}

/// Natural logarithm of a positive, normal double lane, within about 1 ulp (fdlibm, e_log.c):
/// x = 2^k (1 + f), s = f / (2 + f), log(1 + f) = f - f^2/2 + s (f^2/2 + R(s^2)).
template <class R>
inline R log(R x) {
  // Shifting by the offset of sqrt(1/2) puts 1 + f between sqrt(1/2) and sqrt(2).
  const Int<R> shifted = bits(x) - 0x3fe6a09e667f3bcdLL;
  const Int<R> exponent = shifted >> 52;
  const R m = from_bits<R>(bits(x) - shift_left(exponent, 52));
  // |exponent| < 2^11: adding it to the bits of 2^52 + 2^51 makes it a double without a conversion.
  const R k = from_bits<R>(bits(all<R>(0x1.8p52)) + exponent) - all<R>(0x1.8p52);
  const R f = m - all<R>(1.0);
  const R s = f / (all<R>(2.0) + f);
  const R z = s * s;
  R p = fma(z, all<R>(1.479819860511658591e-01), all<R>(1.531383769920937332e-01));
  p = fma(z, p, all<R>(1.818357216161805012e-01));
  p = fma(z, p, all<R>(2.222219843214978396e-01));
  p = fma(z, p, all<R>(2.857142874366239149e-01));
  p = fma(z, p, all<R>(3.999999999940941908e-01));
  p = fma(z, p, all<R>(6.666666666666735130e-01)) * z;
  const R half_square = all<R>(0.5) * f * f;
  const R low = fma(k, all<R>(1.90821492927058770002e-10), s * (half_square + p));
  return fma(k, all<R>(6.93147180369123816490e-01), f - (half_square - low));
}

/// Exponential of a double lane, |x| < 700, within about 1 ulp (fdlibm, e_exp.c): x = k ln 2 + r,
/// |r| <= ln 2 / 2, c = r - r^2 P(r^2), exp x = 2^k (1 + r + r c / (2 - c)).
template <class R>
inline R exp(R x) {
  const R magic = all<R>(0x1.8p52);  // adding it rounds to the nearest integer
  const R rounded = fma(x, all<R>(1.44269504088896338700e+00), magic);
  const R k = rounded - magic;
  R r = fma(k, all<R>(-6.93147180369123816490e-01), x);
  r = fma(k, all<R>(-1.90821492927058770002e-10), r);
  const R z = r * r;
  R p = fma(z, all<R>(4.13813679705723846039e-08), all<R>(-1.65339022054652515390e-06));
  p = fma(z, p, all<R>(6.61375632143793436117e-05));
  p = fma(z, p, all<R>(-2.77777777770155933842e-03));
  p = fma(z, p, all<R>(1.66666666666666019037e-01));
  const R c = fma(-z, p, r);
  const R mantissa = all<R>(1.0) + (r + r * c / (all<R>(2.0) - c));
  return from_bits<R>(bits(mantissa) + shift_left(bits(rounded) - bits(magic), 52));
}

}  // namespace THREELINK_ISA
}  // namespace threelink_sim

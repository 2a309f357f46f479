// Products of small matrices over lanes: what the fused update spends its time in.
#pragma once

#include "network_kernel.hpp"
#include "threelink_agent/kernel/gradient.hpp"

namespace threelink_agent {
namespace THREELINK_ISA {

enum class Start { kZero, kBias, kSum };
enum class Finish { kPlain, kTanh, kTanhSlope };

// c(r, j) = start(r, j) + sum_k a(r, k) b(k, j) in rising k, a chain of fused multiply-adds, with
// a(r, k) = a[r * a_row + k * a_inner]. The start is 0, bias(j), or the c(r, j) there was. The
// finish turns the sum s into s, tanh(s), or s (1 - h(r, j)^2).
struct Product {
  int inner;
  const float* a;
  int a_row, a_inner;
  const float* b;
  int b_stride;
  float* c;
  int c_stride;
  const float* bias;
  const float* h;  // strided as c
};

// kRows rows and kPacks packs of columns, all in registers at once.
template <Start kStart, Finish kFinish, class R, int kRows, int kPacks>
inline void tile(const Product& p, int row, int column) {
  constexpr int kLanes = LaneTraits<R>::kWidth;
  const float* a = p.a + row * p.a_row;
  const float* b = p.b + column;
  const int first = row * p.c_stride + column;
  R sum[kRows][kPacks];
  for (int r = 0; r < kRows; ++r)
    for (int q = 0; q < kPacks; ++q) {
      if (kStart == Start::kZero) sum[r][q] = R{};
      if (kStart == Start::kBias) sum[r][q] = load<R>(p.bias + column + q * kLanes);
      if (kStart == Start::kSum) sum[r][q] = load<R>(p.c + first + r * p.c_stride + q * kLanes);
    }
  for (int k = 0; k < p.inner; ++k) {
    R right[kPacks];
    for (int q = 0; q < kPacks; ++q) right[q] = load<R>(b + k * p.b_stride + q * kLanes);
    for (int r = 0; r < kRows; ++r) {
      const R left = all<R>(a[r * p.a_row + k * p.a_inner]);
      for (int q = 0; q < kPacks; ++q) sum[r][q] = fma(left, right[q], sum[r][q]);
    }
  }
  for (int r = 0; r < kRows; ++r)
    for (int q = 0; q < kPacks; ++q) {
      const int at = first + r * p.c_stride + q * kLanes;
      R value = sum[r][q];
      if (kFinish == Finish::kTanh) value = tanh(value);
      if (kFinish == Finish::kTanhSlope) {
        const R h = load<R>(p.h + at);
        value = value * fma(-h, h, all<R>(1.0f));
      }
      store(value, p.c + at);
    }
}

// Sums in registers at a time: 16 of 32 registers with AVX-512, else 8 of 16.
constexpr int kTileRows = 4;
constexpr int kTilePacks = kRegister == 64 ? 4 : 2;
constexpr int kNarrowRows = 8;  // where one pack holds all columns

// All rows of kPacks packs of columns.
template <Start kStart, Finish kFinish, class R, int kRows, int kPacks>
inline void strip(const Product& p, int rows, int column) {
  int row = 0;
  for (; row + kRows <= rows; row += kRows) tile<kStart, kFinish, R, kRows, kPacks>(p, row, column);
  for (; row < rows; ++row) tile<kStart, kFinish, R, 1, kPacks>(p, row, column);
}

// Columns are rounded up to whole packs; the strides leave room for that.
template <Start kStart, Finish kFinish>
inline void multiply(const Product& p, int rows, int columns) {
  int column = 0;
  for (; column + kTilePacks * kWidth <= columns; column += kTilePacks * kWidth)
    strip<kStart, kFinish, FloatPack, kTileRows, kTilePacks>(p, rows, column);
  for (; column + 4 < columns; column += kWidth)
    strip<kStart, kFinish, FloatPack, kNarrowRows, 1>(p, rows, column);
  if (column < columns) strip<kStart, kFinish, QuadPack, kNarrowRows, 1>(p, rows, column);
}

// e^x within 2 ulp for |x| <= 80, beyond that the value at the bound: 2^k e^r with k = round(x /
// log 2), and the polynomial of Cephes (expf.c) for e^r.
template <class R>
inline R exp(R x) {
  const R bound = all<R>(80.0f);
  x = max(-bound, min(bound, x));
  const R magic = all<R>(0x1.8p23f);  // adding it rounds to the nearest integer
  const R rounded = fma(x, all<R>(1.44269504088896341f), magic);
  const R k = rounded - magic;
  R r = fma(k, all<R>(-0.693359375f), x);
  r = fma(k, all<R>(2.12194440e-4f), r);
  R p = fma(r, all<R>(1.9875691500e-4f), all<R>(1.3981999507e-3f));
  p = fma(r, p, all<R>(8.3334519073e-3f));
  p = fma(r, p, all<R>(4.1665795894e-2f));
  p = fma(r, p, all<R>(1.6666665459e-1f));
  p = fma(r, p, all<R>(5.0000001201e-1f));
  const R e_r = fma(r * r, p, r) + all<R>(1.0f);
  return e_r * from_bits<R>(shift_left(bits(rounded), 23) + bits(all<R>(1.0f)));
}

}  // namespace THREELINK_ISA
}  // namespace threelink_agent

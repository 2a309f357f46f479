// Philox4x32-10 (Salmon et al., "Parallel random numbers: as easy as 1, 2, 3", SC 2011) and
// normals.
#pragma once

#include <stdint.h>

#include "threelink_sim/kernel/lane.hpp"

namespace threelink_sim {
namespace THREELINK_ISA {

// Ten rounds on kLanes counters at once; word w of lane i is words[w][i]. The loop over lanes is
// plain integer arithmetic, which the compiler vectorises without changing a bit.
template <int kLanes>
inline void philox(const uint32_t key[2], uint32_t words[4][kLanes]) {
  uint32_t k0 = key[0], k1 = key[1];
  for (int round = 0; round < 10; ++round) {
    for (int i = 0; i < kLanes; ++i) {
      const uint64_t product_0 = uint64_t(0xD2511F53u) * words[0][i];
      const uint64_t product_1 = uint64_t(0xCD9E8D57u) * words[2][i];
      const uint32_t word_1 = words[1][i], word_3 = words[3][i];
      words[0][i] = uint32_t(product_1 >> 32) ^ word_1 ^ k0;
      words[1][i] = uint32_t(product_1);
      words[2][i] = uint32_t(product_0 >> 32) ^ word_3 ^ k1;
      words[3][i] = uint32_t(product_0);
    }
    k0 += 0x9E3779B9u;
    k1 += 0xBB67AE85u;
  }
}

template <int kLanes>
inline void philox_of(const uint32_t key[2], const uint32_t* counters, uint32_t words[4][kLanes]) {
  for (int i = 0; i < kLanes; ++i)
    for (int w = 0; w < 4; ++w) words[w][i] = counters[4 * i + w];
  philox<kLanes>(key, words);
}

// The upper 52 of 64 bits as a double in (0, 1), ends excluded.
inline double open_uniform(uint32_t high, uint32_t low) {
  const uint64_t fraction = ((uint64_t(high) << 32) | low) >> 12;
  return (double(fraction) + 0.5) * 0x1p-52;
}

// Box and Muller: standard normals sqrt(-2 ln u) (cos, sin)(2 pi v), one pair a lane.
template <class R>
inline void normals_lane(const uint32_t key[2], const uint32_t* counters, double* out) {
  constexpr int kLanes = LaneTraits<R>::kWidth;
  uint32_t words[4][kLanes];
  philox_of<kLanes>(key, counters, words);
  double u[kLanes], v[kLanes], first[kLanes], second[kLanes];
  for (int i = 0; i < kLanes; ++i) {
    u[i] = open_uniform(words[0][i], words[1][i]);
    v[i] = open_uniform(words[2][i], words[3][i]);
  }
  const R radius = sqrt(all<R>(-2.0) * log(load<R>(u)));
  R sine, cosine;
  sincos(load<R>(v) * all<R>(0x1.921fb54442d18p+2), sine, cosine);
  store(radius * cosine, first);
  store(radius * sine, second);
  for (int i = 0; i < kLanes; ++i) {
    out[2 * i] = first[i];
    out[2 * i + 1] = second[i];
  }
}

}  // namespace THREELINK_ISA
}  // namespace threelink_sim

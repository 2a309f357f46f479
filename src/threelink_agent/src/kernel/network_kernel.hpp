// Forward pass of the tanh network over lanes (see threelink_sim/kernel/lane.hpp).
//
// Each output is the chain y_j = fma(w_jk, x_k, y_j), k rising, started at b_j. A batch has one
// sample in each lane, a single sample one output in each lane; the chains, and so the bits, are
// the same.
#pragma once

#include "threelink_agent/kernel/network.hpp"
#include "threelink_sim/kernel/lane.hpp"

namespace threelink_agent {
namespace THREELINK_ISA {

using namespace threelink_sim::THREELINK_ISA;

constexpr int kWidth = LaneTraits<FloatPack>::kWidth;

// tanh(x) = x P(x^2) / Q(x^2), both of degree 4: the minimax fit of the relative error on
// [0, 9.02], 2.1e-8, beyond which tanh is 1 in float. Evaluated in float it is within 6 ulp, and so
// may exceed 1 by 2.4e-7.
template <class R>
inline R tanh(R x) {
  const R bound = all<R>(9.02f);
  x = max(-bound, min(bound, x));
  const R z = x * x;
  R p = fma(z, all<R>(1.33195522086761367e-08f), all<R>(2.05838825417031101e-05f));
  p = fma(z, p, all<R>(3.49406122148558639e-03f));
  p = fma(z, p, all<R>(1.33797411948128276e-01f));
  p = fma(z, p, all<R>(0.999999979222354569f));
  R q = fma(z, all<R>(7.76223239641817074e-07f), all<R>(3.28313484438050520e-04f));
  q = fma(z, q, all<R>(2.58711770470399885e-02f));
  q = fma(z, q, all<R>(4.67130565091532870e-01f));
  q = fma(z, q, all<R>(1.0f));
  return x * p / q;
}

// --- Batch: lanes are samples --------------------------------------------------------------------

// A block of kPacks packs R of samples goes through the whole network at once. Its activations,
// x[k * kBlock<R, kPacks> + i], stay in the first-level cache, and each weight that is read serves
// all of the block.
template <class R, int kPacks>
constexpr int kBlock = kPacks* LaneTraits<R>::kWidth;
constexpr int kMaxPacks = 2;
// Outputs whose sums are in registers at a time: 16 of 32 registers with AVX-512, else 8 of 16.
constexpr int kMaxOutputs = kRegister == 64 ? 8 : 4;

template <class R, int kPacks, int kOutputs>
inline void block_outputs(const PackedLayer& layer, const float* rows, int first, bool last_layer,
                          const float* x, float* y) {
  constexpr int kLanes = LaneTraits<R>::kWidth, kSize = kBlock<R, kPacks>;
  R sum[kOutputs][kPacks];
  const float* row = rows + first;
  for (int j = 0; j < kOutputs; ++j)
    for (int p = 0; p < kPacks; ++p) sum[j][p] = all<R>(row[j]);
  for (int k = 0; k < layer.inputs; ++k) {
    row += layer.stride;
    R sample[kPacks];
    for (int p = 0; p < kPacks; ++p) sample[p] = load<R>(x + k * kSize + p * kLanes);
    for (int j = 0; j < kOutputs; ++j) {
      const R weight = all<R>(row[j]);
      for (int p = 0; p < kPacks; ++p) sum[j][p] = fma(weight, sample[p], sum[j][p]);
    }
  }
  for (int j = 0; j < kOutputs; ++j)
    for (int p = 0; p < kPacks; ++p)
      store(last_layer ? sum[j][p] : tanh(sum[j][p]), y + (first + j) * kSize + p * kLanes);
}

// Outputs from `first` on: as many as fit in groups of kOutputs, the rest in smaller groups.
template <class R, int kPacks, int kOutputs>
inline void block_layer(const PackedLayer& layer, const float* rows, int first, bool last_layer,
                        const float* x, float* y) {
  for (; first + kOutputs <= layer.outputs; first += kOutputs)
    block_outputs<R, kPacks, kOutputs>(layer, rows, first, last_layer, x, y);
  if constexpr (kOutputs > 1)
    block_layer<R, kPacks, kOutputs / 2>(layer, rows, first, last_layer, x, y);
}

// `samples` samples from `first` on, at most kBlock<R, kPacks>; further lanes compute on zeros and
// are not stored.
template <class R, int kPacks>
inline void block(const PackedNetwork& network, std::size_t n, std::size_t first,
                  std::size_t samples, const float* input, float* output) {
  constexpr int kSize = kBlock<R, kPacks>;
  alignas(64) float activations[2][kMaxLayerWidth * kSize];
  const int inputs = network.layers[0].inputs;
  const int outputs = network.layers[network.count - 1].outputs;
  for (int k = 0; k < inputs; ++k) {
    float* x = activations[0] + k * kSize;
    if (samples < kSize) __builtin_memset(x, 0, kSize * sizeof(float));
    __builtin_memcpy(x, input + k * n + first, samples * sizeof(float));
  }
  for (int l = 0; l < network.count; ++l) {
    const PackedLayer& layer = network.layers[l];
    block_layer<R, kPacks, kMaxOutputs>(layer, network.values + layer.offset, 0,
                                        l + 1 == network.count, activations[l % 2],
                                        activations[(l + 1) % 2]);
  }
  for (int j = 0; j < outputs; ++j)
    __builtin_memcpy(output + j * n + first, activations[network.count % 2] + j * kSize,
                     samples * sizeof(float));
}

// --- One sample: lanes are outputs ---------------------------------------------------------------

template <int kCount>
inline void one_outputs(const PackedLayer& layer, const float* rows, int first, bool last_layer,
                        const float* x, float* y) {
  FloatPack sum[kCount];
  const float* row = rows + first;
  for (int p = 0; p < kCount; ++p) sum[p] = load<FloatPack>(row + p * kWidth);
  for (int k = 0; k < layer.inputs; ++k) {
    row += layer.stride;
    const FloatPack sample = all<FloatPack>(x[k]);
    for (int p = 0; p < kCount; ++p)
      sum[p] = fma(load<FloatPack>(row + p * kWidth), sample, sum[p]);
  }
  for (int p = 0; p < kCount; ++p)
    store(last_layer ? sum[p] : tanh(sum[p]), y + first + p * kWidth);
}

// Packs of outputs from `first` on, kCount at a time, so that their chains hide each other's
// latency.
template <int kCount>
inline void one_layer(const PackedLayer& layer, const float* rows, int first, bool last_layer,
                      const float* x, float* y) {
  for (; first + kCount * kWidth <= layer.stride; first += kCount * kWidth)
    one_outputs<kCount>(layer, rows, first, last_layer, x, y);
  if constexpr (kCount > 1) one_layer<kCount / 2>(layer, rows, first, last_layer, x, y);
}

}  // namespace THREELINK_ISA
}  // namespace threelink_agent

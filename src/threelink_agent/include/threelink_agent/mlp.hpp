/// @file
/// The tanh network of actor and critic, evaluated without LibTorch and without allocation.
#pragma once

#include <cstddef>
#include <vector>

#include "threelink_agent/kernel/network.hpp"
#include "threelink_agent/linear.hpp"
#include "threelink_agent/packed.hpp"
#include "threelink_sim/isa.hpp"

namespace threelink_agent {

/// Linear layers with tanh between them; the last one is linear.
///
/// For every output y_j = b_j + sum_k w_jk x_k is a chain of fused multiply-adds in increasing k
/// that starts at b_j, and tanh is a rational function within 6 ulp
/// (src/kernel/network_kernel.hpp). Therefore a single sample and a batch give the same bits, on
/// every instruction set with fused multiply-adds.
class Mlp {
 public:
  /// Largest number of inputs or outputs of a layer.
  static constexpr int kMaxWidth = kMaxLayerWidth;

  Mlp() = default;
  /// Throws std::invalid_argument that names layer, shape and bound if there is no layer, if
  /// consecutive layers do not match, if a layer is wider than kMaxWidth or not finite, or if this
  /// processor lacks the instruction set.
  explicit Mlp(std::vector<Linear> layers, threelink_sim::Isa isa = threelink_sim::isa_in_use());

  int inputs() const { return static_cast<int>(layers_.front().weight.cols()); }
  int outputs() const { return static_cast<int>(layers_.back().weight.rows()); }
  const std::vector<Linear>& layers() const { return layers_; }

  /// One sample: input (inputs()), output (outputs()).
  void forward(const float* input, float* output) const;

  /// n samples: component k of sample i is input[k * n + i]; likewise for the output.
  void forward(std::size_t n, const float* input, float* output) const;

 private:
  PackedNetwork packed() const;

  std::vector<Linear> layers_;
  std::vector<PackedLayer> layout_;
  AlignedFloats values_;
  const NetworkKernels* kernels_ = nullptr;
};

}  // namespace threelink_agent

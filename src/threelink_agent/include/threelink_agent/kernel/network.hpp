/// @file
/// The kernels of the tanh network, compiled for several instruction sets. Only Mlp uses them.
#pragma once

#include <cstddef>

namespace threelink_sim {
enum class Isa;  ///< isa.hpp; not included, since kernel files use nothing of the standard library
}

namespace threelink_agent {

constexpr int kMaxLayerWidth = 256;  ///< largest number of inputs and of outputs of a layer
constexpr int kPackedFloats = 16;    ///< floats in 64 bytes; a packed row is a multiple of these

/// One layer in the layout of the kernels: inputs + 1 rows of `stride` floats. The first row is the
/// bias; then follows the transposed weight, with row k holding w_jk for j < outputs. The rest of a
/// row is zero.
struct PackedLayer {
  int inputs;
  int outputs;
  int stride;          ///< outputs rounded up to kPackedFloats
  std::size_t offset;  ///< of the first row in PackedNetwork::values
};

/// A network: its `count` layers and their values.
struct PackedNetwork {
  int count;
  const PackedLayer* layers;
  const float* values;  ///< aligned to 64 bytes
};

/// The kernels of one instruction set.
struct NetworkKernels {
  /// input (inputs), output (outputs)
  void (*one)(const PackedNetwork&, const float* input, float* output);
  /// component k of sample i at [k * n + i]
  void (*batch)(const PackedNetwork&, std::size_t n, const float* input, float* output);
};

/// The kernels of an instruction set. Throws std::invalid_argument if this processor lacks it.
const NetworkKernels& network_kernels(threelink_sim::Isa isa);

}  // namespace threelink_agent

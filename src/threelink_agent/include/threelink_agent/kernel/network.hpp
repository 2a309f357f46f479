/// @file
/// The kernels of the tanh network, compiled for several instruction sets; Mlp is their only user.
#pragma once

#include <cstddef>

namespace threelink_sim {
enum class Isa;  ///< isa.hpp; not included, since kernel files use nothing of the standard library
}

namespace threelink_agent {

constexpr int kMaxLayerWidth = 256;  ///< inputs and outputs of a layer
constexpr int kPackedFloats = 16;    ///< in 64 bytes; a packed row is a whole number of these

/// One layer as the kernels read it: inputs + 1 rows of `stride` floats, the bias first, then the
/// transposed weight, row k holding w_jk for j < outputs; the rest of a row is zero.
struct PackedLayer {
  int inputs;
  int outputs;
  int stride;          ///< outputs rounded up to kPackedFloats
  std::size_t offset;  ///< of the first row in PackedNetwork::values
};

struct PackedNetwork {
  int count;
  const PackedLayer* layers;
  const float* values;  ///< aligned to 64 bytes
};

struct NetworkKernels {
  /// input (inputs), output (outputs)
  void (*one)(const PackedNetwork&, const float* input, float* output);
  /// component k of sample i at [k * n + i]
  void (*batch)(const PackedNetwork&, std::size_t n, const float* input, float* output);
};

/// Throws std::invalid_argument if this processor lacks the instruction set.
const NetworkKernels& network_kernels(threelink_sim::Isa isa);

}  // namespace threelink_agent

/// @file
/// The kernels of the fused update: forward and backward pass of the tanh network, PPO's loss and
/// Adam, compiled for several instruction sets.
///
/// Samples are rows here: component j of sample i is at [i * stride + j], and strides are whole
/// numbers of 64 bytes. Lanes run over components, and each sum over samples runs in their order,
/// so that no result depends on the width of the registers. Layers are those of PackedLayer: the
/// first row is the bias, row k + 1 holds w_jk.
#pragma once

#include <cstddef>

#include "threelink_agent/kernel/network.hpp"

namespace threelink_agent {

/// The clipped policy loss of some samples, and its gradient; with z = (a - mean) / std,
///   log r = sum_j (-z_j^2/2 - log std_j - log sqrt(2 pi)) - log p_old
///   loss  = -min(r A, clip(r, 1 - epsilon, 1 + epsilon) A)
/// Arrays hold kLossBlock samples, component-major; what is beyond the samples that there are is
/// computed too, and means nothing.
constexpr int kLossBlock = 64;
struct PolicyLoss {
  int hinges;
  float epsilon;
  const float* log_std;      ///< (A)
  const float* inverse_std;  ///< (A) 1 / std
  const float* mean;         ///< (A, kLossBlock)
  const float* actions;      ///< (A, kLossBlock)
  const float* log_probs;    ///< (kLossBlock) log p_old
  const float* advantages;   ///< (kLossBlock)
  float* z;                  ///< (A, kLossBlock) out
  float* log_ratio;          ///< (kLossBlock) out
  float* loss;               ///< (kLossBlock) out
  float* slope;              ///< (kLossBlock) out: d loss / d log r, that is -r A, or 0 if clipped
};

/// Adam (Kingma and Ba 2015, arXiv:1412.6980), beta = (0.9, 0.999), eps = 1e-8:
///   m <- beta_1 m + (1 - beta_1) g,  v <- beta_2 v + (1 - beta_2) g^2
///   p <- p - step_size m / (sqrt(v) / root_correction + eps)
struct AdamStep {
  std::size_t n;  ///< a multiple of kPackedFloats
  float* parameters;
  float* mean;
  float* variance;
  const float* gradient;
  float scale;            ///< g = scale * gradient
  float step_size;        ///< learning rate / (1 - beta_1^t)
  float root_correction;  ///< sqrt(1 - beta_2^t)
};
constexpr double kBeta1 = 0.9, kBeta2 = 0.999;

struct GradientKernels {
  /// y = b + W x, then tanh if the layer is hidden. x (samples, x_stride), y (samples,
  /// layer.stride), of which layer.outputs are written. Every y_j is the same chain as that of
  /// NetworkKernels, so that both agree to the bit.
  void (*forward)(const PackedLayer& layer, const float* rows, int samples, const float* x,
                  int x_stride, bool hidden, float* y);
  /// Gradient by the activations x = tanh(..) that the layer took: dx_k = (1 - x_k^2) sum_j dy_j
  /// w_jk. weights: rows w_j of x_stride floats.
  void (*backward)(const PackedLayer& layer, const float* weights, int samples, const float* dy,
                   const float* x, int x_stride, float* dx);
  /// Adds to the gradient of the layer's rows: sum_i dy_ij to that of b_j, sum_i dy_ij x_ik to
  /// w_jk.
  void (*accumulate)(const PackedLayer& layer, int samples, const float* dy, const float* x,
                     int x_stride, float* gradient);
  void (*policy_loss)(const PolicyLoss&);
  void (*adam)(const AdamStep&);
};

/// Throws std::invalid_argument if this processor lacks the instruction set.
const GradientKernels& gradient_kernels(threelink_sim::Isa isa);

}  // namespace threelink_agent

/// @file
/// The kernels of the fused update: forward and backward pass of the tanh network, PPO's loss and
/// Adam, compiled for several instruction sets.
///
/// Samples are rows: component j of sample i is at [i * stride + j], and a stride is a multiple of
/// 64 bytes. Lanes run over components, and each sum over samples is taken in the order of the
/// samples, so that no result depends on the width of the registers. Layers have the layout of
/// PackedLayer: the first row is the bias, row k + 1 holds w_jk.
#pragma once

#include <cstddef>

#include "threelink_agent/kernel/network.hpp"

namespace threelink_agent {

/// Number of samples in the arrays of PolicyLoss.
constexpr int kLossBlock = 64;

/// The clipped policy loss of a block of samples, and its gradient. With z = (a - mean) / std,
///
///   log r = sum_j (-z_j^2/2 - log std_j - log sqrt(2 pi)) - log p_old
///   loss  = -min(r A, clip(r, 1 - epsilon, 1 + epsilon) A)
///
/// Arrays hold kLossBlock samples, component-major. Entries beyond the existing samples are
/// computed too and have no meaning.
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
constexpr double kBeta1 = 0.9,  ///< Adam's decay rate of the first moment
    kBeta2 = 0.999;             ///< Adam's decay rate of the second moment

/// The kernels of one instruction set.
struct GradientKernels {
  /// y = b + W x, then tanh if the layer is hidden. x (samples, x_stride), y (samples,
  /// layer.stride), of which layer.outputs are written. Every y_j is computed by the same chain of
  /// operations as in NetworkKernels, so that both agree to the bit.
  void (*forward)(const PackedLayer& layer, const float* rows, int samples, const float* x,
                  int x_stride, bool hidden, float* y);
  /// Gradient with respect to the activations x = tanh(..) that were the input of the layer: dx_k =
  /// (1 - x_k^2) sum_j dy_j w_jk. weights: rows w_j of x_stride floats.
  void (*backward)(const PackedLayer& layer, const float* weights, int samples, const float* dy,
                   const float* x, int x_stride, float* dx);
  /// Adds to the gradient of the layer's rows: sum_i dy_ij to that of b_j, and sum_i dy_ij x_ik to
  /// that of w_jk.
  void (*accumulate)(const PackedLayer& layer, int samples, const float* dy, const float* x,
                     int x_stride, float* gradient);
  /// Computes the loss and its gradient.
  void (*policy_loss)(const PolicyLoss&);
  /// Performs a step of Adam.
  void (*adam)(const AdamStep&);
};

/// The kernels of an instruction set. Throws std::invalid_argument if this processor lacks it.
const GradientKernels& gradient_kernels(threelink_sim::Isa isa);

}  // namespace threelink_agent

/// @file
/// A tanh network that is trained by the gradient kernels: its parameters, gradient and Adam state.
#pragma once

#include <cstdint>
#include <vector>

#include <Eigen/Core>

#include "threelink_agent/kernel/gradient.hpp"
#include "threelink_agent/packed.hpp"

namespace threelink_agent {

/// One number for each parameter of a network and for each extra parameter (log_std).
struct NetworkTensors {
  std::vector<Linear> layers;
  Eigen::VectorXf extra;
};

/// Parameters, moments and gradients are flat arrays: the layers in the layout of PackedLayer, then
/// the extra parameters. The padding is 0 and remains 0, because its gradient is 0.
class FusedNetwork {
 public:
  FusedNetwork(const NetworkTensors& start, const GradientKernels& kernels);

  int inputs() const { return layout_.front().inputs; }
  const std::vector<PackedLayer>& layout() const { return layout_; }

  NetworkTensors parameters() const { return tensors(parameters_); }
  NetworkTensors mean() const { return tensors(mean_); }
  NetworkTensors variance() const { return tensors(variance_); }
  std::uint64_t steps() const { return steps_; }
  float* extra() { return parameters_.data() + extra_at_; }
  const float* extra() const { return parameters_.data() + extra_at_; }
  /// Sets parameters, moments and the number of steps; the shapes must not change.
  void set(const NetworkTensors& parameters, const NetworkTensors& mean,
           const NetworkTensors& variance, std::uint64_t steps);

  /// A slice of a minibatch: the activations of one block at a time, and the sum of the gradients.
  /// Several threads can work on slices of the same network.
  class Slice {
   public:
    /// input_stride: floats from one row of inputs() to the next, a multiple of kPackedFloats and
    /// at least the network's inputs. The caller may use the rest of a row.
    Slice(const FusedNetwork& network, int input_stride);

    void clear() { gradient_.clear(); }

    /// Rows of a block: inputs (kLossBlock, input_stride), to be written before forward(), outputs
    /// (kLossBlock, output_stride()), and the gradient of the loss by them, to be written before
    /// backward().
    float* inputs() { return inputs_.data(); }
    const float* outputs() const { return activations_.back().data(); }
    float* output_gradient() { return deltas_.back().data(); }
    int output_stride() const { return network_->layout_.back().stride; }

    /// samples: at most kLossBlock.
    void forward(int samples);
    void backward(int samples);  ///< adds to the gradient

    /// Gradient of the extra parameters; the caller adds to it.
    float* extra_gradient() { return gradient_.data() + network_->extra_at_; }

   private:
    friend class FusedNetwork;
    const FusedNetwork* network_;
    int input_stride_;
    AlignedFloats inputs_, gradient_;
    std::vector<AlignedFloats> activations_, deltas_;  ///< (kLossBlock, stride) of each layer
  };

  /// Sums the slices in their order, scales the sum to max_gradient_norm if it is longer, and
  /// performs a step of Adam.
  void descend(const std::vector<Slice>& slices, double learning_rate, double max_gradient_norm);

 private:
  NetworkTensors tensors(const AlignedFloats& flat) const;
  void assign(const NetworkTensors& tensors, AlignedFloats& flat) const;
  void transpose();

  const GradientKernels* kernels_;
  std::vector<PackedLayer> layout_;
  std::size_t extra_at_;  ///< index of the extra parameters
  int extra_;             ///< their number, at most kPackedFloats * n
  AlignedFloats parameters_, mean_, variance_, gradient_;
  std::vector<AlignedFloats> weights_;  ///< of each layer but the first: rows w_j, for the way back
  std::uint64_t steps_ = 0;             ///< of Adam
};

}  // namespace threelink_agent

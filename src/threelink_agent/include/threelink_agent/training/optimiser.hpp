/// @file
/// Adam on one flat array of parameters.
#pragma once

#include <cstdint>
#include <vector>

#include <torch/torch.h>

namespace threelink_agent {

/// Moves the given parameters into one array and their gradients into another; the originals become
/// views of these. A step then takes a few operations instead of a dozen for each layer.
///
/// Adam (Kingma and Ba 2015, arXiv:1412.6980) is LibTorch's, beta = (0.9, 0.999), epsilon 1e-8.
class FlatAdam {
 public:
  /// max_gradient_norm: longer gradients are scaled to this Euclidean length before each step.
  FlatAdam(const std::vector<torch::Tensor>& parameters, double max_gradient_norm);

  void set_learning_rate(double rate);

  /// Descends the gradient of `loss` by one step.
  void descend(const torch::Tensor& loss);

  /// First and second moment as flat arrays in the order of the parameters, and the number of
  /// steps.
  struct State {
    torch::Tensor mean, variance;
    std::int64_t steps;
  };
  State state() const;
  void restore(const State& state);

 private:
  torch::Tensor values_;  ///< all parameters; its gradient holds all gradients
  double max_gradient_norm_;
  torch::optim::Adam adam_;
};

}  // namespace threelink_agent

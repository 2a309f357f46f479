#include "threelink_agent/training/fused_network.hpp"

#include <algorithm>
#include <cmath>

namespace threelink_agent {

FusedNetwork::FusedNetwork(const NetworkTensors& start, const GradientKernels& kernels)
    : kernels_(&kernels),
      layout_(packed_layout(start.layers)),
      extra_at_(packed_size(layout_)),
      extra_(static_cast<int>(start.extra.size())),
      parameters_(extra_at_ + extra_),
      mean_(parameters_),
      variance_(parameters_),
      gradient_(parameters_) {
  for (std::size_t l = 1; l < layout_.size(); ++l)
    weights_.emplace_back(std::size_t(layout_[l].outputs) * layout_[l - 1].stride);
  assign(start, parameters_);
  transpose();
}

NetworkTensors FusedNetwork::tensors(const AlignedFloats& flat) const {
  return {unpack(layout_, flat.data()),
          Eigen::Map<const Eigen::VectorXf>(flat.data() + extra_at_, extra_)};
}

void FusedNetwork::assign(const NetworkTensors& tensors, AlignedFloats& flat) const {
  pack(tensors.layers, layout_, flat.data());
  Eigen::Map<Eigen::VectorXf>(flat.data() + extra_at_, extra_) = tensors.extra;
}

void FusedNetwork::set(const NetworkTensors& parameters, const NetworkTensors& mean,
                       const NetworkTensors& variance, std::uint64_t steps) {
  assign(parameters, parameters_);
  assign(mean, mean_);
  assign(variance, variance_);
  steps_ = steps;
  transpose();
}

void FusedNetwork::transpose() {
  for (std::size_t l = 1; l < layout_.size(); ++l) {
    const PackedLayer& layer = layout_[l];
    const int stride = layout_[l - 1].stride;
    const float* rows = parameters_.data() + layer.offset + layer.stride;
    float* weights = weights_[l - 1].data();
    for (int j = 0; j < layer.outputs; ++j)
      for (int k = 0; k < layer.inputs; ++k) weights[j * stride + k] = rows[k * layer.stride + j];
  }
}

FusedNetwork::Slice::Slice(const FusedNetwork& network, int input_stride)
    : network_(&network),
      input_stride_(input_stride),
      inputs_(std::size_t(kLossBlock) * input_stride_),
      gradient_(network.gradient_) {
  clear();
  for (const PackedLayer& layer : network.layout_) {
    activations_.emplace_back(std::size_t(kLossBlock) * layer.stride);
    deltas_.emplace_back(std::size_t(kLossBlock) * layer.stride);
  }
}

void FusedNetwork::Slice::forward(int samples) {
  const float* x = inputs_.data();
  int x_stride = input_stride_;
  const auto& layout = network_->layout_;
  for (std::size_t l = 0; l < layout.size(); ++l) {
    network_->kernels_->forward(layout[l], network_->parameters_.data() + layout[l].offset, samples,
                                x, x_stride, l + 1 < layout.size(), activations_[l].data());
    x = activations_[l].data();
    x_stride = layout[l].stride;
  }
}

void FusedNetwork::Slice::backward(int samples) {
  const auto& layout = network_->layout_;
  for (std::size_t l = layout.size(); l-- > 0;) {
    const float* dy = deltas_[l].data();
    const float* x = l > 0 ? activations_[l - 1].data() : inputs_.data();
    const int x_stride = l > 0 ? layout[l - 1].stride : input_stride_;
    network_->kernels_->accumulate(layout[l], samples, dy, x, x_stride,
                                   gradient_.data() + layout[l].offset);
    if (l > 0)
      network_->kernels_->backward(layout[l], network_->weights_[l - 1].data(), samples, dy, x,
                                   x_stride, deltas_[l - 1].data());
  }
}

void FusedNetwork::descend(const std::vector<Slice>& slices, double learning_rate,
                           double max_gradient_norm) {
  // Line by line, with a partial sum of squares for each place in a line.
  float squares[kPackedFloats] = {};
  for (std::size_t line = 0; line < gradient_.size(); line += kPackedFloats) {
    float sum[kPackedFloats] = {};
    for (const Slice& slice : slices) {
      const float* part = slice.gradient_.data() + line;
      for (int j = 0; j < kPackedFloats; ++j) sum[j] += part[j];
    }
    for (int j = 0; j < kPackedFloats; ++j) squares[j] += sum[j] * sum[j];
    std::copy_n(sum, kPackedFloats, gradient_.data() + line);
  }
  double square = 0;
  for (float partial : squares) square += partial;
  const double norm = std::sqrt(square);

  ++steps_;
  const auto t = static_cast<double>(steps_);
  AdamStep step{};
  step.n = parameters_.size();
  step.parameters = parameters_.data();
  step.mean = mean_.data();
  step.variance = variance_.data();
  step.gradient = gradient_.data();
  step.scale = norm > max_gradient_norm ? static_cast<float>(max_gradient_norm / norm) : 1.0f;
  step.step_size = static_cast<float>(learning_rate / (1 - std::pow(kBeta1, t)));
  step.root_correction = static_cast<float>(std::sqrt(1 - std::pow(kBeta2, t)));
  kernels_->adam(step);
  transpose();
}

}  // namespace threelink_agent

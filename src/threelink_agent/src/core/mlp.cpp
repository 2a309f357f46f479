#include "threelink_agent/mlp.hpp"

#include <stdexcept>
#include <utility>

#include <fmt/format.h>

namespace threelink_agent {
namespace {

void check_layers(const std::vector<Linear>& layers) {
  if (layers.empty()) throw std::invalid_argument("layers: there is none");
  for (std::size_t l = 0; l < layers.size(); ++l) {
    const auto& weight = layers[l].weight;
    const auto refuse = [&](const std::string& reason) {
      throw std::invalid_argument(fmt::format("layer {}: weight of shape ({}, {}) {}", l,
                                              weight.rows(), weight.cols(), reason));
    };
    const auto in_bounds = [](Eigen::Index size) { return size >= 1 && size <= Mlp::kMaxWidth; };
    if (!in_bounds(weight.rows()) || !in_bounds(weight.cols()))
      refuse(fmt::format("must have sizes in [1, {}]", Mlp::kMaxWidth));
    if (l > 0 && weight.cols() != layers[l - 1].weight.rows())
      refuse(fmt::format("must be ({}, {}) after the layer before", weight.rows(),
                         layers[l - 1].weight.rows()));
    if (layers[l].bias.size() != weight.rows())
      refuse(fmt::format("has a bias of {} values", layers[l].bias.size()));
    if (!weight.allFinite() || !layers[l].bias.allFinite()) refuse("or its bias is not finite");
  }
}

}  // namespace

Mlp::Mlp(std::vector<Linear> layers, threelink_sim::Isa isa)
    : layers_(std::move(layers)), kernels_(&network_kernels(isa)) {
  check_layers(layers_);
  std::size_t lines = 0;
  for (const Linear& layer : layers_) {
    const int inputs = static_cast<int>(layer.weight.cols());
    const int outputs = static_cast<int>(layer.weight.rows());
    const int lines_a_row = (outputs + kPackedFloats - 1) / kPackedFloats;
    packed_layers_.push_back({inputs, outputs, lines_a_row * kPackedFloats, lines * kPackedFloats});
    lines += static_cast<std::size_t>(inputs + 1) * lines_a_row;
  }
  packed_values_.assign(lines, Line{});
  for (std::size_t l = 0; l < layers_.size(); ++l) {
    const PackedLayer& packed = packed_layers_[l];
    float* row = packed_values_.front().values + packed.offset;
    Eigen::Map<Eigen::VectorXf>(row, packed.outputs) = layers_[l].bias;
    for (int k = 0; k < packed.inputs; ++k) {
      row += packed.stride;
      Eigen::Map<Eigen::VectorXf>(row, packed.outputs) = layers_[l].weight.col(k);
    }
  }
}

PackedNetwork Mlp::packed() const {
  return {static_cast<int>(packed_layers_.size()), packed_layers_.data(),
          packed_values_.front().values};
}

void Mlp::forward(const float* input, float* output) const {
  kernels_->one(packed(), input, output);
}

void Mlp::forward(std::size_t n, const float* input, float* output) const {
  kernels_->batch(packed(), n, input, output);
}

}  // namespace threelink_agent

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
  layout_ = packed_layout(layers_);
  values_ = AlignedFloats(packed_size(layout_));
  pack(layers_, layout_, values_.data());
}

PackedNetwork Mlp::packed() const {
  return {static_cast<int>(layout_.size()), layout_.data(), values_.data()};
}

void Mlp::forward(const float* input, float* output) const {
  kernels_->one(packed(), input, output);
}

void Mlp::forward(std::size_t n, const float* input, float* output) const {
  kernels_->batch(packed(), n, input, output);
}

}  // namespace threelink_agent

#include "threelink_agent/packed.hpp"

namespace threelink_agent {

std::vector<PackedLayer> packed_layout(const std::vector<Linear>& layers) {
  std::vector<PackedLayer> layout;
  std::size_t offset = 0;
  for (const Linear& layer : layers) {
    const int inputs = static_cast<int>(layer.weight.cols());
    const int outputs = static_cast<int>(layer.weight.rows());
    const int stride = (outputs + kPackedFloats - 1) / kPackedFloats * kPackedFloats;
    layout.push_back({inputs, outputs, stride, offset});
    offset += static_cast<std::size_t>(inputs + 1) * stride;
  }
  return layout;
}

std::size_t packed_size(const std::vector<PackedLayer>& layout) {
  const PackedLayer& last = layout.back();
  return last.offset + static_cast<std::size_t>(last.inputs + 1) * last.stride;
}

void pack(const std::vector<Linear>& layers, const std::vector<PackedLayer>& layout,
          float* values) {
  for (std::size_t l = 0; l < layout.size(); ++l) {
    const PackedLayer& packed = layout[l];
    float* row = values + packed.offset;
    Eigen::Map<Eigen::VectorXf>(row, packed.outputs) = layers[l].bias;
    for (int k = 0; k < packed.inputs; ++k) {
      row += packed.stride;
      Eigen::Map<Eigen::VectorXf>(row, packed.outputs) = layers[l].weight.col(k);
    }
  }
}

std::vector<Linear> unpack(const std::vector<PackedLayer>& layout, const float* values) {
  std::vector<Linear> layers(layout.size());
  for (std::size_t l = 0; l < layout.size(); ++l) {
    const PackedLayer& packed = layout[l];
    const float* row = values + packed.offset;
    layers[l].bias = Eigen::Map<const Eigen::VectorXf>(row, packed.outputs);
    layers[l].weight.resize(packed.outputs, packed.inputs);
    for (int k = 0; k < packed.inputs; ++k) {
      row += packed.stride;
      layers[l].weight.col(k) = Eigen::Map<const Eigen::VectorXf>(row, packed.outputs);
    }
  }
  return layers;
}

}  // namespace threelink_agent

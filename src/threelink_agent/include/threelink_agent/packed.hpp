/// @file
/// Conversion of layers to the memory layout of the kernels (kernel/network.hpp).
#pragma once

#include <cstddef>
#include <vector>

#include "threelink_agent/kernel/network.hpp"
#include "threelink_agent/linear.hpp"

namespace threelink_agent {

/// Array of floats, aligned to 64 bytes and padded to a multiple of 64 bytes; initially zero.
class AlignedFloats {
 public:
  AlignedFloats() = default;
  explicit AlignedFloats(std::size_t size)  // rounded up to whole lines
      : lines_((size + kPackedFloats - 1) / kPackedFloats, Line{}) {}

  std::size_t size() const { return lines_.size() * kPackedFloats; }
  float* data() { return lines_.data()->values; }
  const float* data() const { return lines_.data()->values; }
  void clear() { lines_.assign(lines_.size(), Line{}); }

 private:
  struct alignas(64) Line {
    float values[kPackedFloats];
  };
  std::vector<Line> lines_;
};

/// Layout of the layers, one after the other.
std::vector<PackedLayer> packed_layout(const std::vector<Linear>& layers);

/// Total number of floats of a layout.
std::size_t packed_size(const std::vector<PackedLayer>& layout);

/// Copies the layers into `values` (packed_size(layout)); the padding is not written.
void pack(const std::vector<Linear>& layers, const std::vector<PackedLayer>& layout, float* values);
/// The layers in `values` (packed_size(layout)); the inverse of pack().
std::vector<Linear> unpack(const std::vector<PackedLayer>& layout, const float* values);

}  // namespace threelink_agent

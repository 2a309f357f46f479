/// @file
/// Layers in the layout that the kernels read; see kernel/network.hpp.
#pragma once

#include <cstddef>
#include <vector>

#include "threelink_agent/kernel/network.hpp"
#include "threelink_agent/linear.hpp"

namespace threelink_agent {

/// Floats in whole lines of 64 bytes, aligned to them; zero at first.
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

/// Where each layer lies, one behind the other.
std::vector<PackedLayer> packed_layout(const std::vector<Linear>& layers);

/// Floats that they take in all.
std::size_t packed_size(const std::vector<PackedLayer>& layout);

/// Into `values` of packed_size(layout); the padding is left alone.
void pack(const std::vector<Linear>& layers, const std::vector<PackedLayer>& layout, float* values);
std::vector<Linear> unpack(const std::vector<PackedLayer>& layout, const float* values);

}  // namespace threelink_agent

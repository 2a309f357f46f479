/// @file
/// Named tensors and text in one file: a safetensors container that proves its own integrity.
///
///   8 bytes   n, little-endian
///   n bytes   JSON: {"__metadata__": {key: text, ..},
///                    name: {"dtype": .., "shape": [..], "data_offsets": [begin, end]}, ..},
///             padded with spaces to a multiple of 8
///   the rest  the tensors, little-endian and row-major, without gaps
///
/// https://github.com/huggingface/safetensors defines it. Two metadata keys are ours:
///   sha256         of the data part
///   header_sha256  of the JSON header, the padding included, with the 64 digits of this very field
///                  set to zeros
/// Together with the sizes they show any bit that changed.
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "threelink_sim/usage_error.hpp"

namespace threelink_agent {

/// Bytes that are no such file; what() gives the reason, with the tensor and both values if there
/// are two. A peer is told less: a file that does not prove to be ours may be anybody's.
class ContainerError : public threelink_sim::UsageError {
 public:
  explicit ContainerError(const std::string& what)
      : UsageError(what, "is damaged or holds something else; the log of its reader says what") {}
  using UsageError::UsageError;
};

enum class Dtype { kF32, kF64, kI64, kU8 };

using TensorShape = std::vector<std::size_t>;
std::string to_string(const TensorShape& shape);  ///< "(64, 4)"; a single size gives "(64)"

struct Tensor {
  Dtype dtype = Dtype::kF32;
  TensorShape shape;
  std::string bytes;

  /// values (product of shape), row-major. T: float, double, std::int64_t or std::uint8_t.
  template <class T>
  static Tensor of(TensorShape shape, const T* values);

  std::size_t count() const;  ///< product of shape

  /// A copy of the values (count()). Throws ContainerError naming both dtypes if T is another one.
  template <class T>
  std::vector<T> values() const;
};

struct Container {
  std::map<std::string, std::string> metadata;  ///< UTF-8; without the two hashes
  std::map<std::string, Tensor> tensors;
};

struct SerializedContainer {
  std::string bytes;   ///< of the whole file
  std::string sha256;  ///< of the data part
};

constexpr std::size_t kMaxContainerBytes = std::size_t{64} << 20;
constexpr std::size_t kMaxHeaderBytes = std::size_t{1} << 20;

/// Tensors are laid out by falling size of their elements, then by name. Throws ContainerError if a
/// bound above would be exceeded or text is not UTF-8.
SerializedContainer serialize(const Container& container);

/// Returns what is in the file's bytes once sizes, offsets and both hashes have been checked;
/// throws ContainerError. data_hash receives the sha256 of the data part.
Container parse_container(const std::string& bytes, std::string& data_hash);

}  // namespace threelink_agent

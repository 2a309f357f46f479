/// @file
/// Named tensors and text in one file: a safetensors container with hashes of its content.
///
///   8 bytes   n, little-endian
///   n bytes   JSON: {"__metadata__": {key: text, ..},
///                    name: {"dtype": .., "shape": [..], "data_offsets": [begin, end]}, ..},
///             padded with spaces to a multiple of 8
///   the rest  the tensors, little-endian and row-major, without gaps
///
/// https://github.com/huggingface/safetensors defines the format. threelink adds two metadata keys:
///
///   sha256         of the data part
///   header_sha256  of the JSON header, the padding included, with the 64 digits of this very field
///                  set to zeros
///
/// Together with the sizes they detect any changed bit.
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "threelink_sim/usage_error.hpp"

namespace threelink_agent {

/// Error for bytes that are not a valid container. what() gives the reason, with the tensor and,
/// for a mismatch, both values. for_peers() tells a remote peer less, because an invalid file may
/// hold anything.
class ContainerError : public threelink_sim::UsageError {
 public:
  explicit ContainerError(const std::string& what)
      : UsageError(what, "is damaged or holds something else; the log of its reader says what") {}
  using UsageError::UsageError;
};

/// Element type of a tensor, in the names of safetensors: F32, F64, I64, U8.
enum class Dtype { kF32, kF64, kI64, kU8 };

/// Sizes of the dimensions, the slowest first.
using TensorShape = std::vector<std::size_t>;
std::string to_string(const TensorShape& shape);  ///< "(64, 4)"; a single size gives "(64)"

/// A dense row-major array: its type, its shape and its bytes in little-endian order.
struct Tensor {
  Dtype dtype = Dtype::kF32;
  TensorShape shape;
  std::string bytes;

  /// Makes a tensor from values (product of shape), row-major. T is float, double, std::int64_t or
  /// std::uint8_t.
  template <class T>
  static Tensor of(TensorShape shape, const T* values);

  std::size_t count() const;  ///< product of shape

  /// A copy of the values (count()). Throws ContainerError that names both dtypes if T does not
  /// match.
  template <class T>
  std::vector<T> values() const;
};

/// The content of a file.
struct Container {
  std::map<std::string, std::string> metadata;  ///< UTF-8; without the two hashes
  std::map<std::string, Tensor> tensors;
};

/// A container in the form in which it is written.
struct SerializedContainer {
  std::string bytes;   ///< of the whole file
  std::string sha256;  ///< of the data part
};

/// Largest size of a file [bytes].
constexpr std::size_t kMaxContainerBytes = std::size_t{64} << 20;
/// Largest size of the JSON header [bytes].
constexpr std::size_t kMaxHeaderBytes = std::size_t{1} << 20;

/// The bytes of a file. Tensors are ordered by decreasing size of their elements, then by name.
/// Throws ContainerError if a bound above would be exceeded or if a text is not UTF-8.
SerializedContainer serialize(const Container& container);

/// The content of a file, after checks of sizes, offsets and both hashes. Throws ContainerError.
/// data_hash receives the sha256 of the data part.
Container parse_container(const std::string& bytes, std::string& data_hash);

}  // namespace threelink_agent

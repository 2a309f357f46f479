// Records of a bag, format 2.0: http://wiki.ros.org/Bags/Format/2.0
//
// A record is a header and data, each after its length. Every length is checked against the bytes
// that there are; what is read points into them.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <optional>
#include <string>
#include <string_view>
#include <utility>

#include "threelink_sim/usage_error.hpp"

namespace threelink_tasks {

// What is no bag, or not as the format wants it; the text says why, for people.
class BagError : public threelink_sim::UsageError {
 public:
  using UsageError::UsageError;
};

constexpr std::string_view kBagMagic = "#ROSBAG V2.0\n";

enum class BagOp : std::uint8_t {
  kNone = 0,
  kMessage = 2,
  kBagHeader = 3,
  kIndex = 4,
  kChunk = 5,
  kChunkInfo = 6,
  kConnection = 7
};

// NAME=VALUE, each after its length: a record's header, and the data of a connection record.
class BagFields {
 public:
  BagFields() = default;
  // Nothing if the bytes are no such fields, have more than kMost of them, or one of them twice.
  static std::optional<BagFields> parse(std::string_view bytes);

  static constexpr std::size_t kMost = 24;
  std::size_t size() const { return size_; }
  bool has(std::string_view name) const { return find(name) != nullptr; }
  std::string_view text(std::string_view name) const;  // empty without it
  // Nothing without it, or if it has another size.
  template <class Integer>
  std::optional<Integer> integer(std::string_view name) const;
  BagOp op() const { return static_cast<BagOp>(integer<std::uint8_t>("op").value_or(0)); }
  // Whether both have the same fields, in any order.
  bool operator==(const BagFields& other) const;

 private:
  using Field = std::pair<std::string_view, std::string_view>;
  const Field* find(std::string_view name) const;

  std::array<Field, kMost> fields_;
  std::size_t size_ = 0;
};

// Goes through bytes from the front.
class BagCursor {
 public:
  explicit BagCursor(std::string_view bytes, std::size_t at = 0) : bytes_(bytes), at_(at) {}

  std::size_t at() const { return at_; }
  bool at_end() const { return at_ == bytes_.size(); }
  // Each gives nothing, and stays where it is, if the bytes end before.
  std::optional<std::string_view> take(std::size_t size);
  std::optional<std::string_view> take_sized();  // a length and that many bytes
  template <class Integer>
  std::optional<Integer> take_integer();

 private:
  std::string_view bytes_;
  std::size_t at_;
};

template <class Integer>
Integer bag_integer(const char* bytes) {  // little-endian, as all that ROS 1 runs on
  Integer value;
  std::memcpy(&value, bytes, sizeof value);
  return value;
}

template <class Integer>
std::optional<Integer> BagFields::integer(std::string_view name) const {
  const Field* field = find(name);
  if (!field || field->second.size() != sizeof(Integer)) return std::nullopt;
  return bag_integer<Integer>(field->second.data());
}

template <class Integer>
std::optional<Integer> BagCursor::take_integer() {
  const auto bytes = take(sizeof(Integer));
  if (!bytes) return std::nullopt;
  return bag_integer<Integer>(bytes->data());
}

}  // namespace threelink_tasks

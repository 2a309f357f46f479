/// @file
/// JSON of others, read so that no text can do harm.
#pragma once

#include <cstddef>
#include <string>

#include <nlohmann/json.hpp>

#include "threelink_sim/usage_error.hpp"

namespace threelink_sim {

/// Objects and lists within each other. What is deeper would let the library's own functions run
/// out of stack.
constexpr std::size_t kMaxJsonDepth = 32;

/// One JSON text (RFC 8259), as bytes of UTF-8. Throws FormatError, as soon as it is met, for text
/// that is not JSON ("is not JSON: ..." with line and column), for a byte order mark, for more
/// than max_values values, for more depth than kMaxJsonDepth and for an object that has a key
/// twice.
nlohmann::json parse_json(const std::string& text, std::size_t max_values = 100'000);

/// A value in a message: on one line, about 80 bytes at most, of any depth.
std::string json_excerpt(const nlohmann::json& value);

}  // namespace threelink_sim

/// @file
/// A JSON reader that is safe for untrusted text.
#pragma once

#include <cstddef>
#include <string>

#include <nlohmann/json.hpp>

#include "threelink_sim/usage_error.hpp"

namespace threelink_sim {

/// Largest nesting of objects and lists. Deeper nesting would overflow the stack in the library's
/// functions.
constexpr std::size_t kMaxJsonDepth = 32;

/// Parses one JSON text (RFC 8259) in UTF-8. Throws FormatError at the first fault: for text that
/// is not JSON ("is not JSON: ..." with line and column), for a byte order mark, for more than
/// max_values values, for a nesting deeper than kMaxJsonDepth, and for an object with a repeated
/// key.
nlohmann::json parse_json(const std::string& text, std::size_t max_values = 100'000);

/// A value for a message: one line of at most about 80 bytes.
std::string json_excerpt(const nlohmann::json& value);

}  // namespace threelink_sim

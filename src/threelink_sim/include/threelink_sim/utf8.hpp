/// @file
/// Characters of UTF-8.
#pragma once

#include <cstddef>
#include <string_view>

namespace threelink_sim {

/// The byte order mark in UTF-8.
constexpr std::string_view kByteOrderMark = "\xef\xbb\xbf";

/// Number of bytes of the first character, 1 to 4; 0 if it is not valid UTF-8. Overlong forms,
/// surrogates and truncated characters are not valid.
std::size_t utf8_length(std::string_view text);

}  // namespace threelink_sim

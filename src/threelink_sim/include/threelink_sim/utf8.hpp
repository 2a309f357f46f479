/// @file
/// Characters of UTF-8.
#pragma once

#include <cstddef>
#include <string_view>

namespace threelink_sim {

constexpr std::string_view kByteOrderMark = "\xef\xbb\xbf";

/// Bytes of the character that text begins with, 1 to 4; 0 if that is not UTF-8: overlong forms,
/// surrogates and what is cut off are not.
std::size_t utf8_length(std::string_view text);

}  // namespace threelink_sim

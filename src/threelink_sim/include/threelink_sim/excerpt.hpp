/// @file
/// Excerpts of untrusted text for messages: short, on one line, and harmless to a terminal.
#pragma once

#include <string>
#include <string_view>

namespace threelink_sim {

/// The beginning of a text: at most about `most` bytes, followed by "..." if there are more. Bytes
/// that are not printable ASCII or whole characters of UTF-8, and characters that change the
/// direction of writing, are written \xNN, ends of lines \n.
std::string excerpt(std::string_view text, std::size_t most = 80);
/// Whether the text has at most `most` bytes and excerpt() returns it unchanged.
bool is_harmless(std::string_view text, std::size_t most);

/// Recognises common mistakes, such as "is a Git LFS pointer, not the file itself: run `git lfs
/// pull`". Empty for any other content.
std::string mistaken_format(std::string_view bytes);

}  // namespace threelink_sim

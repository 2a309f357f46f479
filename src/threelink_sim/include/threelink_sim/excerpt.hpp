/// @file
/// Text of others in messages of ours: short, on one line, and harmless to a terminal.
#pragma once

#include <string>
#include <string_view>

namespace threelink_sim {

/// What text begins with: at most about `most` bytes, "..." if there are more. Bytes that are not
/// printable ASCII or whole characters of UTF-8, and characters that change the direction of
/// writing, are written \xNN, ends of lines \n.
std::string excerpt(std::string_view text, std::size_t most = 80);
/// Whether text is no longer than that, and excerpt() leaves it as it is.
bool is_harmless(std::string_view text, std::size_t most);

/// What a file is instead of what it should be, for the mistakes that are made: "is a Git LFS
/// pointer, not the file itself: run `git lfs pull`". Empty if it is none of these.
std::string mistaken_format(std::string_view bytes);

}  // namespace threelink_sim

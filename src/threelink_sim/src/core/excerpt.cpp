#include "threelink_sim/excerpt.hpp"

#include <algorithm>
#include <cctype>

#include <fmt/format.h>

#include "threelink_sim/utf8.hpp"

namespace threelink_sim {
namespace {

// `with` in small letters; those of the text may be of either size.
bool begins_with(std::string_view text, std::string_view with) {
  return text.size() >= with.size() &&
         std::equal(with.begin(), with.end(), text.begin(),
                    [](unsigned char a, unsigned char b) { return a == std::tolower(b); });
}

// U+200E, U+200F, U+202A to U+202E and U+2066 to U+2069.
bool turns_the_direction(std::string_view text) {
  const auto last = static_cast<unsigned char>(text.size() > 2 ? text[2] : 0);
  const std::string_view first = text.substr(0, 2);
  return (first == "\xe2\x80" &&
          (last == 0x8e || last == 0x8f || (last >= 0xaa && last <= 0xae))) ||
         (first == "\xe2\x81" && last >= 0xa6 && last <= 0xa9);
}

}  // namespace

std::string excerpt(std::string_view text, std::size_t most) {
  std::string shown;
  while (!text.empty()) {
    if (shown.size() >= most) return shown + "...";
    const std::size_t length = utf8_length(text);
    const auto byte = static_cast<unsigned char>(text[0]);
    // U+0080 to U+009F are control characters, too.
    const bool control =
        byte < 0x20 || byte == 0x7f ||
        (byte == 0xc2 && length == 2 && static_cast<unsigned char>(text[1]) < 0xa0) ||
        (length == 3 && turns_the_direction(text));
    if (byte == '\n')
      shown += "\\n";
    else if (byte == '\r')
      shown += "\\r";
    else if (byte == '\t')
      shown += "\\t";
    else if (length == 0 || control)
      shown += fmt::format("\\x{:02x}", byte);
    else
      shown += text.substr(0, length);
    text.remove_prefix(length == 0 || control ? 1 : length);
  }
  return shown;
}

bool is_harmless(std::string_view text, std::size_t most) {
  return text.size() <= most && excerpt(text, most + 1) == text;
}

std::string mistaken_format(std::string_view bytes) {
  if (begins_with(bytes, "version https://git-lfs.github.com/spec/"))
    return "is a Git LFS pointer, not the file itself: run `git lfs pull`";
  if (begins_with(bytes, "\xff\xfe") || begins_with(bytes, "\xfe\xff"))
    return "is UTF-16 text, must be UTF-8";
  if (begins_with(bytes, "\x1f\x8b")) return "is compressed with gzip; unpack it first";
  if (begins_with(bytes, "pk\x03\x04")) return "is a ZIP archive, such as PyTorch and Excel write";
  const std::size_t first = bytes.find_first_not_of(" \t\r\n\xef\xbb\xbf");
  const std::string_view start = bytes.substr(std::min(first, bytes.size()));
  if (begins_with(start, "<!doctype html") || begins_with(start, "<html"))
    return "is an HTML page; download the file itself";
  return "";
}

}  // namespace threelink_sim

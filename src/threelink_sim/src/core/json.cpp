#include "threelink_sim/json.hpp"

#include <algorithm>
#include <cstdint>
#include <set>
#include <vector>

#include <fmt/format.h>

#include "threelink_sim/excerpt.hpp"
#include "threelink_sim/utf8.hpp"

namespace threelink_sim {
namespace {

using nlohmann::json;

// "line 2, column 7" of the byte `at`, counted from 1.
std::string position(const std::string& text, std::size_t at) {
  const auto end = text.begin() + std::min(text.size(), at > 0 ? at - 1 : 0);
  const auto lines = std::count(text.begin(), end, '\n');
  const auto line = std::find(std::make_reverse_iterator(end), text.rend(), '\n').base();
  return fmt::format("line {}, column {}", lines + 1, end - line + 1);
}

// Follows the library's parser and throws before a text costs more than it may. The parser itself
// does not recurse.
class Checker {
 public:
  Checker(const std::string& text, std::size_t max_values) : text_(text), max_values_(max_values) {}

  bool null() { return value(); }
  bool boolean(bool) { return value(); }
  bool number_integer(std::int64_t) { return value(); }
  bool number_unsigned(std::uint64_t) { return value(); }
  bool number_float(double, const std::string&) { return value(); }
  bool string(const std::string&) { return value(); }
  template <class Binary>  // not in version 3.7, and not in JSON
  bool binary(Binary&) {
    return value();
  }
  bool start_object(std::size_t) {
    deeper();
    keys_.emplace_back();
    return true;
  }
  bool end_object() {
    keys_.pop_back();
    --depth_;
    return true;
  }
  bool start_array(std::size_t) {
    deeper();
    return true;
  }
  bool end_array() {
    --depth_;
    return true;
  }
  bool key(const std::string& key) {
    if (!keys_.back().insert(key).second)
      throw FormatError(fmt::format("an object has the key \"{}\" twice", excerpt(key)),
                        "an object has a key twice");
    return true;
  }
  template <class Exception>
  bool parse_error(std::size_t at, const std::string& last, const Exception& error) {
    const std::string where = position(text_, at);
    if (error.id == kOutOfRange)
      throw FormatError(fmt::format("{}: the number {} is too large", where, excerpt(last)),
                        where + ": a number is too large");
    const bool cut = at > text_.size();
    throw FormatError(fmt::format("is not JSON: {}{}", where, cut ? ", where the text ends" : ""));
  }

 private:
  static constexpr int kOutOfRange = 406;  // of nlohmann's errors

  bool value() {
    if (++values_ > max_values_)
      throw FormatError(fmt::format("has more than {} values", max_values_));
    return true;
  }

  void deeper() {
    value();
    if (++depth_ > kMaxJsonDepth)
      throw FormatError(fmt::format("is nested more than {} deep", kMaxJsonDepth));
  }

  const std::string& text_;
  std::size_t max_values_, values_ = 0, depth_ = 0;
  std::vector<std::set<std::string>> keys_;  // of the objects that are open
};

void write(const json& value, std::size_t most, int depth, std::string& text) {
  constexpr int kMostDepth = 4;
  if (text.size() > most) return;
  if (!value.is_structured()) {
    // Numbers and words are short; text is cut, and its escapes are those of a message.
    text += value.is_string() ? "\"" + excerpt(value.get_ref<const std::string&>(), most) + "\""
                              : value.dump();
    return;
  }
  const char* brackets = value.is_array() ? "[]" : "{}";
  text += brackets[0];
  if (depth >= kMostDepth && !value.empty()) {
    text += "...";
  } else {
    for (auto item = value.begin(); item != value.end() && text.size() <= most; ++item) {
      if (item != value.begin()) text += ",";
      if (value.is_object()) text += "\"" + excerpt(item.key(), most) + "\":";
      write(*item, most, depth + 1, text);
    }
  }
  text += brackets[1];
}

}  // namespace

json parse_json(const std::string& text, std::size_t max_values) {
  const std::string mistaken = mistaken_format(text);
  if (!mistaken.empty()) throw FormatError(mistaken);
  if (text.compare(0, kByteOrderMark.size(), kByteOrderMark) == 0)
    throw FormatError("is not JSON: begins with a byte order mark");
  Checker checker(text, max_values);
  json::sax_parse(text, &checker);
  return json::parse(text);
}

std::string json_excerpt(const json& value) {
  constexpr std::size_t kMost = 80;
  std::string text;
  write(value, kMost, 0, text);
  return text.size() <= kMost + 3 ? text : text.substr(0, kMost) + "...";
}

}  // namespace threelink_sim

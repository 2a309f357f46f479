#include "threelink_sim/json.hpp"

#include <algorithm>
#include <cstdint>
#include <utility>
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

// Builds what the library's parser reads, and throws before a text costs more than it may. The
// parser itself does not recurse.
class Builder {
 public:
  Builder(const std::string& text, std::size_t max_values) : text_(text), max_values_(max_values) {}

  json take() { return std::move(root_); }

  bool null() { return add(nullptr); }
  bool boolean(bool value) { return add(value); }
  bool number_integer(std::int64_t value) { return add(value); }
  bool number_unsigned(std::uint64_t value) { return add(value); }
  bool number_float(double value, const std::string&) { return add(value); }
  bool string(std::string& value) { return add(std::move(value)); }
  template <class Binary>  // not in version 3.7, and not in JSON
  bool binary(Binary&) {
    return false;
  }
  bool start_object(std::size_t) { return open(json::object()); }
  bool end_object() { return close(); }
  bool start_array(std::size_t) { return open(json::array()); }
  bool end_array() { return close(); }
  bool key(const std::string& key) {
    const auto [member, is_new] = open_.back()->emplace(key, nullptr);
    if (!is_new)
      throw FormatError(fmt::format("an object has the key \"{}\" twice", excerpt(key)),
                        "an object has a key twice");
    member_ = &*member;
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

  bool add(json value) {
    place(std::move(value));
    return true;
  }

  json& place(json&& value) {
    if (++values_ > max_values_)
      throw FormatError(fmt::format("has more than {} values", max_values_));
    if (open_.empty()) return root_ = std::move(value);
    if (open_.back()->is_object()) return *member_ = std::move(value);
    open_.back()->push_back(std::move(value));
    return open_.back()->back();
  }

  bool open(json&& value) {
    if (open_.size() == kMaxJsonDepth)
      throw FormatError(fmt::format("is nested more than {} deep", kMaxJsonDepth));
    open_.push_back(&place(std::move(value)));
    return true;
  }

  bool close() {
    open_.pop_back();
    return true;
  }

  const std::string& text_;
  std::size_t max_values_, values_ = 0;
  json root_;
  std::vector<json*> open_;  // objects and lists that are not closed yet
  json* member_ = nullptr;   // of the innermost object: the one whose value is next
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
  Builder builder(text, max_values);
  json::sax_parse(text, &builder);
  return builder.take();
}

std::string json_excerpt(const json& value) {
  constexpr std::size_t kMost = 80;
  std::string text;
  write(value, kMost, 0, text);
  return text.size() <= kMost + 3 ? text : text.substr(0, kMost) + "...";
}

}  // namespace threelink_sim

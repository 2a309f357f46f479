#include "threelink_sim/yaml.hpp"

#include <set>
#include <sstream>
#include <string_view>
#include <vector>

#include <fmt/format.h>
#include <yaml-cpp/eventhandler.h>

#include "threelink_sim/excerpt.hpp"
#include "threelink_sim/utf8.hpp"

namespace threelink_sim {
namespace {

std::string position(const YAML::Mark& mark) {
  return fmt::format("line {}, column {}", mark.line + 1, mark.column + 1);
}

// Follows the library's parser, which recurses, and throws before a text costs more than it may.
class Checker : public YAML::EventHandler {
 public:
  explicit Checker(std::size_t max_nodes) : max_nodes_(max_nodes) {}

  void OnDocumentStart(const YAML::Mark& mark) override {
    if (++documents_ > 1) refuse(mark, "a second document begins; there must be one only");
  }
  void OnDocumentEnd() override {}
  void OnAlias(const YAML::Mark& mark, YAML::anchor_t) override {
    refuse(mark, "aliases (*name) are not taken");
  }
  void OnNull(const YAML::Mark& mark, YAML::anchor_t anchor) override {
    node(mark, "", anchor, nullptr);
  }
  void OnScalar(const YAML::Mark& mark, const std::string& tag, YAML::anchor_t anchor,
                const std::string& value) override {
    node(mark, tag, anchor, &value);
  }
  void OnSequenceStart(const YAML::Mark& mark, const std::string& tag, YAML::anchor_t anchor,
                       YAML::EmitterStyle::value) override {
    node(mark, tag, anchor, nullptr);
    open(mark, false);
  }
  void OnSequenceEnd() override { open_.pop_back(); }
  void OnMapStart(const YAML::Mark& mark, const std::string& tag, YAML::anchor_t anchor,
                  YAML::EmitterStyle::value) override {
    node(mark, tag, anchor, nullptr);
    open(mark, true);
  }
  void OnMapEnd() override { open_.pop_back(); }

  // At the end, since the library takes a bracket that is never closed for the start of a key.
  void finish() const {
    if (!odd_key_.is_null()) refuse(odd_key_, "a key must be a word");
  }

 private:
  // A map or list that has begun.
  struct Collection {
    bool map, key_is_next;
    std::set<std::string> keys;
  };

  [[noreturn]] static void refuse(const YAML::Mark& mark, const std::string& reason) {
    throw FormatError(fmt::format("{}: {}", position(mark), reason));
  }

  // Of any kind; `word` is the text of one that has some.
  void node(const YAML::Mark& mark, const std::string& tag, YAML::anchor_t anchor,
            const std::string* word) {
    if (++nodes_ > max_nodes_) refuse(mark, fmt::format("more than {} values", max_nodes_));
    if (anchor != 0) refuse(mark, "anchors (&name) are not taken");
    // The library gives "!" to what is in quotes, and "?" to the rest.
    if (!tag.empty() && tag != "!" && tag != "?") refuse(mark, "tags (!name) are not taken");
    if (open_.empty() || !open_.back().map) return;
    Collection& map = open_.back();
    if (map.key_is_next) add_key(mark, word, map);
    map.key_is_next = !map.key_is_next;
  }

  void add_key(const YAML::Mark& mark, const std::string* word, Collection& map) {
    if (!word) {
      if (odd_key_.is_null()) odd_key_ = mark;
      return;
    }
    if (word->size() > kMaxYamlKey)
      refuse(mark,
             fmt::format("a key of {} bytes, at most {} are allowed", word->size(), kMaxYamlKey));
    if (map.keys.insert(*word).second) return;
    throw FormatError(fmt::format("{}: {}: given twice", position(mark), excerpt(*word)),
                      position(mark) + ": a key is given twice");
  }

  void open(const YAML::Mark& mark, bool map) {
    if (open_.size() >= kMaxYamlDepth)
      refuse(mark, fmt::format("nested more than {} deep", kMaxYamlDepth));
    open_.push_back({map, true, {}});
  }

  std::size_t max_nodes_, nodes_ = 0;
  YAML::Mark odd_key_ = YAML::Mark::null_mark();
  int documents_ = 0;
  std::vector<Collection> open_;
};

// What the library's scanner takes for YAML is more than what is: UTF-16, broken UTF-8 and control
// characters.
void require_printable(std::string_view text) {
  std::size_t line = 1;
  while (!text.empty()) {
    const auto byte = static_cast<unsigned char>(text[0]);
    const std::size_t length = utf8_length(text);
    const bool control =
        (byte < 0x20 && byte != '\t' && byte != '\n' && byte != '\r') || byte == 0x7f;
    if (length == 0 || control)
      throw FormatError(fmt::format("line {}: is not printable text in UTF-8", line));
    if (byte == '\n') ++line;
    text.remove_prefix(length);
  }
}

}  // namespace

YAML::Node parse_yaml(const std::string& text, const YamlLimits& limits) {
  if (text.size() > limits.bytes)
    throw FormatError(
        fmt::format("{} bytes of YAML, at most {} are allowed", text.size(), limits.bytes));
  const std::string mistaken = mistaken_format(text);
  if (!mistaken.empty()) throw FormatError(mistaken);
  require_printable(text);
  try {
    std::istringstream stream(text);
    YAML::Parser parser(stream);
    Checker checker(limits.nodes);
    while (parser.HandleNextDocument(checker)) {
    }
    checker.finish();
    return YAML::Load(text);
  } catch (const YAML::Exception& error) {
    // Some of the library's reasons quote the text.
    const std::string where = "is not YAML: " + position(error.mark);
    throw FormatError(fmt::format("{}: {}", where, excerpt(error.msg)), where);
  }
}

}  // namespace threelink_sim

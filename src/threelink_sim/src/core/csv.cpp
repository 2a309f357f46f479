#include "threelink_sim/csv.hpp"

#include <cmath>
#include <cstdlib>
#include <string_view>

#include <fmt/format.h>

#include "threelink_sim/excerpt.hpp"
#include "threelink_sim/utf8.hpp"

namespace threelink_sim {
namespace {

constexpr char kBlanks[] = " \t\r";

// Takes what is in front of the separator, and the separator, off the text.
std::string_view take(std::string_view& text, char separator) {
  const std::size_t end = text.find(separator);
  const std::string_view piece = text.substr(0, end);
  text.remove_prefix(end == std::string_view::npos ? text.size() : end + 1);
  return piece;
}

bool blank(std::string_view row) { return row.find_first_not_of(kBlanks) == row.npos; }

// One line of a file, which can be refused.
class Line {
 public:
  Line(const std::string& source, std::size_t number) : source_(source), number_(number) {}

  std::string name() const { return fmt::format("{}:{}", source_, number_); }
  FormatError refusal(std::string_view quoted, const std::string& reason) const {
    return FormatError(fmt::format("{}: \"{}\" {}", name(), excerpt(quoted), reason),
                       fmt::format("{}: {}", name(), reason));
  }
  FormatError refusal_of_cell(std::size_t column, std::string_view cell, const char* reason) const {
    const std::string where = fmt::format("{}: column {}: ", name(), column);
    return FormatError(fmt::format("{}\"{}\" {}", where, excerpt(cell), reason), where + reason);
  }

 private:
  const std::string& source_;
  std::size_t number_;
};

std::vector<double> numbers(std::string_view row, const Line& line, std::size_t columns) {
  while (!row.empty() && row.back() == '\r') row.remove_suffix(1);
  std::vector<double> values;
  values.reserve(columns);
  std::string_view rest = row;
  for (bool more = true; more;) {
    more = rest.find(',') != std::string_view::npos;
    const std::string_view cell = take(rest, ',');
    if (values.size() == columns)
      throw line.refusal(row, fmt::format("has more than {} numbers", columns));
    const auto value = decimal_number(cell);
    if (!value) throw line.refusal_of_cell(values.size() + 1, cell, "is no number");
    if (!std::isfinite(*value)) throw line.refusal_of_cell(values.size() + 1, cell, "is too large");
    values.push_back(*value);
  }
  if (values.size() != columns)
    throw line.refusal(row, fmt::format("has {} numbers, must have {}", values.size(), columns));
  return values;
}

}  // namespace

std::optional<double> decimal_number(std::string_view text) {
  const std::size_t first = text.find_first_not_of(kBlanks);
  if (first == std::string_view::npos) return {};
  // strtod() reads hexadecimal numbers, names and what the locale has, too.
  const std::string word(text.substr(first, text.find_last_not_of(kBlanks) + 1 - first));
  constexpr std::size_t kMost = 1000;  // more digits than any number needs
  if (word.size() > kMost || word.find_first_not_of("0123456789.eE+-") != std::string::npos)
    return {};
  char* end = nullptr;
  const double value = std::strtod(word.c_str(), &end);
  if (end != word.c_str() + word.size()) return {};
  return value;
}

std::vector<CsvRow> parse_csv(const std::string& text, const std::string& source,
                              const CsvLimits& limits) {
  const std::string mistaken = mistaken_format(text);
  if (!mistaken.empty()) throw FormatError(source + ": " + mistaken);
  std::string_view rest(text);
  if (rest.substr(0, kByteOrderMark.size()) == kByteOrderMark)
    rest.remove_prefix(kByteOrderMark.size());
  rest = rest.substr(0, rest.find_last_not_of(" \t\r\n") + 1);
  std::vector<CsvRow> rows;
  for (std::size_t number = 1; !rest.empty(); ++number) {
    const std::string_view row = take(rest, '\n');
    const Line line(source, number);
    if (blank(row) && limits.skip_blank_lines) continue;
    if (blank(row)) throw FormatError(line.name() + ": is blank");
    if (rows.size() == limits.rows)
      throw FormatError(fmt::format("{}: more than {} rows", line.name(), limits.rows));
    rows.push_back({number, numbers(row, line, limits.columns)});
  }
  return rows;
}

}  // namespace threelink_sim

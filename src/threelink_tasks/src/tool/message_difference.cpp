#include "message_difference.hpp"

#include <algorithm>

namespace threelink_tasks {
namespace {

using Lines = std::vector<std::string>;

Lines lines_of(const std::string& text) {
  Lines lines;
  std::istringstream stream(text);
  for (std::string line; std::getline(stream, line);) lines.push_back(line);
  return lines;
}

std::size_t indent_of(const std::string& line) {
  return std::min(line.find_first_not_of(' '), line.size());
}

std::string name_in(const std::string& line) {
  const std::size_t begin = indent_of(line);
  return line.substr(begin, line.find(": ", begin) - begin);
}

std::string value_in(const std::string& line) {
  const std::size_t colon = line.find(": ");
  return colon == std::string::npos ? line : line.substr(colon + 2);
}

// Name of line i, after those of what it belongs to.
std::string path_of(const Lines& lines, std::size_t i) {
  std::string path = name_in(lines[i]);
  std::size_t indent = indent_of(lines[i]);
  while (i-- > 0) {
    if (indent_of(lines[i]) >= indent) continue;
    indent = indent_of(lines[i]);
    const std::string name = name_in(lines[i]);
    if (name.compare(name.size() - std::min<std::size_t>(2, name.size()), 2, "[]") != 0)
      path = name + "." + path;
  }
  return path;
}

}  // namespace

FieldDifference first_differing_line(const std::string& recorded, const std::string& replayed) {
  const Lines a = lines_of(recorded), b = lines_of(replayed);
  const auto [in_a, in_b] = std::mismatch(a.begin(), a.end(), b.begin(), b.end());
  FieldDifference difference;
  if (in_a == a.end() && in_b == b.end()) {
    difference.field = "a bit that does not show";  // of a NaN
    return difference;
  }
  difference.field = in_a != a.end() ? path_of(a, in_a - a.begin()) : path_of(b, in_b - b.begin());
  if (in_a != a.end()) difference.recorded = value_in(*in_a);
  if (in_b != b.end()) difference.replayed = value_in(*in_b);
  return difference;
}

}  // namespace threelink_tasks

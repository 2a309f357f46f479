#include "grid_file.hpp"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <string_view>

#include <fmt/format.h>

#include "threelink_sim/csv.hpp"
#include "threelink_sim/excerpt.hpp"
#include "threelink_sim/files.hpp"
#include "threelink_sim/sha256.hpp"

namespace threelink_sim {
namespace {

constexpr std::size_t kMaxGridBytes = std::size_t{1} << 30;
constexpr std::size_t kMaxNodes = 20'000'000;
constexpr std::size_t kFewest = 4;  // nodes in a direction, for a cubic

struct Row {
  std::size_t line;
  double x, y, t, u, v;
};

[[noreturn]] void refuse(const std::string& file, std::size_t line, const std::string& reason) {
  throw UsageError(fmt::format("{}:{}: {}", file, line, reason));
}

// Columns of a line, whatever stands between them.
std::vector<std::string_view> columns_of(std::string_view line) {
  std::vector<std::string_view> columns;
  const auto is_between = [](char c) {
    return c == ',' || c == ';' || std::isspace(static_cast<unsigned char>(c));
  };
  for (std::size_t i = 0; i < line.size();) {
    while (i < line.size() && is_between(line[i])) ++i;
    std::size_t end = i;
    while (end < line.size() && !is_between(line[end])) ++end;
    if (end > i) columns.push_back(line.substr(i, end - i));
    i = end;
  }
  return columns;
}

// Numbers of a line; empty for a blank line, a comment, and a header, which may be the first line.
std::vector<double> numbers_of(const std::string& file, std::size_t number, std::string_view line,
                               bool may_be_header) {
  if (const std::size_t comment = line.find_first_of("#%"); comment != std::string_view::npos)
    line = line.substr(0, comment);
  std::vector<double> values;
  for (const std::string_view column : columns_of(line)) {
    const auto value = decimal_number(column);
    if (!value && may_be_header && values.empty()) return {};
    if (!value || !std::isfinite(*value))
      refuse(file, number, fmt::format("\"{}\" is no finite number", excerpt(std::string(column))));
    values.push_back(*value);
  }
  return values;
}

std::vector<Row> rows_of(const std::string& text, const GridSource& source, bool& unsteady) {
  std::vector<Row> rows;
  std::size_t number = 0, columns = 0;
  for (std::size_t begin = 0; begin < text.size();) {
    const std::size_t end = std::min(text.find('\n', begin), text.size());
    std::string_view line(text.data() + begin, end - begin);
    begin = end + 1;
    if (++number == 1 && line.substr(0, 3) == "\xef\xbb\xbf") line.remove_prefix(3);
    const std::vector<double> values = numbers_of(source.file, number, line, rows.empty());
    if (values.empty()) continue;
    if (values.size() != 4 && values.size() != 5)
      refuse(source.file, number,
             fmt::format("{} columns: must be x, y, u, v or x, y, t, u, v", values.size()));
    if (columns != 0 && values.size() != columns)
      refuse(source.file, number,
             fmt::format("{} columns after rows of {}", values.size(), columns));
    columns = values.size();
    if (rows.size() == kMaxNodes)
      refuse(source.file, number, fmt::format("more than {} rows", kMaxNodes));
    const bool with_time = columns == 5;
    rows.push_back({number, values[0], values[1], with_time ? values[2] : 0, values[columns - 2],
                    values[columns - 1]});
  }
  if (rows.empty()) throw UsageError(source.file + ": holds no rows of numbers");
  unsteady = columns == 5;
  return rows;
}

struct Axis {
  double first = 0, spacing = 1;
  std::size_t count = 1;

  // The node nearest to a value.
  std::size_t index(double value) const {
    return static_cast<std::size_t>(std::llround((value - first) / spacing));
  }
};

// The coordinates that occur must be regular.
template <class Coordinate>
Axis axis_of(const std::vector<Row>& rows, const std::string& file, const char* name,
             Coordinate coordinate) {
  std::vector<std::pair<double, std::size_t>> values;  // with their lines
  for (const Row& row : rows) values.emplace_back(coordinate(row), row.line);
  std::sort(values.begin(), values.end());
  const double extent = values.back().first - values.front().first;
  // Files are rounded: what is closer than this is the same place.
  const double same = 1e-6 * extent;
  std::vector<std::pair<double, std::size_t>> distinct{values.front()};
  for (const auto& value : values)
    if (value.first - distinct.back().first > same) distinct.push_back(value);
  if (distinct.size() < kFewest)
    throw UsageError(fmt::format("{}: {} values of {}: must be at least {}", file, distinct.size(),
                                 name, kFewest));
  const double spacing = extent / (distinct.size() - 1);
  for (std::size_t i = 0; i < distinct.size(); ++i) {
    const double regular = distinct.front().first + i * spacing;
    if (std::abs(distinct[i].first - regular) > 1e-3 * spacing)
      refuse(file, distinct[i].second,
             fmt::format("{} = {:.10g}: not on a regular grid, which would have {:.10g} here", name,
                         distinct[i].first, regular));
  }
  return {distinct.front().first, spacing, distinct.size()};
}

double steepest_of(const GridData& grid) {
  const GridFlow& layout = grid.layout;
  double steepest = 0;
  const auto at = [&](int i, int j, int m) {
    const std::size_t node = (static_cast<std::size_t>(m) * layout.ny + j) * layout.nx + i;
    return Eigen::Vector2d(grid.velocities[2 * node], grid.velocities[2 * node + 1]);
  };
  for (int m = 0; m < layout.nt; ++m)
    for (int j = 0; j < layout.ny; ++j)
      for (int i = 0; i < layout.nx; ++i) {
        if (i > 0)
          steepest = std::max(steepest, (at(i, j, m) - at(i - 1, j, m)).norm() / layout.dx);
        if (j > 0)
          steepest = std::max(steepest, (at(i, j, m) - at(i, j - 1, m)).norm() / layout.dy);
      }
  return steepest;
}

}  // namespace

GridData parse_grid(const std::string& text, const GridSource& source) {
  bool unsteady = false;
  const std::vector<Row> rows = rows_of(text, source, unsteady);
  const Axis x = axis_of(rows, source.file, "x", [](const Row& row) { return row.x; });
  const Axis y = axis_of(rows, source.file, "y", [](const Row& row) { return row.y; });
  const Axis t =
      unsteady ? axis_of(rows, source.file, "t", [](const Row& row) { return row.t; }) : Axis();
  const std::size_t nodes = x.count * y.count * t.count;

  GridData grid;
  grid.file = source.file;
  grid.velocities.resize(2 * nodes);
  std::vector<std::size_t> line_of(nodes, 0);
  const double speed = source.length / source.time;
  for (const Row& row : rows) {
    const std::size_t node = (t.index(row.t) * y.count + y.index(row.y)) * x.count + x.index(row.x);
    if (line_of[node] != 0)
      refuse(source.file, row.line,
             fmt::format("the place of line {} once more: ({:.10g}, {:.10g})", line_of[node], row.x,
                         row.y));
    line_of[node] = row.line;
    grid.velocities[2 * node] = row.u * speed;
    grid.velocities[2 * node + 1] = row.v * speed;
  }
  const auto hole = std::find(line_of.begin(), line_of.end(), std::size_t{0});
  if (hole != line_of.end()) {
    const auto node = static_cast<std::size_t>(hole - line_of.begin());
    throw UsageError(fmt::format(
        "{}: has a hole: no row for x = {:.10g}, y = {:.10g}{} ({} rows of {})", source.file,
        x.first + node % x.count * x.spacing, y.first + node / x.count % y.count * y.spacing,
        unsteady ? fmt::format(", t = {:.10g}", t.first + node / x.count / y.count * t.spacing)
                 : "",
        rows.size(), nodes));
  }
  grid.layout = {static_cast<int>(x.count), static_cast<int>(y.count),
                 static_cast<int>(t.count), x.first * source.length,
                 y.first * source.length,   t.first * source.time,
                 x.spacing * source.length, y.spacing * source.length,
                 t.spacing * source.time,   nullptr};
  grid.steepest = steepest_of(grid);
  return grid;
}

GridData read_grid(const GridSource& source, const ParameterMap& entry) {
  const std::string text = read_input(source.file, kMaxGridBytes);
  const std::string hash = sha256(text);
  if (!source.sha256.empty() && source.sha256 != hash)
    entry.refuse("sha256", fmt::format("{} has {}: it is another file", source.file, hash));
  GridData grid = parse_grid(text, source);
  grid.sha256 = hash;
  return grid;
}

}  // namespace threelink_sim

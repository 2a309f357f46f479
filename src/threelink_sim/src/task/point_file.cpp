#include "threelink_sim/task/point_file.hpp"

#include <utility>

#include <fmt/format.h>

#include "threelink_sim/csv.hpp"
#include "threelink_sim/excerpt.hpp"
#include "threelink_sim/files.hpp"
#include "threelink_sim/task/basic_task.hpp"
#include "threelink_sim/yaml.hpp"

namespace threelink_sim {
namespace {

constexpr std::size_t kMaxPointFileBytes = std::size_t{1} << 20;

// Of coordinates as they stand in a file.
class PointList {
 public:
  explicit PointList(const std::string& path) : path_(path) {}

  [[noreturn]] void refuse(std::size_t line, const std::string& quoted,
                           const std::string& reason) const {
    throw UsageError(fmt::format("{}:{}: {}{}", path_, line, quoted, reason),
                     fmt::format("{}:{}: {}", path_, line, reason));
  }

  void add(std::size_t line, double x, double y) {
    for (double value : {x, y})
      if (!(value >= kPosition.low && value <= kPosition.high))
        refuse(line, fmt::format("{} ", value),
               fmt::format("must be in [{}, {}]", kPosition.low, kPosition.high));
    if (points_.size() == kMaxPoints)
      refuse(line, "", fmt::format("more than {} points", kMaxPoints));
    points_.emplace_back(x, y);
  }

  std::vector<Eigen::Vector2d> take() {
    if (points_.empty()) throw UsageError(path_ + ": holds no point");
    return std::move(points_);
  }

 private:
  std::string path_;
  std::vector<Eigen::Vector2d> points_;
};

void read_csv(const std::string& text, const std::string& path, PointList& points) {
  constexpr bool kSkipBlankLines = true;
  for (const CsvRow& row : parse_csv(text, path, {2, kMaxPoints + 1, kSkipBlankLines}))
    points.add(row.line, row.values[0], row.values[1]);
}

void read_yaml(const std::string& text, PointList& points) {
  const YAML::Node list = parse_yaml(text, {kMaxPointFileBytes, 4 * kMaxPoints});
  if (!list.IsSequence()) points.refuse(1, "", "must be a list of pairs [x, y]");
  for (const YAML::Node& pair : list) {
    const auto line = static_cast<std::size_t>(pair.Mark().line + 1);
    if (!pair.IsSequence() || pair.size() != 2 || !pair[0].IsScalar() || !pair[1].IsScalar())
      points.refuse(line, "", "must be a pair [x, y]");
    const auto coordinate = [&](int i) {
      const auto value = decimal_number(pair[i].Scalar());
      if (!value)
        points.refuse(line, fmt::format("\"{}\" ", excerpt(pair[i].Scalar())), "is no number");
      return *value;
    };
    const double x = coordinate(0);
    points.add(line, x, coordinate(1));
  }
}

}  // namespace

std::vector<Eigen::Vector2d> parse_points(const std::string& text, const std::string& path) {
  const auto ends_with = [&](const std::string& ending) {
    return path.size() > ending.size() &&
           path.compare(path.size() - ending.size(), ending.size(), ending) == 0;
  };
  PointList points(path);
  if (!ends_with(".yaml") && !ends_with(".yml")) {
    read_csv(text, path, points);
    return points.take();
  }
  try {
    read_yaml(text, points);
  } catch (const FormatError& error) {
    throw within(path, error);
  }
  return points.take();
}

std::vector<Eigen::Vector2d> read_point_file(const std::string& path) {
  return parse_points(read_input(path, kMaxPointFileBytes), path);
}

}  // namespace threelink_sim

#include "threelink_tasks/point_file.hpp"

#include <cerrno>
#include <cmath>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <optional>

#include <fmt/format.h>
#include <yaml-cpp/yaml.h>

#include "threelink_tasks/basic_task.hpp"

namespace threelink_tasks {
namespace {

using threelink_sim::UsageError;

// The number that is all of the text but for blanks around it.
std::optional<double> number(const std::string& text) {
  const std::size_t first = text.find_first_not_of(" \t");
  if (first == std::string::npos) return {};
  const std::string word = text.substr(first, text.find_last_not_of(" \t\r") + 1 - first);
  if (word.find_first_not_of("0123456789.eE+-") != std::string::npos) return {};
  char* end = nullptr;
  const double value = std::strtod(word.c_str(), &end);
  if (end != word.c_str() + word.size()) return {};
  return value;
}

class PointList {
 public:
  explicit PointList(const std::string& path) : path_(path) {}

  [[noreturn]] void refuse(int line, const std::string& reason) const {
    throw UsageError(fmt::format("{}:{}: {}", path_, line, reason));
  }

  void add(int line, const std::string& x, const std::string& y) {
    const double first = coordinate(line, x);
    points_.emplace_back(first, coordinate(line, y));
    if (points_.size() > kMaxPoints) refuse(line, fmt::format("more than {} points", kMaxPoints));
  }

  std::vector<Eigen::Vector2d> take() {
    if (points_.empty()) throw UsageError(path_ + ": holds no point");
    return std::move(points_);
  }

 private:
  double coordinate(int line, const std::string& text) const {
    const std::optional<double> value = number(text);
    if (!value) refuse(line, fmt::format("\"{}\" is no number", text));
    if (!(*value >= kPosition.low && *value <= kPosition.high))
      refuse(line, fmt::format("{} must be in [{}, {}]", text, kPosition.low, kPosition.high));
    return *value;
  }

  std::string path_;
  std::vector<Eigen::Vector2d> points_;
};

void read_csv(std::istream& file, PointList& points) {
  std::string text;
  for (int line = 1; std::getline(file, text); ++line) {
    if (text.find_first_not_of(" \t\r") == std::string::npos) continue;
    const std::size_t comma = text.find(',');
    if (comma == std::string::npos || text.find(',', comma + 1) != std::string::npos)
      points.refuse(line, fmt::format("\"{}\" must be \"x,y\"", text));
    points.add(line, text.substr(0, comma), text.substr(comma + 1));
  }
}

void read_yaml(std::istream& file, PointList& points) {
  try {
    const YAML::Node list = YAML::Load(file);
    if (!list.IsSequence()) points.refuse(1, "must be a list of pairs [x, y]");
    for (const YAML::Node& pair : list) {
      const int line = pair.Mark().line + 1;
      if (!pair.IsSequence() || pair.size() != 2 || !pair[0].IsScalar() || !pair[1].IsScalar())
        points.refuse(line, "must be a pair [x, y]");
      points.add(line, pair[0].Scalar(), pair[1].Scalar());
    }
  } catch (const YAML::Exception& error) {
    points.refuse(error.mark.line + 1, error.msg);
  }
}

}  // namespace

std::vector<Eigen::Vector2d> read_point_file(const std::string& path) {
  std::ifstream file(path);
  // A folder opens, too; only reading from it fails.
  if (!file || file.peek() == std::ifstream::traits_type::eof()) {
    if (file.is_open() && errno == 0) throw UsageError(path + ": holds no point");
    throw UsageError(fmt::format("{}: cannot be read: {}", path, std::strerror(errno)));
  }
  const auto ends_with = [&](const std::string& ending) {
    return path.size() > ending.size() &&
           path.compare(path.size() - ending.size(), ending.size(), ending) == 0;
  };
  PointList points(path);
  ends_with(".yaml") || ends_with(".yml") ? read_yaml(file, points) : read_csv(file, points);
  return points.take();
}

}  // namespace threelink_tasks

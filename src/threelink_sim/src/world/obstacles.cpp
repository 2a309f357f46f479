#include "threelink_sim/world/obstacles.hpp"

#include <algorithm>
#include <cmath>

namespace threelink_sim {
namespace {

// From here on they are sorted into cells.
constexpr std::size_t kMany = 16;

// The edges between cells (line - 1) and (line) of each row or column, one capsule for each run.
template <class Blocked, class Add>
void add_edges(int lines, int length, Blocked blocked, Add add) {
  for (int line = 0; line <= lines; ++line)
    for (int begin = 0; begin < length;) {
      const auto is_edge = [&](int k) { return blocked(line - 1, k) != blocked(line, k); };
      if (!is_edge(begin)) {
        ++begin;
        continue;
      }
      int end = begin;
      while (end < length && is_edge(end)) ++end;
      add(line, begin, end);
      begin = end;
    }
}

}  // namespace

bool OccupancyMap::blocks(const Eigen::Vector2d& x) const {
  const Eigen::Vector2d place = (x - origin) / resolution;
  if (!(place.x() >= 0 && place.y() >= 0 && place.x() < width && place.y() < height)) return false;
  return blocked[static_cast<std::size_t>(place.y()) * width +
                 static_cast<std::size_t>(place.x())] != 0;
}

void Obstacles::add(const Capsule& capsule) {
  capsules_.push_back(capsule);
  sort();
}

void Obstacles::add(OccupancyMap map) {
  const auto cell = [&](int i, int j) {
    return i >= 0 && j >= 0 && i < map.width && j < map.height &&
           map.blocked[static_cast<std::size_t>(j) * map.width + i] != 0;
  };
  const auto corner = [&](int i, int j) -> Eigen::Vector2d {
    return map.origin + map.resolution * Eigen::Vector2d(i, j);
  };
  add_edges(
      map.width, map.height, [&](int i, int j) { return cell(i, j); },
      [&](int i, int begin, int end) {
        capsules_.push_back({corner(i, begin), corner(i, end), 0});
      });
  add_edges(
      map.height, map.width, [&](int j, int i) { return cell(i, j); },
      [&](int j, int begin, int end) {
        capsules_.push_back({corner(begin, j), corner(end, j), 0});
      });
  maps_.push_back(std::move(map));
  sort();
}

void Obstacles::sort() {
  cells_.clear();
  columns_ = rows_ = 0;
  if (capsules_.size() < kMany) return;
  Eigen::Vector2d low = capsules_[0].a, high = low;
  for (const Capsule& capsule : capsules_) {
    const Eigen::Vector2d radius = Eigen::Vector2d::Constant(capsule.radius);
    low = low.cwiseMin(capsule.a.cwiseMin(capsule.b) - radius);
    high = high.cwiseMax(capsule.a.cwiseMax(capsule.b) + radius);
  }
  // About the reach of a swimmer, and not too many of them.
  const Eigen::Vector2d extent = high - low;
  cell_ = std::max(1.0, std::sqrt(extent.x() * extent.y() / 250'000));
  cell_ = std::max(cell_, extent.maxCoeff() / 5'000);
  corner_ = low;
  columns_ = 1 + static_cast<int>(extent.x() / cell_);
  rows_ = 1 + static_cast<int>(extent.y() / cell_);
  cells_.resize(static_cast<std::size_t>(columns_) * rows_);
  for (std::size_t k = 0; k < capsules_.size(); ++k) {
    const Capsule& capsule = capsules_[k];
    const Eigen::Vector2d radius = Eigen::Vector2d::Constant(capsule.radius);
    const auto [left, bottom] = cell_of(capsule.a.cwiseMin(capsule.b) - radius);
    const auto [right, top] = cell_of(capsule.a.cwiseMax(capsule.b) + radius);
    for (int j = bottom; j <= top; ++j)
      for (int i = left; i <= right; ++i)
        cells_[static_cast<std::size_t>(j) * columns_ + i].push_back(static_cast<int>(k));
  }
}

std::pair<int, int> Obstacles::cell_of(const Eigen::Vector2d& x) const {
  const auto index = [&](double place, int count) {
    return static_cast<int>(std::clamp(std::floor(place / cell_), 0.0, count - 1.0));
  };
  return {index(x.x() - corner_.x(), columns_), index(x.y() - corner_.y(), rows_)};
}

void Obstacles::near(const Eigen::Vector2d& x, double reach, std::vector<int>& found) const {
  found.clear();
  const auto add_if_near = [&](int k) {
    const Capsule& capsule = capsules_[k];
    const double distance = reach + capsule.radius;
    const Eigen::Vector2d low = capsule.a.cwiseMin(capsule.b), high = capsule.a.cwiseMax(capsule.b);
    if (x.x() > low.x() - distance && x.x() < high.x() + distance && x.y() > low.y() - distance &&
        x.y() < high.y() + distance)
      found.push_back(k);
  };
  if (cells_.empty()) {
    for (std::size_t k = 0; k < capsules_.size(); ++k) add_if_near(static_cast<int>(k));
    return;
  }
  const Eigen::Vector2d around = Eigen::Vector2d::Constant(reach);
  const auto [left, bottom] = cell_of(x - around);
  const auto [right, top] = cell_of(x + around);
  for (int j = bottom; j <= top; ++j)
    for (int i = left; i <= right; ++i)
      for (const int k : cells_[static_cast<std::size_t>(j) * columns_ + i]) add_if_near(k);
  std::sort(found.begin(), found.end());
  found.erase(std::unique(found.begin(), found.end()), found.end());
}

}  // namespace threelink_sim

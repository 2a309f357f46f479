// What stands in the swimmer's way: discs, capsules, half-planes and maps.
//
// A disc is a capsule without length, and a map is a capsule without width for each edge between a
// free cell and one that is not.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include <Eigen/Core>

namespace threelink_sim {

// All that is within `radius` of the segment from a to b. [L]
struct Capsule {
  Eigen::Vector2d a, b;
  double radius;
};

// All x with (x - point) . normal < 0; the normal points to the free side.
struct HalfPlane {
  Eigen::Vector2d point;   // [L]
  Eigen::Vector2d normal;  // [1] unit vector
};

// A map in map_server's format, in L.
struct OccupancyMap {
  int width = 0, height = 0;
  double resolution = 0;      // [L] width of a cell
  Eigen::Vector2d origin;     // [L] lower left corner of cell (0, 0)
  std::vector<char> blocked;  // (height, width), row 0 below: 1 if it is not free

  // Whether a place is in a blocked cell; nothing is blocked outside of the map.
  bool blocks(const Eigen::Vector2d& x) const;
};

class Obstacles {
 public:
  void add(const Capsule& capsule);
  void add(const HalfPlane& half_plane) { half_planes_.push_back(half_plane); }
  void add(OccupancyMap map);

  bool empty() const { return capsules_.empty() && half_planes_.empty(); }
  const std::vector<Capsule>& capsules() const { return capsules_; }
  const std::vector<HalfPlane>& half_planes() const { return half_planes_; }
  const std::vector<OccupancyMap>& maps() const { return maps_; }

  // The numbers of the capsules of which something may be within `reach` [L] of x, rising; `found`
  // is emptied first. Without allocation once it is large enough.
  void near(const Eigen::Vector2d& x, double reach, std::vector<int>& found) const;

 private:
  // Cells of a coarse grid, by which many capsules are found fast.
  void sort();
  std::pair<int, int> cell_of(const Eigen::Vector2d& x) const;

  std::vector<Capsule> capsules_;
  std::vector<HalfPlane> half_planes_;
  std::vector<OccupancyMap> maps_;

  Eigen::Vector2d corner_ = Eigen::Vector2d::Zero();
  double cell_ = 1;
  int columns_ = 0, rows_ = 0;
  std::vector<std::vector<int>> cells_;
};

}  // namespace threelink_sim

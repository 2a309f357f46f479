/// @file
/// Points in the plane from a file.
#pragma once

#include <string>
#include <vector>

#include <Eigen/Core>

namespace threelink_sim {

/// [L] at least one and at most kMaxPoints points, each coordinate within kPosition.
///   CSV   a line "x,y" for each point, no header; blank lines do not count
///   YAML  (a name in .yaml or .yml) a list of pairs, "- [x, y]" for each point
/// Throws UsageError that names file, line, what is there and what should be.
std::vector<Eigen::Vector2d> read_point_file(const std::string& path);
/// The same of a text; `path` says of what kind, and is named in errors.
std::vector<Eigen::Vector2d> parse_points(const std::string& text, const std::string& path);

constexpr std::size_t kMaxPoints = 10000;

}  // namespace threelink_sim

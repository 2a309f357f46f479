/// @file
/// Points in the plane from a file.
#pragma once

#include <string>
#include <vector>

#include <Eigen/Core>

namespace threelink_sim {

/// Reads at least one and at most kMaxPoints points [L], each coordinate within kPosition:
///
///   CSV   a line "x,y" for each point, no header; blank lines do not count
///   YAML  (a name in .yaml or .yml) a list of pairs, "- [x, y]" for each point
///
/// Throws UsageError that names file, line, the text found and the expected one.
std::vector<Eigen::Vector2d> read_point_file(const std::string& path);
/// The same for a text. The suffix of `path` determines the format, and errors name it.
std::vector<Eigen::Vector2d> parse_points(const std::string& text, const std::string& path);

/// Largest number of points in a file.
constexpr std::size_t kMaxPoints = 10000;

}  // namespace threelink_sim

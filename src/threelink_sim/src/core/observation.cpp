#include "threelink_sim/observation.hpp"

#include <algorithm>
#include <limits>
#include <stdexcept>

#include <fmt/format.h>

namespace threelink_sim {

std::string to_string(ObservationKind kind) {
  return kind == ObservationKind::kTarget ? "target" : "direction";
}

ObservationKind observation_kind_from_string(const std::string& name) {
  for (ObservationKind kind : {ObservationKind::kDirection, ObservationKind::kTarget})
    if (name == to_string(kind)) return kind;
  throw std::invalid_argument(
      fmt::format("observation \"{}\": must be \"direction\" or \"target\"", name));
}

int observation_size(ObservationKind kind, const Model& model) {
  return 2 + model.hinges() + (kind == ObservationKind::kTarget ? 3 : 0);
}

TargetDirection target_direction(const Eigen::Vector2d& centroid, const Eigen::Vector2d& target,
                                 const Eigen::Vector2d& previous) {
  constexpr double kMax = std::numeric_limits<double>::max();
  const Eigen::Vector2d offset = target - centroid;
  // Neither the square nor, were both components near the largest double, the length overflows.
  const double scale = offset.cwiseAbs().maxCoeff();
  if (scale == 0) return {previous, 0};
  const Eigen::Vector2d scaled = offset / scale;
  const double length = scaled.norm();
  return {scaled / length, std::min(scale * length, kMax)};
}

}  // namespace threelink_sim

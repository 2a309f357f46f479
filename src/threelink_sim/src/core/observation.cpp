#include "threelink_sim/observation.hpp"

#include <algorithm>
#include <limits>
#include <stdexcept>

#include <fmt/format.h>

namespace threelink_sim {

Words<ObservationKind> words_of(ObservationKind) {
  return {{ObservationKind::kDirection, "direction"}, {ObservationKind::kTarget, "target"}};
}

std::string to_string(ObservationKind kind) { return word_of(kind); }

ObservationKind observation_kind_from_string(const std::string& name) {
  for (const auto& [kind, word] : words_of(ObservationKind()))
    if (name == word) return kind;
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

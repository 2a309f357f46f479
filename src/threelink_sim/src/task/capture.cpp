#include "threelink_sim/task/capture.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include <fmt/format.h>

namespace threelink_sim {

void CaptureParameters::validate() const {
  if (!(std::isfinite(threshold) && threshold > 0))
    throw std::invalid_argument(fmt::format("threshold = {}: must be > 0", threshold));
}

double segment_distance(const Eigen::Vector2d& from, const Eigen::Vector2d& to,
                        const Eigen::Vector2d& point) {
  const Eigen::Vector2d way = to - from;
  const double length_2 = way.squaredNorm();
  const double along =
      length_2 > 0 ? std::clamp((point - from).dot(way) / length_2, 0.0, 1.0) : 1.0;
  return (point - (from + along * way)).norm();
}

Capture::Capture(const CaptureParameters& parameters) : parameters_(parameters) {
  parameters.validate();
}

bool Capture::captured(const Eigen::Vector2d& centroid, const Eigen::Vector2d& target) {
  const bool along_the_way = parameters_.between_steps && started_;
  const double distance =
      along_the_way ? segment_distance(before_, centroid, target) : (target - centroid).norm();
  before_ = centroid;
  started_ = true;
  return distance < parameters_.threshold;
}

}  // namespace threelink_sim

/// @file
/// When a swimmer has reached a point.
#pragma once

#include <Eigen/Core>

namespace threelink_sim {

struct CaptureParameters {
  double threshold = 0.001;  ///< [L] captured when nearer than this, > 0
  bool between_steps =
      false;  ///< also look along the way from the state before, for a target at rest

  /// Throws std::invalid_argument that names field, value and bound.
  void validate() const;
};

/// [L] distance from `point` to the straight segment from `from` to `to`.
double segment_distance(const Eigen::Vector2d& from, const Eigen::Vector2d& to,
                        const Eigen::Vector2d& point);

/// One swimmer on its way. The centroid is judged at the end of each action step. With
/// between_steps the straight line between two consecutive centroids counts too: a step moves the
/// centroid by about 0.002, so that a path through the point can have no step that ends within
/// 0.001 of it.
class Capture {
 public:
  explicit Capture(const CaptureParameters& parameters);

  void reset() { started_ = false; }

  /// Both in [L], fixed frame; one call a state.
  bool captured(const Eigen::Vector2d& centroid, const Eigen::Vector2d& target);

 private:
  CaptureParameters parameters_;
  bool started_ = false;
  Eigen::Vector2d before_ = {0.0, 0.0};
};

}  // namespace threelink_sim

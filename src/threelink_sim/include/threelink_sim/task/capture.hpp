/// @file
/// The test whether a swimmer has reached a point.
#pragma once

#include <Eigen/Core>

namespace threelink_sim {

/// Parameters of the test.
struct CaptureParameters {
  double threshold = 0.001;    ///< [L] a point closer than this is captured, > 0
  bool between_steps = false;  ///< also test the path between states, for a target at rest

  /// Throws std::invalid_argument that names field, value and bound.
  void validate() const;
};

/// [L] distance from `point` to the straight segment from `from` to `to`.
double segment_distance(const Eigen::Vector2d& from, const Eigen::Vector2d& to,
                        const Eigen::Vector2d& point);

/// The capture test for one swimmer. The centroid is tested at the end of each action step. With
/// between_steps the straight line between two consecutive centroids is tested too: a step moves
/// the centroid by about 0.002, so that a path through the point may have no state within 0.001 of
/// it.
class Capture {
 public:
  explicit Capture(const CaptureParameters& parameters);

  void reset() { started_ = false; }

  /// Tests one state. Both positions in [L], fixed frame; must be called once for each state.
  bool captured(const Eigen::Vector2d& centroid, const Eigen::Vector2d& target);

 private:
  CaptureParameters parameters_;
  bool started_ = false;
  Eigen::Vector2d before_ = {0.0, 0.0};
};

}  // namespace threelink_sim

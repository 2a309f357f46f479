/// @file
/// The display of a swimmer and its target in rviz, from recorded or live messages.
///
///   markers       visualization_msgs/MarkerArray: links (true to scale), centroid, trail (fades
///                 with age), target, and a text: step, distance, speed, efficiency
///   swimmer_path  nav_msgs/Path: the centroid's path since the start of the episode
#pragma once

#include <deque>
#include <functional>
#include <optional>
#include <vector>

#include <Eigen/Core>
#include <ros/node_handle.h>
#include <threelink_msgs/SwimmerState.h>
#include <visualization_msgs/MarkerArray.h>

#include "threelink_sim/node/conversions.hpp"
#include "threelink_sim/node/thinned_path.hpp"
#include "threelink_sim/swimmer.hpp"

namespace threelink_sim {

/// Units and constants of the display.
struct SwimmerViewConfig {
  Scales scales;
  double dt;     ///< [T0] of a step
  double gamma;  ///< C_parallel / C_perp, for the efficiency
};

/// Collects states and publishes markers and path.
class SwimmerView {
 public:
  /// on_viewer is called in the node handle's queue when a viewer has subscribed; the owner should
  /// then call draw().
  SwimmerView(ros::NodeHandle& node, const SwimmerViewConfig& config,
              const std::function<void()>& on_viewer);

  /// Adds a state, in order. A new episode or an earlier step clears the view.
  void add(const threelink_msgs::SwimmerState& state);
  /// Sets the target of the swimmer [m].
  void set_target(const Eigen::Vector2d& target) { target_ = target; }
  /// Publishes the display; does nothing without subscribers.
  void draw();

 private:
  static constexpr std::size_t kTrail = 700;   ///< positions
  static constexpr std::size_t kSteady = 500;  ///< of them, in which the stroke is looked for

  struct Position {
    Eigen::Vector2d centroid;  ///< [L]
    double work;               ///< [C_perp L^3/T0] of the step that led here
    HingeVector alpha;         ///< [rad]
  };

  void clear();
  void draw_markers();
  // Positions over which speed and efficiency are taken: about one period of the stroke.
  std::size_t window() const;
  std::string caption() const;

  SwimmerViewConfig config_;
  ros::Publisher marker_publisher_, path_publisher_;
  threelink_msgs::SwimmerState state_;
  std::optional<Eigen::Vector2d> target_;
  std::deque<Position> trail_;  ///< the latest positions
  ThinnedPath path_;
  bool cleared_ = true;  ///< since the last drawing
};

}  // namespace threelink_sim

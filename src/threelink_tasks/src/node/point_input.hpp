// Where a user points to in rviz: the tool "Publish Point", and a marker to be dragged.
#pragma once

#include <functional>

#include <Eigen/Core>
#include <geometry_msgs/PointStamped.h>
#include <interactive_markers/interactive_marker_server.h>
#include <ros/node_handle.h>

#include "threelink_sim/node/intake.hpp"

namespace threelink_tasks {

class PointInput {
 public:
  // take_point gets every point [m], in the node handle's queue; refused() is called for one that
  // is not finite or not in the frame `world`. The marker stands at `start` [m]; one L is `metre`.
  PointInput(ros::NodeHandle& node, threelink_sim::Diagnostics& diagnostics,
             const Eigen::Vector2d& start, double metre,
             const std::function<void(const Eigen::Vector2d&)>& take_point,
             const std::function<void()>& refused);

 private:
  void on_click(const geometry_msgs::PointStamped& click);
  void on_drag(const visualization_msgs::InteractiveMarkerFeedbackConstPtr& feedback);
  bool take(const std::string& frame, const geometry_msgs::Point& point);

  std::function<void(const Eigen::Vector2d&)> take_point_;
  std::function<void()> refused_;
  interactive_markers::InteractiveMarkerServer markers_;
  ros::Subscriber clicks_;
};

}  // namespace threelink_tasks

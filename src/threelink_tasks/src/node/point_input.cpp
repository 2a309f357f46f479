#include "point_input.hpp"

#include <cmath>

#include "threelink_sim/node/topics.hpp"
#include "threelink_tasks/basic_task.hpp"

namespace threelink_tasks {
namespace {

namespace topics = threelink_sim::topics;
using visualization_msgs::InteractiveMarkerControl;
using visualization_msgs::InteractiveMarkerFeedback;

constexpr char kName[] = "target";

visualization_msgs::InteractiveMarker target_marker(const Eigen::Vector2d& start, double metre) {
  visualization_msgs::InteractiveMarker marker;
  marker.header.frame_id = threelink_sim::frames::kWorld;
  marker.name = kName;
  marker.description = "drag me";
  marker.scale = static_cast<float>(0.3 * metre);
  marker.pose.position.x = start.x();
  marker.pose.position.y = start.y();
  marker.pose.orientation.w = 1;

  InteractiveMarkerControl control;
  control.interaction_mode = InteractiveMarkerControl::MOVE_PLANE;
  control.always_visible = true;
  // A control moves in the plane across its own x axis: that axis turned to z.
  control.orientation.w = control.orientation.y = std::sqrt(0.5);
  visualization_msgs::Marker ring;
  ring.type = visualization_msgs::Marker::CYLINDER;
  ring.scale.x = ring.scale.y = 0.12 * metre;
  ring.scale.z = 0.01 * metre;
  ring.color.r = 0.85F;
  ring.color.g = 0.15F;
  ring.color.b = 0.20F;
  ring.color.a = 0.5F;
  control.markers.push_back(ring);
  marker.controls.push_back(control);
  return marker;
}

}  // namespace

PointInput::PointInput(ros::NodeHandle& node, threelink_sim::Diagnostics& diagnostics,
                       const Eigen::Vector2d& start, double metre,
                       const std::function<void(const Eigen::Vector2d&)>& take_point,
                       const std::function<void()>& refused)
    : take_point_(take_point),
      refused_(refused),
      markers_(node.resolveName(topics::kTargetMarker)),
      clicks_(threelink_sim::subscribe<geometry_msgs::PointStamped>(
          node, topics::kClickedPoint, 10, threelink_sim::message_size::kSmall, &diagnostics,
          [this](const auto& event) { on_click(*event.getConstMessage()); })) {
  markers_.insert(target_marker(start, metre),
                  [this](const visualization_msgs::InteractiveMarkerFeedbackConstPtr& feedback) {
                    on_drag(feedback);
                  });
  markers_.applyChanges();
}

void PointInput::on_click(const geometry_msgs::PointStamped& click) {
  if (!take(click.header.frame_id, click.point)) return;
  geometry_msgs::Pose pose;
  pose.position = click.point;
  pose.position.z = 0;
  pose.orientation.w = 1;
  markers_.setPose(kName, pose);
  markers_.applyChanges();
}

void PointInput::on_drag(const visualization_msgs::InteractiveMarkerFeedbackConstPtr& feedback) {
  if (feedback->event_type == InteractiveMarkerFeedback::POSE_UPDATE)
    take(feedback->header.frame_id, feedback->pose.position);
}

bool PointInput::take(const std::string& frame, const geometry_msgs::Point& point) {
  const Eigen::Vector2d position(point.x, point.y);
  const bool good = frame == threelink_sim::frames::kWorld &&
                    position.cwiseAbs().maxCoeff() <= kPosition.high && position.allFinite();
  good ? take_point_(position) : refused_();
  return good;
}

}  // namespace threelink_tasks

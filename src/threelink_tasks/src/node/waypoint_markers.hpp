// How rviz shows the waypoints of a task: those reached grey and ticked, the next one marked, the
// others pale, all of them numbered, with thin lines between them.
#pragma once

#include <vector>

#include <Eigen/Core>
#include <visualization_msgs/MarkerArray.h>

namespace threelink_tasks {

// points [L], of which the first `reached` are; `metre` [m] is one L. Takes the place of whatever
// was shown before; without points, that is all it does.
visualization_msgs::MarkerArray waypoint_markers(const std::vector<Eigen::Vector2d>& points,
                                                 std::uint32_t reached, double metre,
                                                 const ros::Time& stamp);

}  // namespace threelink_tasks

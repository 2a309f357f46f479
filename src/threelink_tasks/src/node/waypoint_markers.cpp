#include "waypoint_markers.hpp"

#include <algorithm>
#include <string>

#include "threelink_sim/node/markers.hpp"
#include "threelink_sim/node/topics.hpp"

namespace threelink_tasks {
namespace {

using threelink_sim::colour;

using visualization_msgs::Marker;

// [L]
constexpr double kSize = 0.035, kNextSize = 0.06, kLineWidth = 0.004;
constexpr double kTextHeight = 0.04, kTextOffset = 0.05;
constexpr double kZ = -0.03;  // below the trail
// Beyond that rviz would be busy with nothing but numbers.
constexpr std::size_t kMostNumbers = 200;

}  // namespace

visualization_msgs::MarkerArray waypoint_markers(const std::vector<Eigen::Vector2d>& points,
                                                 std::uint32_t reached, double metre,
                                                 const ros::Time& stamp) {
  const auto place = [&](const Eigen::Vector2d& position) {
    geometry_msgs::Point result;
    result.x = metre * position.x();
    result.y = metre * position.y();
    result.z = metre * kZ;
    return result;
  };
  visualization_msgs::MarkerArray array;
  const auto add_marker = [&](const char* name, std::size_t id, int type) -> Marker& {
    Marker& marker = array.markers.emplace_back();
    marker.header.stamp = stamp;
    marker.header.frame_id = threelink_sim::frames::kWorld;
    marker.ns = name;
    marker.id = static_cast<int>(id);
    marker.type = type;
    marker.pose.orientation.w = 1;
    return marker;
  };
  add_marker("", 0, Marker::SPHERE).action = Marker::DELETEALL;
  if (points.size() > 1) {
    Marker& line = add_marker("way", 0, Marker::LINE_STRIP);
    line.scale.x = metre * kLineWidth;
    line.color = colour(0.5F, 0.5F, 0.5F, 0.5F);
    for (const Eigen::Vector2d& point : points) line.points.push_back(place(point));
  }
  for (std::size_t i = 0; i < points.size(); ++i) {
    const bool done = i < reached, next = i == reached;
    Marker& disc = add_marker("waypoints", i, Marker::SPHERE);
    disc.pose.position = place(points[i]);
    disc.scale.x = disc.scale.y = metre * (next ? kNextSize : kSize);
    disc.scale.z = metre * 0.2 * kSize;
    disc.color = done   ? colour(0.6F, 0.6F, 0.6F, 0.8F)
                 : next ? colour(0.95F, 0.55F, 0.15F, 1.0F)
                        : colour(0.95F, 0.80F, 0.55F, 0.9F);
    if (points.size() > kMostNumbers && !next) continue;
    Marker& text = add_marker("numbers", i, Marker::TEXT_VIEW_FACING);
    text.pose.position = place(points[i] + Eigen::Vector2d(kTextOffset, kTextOffset));
    text.scale.z = metre * kTextHeight;
    text.color = done ? colour(0.5F, 0.5F, 0.5F, 0.9F) : colour(0.1F, 0.1F, 0.1F, 1.0F);
    text.text = std::to_string(i + 1);
  }
  if (reached > 0) {
    Marker& ticks = add_marker("ticks", 0, Marker::LINE_LIST);  // rviz's font has none
    ticks.pose.position.z = metre * kSize;                      // above the points
    ticks.scale.x = metre * 2 * kLineWidth;
    ticks.color = colour(0.1F, 0.5F, 0.2F, 1.0F);
    for (std::size_t i = 0; i < std::min<std::size_t>(reached, points.size()); ++i) {
      const Eigen::Vector2d bottom = points[i] + kSize * Eigen::Vector2d(-0.1, -0.3);
      for (const Eigen::Vector2d& end : {Eigen::Vector2d(-0.4, 0.3), Eigen::Vector2d(0.6, 0.9)}) {
        ticks.points.push_back(place(bottom));
        ticks.points.push_back(place(bottom + kSize * end));
      }
    }
  }
  return array;
}

}  // namespace threelink_tasks

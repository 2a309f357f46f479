#include "threelink_sim/node/world_view.hpp"

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "threelink_sim/node/markers.hpp"
#include "threelink_sim/node/topics.hpp"

namespace threelink_sim {
namespace {

using visualization_msgs::Marker;

constexpr double kReach = 4;       // [L] around the swimmer
constexpr double kSpacing = 0.25;  // [L] of the arrows
constexpr double kArrow = 0.22;    // [L] length of the fastest one
constexpr double kWallWidth = 0.02;
constexpr double kGroundZ = -0.06, kFlowZ = -0.04, kForceZ = 0.05;  // [L]
constexpr double kForceScale = 8;                                   // [L / (C_perp L^2/T0)]

// From slow, grey blue, to fast, orange.
std_msgs::ColorRGBA colour_of_speed(double share) {
  return colour(0.45 + 0.45 * share, 0.60 - 0.15 * share, 0.75 - 0.60 * share, 0.9);
}

}  // namespace

WorldView::WorldView(ros::NodeHandle& node, std::shared_ptr<const World> world,
                     const Scales& scales)
    : world_(std::move(world)), scales_(scales) {
  publisher_ = node.advertise<visualization_msgs::MarkerArray>(topics::kWorldMarkers, 2);
}

Marker WorldView::marker(const char* name, int id, int type) const {
  Marker marker;
  marker.header.frame_id = frames::kWorld;
  marker.ns = name;
  marker.id = id;
  marker.type = type;
  marker.action = Marker::ADD;
  marker.pose.orientation.w = 1;
  return marker;
}

void WorldView::add_obstacles(const Eigen::Vector2d& centre,
                              visualization_msgs::MarkerArray& array) const {
  const double metre = scales_.length;
  const auto place = [&](const Eigen::Vector2d& x, double z) {
    geometry_msgs::Point point;
    point.x = metre * x.x();
    point.y = metre * x.y();
    point.z = metre * z;
    return point;
  };
  int id = 0;
  Marker walls = marker("walls", 0, Marker::LINE_LIST);
  walls.scale.x = metre * kWallWidth;
  walls.color = colour(0.25, 0.25, 0.28);
  std::vector<int> near;
  world_->obstacles().near(centre, kReach, near);
  for (const int k : near) {
    const Capsule& capsule = world_->obstacles().capsules()[k];
    if (capsule.radius == 0) {
      walls.points.push_back(place(capsule.a, kGroundZ));
      walls.points.push_back(place(capsule.b, kGroundZ));
      continue;
    }
    for (const Eigen::Vector2d& end : {capsule.a, capsule.b}) {
      Marker disc = marker("obstacles", id++, Marker::CYLINDER);
      disc.pose.position = place(end, kGroundZ);
      disc.scale.x = disc.scale.y = metre * 2 * capsule.radius;
      disc.scale.z = metre * 0.02;
      disc.color = colour(0.45, 0.45, 0.48);
      array.markers.push_back(disc);
    }
    const Eigen::Vector2d along = capsule.b - capsule.a;
    if (along.norm() == 0) continue;
    Marker bar = marker("obstacles", id++, Marker::CUBE);
    bar.pose.position = place(0.5 * (capsule.a + capsule.b), kGroundZ);
    bar.pose.orientation = yaw_quaternion(std::atan2(along.y(), along.x()));
    bar.scale.x = metre * along.norm();
    bar.scale.y = metre * 2 * capsule.radius;
    bar.scale.z = metre * 0.02;
    bar.color = colour(0.45, 0.45, 0.48);
    array.markers.push_back(bar);
  }
  for (const HalfPlane& plane : world_->obstacles().half_planes()) {
    const double distance = plane.normal.dot(centre - plane.point);
    if (distance > kReach) continue;
    const Eigen::Vector2d foot = centre - distance * plane.normal;
    const Eigen::Vector2d along(-plane.normal.y(), plane.normal.x());
    walls.points.push_back(place(foot - kReach * along, kGroundZ));
    walls.points.push_back(place(foot + kReach * along, kGroundZ));
  }
  if (!walls.points.empty()) array.markers.push_back(walls);
}

void WorldView::add_flow(const Eigen::Vector2d& centre, double t,
                         visualization_msgs::MarkerArray& array) const {
  if (!world_->has_flow()) return;
  const double metre = scales_.length;
  // On places that stay where they are while the swimmer moves.
  const auto first = [&](double x) { return std::ceil((x - kReach) / kSpacing) * kSpacing; };
  const int count = static_cast<int>(2 * kReach / kSpacing);
  std::vector<std::pair<Eigen::Vector2d, Eigen::Vector2d>> arrows;
  double fastest = 0;
  for (int j = 0; j < count; ++j)
    for (int i = 0; i < count; ++i) {
      const Eigen::Vector2d x(first(centre.x()) + i * kSpacing, first(centre.y()) + j * kSpacing);
      if (!world_->within_grids(t, x)) continue;
      arrows.emplace_back(x, world_->flow(t, x));
      fastest = std::max(fastest, arrows.back().second.norm());
    }
  if (fastest == 0) return;
  Marker lines = marker("flow", 0, Marker::LINE_LIST);
  lines.scale.x = metre * 0.008;
  const auto add_line = [&](const Eigen::Vector2d& from, const Eigen::Vector2d& to, double share) {
    for (const Eigen::Vector2d& x : {from, to}) {
      geometry_msgs::Point point;
      point.x = metre * x.x();
      point.y = metre * x.y();
      point.z = metre * kFlowZ;
      lines.points.push_back(point);
      lines.colors.push_back(colour_of_speed(share));
    }
  };
  for (const auto& [x, u] : arrows) {
    const double share = u.norm() / fastest;
    const Eigen::Vector2d half = 0.5 * kArrow / fastest * u, tip = x + half;
    const Eigen::Vector2d side(-half.y(), half.x());
    add_line(x - half, tip, share);
    add_line(tip, tip - 0.5 * half + 0.3 * side, share);
    add_line(tip, tip - 0.5 * half - 0.3 * side, share);
  }
  array.markers.push_back(lines);
}

void WorldView::draw(const threelink_msgs::SwimmerState& state,
                     const threelink_msgs::WorldState& world, double t) {
  if (publisher_.getNumSubscribers() == 0) return;
  visualization_msgs::MarkerArray array;
  array.markers.push_back(marker("", 0, Marker::SPHERE));
  array.markers.back().action = Marker::DELETEALL;
  const Eigen::Vector2d centre(state.centroid[0], state.centroid[1]);
  add_obstacles(centre, array);
  add_flow(centre, t, array);
  if (world.contacts > 0) {
    const double metre = scales_.length;
    Marker force = marker("contact_force", 0, Marker::ARROW);
    force.points.resize(2);
    force.points[0].x = metre * centre.x();
    force.points[0].y = metre * centre.y();
    force.points[1].x = metre * (centre.x() + kForceScale * world.contact_force[0]);
    force.points[1].y = metre * (centre.y() + kForceScale * world.contact_force[1]);
    force.points[0].z = force.points[1].z = metre * kForceZ;
    force.scale.x = metre * 0.015;
    force.scale.y = metre * 0.04;
    force.color = colour(0.85, 0.15, 0.20);
    array.markers.push_back(force);
  }
  for (Marker& each : array.markers) each.header.stamp = state.header.stamp;
  publisher_.publish(array);
}

}  // namespace threelink_sim

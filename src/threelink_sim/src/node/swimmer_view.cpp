#include "threelink_sim/node/swimmer_view.hpp"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "threelink_sim/node/markers.hpp"
#include "threelink_sim/node/topics.hpp"
#include "threelink_sim/stroke_period.hpp"

namespace threelink_sim {
namespace {

using visualization_msgs::Marker;

// Sizes in L, the swimmer's length.
constexpr double kLinkWidth = 0.022;
constexpr double kTrailWidth = 0.006;
constexpr double kCentroidSize = 0.03;
constexpr double kTargetSize = 0.05;
constexpr double kTextHeight = 0.045;
constexpr double kTextOffset = 0.45;  // above the centroid
// Heights keep the layers apart, seen from above.
constexpr double kTrailZ = -0.02, kTargetZ = 0.0, kCentroidZ = 0.03, kTextZ = 0.06;
constexpr double kFarAway = 1e6;  // [m] beyond, rviz's single precision is of no use

geometry_msgs::Point point(const Eigen::Vector2d& position, double z) {
  geometry_msgs::Point result;
  result.x = position.x();
  result.y = position.y();
  result.z = z;
  return result;
}

geometry_msgs::Vector3 size(double x, double y, double z) {
  geometry_msgs::Vector3 result;
  result.x = x;
  result.y = y;
  result.z = z;
  return result;
}

}  // namespace

SwimmerView::SwimmerView(ros::NodeHandle& node, const SwimmerViewConfig& config,
                         const std::function<void()>& on_viewer)
    : config_(config) {
  const auto notify = [on_viewer](const ros::SingleSubscriberPublisher&) { on_viewer(); };
  marker_publisher_ = node.advertise<visualization_msgs::MarkerArray>(topics::kMarkers, 2, notify);
  path_publisher_ = node.advertise<nav_msgs::Path>(topics::kSwimmerPath, 2, notify);
}

void SwimmerView::clear() {
  trail_.clear();
  path_.clear();
  target_.reset();
  cleared_ = true;
}

void SwimmerView::add(const threelink_msgs::SwimmerState& state) {
  if (state.episode != state_.episode || state.step <= state_.step) clear();
  state_ = state;
  const auto hinges =
      static_cast<Eigen::Index>(std::min<std::size_t>(state.alpha.size(), kMaxHinges));
  trail_.push_back({{state.centroid[0], state.centroid[1]},
                    state.work,
                    Eigen::Map<const Eigen::VectorXd>(state.alpha.data(), hinges)});
  if (trail_.size() > kTrail) trail_.pop_front();

  geometry_msgs::PoseStamped pose;
  to_pose(state, config_.scales, pose);
  path_.add(state.step, pose);
}

void SwimmerView::draw() {
  if (trail_.empty()) return;
  if (marker_publisher_.getNumSubscribers() > 0) draw_markers();
  if (path_publisher_.getNumSubscribers() > 0) path_publisher_.publish(path_.message());
}

void SwimmerView::draw_markers() {
  const double metre = config_.scales.length;
  visualization_msgs::MarkerArray array;
  const auto add_marker = [&](const char* name, int id, int type) -> Marker& {
    array.markers.emplace_back();
    Marker& marker = array.markers.back();
    marker.header.stamp = state_.header.stamp;
    marker.header.frame_id = frames::kWorld;
    marker.ns = name;
    marker.id = id;
    marker.type = type;
    marker.action = Marker::ADD;
    marker.pose.orientation.w = 1;
    return marker;
  };
  if (cleared_) add_marker("", 0, Marker::SPHERE).action = Marker::DELETEALL;
  cleared_ = false;

  const int links = static_cast<int>(state_.theta.size());
  for (int i = 0; i < links; ++i) {
    Marker& link = add_marker("links", i, Marker::CUBE);
    link.pose.position = point(metre * link_midpoint(state_, i), 0);
    link.pose.orientation = yaw_quaternion(state_.theta[i]);
    link.scale = size(metre / links, metre * kLinkWidth, metre * kLinkWidth);
    // The axis of the swimmer: the middle link, or of an even number the middle two.
    const bool middle = i == links / 2 || i == (links - 1) / 2;
    link.color = middle ? colour(0.95, 0.55, 0.15) : colour(0.20, 0.45, 0.75);
  }

  const Eigen::Vector2d centroid = trail_.back().centroid;
  Marker& centre = add_marker("centroid", 0, Marker::SPHERE);
  centre.pose.position = point(metre * centroid, metre * kCentroidZ);
  centre.scale = size(metre * kCentroidSize, metre * kCentroidSize, metre * kCentroidSize);
  centre.color = colour(0.1, 0.1, 0.1);

  if (trail_.size() > 1) {
    Marker& trail = add_marker("trail", 0, Marker::LINE_STRIP);
    trail.scale.x = metre * kTrailWidth;
    for (std::size_t i = 0; i < trail_.size(); ++i) {
      const double age = static_cast<double>(trail_.size() - 1 - i) / kTrail;
      trail.points.push_back(point(metre * trail_[i].centroid, metre * kTrailZ));
      trail.colors.push_back(colour(0.10, 0.25, 0.55, 1.0 - age));
    }
  }

  if (target_ && target_->cwiseAbs().maxCoeff() < kFarAway) {
    Marker& target = add_marker("target", 0, Marker::SPHERE);
    target.pose.position = point(*target_, metre * kTargetZ);
    target.scale = size(metre * kTargetSize, metre * kTargetSize, metre * kTargetSize);
    target.color = colour(0.85, 0.15, 0.20);
  }

  Marker& text = add_marker("text", 0, Marker::TEXT_VIEW_FACING);
  text.pose.position = point(metre * (centroid + Eigen::Vector2d(0, kTextOffset)), metre * kTextZ);
  text.scale.z = metre * kTextHeight;
  text.color = colour(0.1, 0.1, 0.1);
  text.text = caption();
  marker_publisher_.publish(array);
}

std::size_t SwimmerView::window() const {
  const std::size_t states = std::min(trail_.size(), kSteady + 1);
  const Eigen::Index hinges = trail_.back().alpha.size();
  if (hinges <= 2) return kSmoothing;
  Eigen::MatrixXd angles(hinges, static_cast<Eigen::Index>(states));
  for (std::size_t i = 0; i < states; ++i)
    angles.col(static_cast<Eigen::Index>(i)) = trail_[trail_.size() - states + i].alpha;
  return static_cast<std::size_t>(smoothing(angles));
}

std::string SwimmerView::caption() const {
  std::string text = fmt::format("episode {}  step {}", state_.episode, state_.step);
  if (target_) {
    const double distance = (*target_ / config_.scales.length - trail_.back().centroid).norm();
    text += fmt::format("\ndistance {:.4g} L", distance);
  }
  const std::size_t positions = window();
  if (trail_.size() < positions) return text;
  const std::size_t first = trail_.size() - positions;
  const double time = static_cast<double>(positions - 1) * config_.dt;
  const double speed = (trail_.back().centroid - trail_[first].centroid).norm() / time;
  double work = 0;
  for (std::size_t i = first + 1; i < trail_.size(); ++i) work += trail_[i].work;
  text += fmt::format("\nspeed {:.4f} L/T0", speed);
  if (work > 0)
    text += fmt::format("\nefficiency {:.2f} %", 100 * config_.gamma * speed * speed * time / work);
  return text;
}

}  // namespace threelink_sim

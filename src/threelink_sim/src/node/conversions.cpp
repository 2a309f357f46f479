#include "threelink_sim/node/conversions.hpp"

#include <algorithm>
#include <cmath>
#include <string>

#include "threelink_sim/node/topics.hpp"

namespace threelink_sim {
namespace {

Eigen::Vector2d along(double angle) { return {std::cos(angle), std::sin(angle)}; }

double heading(const threelink_msgs::SwimmerState& state) {
  return state.theta[state.theta.size() / 2];
}

}  // namespace

bool well_formed(const threelink_msgs::SwimmerState& state) {
  const std::size_t hinges = state.alpha.size();
  const auto finite = [](const auto& numbers) {
    return std::all_of(numbers.begin(), numbers.end(), [](double x) { return std::isfinite(x); });
  };
  return hinges >= 1 && hinges < kMaxLinks && state.theta.size() == hinges + 1 &&
         (state.hinge_rates.empty() || state.hinge_rates.size() == hinges) && finite(state.x_1) &&
         finite(state.theta) && finite(state.alpha) && finite(state.hinge_rates) &&
         finite(state.centroid) && std::isfinite(state.power) && std::isfinite(state.work) &&
         std::isfinite(state.reward);
}

void to_message(const Model& model, const StepRecord& record, threelink_msgs::SwimmerState& out) {
  const SwimmerState& state = record.state;
  const Eigen::Vector2d end = free_end(model, state);
  const LinkVector theta = link_angles(model, state);
  out.x_1 = {end.x(), end.y()};
  out.centroid = {state.centroid.x(), state.centroid.y()};
  out.theta.assign(theta.data(), theta.data() + theta.size());
  out.alpha.assign(state.alpha.data(), state.alpha.data() + state.alpha.size());
  const HingeVector& rates = record.hinge_rates;
  out.hinge_rates.assign(rates.data(), rates.data() + rates.size());
  out.power = record.power;
  out.work = record.work;
  out.reward = record.reward;
}

void to_message(const Environment& environment, const StepRecord& record,
                threelink_msgs::WorldState& out) {
  const Eigen::Vector2d flow = environment.flow(0);
  out.flow = {flow.x(), flow.y()};
  out.dissipation = record.dissipation;
  out.contacts = static_cast<std::uint32_t>(record.contact.contacts);
  out.contact_force = {record.contact.force.x(), record.contact.force.y()};
  out.contact_torque = record.contact.torque;
}

void to_message(const Environment& environment, threelink_msgs::Observation& out) {
  const Eigen::Vector2d p = environment.direction(0);
  out.kind = to_string(environment.config().observation);
  out.values.resize(environment.observation_size());
  environment.observe(out.values.data());
  out.theta_t = std::atan2(p.y(), p.x());
  out.distance = environment.distance(0);
}

void to_joint_state(const threelink_msgs::SwimmerState& state, const Scales& scales,
                    sensor_msgs::JointState& out) {
  const std::size_t hinges = state.alpha.size();
  out.header.stamp = state.header.stamp;
  for (std::size_t j = out.name.size(); j < hinges; ++j)
    out.name.push_back("hinge_" + std::to_string(j + 1));
  out.position = state.alpha;
  out.velocity.resize(hinges);
  std::transform(state.hinge_rates.begin(), state.hinge_rates.end(), out.velocity.begin(),
                 [&](double rate) { return rate / scales.time; });
}

void to_pose(const threelink_msgs::SwimmerState& state, const Scales& scales,
             geometry_msgs::PoseStamped& out) {
  out.header.stamp = state.header.stamp;
  out.header.frame_id = frames::kWorld;
  out.pose.position.x = state.centroid[0] * scales.length;
  out.pose.position.y = state.centroid[1] * scales.length;
  out.pose.orientation = yaw_quaternion(heading(state));
}

void to_transform(const threelink_msgs::SwimmerState& state, const Scales& scales,
                  geometry_msgs::TransformStamped& out) {
  const Eigen::Vector2d origin = link_midpoint(state, static_cast<int>(state.theta.size() / 2));
  out.header.stamp = state.header.stamp;
  out.header.frame_id = frames::kWorld;
  out.child_frame_id = frames::kBaseLink;
  out.transform.translation.x = origin.x() * scales.length;
  out.transform.translation.y = origin.y() * scales.length;
  out.transform.rotation = yaw_quaternion(heading(state));
}

Eigen::Vector2d link_midpoint(const threelink_msgs::SwimmerState& state, int i) {
  const double length = 1.0 / state.theta.size();
  Eigen::Vector2d point(state.x_1[0], state.x_1[1]);
  for (int k = 0; k < i; ++k) point += length * along(state.theta[k]);
  return point + 0.5 * length * along(state.theta[i]);
}

geometry_msgs::Quaternion yaw_quaternion(double angle) {
  geometry_msgs::Quaternion rotation;
  rotation.w = std::cos(0.5 * angle);
  rotation.z = std::sin(0.5 * angle);
  return rotation;
}

}  // namespace threelink_sim

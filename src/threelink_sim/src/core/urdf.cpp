#include "threelink_sim/urdf.hpp"

#include <fmt/format.h>

namespace threelink_sim {
namespace {

// Sizes in L, the swimmer's length.
constexpr double kLinkWidth = 0.02;
constexpr double kHingeRadius = 0.015;

// A box along x from the link's frame; `centre` is the box's [m].
std::string link(const RobotDescription& robot, int number, double centre, bool hinge) {
  const double metre = robot.length_scale, width = kLinkWidth * metre;
  // The axis of the swimmer: the middle link, or of an even number the middle two.
  const int links = robot.model.links;
  const bool middle = number == links / 2 + 1 || number == (links + 1) / 2;
  std::string text = fmt::format(
      R"(  <link name="link_{}">
    <visual>
      <origin xyz="{} 0 0"/>
      <geometry><box size="{} {} {}"/></geometry>
      <material name="{}"/>
    </visual>
)",
      number, centre, metre * robot.model.link_length(), width, width, middle ? "heading" : "limb");
  if (hinge)
    text += fmt::format(
        R"(    <visual>
      <geometry><cylinder radius="{}" length="{}"/></geometry>
      <material name="hinge"/>
    </visual>
)",
        kHingeRadius * metre, 2 * width);
  return text + "  </link>\n";
}

// Hinge `number` from link `parent` to link `child`, at `x` [m] in the parent's frame.
std::string joint(const RobotDescription& robot, int number, int parent, int child, double x) {
  const double limit = robot.model.joint_limit;
  return fmt::format(
      R"(  <joint name="hinge_{}" type="revolute">
    <parent link="link_{}"/>
    <child link="link_{}"/>
    <origin xyz="{} 0 0"/>
    <axis xyz="0 0 {}"/>
    <limit lower="{}" upper="{}" velocity="{}" effort="1"/>
  </joint>
)",
      number, parent, child, x, child > parent ? 1 : -1, -limit, limit, 1 / robot.time_scale);
}

}  // namespace

std::string urdf(const RobotDescription& robot) {
  const int links = robot.model.links, heading = robot.model.heading_link() + 1;
  const double length = robot.length_scale * robot.model.link_length();
  std::string text = fmt::format(
      R"(<?xml version="1.0"?>
<!-- By make_urdf, for {} links, joint limit {} rad, length scale {} m, time scale {} s. -->
<robot name="threelink">
  <material name="heading"><color rgba="0.95 0.55 0.15 1"/></material>
  <material name="limb"><color rgba="0.20 0.45 0.75 1"/></material>
  <material name="hinge"><color rgba="0.15 0.15 0.20 1"/></material>
  <link name="base_link"/>
  <joint name="heading" type="fixed">
    <parent link="base_link"/>
    <child link="link_{}"/>
  </joint>
)",
      links, robot.model.joint_limit, robot.length_scale, robot.time_scale, heading);
  text += link(robot, heading, 0, false);
  for (int i = heading + 1; i <= links; ++i) {
    text += joint(robot, i - 1, i - 1, i, i - 1 == heading ? 0.5 * length : length);
    text += link(robot, i, 0.5 * length, true);
  }
  for (int i = heading - 1; i >= 1; --i) {
    text += joint(robot, i, i + 1, i, i + 1 == heading ? -0.5 * length : -length);
    text += link(robot, i, -0.5 * length, true);
  }
  return text + "</robot>\n";
}

}  // namespace threelink_sim

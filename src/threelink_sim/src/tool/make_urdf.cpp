// Prints the URDF of the N-link swimmer, for robot_state_publisher and rviz.
//
// base_link is the heading link's frame: origin at its midpoint, x along it. From there the joints
// go outwards, so that their angles are alpha_j = theta_{j+1} - theta_j: hinges ahead of the
// heading link turn about +z, those behind it, where link j hangs on link j + 1, about -z.
#include <string>

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include "threelink_sim/command_line.hpp"
#include "threelink_sim/model.hpp"
#include "threelink_sim/output.hpp"

namespace threelink_sim {
namespace {

// Sizes in L, the swimmer's length.
constexpr double kLinkWidth = 0.02;
constexpr double kHingeRadius = 0.015;

struct Options {
  Model model;
  double length_scale = 1.0;  // [m] of one L
  double time_scale = 1.0;    // [s] of one T0
};

// A box along x from the link's frame; `centre` is the box's [m].
std::string link(const Options& options, int number, double centre, bool hinge) {
  const double metre = options.length_scale, width = kLinkWidth * metre;
  const bool heading = number == options.model.heading_link() + 1;
  std::string text = fmt::format(
      R"(  <link name="link_{}">
    <visual>
      <origin xyz="{} 0 0"/>
      <geometry><box size="{} {} {}"/></geometry>
      <material name="{}"/>
    </visual>
)",
      number, centre, metre * options.model.link_length(), width, width,
      heading ? "heading" : "limb");
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
std::string joint(const Options& options, int number, int parent, int child, double x) {
  const double limit = options.model.joint_limit;
  return fmt::format(
      R"(  <joint name="hinge_{}" type="revolute">
    <parent link="link_{}"/>
    <child link="link_{}"/>
    <origin xyz="{} 0 0"/>
    <axis xyz="0 0 {}"/>
    <limit lower="{}" upper="{}" velocity="{}" effort="1"/>
  </joint>
)",
      number, parent, child, x, child > parent ? 1 : -1, -limit, limit, 1 / options.time_scale);
}

std::string urdf(const Options& options) {
  const int links = options.model.links, heading = options.model.heading_link() + 1;
  const double length = options.length_scale * options.model.link_length();
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
      links, options.model.joint_limit, options.length_scale, options.time_scale, heading);
  text += link(options, heading, 0, false);
  for (int i = heading + 1; i <= links; ++i) {
    text += joint(options, i - 1, i - 1, i, i - 1 == heading ? 0.5 * length : length);
    text += link(options, i, 0.5 * length, true);
  }
  for (int i = heading - 1; i >= 1; --i) {
    text += joint(options, i, i + 1, i, i + 1 == heading ? -0.5 * length : -length);
    text += link(options, i, -0.5 * length, true);
  }
  return text + "</robot>\n";
}

}  // namespace
}  // namespace threelink_sim

int main(int argc, char** argv) {
  using threelink_sim::real_number;
  return threelink_sim::run_tool("make_urdf", [=] {
    threelink_sim::Options options;
    CLI::App app("Prints the URDF of the N-link swimmer");
    app.add_option("--links", options.model.links, "number of links N")
        ->check(threelink_sim::whole_number<int>(2, threelink_sim::kMaxLinks))
        ->capture_default_str();
    app.add_option("--joint-limit", options.model.joint_limit, "[rad] bound on every hinge angle")
        ->check(real_number())
        ->capture_default_str();
    app.add_option("--length-scale", options.length_scale, "[m] length of the swimmer")
        ->check(real_number(1e-9, 1e6))
        ->capture_default_str();
    app.add_option("--time-scale", options.time_scale, "[s] of one T0")
        ->check(real_number(1e-3, 1e3))
        ->capture_default_str();
    if (threelink_sim::parse_command_line(app, argc, argv)) {
      options.model.validate();
      fmt::print("{}", threelink_sim::urdf(options));
    }
    return 0;
  });
}

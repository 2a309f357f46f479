// Prints the URDF of the N-link swimmer; see urdf.hpp.
#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include "threelink_sim/command_line.hpp"
#include "threelink_sim/output.hpp"
#include "threelink_sim/urdf.hpp"

int main(int argc, char** argv) {
  using threelink_sim::real_number;
  return threelink_sim::run_tool("make_urdf", [=] {
    threelink_sim::RobotDescription robot;
    CLI::App app("Prints the URDF of the N-link swimmer");
    app.add_option("--links", robot.model.links, "number of links N")
        ->check(threelink_sim::whole_number<int>(2, threelink_sim::kMaxLinks))
        ->capture_default_str();
    app.add_option("--joint-limit", robot.model.joint_limit, "[rad] bound on every hinge angle")
        ->check(real_number())
        ->capture_default_str();
    app.add_option("--length-scale", robot.length_scale, "[m] length of the swimmer")
        ->check(real_number(1e-9, 1e6))
        ->capture_default_str();
    app.add_option("--time-scale", robot.time_scale, "[s] of one T0")
        ->check(real_number(1e-3, 1e3))
        ->capture_default_str();
    if (threelink_sim::parse_command_line(app, argc, argv)) {
      robot.model.validate();
      fmt::print("{}", threelink_sim::urdf(robot));
    }
    return 0;
  });
}

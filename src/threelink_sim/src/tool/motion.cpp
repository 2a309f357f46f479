// The velocities and the power of one swimmer in one state, in still water or in a flow.
#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include <CLI/CLI.hpp>
#include <Eigen/Geometry>
#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "threelink_sim/command_line.hpp"
#include "threelink_sim/csv.hpp"
#include "threelink_sim/output.hpp"
#include "threelink_sim/plugins.hpp"
#include "threelink_sim/swimmer.hpp"
#include "threelink_sim/world/world_stepper.hpp"

namespace {

using namespace threelink_sim;

struct Options {
  std::string state, rates, world;
  double time = 0;
  bool json = false;
  Model model;
};

std::vector<double> numbers(const std::string& option, const std::string& text, std::size_t count,
                            const std::string& what) {
  const auto given = static_cast<std::size_t>(std::count(text.begin(), text.end(), ',') + 1);
  if (given != count)
    throw UsageError(fmt::format("{} has {} values: needs {}", option, given, what));
  const std::vector<CsvRow> rows = parse_csv(text, option, {count, 1});
  if (rows.empty()) throw UsageError(option + ": is empty");
  return rows[0].values;
}

struct Motion {
  Eigen::Vector3d free_end;  // [L/T0, 1/T0] velocity of x_1 and turning rate of link 1, fixed frame
  double power, dissipation;
};

// From that of the centroid: x_1 = x_c - sum over links of (N - i - 1/2) / N l t_i, i from 0.
Eigen::Vector3d of_free_end(const Model& model, const SwimmerState& state, const HingeVector& rates,
                            const BodyMotion& motion) {
  LinkVector spin(model.links);
  const int h = model.heading_link();
  spin[h] = motion.spin;
  for (int i = h + 1; i < model.links; ++i) spin[i] = spin[i - 1] + rates[i - 1];
  for (int i = h - 1; i >= 0; --i) spin[i] = spin[i + 1] - rates[i];
  const LinkVector theta = link_angles(model, state);
  Eigen::Vector2d v = Eigen::Rotation2Dd(state.heading) * motion.velocity;
  for (int i = 0; i < model.links; ++i)
    v -= (model.links - i - 0.5) / model.links * model.link_length() * spin[i] *
         Eigen::Vector2d(-std::sin(theta[i]), std::cos(theta[i]));
  return {v.x(), v.y(), spin[0]};
}

Motion motion_of(const Options& options) {
  const Model& model = options.model;
  model.validate();
  const int hinges = model.hinges();
  const std::vector<double> v =
      numbers("--state", options.state, 3 + hinges,
              fmt::format("X1,Y1,THETA1 and {} hinge angles for {} links", hinges, model.links));
  const std::vector<double> r = numbers("--rates", options.rates, hinges,
                                        fmt::format("{} for {} links", hinges, model.links));
  const SwimmerState state =
      state_from_free_end(model, {v[0], v[1]}, v[2], HingeVector::Map(v.data() + 3, hinges));
  validate(model, state);
  const HingeVector rates = HingeVector::Map(r.data(), hinges);
  const auto world = options.world.empty() ? nullptr : World::load(options.world);
  if (!world || !world->has_flow()) {
    const BodyMotion motion = body_motion(model, state.alpha, rates);
    return {of_free_end(model, state, rates, motion), motion.power, motion.power};
  }
  const WorldStepper stepper(world, model, 1);
  const WorldStepper::FlowMotion motion = stepper.motion(state, rates, options.time);
  return {of_free_end(model, state, rates, motion.body), motion.body.power, motion.dissipation};
}

int run(const Options& options) {
  const Motion motion = motion_of(options);
  const Eigen::Vector3d& v = motion.free_end;
  if (options.json) {
    const nlohmann::json json = {{"velocity", {{v.x(), v.y(), v.z()}}},
                                 {"power", motion.power},
                                 {"dissipation", motion.dissipation}};
    fmt::print("{}\n", json.dump());
  } else {
    fmt::print(
        "free end of link 1: velocity ({:.10g}, {:.10g}) L/T0, link 1 turns with {:.10g} /T0\n"
        "power {:.10g}, dissipation {:.10g} C_perp L^3/T0^2\n",
        v.x(), v.y(), v.z(), motion.power, motion.dissipation);
  }
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  return run_tool("motion", [=] {
    load_plugins();  // as flows of the world
    CLI::App app(
        "The motion of one swimmer in one state, without a step: dimensionless, lengths in L, "
        "times\n"
        "in T0, power in C_perp L^3/T0^2. Obstacles are not asked for.");
    Options options;
    app.add_option(
           "--state", options.state,
           "X1,Y1,THETA1,ALPHA1[,ALPHA2...]: free end of link 1, its angle, hinge angles [rad]")
        ->required();
    app.add_option("--rates", options.rates, "R1[,R2...]: hinge rates [1/T0]")->required();
    app.add_option("--world", options.world, "world file with a flow (docs/world.md)");
    app.add_option("--time", options.time, "of the flow [T0]")
        ->check(real_number())
        ->capture_default_str();
    app.add_option("--links", options.model.links, "number of links N")
        ->check(whole_number<int>(2, kMaxLinks))
        ->capture_default_str();
    app.add_option("--gamma", options.model.gamma, "drag ratio C_parallel / C_perp")
        ->check(real_number())
        ->capture_default_str();
    app.add_flag("--json", options.json,
                 "one line of JSON: {\"velocity\": [[vx1, vy1, omega1]], \"power\": .., "
                 "\"dissipation\": ..}");
    app.footer("Exit status: 0 printed; 1 failed; 2 wrong arguments or file.");
    return parse_command_line(app, argc, argv) ? run(options) : 0;
  });
}

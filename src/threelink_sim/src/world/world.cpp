#include "threelink_sim/world/world.hpp"

#include <cmath>
#include <filesystem>
#include <sstream>

#include <fmt/format.h>

#include "flow_set.hpp"
#include "map_file.hpp"
#include "threelink_sim/fields.hpp"
#include "threelink_sim/files.hpp"
#include "threelink_sim/kernel/world.hpp"
#include "threelink_sim/nearest_name.hpp"

namespace threelink_sim {
namespace {

constexpr std::size_t kMaxWorldBytes = std::size_t{1} << 20;

struct WorldNumbers {
  int flow_points = 3, flow_sweeps = 4;
  double link_radius = 0.01, contact_stiffness = 3000, thermal_noise = 0;

  template <class Self, class Visit>
  static void fields(Self& self, Visit&& visit) {
    visit("flow_points", self.flow_points, Range<int>{1, KernelFlows::kMaxPoints},
          "Gauss points a link");
    visit("flow_sweeps", self.flow_sweeps, Range<int>{1, 20}, "fixed-point sweeps a step");
    visit("link_radius", self.link_radius, Range<double>{1e-4, 0.1},
          "[L] of the links as capsules");
    visit("contact_stiffness", self.contact_stiffness, Range<double>{1, 1e6},
          "[C_perp L/T0] force over overlap");
    visit("thermal_noise", self.thermal_noise, Range<double>{0, 0.1}, "kT [C_perp L^3/T0]");
  }
};

struct ObstacleFields {
  double center[2] = {kNoDefault, 0}, from[2] = {kNoDefault, 0}, to[2] = {kNoDefault, 0};
  double point[2] = {kNoDefault, 0}, normal[2] = {kNoDefault, 0};
  double radius = kNoDefault, length = 1;
};

// One entry of the list `obstacles`; its values as YAML.
std::string add_obstacle(ParameterMap& entry, const std::string& folder, Obstacles& obstacles) {
  const std::string kind = entry.text("kind");
  const FieldReader read(entry);
  const auto vector = [](const double* values) { return Eigen::Vector2d(values[0], values[1]); };
  ObstacleFields field;
  if (kind == "disc") {
    read("center", field.center, kPlace, "[L]");
    read("radius", field.radius, kLength, "[L]");
    obstacles.add(Capsule{vector(field.center), vector(field.center), field.radius});
  } else if (kind == "capsule") {
    read("from", field.from, kPlace, "[L]");
    read("to", field.to, kPlace, "[L]");
    read("radius", field.radius, Range<double>{0, 1e6}, "[L]");
    obstacles.add(Capsule{vector(field.from), vector(field.to), field.radius});
  } else if (kind == "half_plane") {
    read("point", field.point, kPlace, "[L]");
    read("normal", field.normal, Range<double>{-1e6, 1e6}, "to the free side");
    const double length = vector(field.normal).norm();
    if (!(length > 1e-6))
      entry.refuse("normal", "must point to a side: its length must be above 1e-06");
    obstacles.add(HalfPlane{vector(field.point), vector(field.normal) / length});
  } else if (kind == "map") {
    const std::string file = path_from(folder, entry.text("file"));
    read("length", field.length, Range<double>{1e-9, 1e9}, "the map's length unit, in L");
    const std::string wanted = entry.text("sha256", std::string());
    entry.finish();
    MapFile map = read_map(file, field.length);
    if (!wanted.empty() && wanted != map.sha256)
      entry.refuse("sha256", fmt::format("{} has {}: it is another map", file, map.sha256));
    obstacles.add(std::move(map.map));
    return fmt::format("{{kind: map, file: {}, length: {}, sha256: {}}}",
                       yaml_text(std::filesystem::absolute(file).lexically_normal().string()),
                       yaml_number(field.length), map.sha256);
  } else {
    entry.refuse("kind", "there is no such obstacle; the nearest one is " +
                             nearest_name(kind, {"disc", "capsule", "half_plane", "map"}));
  }
  entry.finish();
  return one_line(entry);
}

void require_resistive_force(ParameterMap& parameters) {
  if (!parameters.has("hydrodynamics")) return;
  ParameterMap hydrodynamics = parameters.map("hydrodynamics");
  hydrodynamics.choice("kind", {"resistive_force"});
  hydrodynamics.finish();
}

std::string list_yaml(const std::string& name, const std::vector<std::string>& entries) {
  std::string yaml;
  for (const std::string& entry : entries) yaml += fmt::format("  - {}\n", entry);
  return yaml.empty() ? "" : name + ":\n" + yaml;
}

}  // namespace

World::World() = default;
World::~World() = default;

std::shared_ptr<const World> World::load(const std::string& path) {
  return parse(read_input(path, kMaxWorldBytes), path,
               std::filesystem::path(path).parent_path().string());
}

std::shared_ptr<const World> World::read(const std::string& text_or_path, const std::string& source,
                                         const std::string& folder) {
  if (text_or_path.find('\n') != std::string::npos) return parse(text_or_path, source, folder);
  return load(path_from(folder, text_or_path));
}

std::shared_ptr<const World> World::parse(const std::string& yaml, const std::string& source,
                                          const std::string& folder) {
  ParameterMap parameters = parse_parameters(source, yaml);
  std::shared_ptr<World> world(new World);
  world->source_ = source;
  WorldNumbers numbers;
  WorldNumbers::fields(numbers, FieldReader(parameters));
  std::vector<std::string> flows, obstacles;
  for (ParameterMap& entry : parameters.list("flow")) {
    if (!world->flows_) world->flows_ = std::make_unique<FlowSet>();
    flows.push_back(world->flows_->add(entry, folder));
  }
  for (ParameterMap& entry : parameters.list("obstacles"))
    obstacles.push_back(add_obstacle(entry, folder, world->obstacles_));
  require_resistive_force(parameters);
  parameters.finish();
  if (world->flows_) world->flows_->finish(numbers.flow_points);
  world->flow_sweeps_ = numbers.flow_sweeps;
  world->thermal_noise_ = numbers.thermal_noise;
  world->link_radius_ = numbers.link_radius;
  world->contact_stiffness_ = numbers.contact_stiffness;
  if (!world->still())
    world->yaml_ = list_yaml("flow", flows) + list_yaml("obstacles", obstacles) +
                   to_yaml(field_texts(numbers));
  return world;
}

void World::check_step(double dt, int substeps) const {
  if (!flows_) return;
  // Each sweep improves the poses by about dt |grad u| / 4 (docs/world.md).
  constexpr double kError = 1e-6;
  const double most = 4 * std::pow(kError, 1.0 / flow_sweeps_);
  double sum = 0;
  for (std::size_t i = 0; i < flows_->steepest().size(); ++i) {
    sum += flows_->steepest()[i];
    if (sum * dt / substeps <= most) continue;
    throw UsageError(fmt::format(
        "{}/flow[{}]: with it the flow's gradient is up to {:.4g} / T0, which in a step of {:.4g} "
        "T0 "
        "is {:.4g}: must be at most {:.4g} for {} sweeps to converge; flow_sweeps (up to 20) or a "
        "smaller dt allow more",
        source_, i, sum, dt / substeps, sum * dt / substeps, most, flow_sweeps_));
  }
}

const KernelFlows& World::flows() const { return flows_->kernel(); }

Eigen::Vector2d World::flow(double t, const Eigen::Vector2d& x) const {
  if (!flows_) return Eigen::Vector2d::Zero();
  Eigen::Vector2d u;
  FlowArgs args;
  args.flows = &flows();
  args.n = 1;
  args.time = &t;
  args.x = &x.x();
  args.y = &x.y();
  args.u = &u.x();
  args.v = &u.y();
  world_kernels().flow(args);
  return u;
}

bool World::has_grid() const { return flows_ && !flows_->grids().empty(); }

bool World::within_grids(double t, const Eigen::Vector2d& x) const {
  if (!flows_) return true;
  for (const GridData& grid : flows_->grids()) {
    const GridFlow& layout = grid.layout;
    if (!(x.x() >= layout.x0 && x.x() <= grid.right() && x.y() >= layout.y0 && x.y() <= grid.top()))
      return false;
    if (layout.nt > 1 && !(t >= layout.t0 && t <= grid.last())) return false;
  }
  return true;
}

std::string world_difference(const World* found, const World* wanted) {
  std::istringstream a(found ? found->yaml() : ""), b(wanted ? wanted->yaml() : "");
  std::string of_a, of_b;
  while (true) {
    const bool more_a = static_cast<bool>(std::getline(a, of_a));
    const bool more_b = static_cast<bool>(std::getline(b, of_b));
    if (!more_a && !more_b) return "";
    if (!more_a) of_a = "nothing";
    if (!more_b) of_b = "nothing";
    if (of_a != of_b) return fmt::format("world: {} instead of {}", of_a, of_b);
  }
}

}  // namespace threelink_sim

#include "flow_set.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <map>

#include <Eigen/Eigenvalues>
#include <fmt/format.h>
#include <fmt/ranges.h>

#include "threelink_sim/fields.hpp"
#include "threelink_sim/nearest_name.hpp"

namespace threelink_sim {
namespace {

constexpr std::array<const char*, 8> kOwnKinds{"uniform",      "linear", "poiseuille",
                                               "taylor_green", "vortex", "double_gyre",
                                               "random_modes", "grid"};

std::map<std::string, FlowMaker>& registry() {
  static std::map<std::string, FlowMaker> makers;
  return makers;
}

std::function<void()>& source() {
  static std::function<void()> find;
  return find;
}

// Also those that the source knows.
const FlowMaker* find_maker(const std::string& kind) {
  if (registry().count(kind) == 0 && source()) {
    const std::function<void()> find = std::move(source());
    source() = nullptr;
    find();
  }
  const auto entry = registry().find(kind);
  return entry == registry().end() ? nullptr : &entry->second;
}

void user_velocity(const void* flow, double t, double x, double y, double u[2]) {
  const Eigen::Vector2d velocity = static_cast<const Flow*>(flow)->velocity(t, {x, y});
  u[0] = velocity.x();
  u[1] = velocity.y();
}

template <class F>
void point_to(FlowList<F>& list, const std::vector<F>& flows) {
  list.first = flows.data();
  list.count = static_cast<int>(flows.size());
}

// Gauss-Legendre nodes and weights as the eigenvalues and eigenvectors of the Jacobi matrix (Golub
// & Welsch 1969), improved by Newton steps on the Legendre polynomial to the last digit.
void gauss_rule(int points, double* xi, double* weight) {
  for (int q = 0; q < points; ++q) {
    double x = -std::cos(3.14159265358979323846 * (q + 0.75) / (points + 0.5)), slope = 0;
    for (int iteration = 0; iteration < 20; ++iteration) {
      double before = 1, p = x;
      for (int n = 2; n <= points; ++n) {
        const double next = ((2 * n - 1) * x * p - (n - 1) * before) / n;
        before = p;
        p = next;
      }
      slope = points * (x * p - before) / (x * x - 1);
      x -= p / slope;
    }
    xi[q] = x;
    weight[q] = 2 / ((1 - x * x) * slope * slope);
  }
  // Exactly symmetric.
  for (int q = 0; q < points / 2; ++q) {
    xi[q] = -xi[points - 1 - q];
    weight[q] = weight[points - 1 - q];
  }
  if (points % 2 == 1) xi[points / 2] = 0;
}

// The largest stretching of a matrix.
double norm(const double a[2][2]) {
  Eigen::Matrix2d matrix;
  matrix << a[0][0], a[0][1], a[1][0], a[1][1];
  return std::sqrt((matrix.transpose() * matrix).selfadjointView<Eigen::Lower>().eigenvalues()[1]);
}

}  // namespace

void register_flow(const std::string& kind, const FlowMaker& make) { registry()[kind] = make; }

bool has_flow(const std::string& kind) {
  return registry().count(kind) > 0 ||
         std::find(kOwnKinds.begin(), kOwnKinds.end(), kind) != kOwnKinds.end();
}

void register_flow_source(const std::function<void()>& find) { source() = find; }

std::string path_from(const std::string& folder, const std::string& name) {
  return (std::filesystem::path(folder) / name).lexically_normal().string();
}

std::string one_line(const ParameterMap& entry) {
  std::vector<std::string> texts;
  for (const auto& [name, value] : entry.effective_values()) texts.push_back(name + ": " + value);
  return fmt::format("{{{}}}", fmt::join(texts, ", "));
}

std::string FlowSet::add(ParameterMap& entry, const std::string& folder) {
  const std::string kind = entry.text("kind");
  const FieldReader read(entry);
  double steepest = 0;
  if (kind == "uniform") {
    UniformFlow flow;
    uniform_fields(flow, read);
    linear_.push_back({{{0, 0}, {0, 0}}, {flow.U[0], flow.U[1]}, {0, 0}});
  } else if (kind == "linear") {
    linear_fields(linear_.emplace_back(kLinearFlow), read);
    steepest = norm(linear_.back().A);
  } else if (kind == "poiseuille") {
    // Where a swimmer is no farther from the axis than twice the half-width.
    const PoiseuilleFlow& flow = poiseuille_.emplace_back(kPoiseuilleFlow);
    poiseuille_fields(poiseuille_.back(), read);
    steepest = 4 * std::abs(flow.U) / flow.H;
  } else if (kind == "taylor_green") {
    const TaylorGreenFlow& flow = taylor_green_.emplace_back(kTaylorGreenFlow);
    taylor_green_fields(taylor_green_.back(), read);
    steepest = std::abs(flow.u0) * flow.k;
  } else if (kind == "vortex") {
    const VortexFlow& flow = vortex_.emplace_back(kVortexFlow);
    vortex_fields(vortex_.back(), read);
    steepest = std::abs(flow.Gamma) / (2 * 3.14159265358979323846 * flow.epsilon * flow.epsilon);
  } else if (kind == "double_gyre") {
    const DoubleGyreFlow& flow = double_gyre_.emplace_back(kDoubleGyreFlow);
    double_gyre_fields(double_gyre_.back(), read);
    // |f'| <= 1 + 2 epsilon between the walls; the second derivative of f adds 2 epsilon.
    const double slope = 1 + 2 * flow.epsilon;
    steepest = 10 * std::abs(flow.A) / flow.size * slope * slope;
  } else if (kind == "random_modes") {
    RandomModes modes;
    random_modes_fields(modes, read);
    for (const FlowMode& mode : draw_modes(modes)) {
      modes_.push_back(mode);
      steepest += std::hypot(mode.ux, mode.uy) * std::hypot(mode.kx, mode.ky);
    }
  } else if (kind == "grid") {
    GridSource grid;
    const std::string name = entry.text("file");
    grid_fields(grid, read);
    grid.file = path_from(folder, name);
    grid.sha256 = entry.text("sha256", std::string());
    entry.finish();
    grids_.push_back(read_grid(grid, entry));
    steepest = grids_.back().steepest;
    steepest_.push_back(steepest);
    return fmt::format("{{kind: grid, file: {}, length: {}, time: {}, sha256: {}}}",
                       yaml_text(std::filesystem::absolute(grid.file).lexically_normal().string()),
                       yaml_number(grid.length), yaml_number(grid.time), grids_.back().sha256);
  } else if (const FlowMaker* make = find_maker(kind)) {
    user_flows_.push_back((*make)());
    user_flows_.back()->configure(entry);
    user_.push_back({user_velocity, user_flows_.back().get()});
    steepest = user_flows_.back()->steepest();
    if (!(steepest >= 0 && std::isfinite(steepest)))
      entry.refuse(
          "kind",
          fmt::format("its gradient is at most {}: must be finite and not negative", steepest));
  } else {
    std::vector<std::string> kinds(kOwnKinds.begin(), kOwnKinds.end());
    for (const auto& known : registry()) kinds.push_back(known.first);
    entry.refuse("kind", "there is no such flow; the nearest one is " + nearest_name(kind, kinds));
  }
  entry.finish();
  steepest_.push_back(steepest);
  return one_line(entry);
}

void FlowSet::finish(int points) {
  for (const GridData& grid : grids_) grid_.push_back(grid.kernel());
  point_to(kernel_.linear, linear_);
  point_to(kernel_.poiseuille, poiseuille_);
  point_to(kernel_.taylor_green, taylor_green_);
  point_to(kernel_.vortex, vortex_);
  point_to(kernel_.double_gyre, double_gyre_);
  point_to(kernel_.modes, modes_);
  point_to(kernel_.grid, grid_);
  point_to(kernel_.user, user_);
  kernel_.points = points;
  gauss_rule(points, kernel_.xi, kernel_.weight);
}

}  // namespace threelink_sim

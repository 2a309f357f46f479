// The world around the swimmer: ambient flow, obstacles and thermal noise, from a file.
//
// docs/world.md is the manual of the file, with the physics; config/worlds has examples. An empty
// file is still water without anything in it.
#pragma once

#include <memory>
#include <string>

#include <Eigen/Core>

#include "threelink_sim/kernel/flows.hpp"
#include "threelink_sim/model.hpp"
#include "threelink_sim/world/obstacles.hpp"

namespace threelink_sim {

class FlowSet;

class World {
 public:
  // Throw UsageError or ParameterError that names file, key, value and bound. Names of files in
  // `yaml` are relative to `folder`, and `source` is what its text is called in errors.
  static std::shared_ptr<const World> load(const std::string& path);
  // What a parameter or key says: the text of a world, of several lines, or the path of its file.
  static std::shared_ptr<const World> read(const std::string& text_or_path,
                                           const std::string& source, const std::string& folder);
  static std::shared_ptr<const World> parse(const std::string& yaml, const std::string& source,
                                            const std::string& folder);
  ~World();

  // Everything in it as YAML, of which parse() makes the same world: all defaults, absolute paths,
  // and the sha256 of each file. Empty for still water.
  const std::string& yaml() const { return yaml_; }
  // Whether it is still water without obstacles and noise.
  bool still() const { return !flows_ && obstacles_.empty() && thermal_noise_ == 0; }

  // Throws UsageError if the flow changes so much within an action step dt [T0] of which each has
  // `substeps` that the sweeps would not converge.
  void check_step(double dt, int substeps) const;

  bool has_flow() const { return flows_ != nullptr; }
  const KernelFlows& flows() const;                                // has_flow()
  int flow_sweeps() const { return flow_sweeps_; }                 // fixed-point sweeps of a step
  double thermal_noise() const { return thermal_noise_; }          // kT [C_perp L^3/T0]
  double link_radius() const { return link_radius_; }              // [L]
  double contact_stiffness() const { return contact_stiffness_; }  // [C_perp L/T0]
  const Obstacles& obstacles() const { return obstacles_; }

  // [L/T0] of the flow; zero without one.
  Eigen::Vector2d flow(double t, const Eigen::Vector2d& x) const;
  // Whether a place and time are within all grids of the flow, which know nothing of the rest.
  bool within_grids(double t, const Eigen::Vector2d& x) const;
  bool has_grid() const;

 private:
  World();

  std::string source_, yaml_;
  std::unique_ptr<FlowSet> flows_;
  int flow_sweeps_;
  double thermal_noise_, link_radius_, contact_stiffness_;
  Obstacles obstacles_;
};

// "the world is FILE" for two nodes' or runs' comparison: the first line in which the effective
// YAML of two worlds differs; null stands for still water. Empty if they are the same.
std::string world_difference(const World* found, const World* wanted);

}  // namespace threelink_sim

// The flows of a world: read, bounded, and laid out for the kernels.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "flow_fields.hpp"
#include "grid_file.hpp"
#include "threelink_sim/kernel/flows.hpp"
#include "threelink_sim/parameter_map.hpp"
#include "threelink_sim/world/flow.hpp"

namespace threelink_sim {

// kT-free part of a world: u(X, t) as a sum.
class FlowSet {
 public:
  FlowSet() = default;
  FlowSet(const FlowSet&) = delete;
  FlowSet& operator=(const FlowSet&) = delete;

  // One entry of the list `flow`; names of files are relative to `folder`. Throws ParameterError or
  // UsageError. Returns the entry with all its values, as YAML.
  std::string add(ParameterMap& entry, const std::string& folder);
  // To be called once, after the last: with so many Gauss points a link.
  void finish(int points);

  const KernelFlows& kernel() const { return kernel_; }
  const std::vector<GridData>& grids() const { return grids_; }

  // [1/T0] bounds of |grad u|, one for each entry.
  const std::vector<double>& steepest() const { return steepest_; }

 private:
  std::vector<LinearFlow> linear_;
  std::vector<PoiseuilleFlow> poiseuille_;
  std::vector<TaylorGreenFlow> taylor_green_;
  std::vector<VortexFlow> vortex_;
  std::vector<DoubleGyreFlow> double_gyre_;
  std::vector<FlowMode> modes_;
  std::vector<GridData> grids_;
  std::vector<GridFlow> grid_;
  std::vector<std::unique_ptr<Flow>> user_flows_;
  std::vector<UserFlow> user_;
  std::vector<double> steepest_;
  KernelFlows kernel_;
};

// The modes that a seed gives: wave vectors of one length in directions that are uniform,
// velocities at right angles to them, random phases.
std::vector<FlowMode> draw_modes(const RandomModes& config);

// A name as the world file gives it, from the folder of that file.
std::string path_from(const std::string& folder, const std::string& name);

// "{name: value, ..}" of what was read.
std::string one_line(const ParameterMap& entry);

}  // namespace threelink_sim

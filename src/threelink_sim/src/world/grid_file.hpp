// A velocity field from a file: rows x, y[, t], u, v as programs for particle image velocimetry and
// computational fluid dynamics write them, with commas, tabs or blanks between.
#pragma once

#include <string>
#include <vector>

#include "flow_fields.hpp"
#include "threelink_sim/kernel/flows.hpp"
#include "threelink_sim/parameter_map.hpp"

namespace threelink_sim {

struct GridData {
  std::string file, sha256;
  GridFlow layout;                 // its pointer is set by kernel()
  std::vector<double> velocities;  // [L/T0]
  double steepest = 0;  // [1/T0] largest difference between neighbours over their distance

  GridFlow kernel() const {
    GridFlow flow = layout;
    flow.u = velocities.data();
    return flow;
  }
  // Of its last node.
  double right() const { return layout.x0 + (layout.nx - 1) * layout.dx; }
  double top() const { return layout.y0 + (layout.ny - 1) * layout.dy; }
  double last() const { return layout.t0 + (layout.nt - 1) * layout.dt; }
};

// Throws UsageError that names file and line; `entry` is what named the file, for errors about it.
GridData read_grid(const GridSource& source, const ParameterMap& entry);

// Of a text; the same errors.
GridData parse_grid(const std::string& text, const GridSource& source);

}  // namespace threelink_sim

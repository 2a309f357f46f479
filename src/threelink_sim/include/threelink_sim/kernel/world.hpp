// The kernels of a world around the swimmer: stepping in a flow, and thermal motion.
//
// Arrays are those of kernel/kernels.hpp; times in T0, flows in L/T0.
#pragma once

#include "threelink_sim/kernel/flows.hpp"
#include "threelink_sim/kernel/kernels.hpp"

namespace threelink_sim {

// One action step in a flow.
struct DriftArgs {
  AdvanceArgs step;
  const KernelFlows* flows;
  int sweeps;           // of the fixed-point iteration, 1 at least
  const double* time;   // [T0] (n) at the start of the step
  double* dissipation;  // [C_perp L^3/T0] (n) out
};

// Motion in a given state, as MotionArgs; the centroid's velocity in the body frame, that of the
// fluid included.
struct FlowMotionArgs {
  MotionArgs shape;
  const KernelFlows* flows;
  const double* time;     // [T0] (n)
  const double* x;        // [L] (n) centroid
  const double* y;        // [L] (n)
  const double* heading;  // [rad] (n)
  double* dissipation;    // [C_perp L^3/T0^2] (n) out
};

// The flow at n places.
struct FlowArgs {
  const KernelFlows* flows;
  std::size_t n;
  const double* time;  // [T0] (n)
  const double* x;     // [L] (n)
  const double* y;     // [L] (n)
  double* u;           // [L/T0] (n) out
  double* v;           // [L/T0] (n) out
};

// What thermal motion adds to a step of length dt, after it.
struct ThermalArgs {
  KernelModel model;
  double kT;  // [C_perp L^3/T0]
  double dt;  // [T0]
  std::size_t n;
  std::size_t stride;
  const double* alpha;    // [rad] (N-1, n)
  const double* normals;  // (3, n) two for the place, heading frame, and one for the turn
  double* x;              // [L] (n) centroid, in and out
  double* y;              // [L] (n)
  double* heading;        // [rad] (n) in and out
  double* displacement;   // [L] (2, n) in and out
};

struct WorldKernels {
  void (*drift)(const DriftArgs&);
  void (*motion)(const FlowMotionArgs&);
  void (*flow)(const FlowArgs&);
  void (*shake)(const ThermalArgs&);
};

// The kernels of an instruction set. Throws std::invalid_argument if this processor lacks it.
const WorldKernels& world_kernels(Isa isa);

// The kernels in use; see isa_in_use().
const WorldKernels& world_kernels();

}  // namespace threelink_sim

// Ambient flows u(X, t) as the kernels see them; equations and sources are in src/kernel/flow, what
// users write is in world/flow_fields.hpp. Lengths in L, times in T0.
#pragma once

namespace threelink_sim {

// u = A (X - x0) + U; a uniform flow has A = 0.
struct LinearFlow {
  double A[2][2];  // [1/T0]
  double U[2];     // [L/T0]
  double x0[2];    // [L]
};

// u = (U (1 - ((y - y0) / H)^2), 0)
struct PoiseuilleFlow {
  double U;   // [L/T0] on the axis
  double H;   // [L] half the width
  double y0;  // [L] of the axis
};

// u = u0 (sin a cos b, -cos a sin b), a = k x + phase[0], b = k y + phase[1]
struct TaylorGreenFlow {
  double u0;        // [L/T0]
  double k;         // [1/L]
  double phase[2];  // [rad]
};

// u = Gamma / (2 pi) (-(y - y0), x - x0) / (r^2 + epsilon^2)
struct VortexFlow {
  double Gamma;    // [L^2/T0]
  double epsilon;  // [L] of the core
  double x0[2];    // [L]
};

// Two vortices side by side whose border swings; see flow/double_gyre.hpp.
struct DoubleGyreFlow {
  double A;        // [L/T0]
  double epsilon;  // of the swing
  double omega;    // [1/T0] of the swing
  double size;     // [L] of one gyre
};

// One of the random modes: u += (ux, uy) cos(kx x + ky y + omega t + phase).
struct FlowMode {
  double kx, ky;  // [1/L]
  double ux, uy;  // [L/T0]
  double omega;   // [1/T0]
  double phase;   // [rad]
};

// Values at the nodes of a regular grid; see flow/grid.hpp. Node (i, j, m) is at
// x[i] = x0 + i dx, y[j] = y0 + j dy, t[m] = t0 + m dt, and its velocity at
// u[2 ((m ny + j) nx + i)] and the place after it.
struct GridFlow {
  int nx, ny, nt;     // nt = 1: steady
  double x0, y0, t0;  // [L], [L], [T0]
  double dx, dy, dt;  // [L], [L], [T0]
  const double* u;    // [L/T0]
};

// A flow that is code of the user's.
struct UserFlow {
  void (*velocity)(const void* flow, double t, double x, double y, double u[2]);  // [L/T0]
  const void* flow;
};

template <class Flow>
struct FlowList {
  const Flow* first = nullptr;
  int count = 0;

  const Flow* begin() const { return first; }
  const Flow* end() const { return first + count; }
};

// The sum of all of them.
struct KernelFlows {
  FlowList<LinearFlow> linear;
  FlowList<PoiseuilleFlow> poiseuille;
  FlowList<TaylorGreenFlow> taylor_green;
  FlowList<VortexFlow> vortex;
  FlowList<DoubleGyreFlow> double_gyre;
  FlowList<FlowMode> modes;
  FlowList<GridFlow> grid;
  FlowList<UserFlow> user;

  // A link's integrals are sums over Gauss points xi in [-1, 1] with weights of sum 2, in the order
  // of rising xi. The nodes are symmetric: xi[points - 1 - q] = -xi[q].
  static constexpr int kMaxPoints = 8;
  int points = 3;
  double xi[kMaxPoints] = {}, weight[kMaxPoints] = {};
};

}  // namespace threelink_sim

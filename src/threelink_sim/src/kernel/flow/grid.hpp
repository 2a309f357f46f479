// Values on a regular grid in x, y and, if there are several times, t: cubic Lagrange interpolation
// through the four nearest nodes of each direction, one-sided at the rim. The error falls as the
// fourth power of the spacing; cubics are exact, which is the exact check.
//
// Places beyond the grid give the values of the polynomial at its rim: who steps the swimmer finds
// out that it has left the grid, and ends the episode.
#pragma once

#include "threelink_sim/kernel/flows.hpp"
#include "threelink_sim/kernel/lane.hpp"

namespace threelink_sim {
namespace THREELINK_ISA {

// The first of the four nodes around a place among n, which is counted in spacings from node 0, and
// their weights. A single node has the weight 1.
inline int cubic_weights(double place, int n, double weight[4]) {
  weight[0] = 1;
  weight[1] = weight[2] = weight[3] = 0;
  if (n == 1) return 0;
  place = place > 0 ? place : 0;
  place = place < n - 1 ? place : n - 1;
  int first = static_cast<int>(place) - 1;
  first = first > 0 ? first : 0;
  first = first < n - 4 ? first : n - 4;
  const double a = place - first, b = a - 1, c = a - 2, d = a - 3;
  weight[0] = b * c * d * (-1.0 / 6);
  weight[1] = a * c * d * 0.5;
  weight[2] = a * b * d * -0.5;
  weight[3] = a * b * c * (1.0 / 6);
  return first;
}

inline void velocity_on_grid(const GridFlow& flow, double t, double x, double y,
                             double velocity[2]) {
  double wx[4], wy[4], wt[4];
  const int i = cubic_weights((x - flow.x0) / flow.dx, flow.nx, wx);
  const int j = cubic_weights((y - flow.y0) / flow.dy, flow.ny, wy);
  const int m = cubic_weights((t - flow.t0) / flow.dt, flow.nt, wt);
  velocity[0] = velocity[1] = 0;
  for (int c = 0; c < (flow.nt == 1 ? 1 : 4); ++c)
    for (int b = 0; b < 4; ++b) {
      const double* row =
          flow.u + 2 * ((static_cast<long long>(m + c) * flow.ny + j + b) * flow.nx + i);
      double u = 0, v = 0;
      for (int a = 0; a < 4; ++a) {
        u = fma(wx[a], row[2 * a], u);
        v = fma(wx[a], row[2 * a + 1], v);
      }
      velocity[0] = fma(wt[c] * wy[b], u, velocity[0]);
      velocity[1] = fma(wt[c] * wy[b], v, velocity[1]);
    }
}

}  // namespace THREELINK_ISA
}  // namespace threelink_sim

// Contact of the links, as capsules, with obstacles: what keeps the swimmer out of them.
//
// After a substep of length h without contact (free: the pose, and z_free = (centroid velocity,
// turning rate)) the motion z = z_free + delta with contact is that of least dissipation with stiff
// contacts,
//   K_c delta = sum over A of J^T F,   F = -kappa d >= 0,   A = {contacts with d < 0},
// where K_c is the 3x3 resistance about the centroid, d the gap at the end of the substep, n the
// normal from the obstacle to the link at the nearest point p, and J = (n, (p - x_c) x n). Since d
// depends on delta, (K_c + kappa h sum J^T J) delta is solved by Newton's method, with A found by
// sweeps: an implicit step, stable for any stiffness, without friction and without extra state.
//
// Contacts dissipate h delta . K_c delta more, and do the work W_c = sum of F times the change of
// d, which over a whole contact with an obstacle at rest is negative: the step is implicit. The
// hinges pay for both, h (delta . K_c delta + delta . K_c z_drift) - W_c, where z_drift is the
// motion of the locked swimmer in the flow. Derivation: docs/world.md.
#pragma once

#include <vector>

#include <Eigen/Core>

#include "threelink_sim/swimmer.hpp"
#include "threelink_sim/world/world.hpp"

namespace threelink_sim {

// What obstacles did in a step.
struct ContactRecord {
  int contacts = 0;                                 // that press, at the end of the step
  Eigen::Vector2d force = Eigen::Vector2d::Zero();  // [C_perp L^2/T0] sum of theirs on the swimmer
  double torque = 0;                                // [C_perp L^3/T0] about the centroid
  double power = 0;  // [C_perp L^3/T0^2] that they add to the hinges'
};

// The end of a substep with contact.
struct ContactStep {
  SwimmerState state;
  double work = 0;  // [C_perp L^3/T0] to be added to that of the free substep; without z_drift
  double dissipation = 0;  // [C_perp L^3/T0] likewise
  double gap = 0;          // [L] the smallest one in the end; infinite if nothing is near
  ContactRecord record;
};

class ContactSolver {
 public:
  // The world must outlive it.
  ContactSolver(const World& world, const Model& model);

  // A substep of length h [T0] from a state to the one that it would lead to without obstacles,
  // thermal motion included, of which `kick` (x, y, turn) is the part that the hinges do not pay
  // for. Allocates only if more obstacles are near than ever before.
  ContactStep step(const SwimmerState& from, const SwimmerState& free, const Eigen::Vector3d& kick,
                   double h);

  // Throws std::invalid_argument if a link touches an obstacle or lies within a blocked cell.
  void check_free(const SwimmerState& state);

  // [L] the smallest gap; infinite if it is above `reach`.
  double gap(const SwimmerState& state, double reach);

 private:
  // The links in the fixed frame.
  struct Links {
    Eigen::Vector2d joint[kMaxLinks + 1];
    Eigen::Vector2d tangent[kMaxLinks];
  };
  // A pair that may touch: of a link and a capsule, or of a joint and a half-plane.
  struct Pair {
    bool half_plane;
    int part, obstacle;
    Eigen::Vector2d side;  // normal at the start of the substep
    double gap;            // [L] then
  };
  struct Nearest {
    double gap;  // [L]
    Eigen::Vector2d normal, point;
  };

  Links links_of(const SwimmerState& state) const;
  Nearest nearest(const Links& links, const Pair& pair) const;
  void find_pairs(const Links& links, const Eigen::Vector2d& centroid, double reach);
  Eigen::Matrix3d resistance(const Links& links, const Eigen::Vector2d& centroid) const;

  const World* world_;
  Model model_;
  std::vector<int> near_;
  std::vector<Pair> pairs_;
  std::vector<Nearest> nearest_;
  std::vector<char> pressing_;
};

}  // namespace threelink_sim

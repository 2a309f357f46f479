// The search for a stroke as NLopt sees it: a vector of unknowns, an objective, and constraints.
#pragma once

#include <vector>

#include <Eigen/Core>

#include "threelink_sim/optimal_stroke.hpp"
#include "threelink_sim/stroke_gradient.hpp"

namespace threelink_sim {

// A stroke of K pieces has the unknowns
//   z = (sqrt(K) start, sqrt(K) dt / dt_0, rates by piece)
// and the objective K f, which makes second derivatives about 1 whatever K is: SLSQP begins with
// the identity.
class StrokeProblem {
 public:
  using Index = Eigen::Index;

  // For strokes like x; keeps in `climb` what is tried, and the best value of it.
  StrokeProblem(const StrokeSearch& search, const StrokeVariables& x, Climb& climb,
                const ClimbWatch& on_step);

  Index size() const { return hinges_ + 1 + hinges_ * pieces_; }
  Index dt_at() const { return hinges_; }
  Index rate_at(Index hinge, Index piece) const { return hinges_ + 1 + piece * hinges_ + hinge; }
  Eigen::VectorXd pack(const StrokeVariables& x) const;

  // K times the objective, in units that make it about 1. Gradients, here and below, may be null.
  double objective(const double* z, double* gradient);

  // Zero: the sum of each hinge's rates, and the rotation.
  Index equalities() const { return hinges_ + 1; }
  void equalities(double* result, const double* z, double* gradient);

  // Not positive: how far each angle that is held is beyond the joint limit.
  Index inequalities() const { return held_.size(); }
  void inequalities(double* result, const double* z, double* gradient);

  // Holds the angles of x beyond limit - margin that are not held yet; false if there are none.
  bool hold(const StrokeVariables& x, double margin);

  // The best feasible stroke so far. (NLopt's own choice falls back to the start where the last
  // steps are lost in rounding.)
  bool found() const { return found_; }
  const StrokeVariables& best() const { return best_; }
  void forget_best() { found_ = false; }

 private:
  // A hinge angle before a piece, and the sign of the limit that it is held to.
  struct Held {
    Index hinge, piece;
    double sign;
  };

  static constexpr double kFeasible = 1e-8;  // [rad]

  // With room for what is taken as feasible.
  double limit() const { return search_.model.joint_limit - 3 * kFeasible; }
  double objective_scale() const;
  bool is_held(Index hinge, Index piece, double sign) const;
  double violation(const StrokeVariables& x) const;
  StrokeVariables unpack(const double* z) const;
  // A gradient by the variables becomes one by z.
  void put(double* gradient, const StrokeVariables& by) const;
  // The stroke at z. Objective and constraints are asked for at one point after the other, and
  // share its outcome_.
  const StrokeVariables& at(const double* z);

  const StrokeSearch& search_;
  Index hinges_, pieces_;
  double root_;      // sqrt(K)
  double dt_scale_;  // sqrt(K) / dt_0
  Climb& climb_;
  const ClimbWatch& on_step_;
  std::vector<Held> held_;
  Eigen::VectorXd z_;
  StrokeVariables x_;
  StrokeOutcome outcome_;
  bool found_ = false;
  StrokeVariables best_;
};

}  // namespace threelink_sim

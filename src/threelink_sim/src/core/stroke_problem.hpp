// The search for a stroke as NLopt sees it: a vector of unknowns, an objective, and constraints.
#pragma once

#include <vector>

#include <Eigen/Core>

#include "threelink_sim/optimal_stroke.hpp"
#include "threelink_sim/stroke_gradient.hpp"

namespace threelink_sim {

// rates (by piece, then hinge) = fixed + basis y, with orthonormal columns. An empty basis stands
// for all rates, fixed = 0.
struct RateSpace {
  Eigen::VectorXd fixed;
  Eigen::MatrixXd basis;
};

// The first `modes` harmonics of the period, and the mean, of each hinge.
RateSpace harmonics(Eigen::Index hinges, Eigen::Index pieces, int modes);

// A stroke of K pieces has the unknowns
//   z = (sqrt(K) start, sqrt(K) dt / dt_0, rates by piece)
// and the objective K f, which makes second derivatives about 1 whatever K is: SLSQP begins with
// the identity. A step of SLSQP costs as the cube of the unknowns, so that the rates may be
// restricted to those of a RateSpace, whose coordinates then are the unknowns.
class StrokeProblem {
 public:
  using Index = Eigen::Index;

  // For strokes like x; keeps in `climb` what is tried, and the best value of it.
  StrokeProblem(const StrokeSearch& search, const StrokeVariables& x, Climb& climb,
                const ClimbWatch& on_step);

  Index size() const { return first_rate() + (whole() ? rates() : space_.basis.cols()); }
  Index dt_at() const { return hinges_; }
  Index first_rate() const { return hinges_ + 1; }  // and up to the end
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

  void restrict_to(const RateSpace& space) { space_ = space; }
  // Fixes the rates of x that are at their bounds, but for those next in time to one that is not or
  // that changes sign, up to `margin` pieces away.
  void fix_saturated(const StrokeVariables& x, Index margin);
  // Of these frees the ones that the gradient at x, with the multipliers of the constraints, would
  // move inwards; false if there are none.
  bool release(const StrokeVariables& x);

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
  bool whole() const { return space_.basis.size() == 0; }
  Index rates() const { return hinges_ * pieces_; }
  Index rate_at(Index hinge, Index piece) const { return piece * hinges_ + hinge; }
  void select_free();  // the space of the rates that are free_
  // A gradient by all rates becomes one by their coordinates.
  void put_rates(double* gradient, const Eigen::VectorXd& by) const;
  // The weights of distance and work in the derivative of the objective.
  struct Slopes {
    double value, by_distance, by_work;
  };
  Slopes slopes() const;
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
  RateSpace space_;
  std::vector<bool> free_;  // rates, where some are fixed
  Eigen::VectorXd z_;
  StrokeVariables x_;
  StrokeOutcome outcome_;
  bool found_ = false;
  StrokeVariables best_;
};

}  // namespace threelink_sim

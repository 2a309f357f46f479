/// @file
/// Many swimmers at once as a structure of arrays, one swimmer per lane.
#pragma once

#include <vector>

#include "threelink_sim/kernel/kernels.hpp"
#include "threelink_sim/swimmer.hpp"

namespace threelink_sim {

/// n swimmers of one model. Array q of swimmer i is q()[i]; hinge j of swimmer i is q(j)[i].
class Batch {
 public:
  Batch(const Model& model, std::size_t n, const Kernels& kernels = threelink_sim::kernels());

  const Model& model() const { return model_; }
  std::size_t size() const { return n_; }

  void set_state(std::size_t i, const SwimmerState& state);
  SwimmerState state(std::size_t i) const;

  const double* x() const { return x_.data(); }                                ///< [L] centroid
  const double* y() const { return y_.data(); }                                ///< [L]
  const double* heading() const { return heading_.data(); }                    ///< [rad]
  const double* alpha(int hinge) const { return alpha_.data() + hinge * n_; }  ///< [rad]

  /// [1/T0] to be written before advance(); holds the applied rates after it.
  double* rates(int hinge) { return rates_.data() + hinge * n_; }
  const double* rates(int hinge) const { return rates_.data() + hinge * n_; }

  /// Advances all swimmers by one action step; see threelink_sim::advance.
  void advance(double dt, int substeps);

  /// Arguments of the kernels that point into this batch, for steps that do more than advance().
  AdvanceArgs arguments(double dt, int substeps);
  /// Sets centroid and heading of lane i; the hinge angles and the results of the last step remain.
  void set_pose(std::size_t i, const Eigen::Vector2d& centroid, double heading);

  /// Results of the last advance().
  const double* dx() const { return displacement_.data(); }       ///< [L] of the centroid
  const double* dy() const { return displacement_.data() + n_; }  ///< [L]
  const double* work() const { return work_.data(); }             ///< [C_perp L^3/T0]

  /// Of the angle theta_a of every swimmer's axis (observation.hpp), by the kernels (so that all
  /// instruction sets give the same bits).
  void axis_sincos(double* sine, double* cosine) const;

  /// The terms of the observation for a distance r [L] (n): weight w = tanh(r / 0.1) and (ln r + 4)
  /// / 2, also by the kernels.
  void look_at_distance(const double* r, double* weight, double* log) const;

 private:
  Model model_;
  const Kernels* kernels_;
  std::size_t n_;
  std::vector<double> x_, y_, heading_, alpha_, rates_, displacement_, work_;
};

}  // namespace threelink_sim

/// @file
/// The swimmer's constants and their bounds.
#pragma once

#include <Eigen/Core>

#include "threelink_sim/kernel/kernels.hpp"
#include "threelink_sim/model_limits.hpp"
#include "threelink_sim/range.hpp"

namespace threelink_sim {

/// The number pi.
constexpr double kPi = 3.14159265358979323846;

/// One value per hinge, without heap allocation.
using HingeVector = Eigen::Matrix<double, Eigen::Dynamic, 1, Eigen::ColMajor, kMaxHinges, 1>;
/// One value per link, without heap allocation.
using LinkVector = Eigen::Matrix<double, Eigen::Dynamic, 1, Eigen::ColMajor, kMaxLinks, 1>;

/// N equal slender links of length 1/N, joined by N-1 hinges, at low Reynolds number. Dimensionless
/// as in the paper: lengths in L, times in T0, forces in C_perp L^2 / T0.
struct Model {
  int links = 3;
  double gamma = 0.5;
  double joint_limit = 2 * kPi / 3;

  template <class Self, class Visit>
  static void fields(Self& self, Visit&& visit) {
    visit("links", self.links, Range<int>{2, kMaxLinks}, "number of links N");
    visit("gamma", self.gamma, Range<double>{1e-3, 10}, "drag ratio C_parallel / C_perp");
    visit("joint_limit", self.joint_limit, Range<double>{1e-3, kPi}, "[rad] bound on |alpha_j|");
  }

  int hinges() const { return links - 1; }
  /// Index, from 0, of the link whose angle is the swimmer's heading: theta_2 of three.
  int heading_link() const { return links / 2; }
  // N odd: the heading link is then the same one counted from either end.
  bool has_middle_link() const { return links % 2 == 1; }
  double link_length() const { return 1.0 / links; }

  /// Throws std::invalid_argument that names field, value and bound.
  void validate() const;
};

/// Number of substeps of a step of length dt [T0] with hinge rates of at most max_rate [1/T0]. One
/// is enough for dt max_rate <= 0.1 and up to six links (the error of 60 steps is below 1e-12 for
/// three links and below 1e-11 for more). The number grows in proportion to the change of angle per
/// step and to the number of links, so that the angles in the kernels stay small enough for their
/// series.
int substeps(const Model& model, double dt, double max_rate);

/// The model in the form of the kernels.
KernelModel kernel_model(const Model& model);

}  // namespace threelink_sim

#define THREELINK_ISA dual

#include "threelink_sim/stroke_gradient.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

#include <Eigen/Geometry>

#include "../kernel/dual.hpp"
#include "../kernel/swimmer_kernel.hpp"

namespace threelink_sim {
namespace {

using dual::Dual;

// Of one piece, from heading 0 at dt = 1.
enum { kAhead, kAside, kTurn, kWork, kQuantities };

// Values, and derivatives by the first angles (N-1), then by the changes of angle (N-1).
struct Piece {
  Eigen::Matrix<double, kQuantities, 1> value;
  Eigen::Matrix<double, kQuantities, Eigen::Dynamic> by;
};

dual::Travel<Dual> travel(const KernelModel& model, int substeps, const Dual* alpha,
                          const Dual* change) {
  constexpr double kUnitTime = 1;
  return model.links == 3
             ? dual::travel<Dual, 3>(model, kUnitTime, substeps, alpha, change, Dual{})
             : dual::travel<Dual, 0>(model, kUnitTime, substeps, alpha, change, Dual{});
}

Piece piece(const Model& model, const HingeVector& angles, const HingeVector& changes) {
  const int hinges = model.hinges(), inputs = 2 * hinges;
  const int n = substeps(model, 1.0, changes.cwiseAbs().maxCoeff());
  const double lambda = 0.5 * model.link_length();
  Piece result;
  result.by.resize(kQuantities, inputs);
  for (int first = 0; first < inputs; first += Dual::kWidth) {
    Dual input[2 * kMaxHinges];
    for (int j = 0; j < hinges; ++j) {
      input[j].v = angles[j];
      input[hinges + j].v = changes[j];
    }
    const int width = std::min<int>(Dual::kWidth, inputs - first);
    for (int i = 0; i < width; ++i) input[first + i].d[i] = 1;
    const auto way = travel(kernel_model(model), n, input, input + hinges);
    const Dual quantities[kQuantities] = {way.dx * lambda, way.dy * lambda, way.heading,
                                          way.work * (lambda * lambda * model.link_length())};
    for (int q = 0; q < kQuantities; ++q) {
      result.value[q] = quantities[q].v;
      for (int i = 0; i < width; ++i) result.by(q, first + i) = quantities[q].d[i];
    }
  }
  return result;
}

// The chain rule: derivatives by each piece's angles a_k and changes d_k, (2 (N-1), pieces), become
// those by start, dt and rates, with d_k = dt r_k and a_k = start + dt (r_0 + .. + r_{k-1}).
StrokeVariables by_variables(const StrokeVariables& x, const Eigen::MatrixXd& by_piece) {
  const Eigen::Index hinges = x.rates.rows(), pieces = x.rates.cols();
  StrokeVariables by;
  by.rates.resize(hinges, pieces);
  by.start = HingeVector::Zero(hinges);
  by.dt = 0;
  for (Eigen::Index k = pieces - 1; k >= 0; --k) {
    // by.start is the sum over the later pieces, whose angles all hold r_k.
    by.rates.col(k) = by_piece.col(k).tail(hinges) + by.start;
    by.dt += by.rates.col(k).dot(x.rates.col(k));
    by.start += by_piece.col(k).head(hinges);
  }
  by.rates *= x.dt;
  return by;
}

}  // namespace

StrokeOutcome stroke_outcome(const Model& model, const StrokeVariables& x) {
  const Eigen::Index hinges = x.rates.rows(), pieces = x.rates.cols();
  std::vector<Piece> parts;
  Eigen::Matrix2Xd after(2, pieces);  // centroid after each piece
  Eigen::VectorXd heading(pieces);    // before each piece
  HingeVector angles = x.start;
  Eigen::Vector2d centroid = Eigen::Vector2d::Zero();
  double theta = 0, work = 0;  // work at dt = 1
  for (Eigen::Index k = 0; k < pieces; ++k) {
    const HingeVector changes = x.dt * x.rates.col(k);
    parts.push_back(piece(model, angles, changes));
    const auto& value = parts.back().value;
    heading[k] = theta;
    centroid += Eigen::Rotation2Dd(theta) * value.head<2>();
    after.col(k) = centroid;
    theta += value[kTurn];
    work += value[kWork];
    angles += changes;
  }

  StrokeOutcome outcome;
  outcome.distance.value = centroid.norm();
  outcome.rotation.value = theta;
  outcome.work.value = work / x.dt;

  Eigen::MatrixXd distance(2 * hinges, pieces), rotation(2 * hinges, pieces),
      work_1(2 * hinges, pieces);
  const Eigen::Vector2d along = centroid.normalized();
  for (Eigen::Index k = 0; k < pieces; ++k) {
    // A turn in piece k turns all that follows: e_z x (centroid - after_k).
    const Eigen::Vector2d rest = centroid - after.col(k);
    const double by_turn = along.y() * rest.x() - along.x() * rest.y();
    const Eigen::Vector2d by_motion = Eigen::Rotation2Dd(-heading[k]) * along;
    const auto& by = parts[k].by;
    distance.col(k) = by.topRows<2>().transpose() * by_motion + by.row(kTurn).transpose() * by_turn;
    rotation.col(k) = by.row(kTurn).transpose();
    work_1.col(k) = by.row(kWork).transpose();
  }
  outcome.distance.by = by_variables(x, distance);
  outcome.rotation.by = by_variables(x, rotation);
  outcome.work.by = by_variables(x, work_1 / x.dt);
  outcome.work.by.dt -= outcome.work.value / x.dt;
  return outcome;
}

}  // namespace threelink_sim

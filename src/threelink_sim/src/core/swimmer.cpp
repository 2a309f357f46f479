#include "threelink_sim/swimmer.hpp"

#include <cmath>
#include <stdexcept>

#include <Eigen/Geometry>
#include <fmt/format.h>

#include "threelink_sim/kernel/kernels.hpp"

namespace threelink_sim {
namespace {

// Unit vectors along links at the given angles, (2, N), by the kernels' sine and cosine.
Eigen::Matrix2Xd tangents(const LinkVector& angles) {
  LinkVector sine(angles.size()), cosine(angles.size());
  kernels().sincos(angles.size(), angles.data(), sine.data(), cosine.data());
  Eigen::Matrix2Xd result(2, angles.size());
  result.row(0) = cosine;
  result.row(1) = sine;
  return result;
}

// Midpoints relative to that of link 1, (2, N).
Eigen::Matrix2Xd midpoints_from_first(const Model& model, const Eigen::Matrix2Xd& t) {
  Eigen::Matrix2Xd midpoints(2, model.links);
  midpoints.col(0).setZero();
  for (int i = 1; i < model.links; ++i)
    midpoints.col(i) = midpoints.col(i - 1) + 0.5 * model.link_length() * (t.col(i - 1) + t.col(i));
  return midpoints;
}

// Quarter turn counter-clockwise: e_z x v.
Eigen::Vector2d turn(const Eigen::Vector2d& v) { return {-v.y(), v.x()}; }

double cross(const Eigen::Vector2d& a, const Eigen::Vector2d& b) {
  return a.x() * b.y() - a.y() * b.x();
}

// Link angles in the body frame.
LinkVector body_angles(const Model& model, const HingeVector& alpha) {
  SwimmerState state;
  state.alpha = alpha;
  return link_angles(model, state);
}

// Drag coefficients of a link, gamma t t + n n, per unit length.
Eigen::Matrix2d drag(const Model& model, const Eigen::Vector2d& t) {
  const Eigen::Vector2d n = turn(t);
  return model.gamma * t * t.transpose() + n * n.transpose();
}

}  // namespace

LinkVector link_angles(const Model& model, const SwimmerState& state) {
  LinkVector theta(model.links);
  const int h = model.heading_link();
  theta[h] = state.heading;
  for (int i = h + 1; i < model.links; ++i) theta[i] = theta[i - 1] + state.alpha[i - 1];
  for (int i = h - 1; i >= 0; --i) theta[i] = theta[i + 1] - state.alpha[i];
  return theta;
}

SwimmerState state_from_free_end(const Model& model, const Eigen::Vector2d& x_1, double theta_1,
                                 const HingeVector& alpha) {
  SwimmerState state;
  state.alpha = alpha;
  state.heading = theta_1;
  for (int i = 0; i < model.heading_link(); ++i) state.heading += alpha[i];
  // free_end() of the state at the origin tells how far the centroid is from x_1.
  state.centroid = x_1 - free_end(model, state);
  return state;
}

Eigen::Vector2d free_end(const Model& model, const SwimmerState& state) {
  const Eigen::Matrix2Xd t = tangents(link_angles(model, state));
  const Eigen::Vector2d mean = midpoints_from_first(model, t).rowwise().mean();
  return state.centroid - mean - 0.5 * model.link_length() * t.col(0);
}

Eigen::Matrix2Xd link_midpoints(const Model& model, const SwimmerState& state) {
  const Eigen::Matrix2Xd t = tangents(link_angles(model, state));
  const Eigen::Matrix2Xd from_first = midpoints_from_first(model, t);
  const Eigen::Vector2d shift = state.centroid - from_first.rowwise().mean();
  return from_first.colwise() + shift;
}

void validate(const Model& model, const SwimmerState& state) {
  if (!state.centroid.allFinite())
    throw std::invalid_argument(
        fmt::format("centroid = ({}, {}): must be finite", state.centroid.x(), state.centroid.y()));
  // The kernels' sine and cosine are accurate up to this angle.
  constexpr double kMaxHeading = 1e5;
  if (!(std::abs(state.heading) <= kMaxHeading))
    throw std::invalid_argument(fmt::format("heading = {}: must be within [-{}, {}] rad",
                                            state.heading, kMaxHeading, kMaxHeading));
  if (state.alpha.size() != model.hinges())
    throw std::invalid_argument(fmt::format("alpha has {} values: {} links have {} hinges",
                                            state.alpha.size(), model.links, model.hinges()));
  for (int j = 0; j < model.hinges(); ++j)
    if (!(std::abs(state.alpha[j]) <= model.joint_limit))
      throw std::invalid_argument(fmt::format("alpha_{} = {}: must be within [-{}, {}] rad", j + 1,
                                              state.alpha[j], model.joint_limit,
                                              model.joint_limit));
}

BodyMotion body_motion(const Model& model, const HingeVector& alpha, const HingeVector& rates) {
  BodyMotion motion;
  MotionArgs args;
  args.model = kernel_model(model);
  args.n = args.stride = 1;
  args.alpha = alpha.data();
  args.rates = rates.data();
  args.velocity = motion.velocity.data();
  args.spin = &motion.spin;
  args.power = &motion.power;
  kernels().motion(args);
  return motion;
}

Eigen::Matrix3d resistance_matrix(const Model& model, const HingeVector& alpha) {
  SwimmerState state;
  state.alpha = alpha;
  const Eigen::Matrix2Xd t = tangents(link_angles(model, state));
  const Eigen::Matrix2Xd midpoints = link_midpoints(model, state);
  const double l = model.link_length();
  Eigen::Matrix3d resistance = Eigen::Matrix3d::Zero();
  for (int i = 0; i < model.links; ++i) {
    const Eigen::Matrix2d d = drag(model, t.col(i));
    const Eigen::Vector2d spun = turn(midpoints.col(i));  // velocity for unit spin
    resistance.topLeftCorner<2, 2>() += l * d;
    resistance.topRightCorner<2, 1>() += l * d * spun;
    resistance(2, 2) += l * spun.dot(d * spun) + l * l * l / 12;
  }
  resistance.bottomLeftCorner<1, 2>() = resistance.topRightCorner<2, 1>().transpose();
  return resistance;
}

Eigen::Vector3d net_force_and_torque(const Model& model, const HingeVector& alpha,
                                     const HingeVector& rates, const BodyMotion& motion) {
  const Eigen::Matrix2Xd t = tangents(body_angles(model, alpha));
  const double l = model.link_length();
  const int h = model.heading_link();
  // Turning rates and midpoint velocities in the body frame, from the heading link outwards.
  LinkVector spin(model.links);
  spin[h] = motion.spin;
  for (int i = h + 1; i < model.links; ++i) spin[i] = spin[i - 1] + rates[i - 1];
  for (int i = h - 1; i >= 0; --i) spin[i] = spin[i + 1] - rates[i];
  SwimmerState state;
  state.alpha = alpha;
  const Eigen::Matrix2Xd midpoints = link_midpoints(model, state);
  Eigen::Matrix2Xd velocity(2, model.links);
  velocity.col(0).setZero();
  for (int i = 1; i < model.links; ++i)
    velocity.col(i) = velocity.col(i - 1) +
                      0.5 * l * (spin[i - 1] * turn(t.col(i - 1)) + spin[i] * turn(t.col(i)));
  const Eigen::Vector2d shift = motion.velocity - velocity.rowwise().mean();
  velocity.colwise() += shift;

  Eigen::Vector3d total = Eigen::Vector3d::Zero();
  for (int i = 0; i < model.links; ++i) {
    const Eigen::Vector2d force = -l * drag(model, t.col(i)) * velocity.col(i);
    total.head<2>() += force;
    total[2] += cross(midpoints.col(i), force) - l * l * l / 12 * spin[i];
  }
  return total;
}

StepResult advance(const Model& model, SwimmerState& state, const HingeVector& rates, double dt,
                   int substeps) {
  StepResult result;
  result.rates = rates;
  AdvanceArgs args;
  args.model = kernel_model(model);
  args.dt = dt;
  args.substeps = substeps;
  args.n = args.stride = 1;
  args.x = &state.centroid.x();
  args.y = &state.centroid.y();
  args.heading = &state.heading;
  args.alpha = state.alpha.data();
  args.rates = result.rates.data();
  args.displacement = result.displacement.data();
  args.work = &result.work;
  kernels().advance(args);
  return result;
}

}  // namespace threelink_sim

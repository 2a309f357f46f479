// The physics against figures computed elsewhere in high precision (tests/data/reference).
#include <cmath>
#include <string>

#include <Eigen/Geometry>
#include <gtest/gtest.h>

#include "reference_data.hpp"
#include "threelink_sim/reference/nine_by_nine.hpp"
#include "threelink_sim/swimmer.hpp"

namespace threelink_tests {
namespace {

using namespace threelink_sim;

// Fixed-frame velocity of x_1, from that of the centroid: differentiating free_end() by hand.
Eigen::Vector3d free_end_velocity(const Model& model, const SwimmerState& state,
                                  const HingeVector& rates) {
  const BodyMotion motion = body_motion(model, state.alpha, rates);
  LinkVector spin(model.links);
  const int h = model.heading_link();
  spin[h] = motion.spin;
  for (int i = h + 1; i < model.links; ++i) spin[i] = spin[i - 1] + rates[i - 1];
  for (int i = h - 1; i >= 0; --i) spin[i] = spin[i + 1] - rates[i];
  const LinkVector theta = link_angles(model, state);
  const double l = model.link_length();
  // x_1 = x_c - sum_i (N - i - 1/2) / N l t_i, i from 0.
  Eigen::Vector2d v = Eigen::Rotation2Dd(state.heading) * motion.velocity;
  for (int i = 0; i < model.links; ++i)
    v -= (model.links - i - 0.5) / model.links * l * spin[i] *
         Eigen::Vector2d(-std::sin(theta[i]), std::cos(theta[i]));
  return {v.x(), v.y(), spin[0]};
}

// One Runge-Kutta step of (centroid, heading, work) under angles given as functions of time; an
// integrator of the test's own, since advance() is only for constant rates.
template <class Angles>
void runge_kutta(const Model& model, SwimmerState& state, double& work, double t, double h,
                 const Angles& angles) {
  struct Slope {
    Eigen::Vector2d velocity;
    double spin, power;
  };
  const auto slope = [&](double time, double heading) {
    HingeVector alpha, rates;
    angles(time, alpha, rates);
    const BodyMotion motion = body_motion(model, alpha, rates);
    return Slope{Eigen::Rotation2Dd(heading) * motion.velocity, motion.spin, motion.power};
  };
  const Slope k1 = slope(t, state.heading);
  const Slope k2 = slope(t + h / 2, state.heading + h / 2 * k1.spin);
  const Slope k3 = slope(t + h / 2, state.heading + h / 2 * k2.spin);
  const Slope k4 = slope(t + h, state.heading + h * k3.spin);
  state.centroid += h / 6 * (k1.velocity + 2 * k2.velocity + 2 * k3.velocity + k4.velocity);
  state.heading += h / 6 * (k1.spin + 2 * k2.spin + 2 * k3.spin + k4.spin);
  work += h / 6 * (k1.power + 2 * k2.power + 2 * k3.power + k4.power);
  HingeVector rates;
  angles(t + h, state.alpha, rates);
}

// Velocities are of order 0.1 and the 3x3 system's condition is below 1e3: 1e-13 leaves a margin of
// ten over 1e3 * 1e-16 * 0.1.
constexpr double kVelocityTolerance = 1e-13;

TEST(SwimmerReference, VelocitiesOfThreeLinks) {
  const Model model;
  const auto samples = reference("velocities", "samples");
  ASSERT_EQ(samples.size(), 110u);
  for (const auto& s : samples) {
    HingeVector alpha(2), rates(2);
    alpha << s["alpha1"].get<double>(), s["alpha2"].get<double>();
    rates << s["alpha1dot"].get<double>(), s["alpha2dot"].get<double>();
    const SwimmerState state =
        state_from_free_end(model, point(s["x1"], s["y1"]), s["theta1"], alpha);
    const Eigen::Vector3d v = free_end_velocity(model, state, rates);
    EXPECT_NEAR(v[0], value(s["x1dot"]), kVelocityTolerance);
    EXPECT_NEAR(v[1], value(s["y1dot"]), kVelocityTolerance);
    EXPECT_NEAR(v[2], value(s["theta1dot"]), kVelocityTolerance);
    const BodyMotion motion = body_motion(model, alpha, rates);
    const Eigen::Vector2d centroid_velocity = Eigen::Rotation2Dd(state.heading) * motion.velocity;
    EXPECT_NEAR(centroid_velocity.x(), value(s["xcdot"]), kVelocityTolerance);
    EXPECT_NEAR(centroid_velocity.y(), value(s["ycdot"]), kVelocityTolerance);
    EXPECT_NEAR(motion.spin, value(s["theta2dot"]), kVelocityTolerance);
    EXPECT_NEAR(motion.power, value(s["Phi"]), kVelocityTolerance);
  }
}

TEST(SwimmerReference, VelocitiesOfManyLinks) {
  const auto samples = reference("n_link", "random_samples");
  ASSERT_EQ(samples.size(), 24u);
  for (const auto& s : samples) {
    Model model;
    model.links = s["N"];
    const HingeVector alpha = hinges(s["alpha"]), rates = hinges(s["alphadot"]);
    const SwimmerState state = state_from_free_end(model, {0, 0}, s["theta1"], alpha);
    const Eigen::Vector3d v = free_end_velocity(model, state, rates);
    EXPECT_NEAR(v[0], value(s["x1dot"]), kVelocityTolerance) << model.links << " links";
    EXPECT_NEAR(v[1], value(s["y1dot"]), kVelocityTolerance) << model.links << " links";
    EXPECT_NEAR(v[2], value(s["theta1dot"]), kVelocityTolerance) << model.links << " links";
    EXPECT_NEAR(body_motion(model, alpha, rates).power, value(s["Phi"]), kVelocityTolerance);
  }
}

// Angles are smooth, so that 2000 Runge-Kutta steps a period leave (2 pi / 2000)^4 ~ 1e-10 times
// the pose's scale of 0.1, well below the tolerance.
constexpr int kRungeKuttaSteps = 2000;
constexpr double kPathTolerance = 1e-10;

TEST(SwimmerReference, TravellingWavesOfManyLinks) {
  const auto gaits = reference("n_link", "gaits");
  ASSERT_EQ(gaits.size(), 6u);
  for (const auto& gait : gaits) {
    Model model;
    model.links = gait["N"];
    ASSERT_EQ(gait["phi"], "2*pi/" + std::to_string(model.links));
    const double amplitude = gait["A"], phase = 2 * kPi / model.links, offset = gait["offset"];
    const auto angles = [&](double t, HingeVector& alpha, HingeVector& rates) {
      alpha.resize(model.hinges());
      rates.resize(model.hinges());
      for (int j = 0; j < model.hinges(); ++j) {
        alpha[j] = offset + amplitude * std::cos(t - phase * j);
        rates[j] = -amplitude * std::sin(t - phase * j);
      }
    };
    HingeVector alpha, rates;
    angles(0, alpha, rates);
    SwimmerState state = state_from_free_end(model, {0, 0}, 0, alpha);
    double work = 0;
    const double h = 2 * kPi / kRungeKuttaSteps;
    for (int k = 0; k < kRungeKuttaSteps; ++k) runge_kutta(model, state, work, k * h, h, angles);
    const Eigen::Vector2d x_1 = free_end(model, state);
    EXPECT_NEAR(x_1.x(), value(gait["x1"]), kPathTolerance) << model.links << " links";
    EXPECT_NEAR(x_1.y(), value(gait["y1"]), kPathTolerance) << model.links << " links";
    EXPECT_NEAR(link_angles(model, state)[0], value(gait["theta1"]), kPathTolerance);
    EXPECT_NEAR(work, value(gait["work"]), kPathTolerance);
  }
}

TEST(SwimmerReference, FourierAngles) {
  const Model model;
  const auto trajectories = reference("fourier_trajectories", "trajectories");
  ASSERT_EQ(trajectories.size(), 10u);
  for (const auto& trajectory : trajectories) {
    const double omega = trajectory["omega"], duration = trajectory["T"];
    const auto angles = [&](double t, HingeVector& alpha, HingeVector& rates) {
      alpha.resize(2);
      rates.setZero(2);
      for (int j = 0; j < 2; ++j) {
        const auto& series = trajectory[j == 0 ? "alpha1" : "alpha2"];
        alpha[j] = series["a0"];
        for (std::size_t k = 1; k <= series["a"].size(); ++k) {
          const double a = series["a"][k - 1], b = series["b"][k - 1], w = k * omega;
          alpha[j] += a * std::cos(w * t) + b * std::sin(w * t);
          rates[j] += w * (b * std::cos(w * t) - a * std::sin(w * t));
        }
      }
    };
    HingeVector alpha, rates;
    angles(0, alpha, rates);
    SwimmerState state = state_from_free_end(model, point(trajectory["x1"], trajectory["y1"]),
                                             trajectory["theta1"], alpha);
    double work = 0;
    const double h = duration / kRungeKuttaSteps;
    for (int k = 0; k < kRungeKuttaSteps; ++k) runge_kutta(model, state, work, k * h, h, angles);
    const auto& end = trajectory["final"];
    EXPECT_NEAR(state.centroid.x(), value(end["xc"]), kPathTolerance);
    EXPECT_NEAR(state.centroid.y(), value(end["yc"]), kPathTolerance);
    EXPECT_NEAR(state.heading, value(end["theta2"]), kPathTolerance);
    EXPECT_NEAR(work, value(trajectory["work"]), kPathTolerance);
  }
}

TEST(SwimmerReference, PiecewiseConstantRates) {
  // 60 steps with an error near 1e-13 each (see substeps()).
  constexpr double kTolerance = 1e-11;
  const auto runs = reference("zero_order_hold", "runs");
  ASSERT_EQ(runs.size(), 8u);
  for (const auto& run : runs) {
    Model model;
    model.links = run["links"];
    model.gamma = run["gamma"];
    const double dt = run["dt"];
    const auto& start = run["start"];
    SwimmerState state = state_from_free_end(model, point(start["x1"], start["y1"]),
                                             start["theta1"], hinges(start["alpha"]));
    double work = 0;
    for (const auto& rates : run["rates"])
      work += advance(model, state, hinges(rates), dt, substeps(model, dt, 1.0)).work;
    const auto& end = run["final"];
    EXPECT_NEAR(free_end(model, state).x(), end["x1"].get<double>(), kTolerance);
    EXPECT_NEAR(free_end(model, state).y(), end["y1"].get<double>(), kTolerance);
    EXPECT_NEAR(state.centroid.x(), end["xc"].get<double>(), kTolerance);
    EXPECT_NEAR(state.centroid.y(), end["yc"].get<double>(), kTolerance);
    for (int i = 0; i < model.links; ++i)
      EXPECT_NEAR(link_angles(model, state)[i], end["theta"][i].get<double>(), kTolerance);
    EXPECT_NEAR(work, end["work"].get<double>(), kTolerance);
  }
}

TEST(SwimmerReference, SquareStrokes) {
  const Model model;
  constexpr int kStepsALeg = 30;
  const auto strokes = reference("strokes", "strokes");
  ASSERT_EQ(strokes.size(), 3u);
  for (const auto& stroke : strokes) {
    const double low = value(stroke["lo"]), high = value(stroke["hi"]);
    const double dt = (high - low) / kStepsALeg;
    SwimmerState state;
    state.alpha = HingeVector::Constant(2, low);
    double work = 0;
    // Clockwise in the plane of (alpha_1, alpha_2) from (lo, lo): hinge 2 moves first.
    const int first = stroke["order"] == "CW" ? 1 : 0;
    for (int leg = 0; leg < 4; ++leg) {
      HingeVector rates = HingeVector::Zero(2);
      rates[leg % 2 == 0 ? first : 1 - first] = leg < 2 ? 1 : -1;
      for (int k = 0; k < kStepsALeg; ++k) work += advance(model, state, rates, dt, 1).work;
    }
    EXPECT_NEAR(state.centroid.x(), value(stroke["dx_centroid"]), 1e-12);
    EXPECT_NEAR(state.centroid.y(), value(stroke["dy_centroid"]), 1e-12);
    EXPECT_NEAR(state.heading, value(stroke["net_rotation"]), 1e-12);
    EXPECT_NEAR(work, value(stroke["work_per_cycle"]), 1e-12);
  }
}

// The reduced system against the paper's own 9x9 one, for several gamma.
TEST(SwimmerReference, NineByNineSystem) {
  const auto samples = reference("velocities", "samples");
  ASSERT_EQ(samples.size(), 110u);
  for (double gamma : {0.3, 0.5, 0.8, 1.5}) {
    Model model;
    model.gamma = gamma;
    for (const auto& s : samples) {
      HingeVector alpha(2), rates(2);
      alpha << s["alpha1"].get<double>(), s["alpha2"].get<double>();
      rates << s["alpha1dot"].get<double>(), s["alpha2dot"].get<double>();
      const double x_1 = s["x1"], y_1 = s["y1"], theta_1 = s["theta1"];
      const SwimmerState state = state_from_free_end(model, {x_1, y_1}, theta_1, alpha);
      const auto ends = reference::left_ends(x_1, y_1, theta_1, alpha[0], alpha[1]);
      const auto v = reference::velocities(ends, gamma, rates[0], rates[1]);
      const Eigen::Vector3d mine = free_end_velocity(model, state, rates);
      EXPECT_NEAR(mine[0], v[0], kVelocityTolerance);
      EXPECT_NEAR(mine[1], v[3], kVelocityTolerance);
      EXPECT_NEAR(mine[2], v[6], kVelocityTolerance);
      EXPECT_NEAR(body_motion(model, alpha, rates).power, reference::power(ends, gamma, v),
                  kVelocityTolerance);
    }
  }
}

}  // namespace
}  // namespace threelink_tests

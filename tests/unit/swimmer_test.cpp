// The physics by its laws: invariances, balance of force and torque, dissipation, scallop theorem.
#include "threelink_sim/swimmer.hpp"

#include <cmath>
#include <vector>

#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>
#include <gtest/gtest.h>

#include "threelink_sim/environment.hpp"
#include "threelink_sim/random.hpp"

namespace threelink_tests {
namespace {

using namespace threelink_sim;

Model model_of(int links, double gamma = 0.5) {
  Model model;
  model.links = links;
  model.gamma = gamma;
  return model;
}

HingeVector random_rates(Random& random, int hinges) {
  HingeVector rates(hinges);
  for (int i = 0; i < hinges; ++i) rates[i] = random.uniform(-1, 1);
  return rates;
}

// A random state within half the joint limit, so that a stroke of some steps meets no limit.
SwimmerState random_state(Random& random, const Model& model) {
  SwimmerState state;
  state.centroid = {random.uniform(-1, 1), random.uniform(-1, 1)};
  state.heading = random.uniform(-kPi, kPi);
  state.alpha.resize(model.hinges());
  for (int i = 0; i < model.hinges(); ++i) state.alpha[i] = random.uniform(-1, 1);
  return state;
}

StepResult step(const Model& model, SwimmerState& state, const HingeVector& rates) {
  return advance(model, state, rates, 0.1, substeps(model, 0.1, 1.0));
}

TEST(Swimmer, NoNetForceAndTorque) {
  Random random(1, Stream::kStart, 0);
  for (int links = 2; links <= 12; ++links)
    for (int k = 0; k < 1000; ++k) {
      const Model model = model_of(links, random.uniform(0.1, 2.0));
      const SwimmerState state = random_start(model, links, k);
      const HingeVector rates = random_rates(random, model.hinges());
      const BodyMotion motion = body_motion(model, state.alpha, rates);
      const Eigen::Vector3d net = net_force_and_torque(model, state.alpha, rates, motion);
      EXPECT_LT(net.cwiseAbs().maxCoeff(), 1e-12) << links << " links";
    }
}

TEST(Swimmer, NetForceNoticesAWrongMotion) {
  const Model model;
  const HingeVector alpha = HingeVector::Constant(2, 0.3), rates = HingeVector::Constant(2, 0.5);
  BodyMotion motion = body_motion(model, alpha, rates);
  motion.velocity.x() += 0.01;
  EXPECT_GT(net_force_and_torque(model, alpha, rates, motion).norm(), 1e-3);
}

TEST(Swimmer, DissipationIsPositive) {
  Random random(2, Stream::kStart, 0);
  for (int k = 0; k < 1000; ++k) {
    const Model model = model_of(3);
    const SwimmerState state = random_start(model, 2, k);
    const HingeVector rates = random_rates(random, 2);
    EXPECT_GT(body_motion(model, state.alpha, rates).power, 0);
  }
  EXPECT_EQ(body_motion(model_of(3), HingeVector::Constant(2, 1.0), HingeVector::Zero(2)).power, 0);
}

TEST(Swimmer, TowingTheStraightSwimmerCostsGammaVSquared) {
  for (double gamma : {0.2, 0.5, 1.3})
    for (int links : {2, 3, 7}) {
      const Model model = model_of(links, gamma);
      const Eigen::Matrix3d k = resistance_matrix(model, HingeVector::Zero(model.hinges()));
      const double v = 0.7;
      EXPECT_NEAR(k(0, 0) * v * v, gamma * v * v, 1e-15);
      // Broadside, and turning about the centre: C_perp L and C_perp L^3 / 12.
      EXPECT_NEAR(k(1, 1), 1.0, 1e-15);
      EXPECT_NEAR(k(2, 2), 1.0 / 12, 1e-15);
    }
}

TEST(Swimmer, ResistanceIsSymmetricPositiveDefinite) {
  for (int k = 0; k < 200; ++k) {
    const Model model = model_of(2 + k % 7);
    const Eigen::Matrix3d resistance = resistance_matrix(model, random_start(model, 3, k).alpha);
    EXPECT_TRUE(resistance.isApprox(resistance.transpose(), 1e-15));
    EXPECT_GT(Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(resistance).eigenvalues()[0], 0);
  }
}

TEST(Swimmer, ForwardAndBackwardLeadsBack) {
  // Scallop theorem: a stroke that retraces its shapes gives no net motion, at any rates.
  Random random(4, Stream::kStart, 0);
  for (int links : {2, 3, 5}) {
    const Model model = model_of(links);
    const SwimmerState start = random_state(random, model);
    SwimmerState state = start;
    std::vector<HingeVector> rates;
    for (int k = 0; k < 10; ++k) {
      rates.push_back(random_rates(random, model.hinges()));
      step(model, state, rates.back());
    }
    EXPECT_GT((state.centroid - start.centroid).norm(), 1e-5);
    // Backwards at half the speed and twice the time.
    for (int k = 9; k >= 0; --k)
      advance(model, state, -0.5 * rates[k], 0.2, substeps(model, 0.2, 0.5));
    EXPECT_LT((state.centroid - start.centroid).norm(), 1e-12);
    EXPECT_NEAR(state.heading, start.heading, 1e-12);
  }
}

TEST(Swimmer, OneHingeCannotSwim) {
  const Model model = model_of(2);
  SwimmerState state;
  state.alpha = HingeVector::Constant(1, -0.8);
  const SwimmerState start = state;
  // Out fast, back slowly in uneven steps: every cycle of one hinge is reciprocal.
  for (int k = 0; k < 16; ++k) step(model, state, HingeVector::Constant(1, 1.0));
  for (int k = 0; k < 32; ++k)
    step(model, state, HingeVector::Constant(1, k % 2 == 0 ? -0.7 : -0.3));
  EXPECT_NEAR(state.alpha[0], start.alpha[0], 1e-13);
  EXPECT_LT((state.centroid - start.centroid).norm(), 1e-10);
  EXPECT_NEAR(state.heading, start.heading, 1e-10);
}

TEST(Swimmer, MovesTheSameInEveryFrame) {
  Random random(5, Stream::kStart, 0);
  const Model model;
  for (int k = 0; k < 100; ++k) {
    SwimmerState state = random_state(random, model);
    const double turn = random.uniform(-kPi, kPi);
    const Eigen::Vector2d shift(random.uniform(-5, 5), random.uniform(-5, 5));
    const Eigen::Rotation2Dd rotation(turn);
    SwimmerState moved = state;
    moved.centroid = rotation * state.centroid + shift;
    moved.heading += turn;
    const HingeVector rates = random_rates(random, 2);
    const double work = step(model, state, rates).work;
    EXPECT_NEAR(step(model, moved, rates).work, work, 1e-16);
    EXPECT_LT((moved.centroid - (rotation * state.centroid + shift)).norm(), 1e-14);
    EXPECT_NEAR(moved.heading, state.heading + turn, 1e-14);
  }
}

TEST(Swimmer, MirrorImageMovesAsTheMirrorImage) {
  Random random(6, Stream::kStart, 0);
  for (int links : {3, 4}) {
    const Model model = model_of(links);
    SwimmerState state = random_state(random, model);
    SwimmerState mirrored = state;
    mirrored.centroid.y() *= -1;
    mirrored.heading *= -1;
    mirrored.alpha *= -1;
    const HingeVector rates = random_rates(random, model.hinges());
    step(model, state, rates);
    step(model, mirrored, -rates);
    EXPECT_NEAR(mirrored.centroid.x(), state.centroid.x(), 1e-16);
    EXPECT_NEAR(mirrored.centroid.y(), -state.centroid.y(), 1e-16);
    EXPECT_NEAR(mirrored.heading, -state.heading, 1e-15);
  }
}

TEST(Swimmer, SwappingTheEndsChangesNothing) {
  // Numbering the links from the other end turns each by pi: alpha'_j = -alpha_{N-j}.
  Random random(7, Stream::kStart, 0);
  const Model model;
  for (int k = 0; k < 100; ++k) {
    SwimmerState state = random_state(random, model);
    SwimmerState swapped = state;
    swapped.heading += kPi;
    swapped.alpha = -state.alpha.reverse();
    const HingeVector rates = random_rates(random, 2);
    const HingeVector swapped_rates = -rates.reverse();
    step(model, state, rates);
    step(model, swapped, swapped_rates);
    EXPECT_LT((swapped.centroid - state.centroid).norm(), 1e-15);
    EXPECT_NEAR(swapped.heading, state.heading + kPi, 1e-14);
  }
}

TEST(Swimmer, StepIsOfSixthOrder) {
  const Model model;
  SwimmerState start;
  start.alpha = HingeVector::Zero(2);
  start.alpha << 0.7, -0.4;
  const HingeVector rates = (HingeVector(2) << 0.9, 0.6).finished();
  const auto end = [&](int substeps) {
    SwimmerState state = start;
    advance(model, state, rates, 0.6, substeps);
    return state.centroid;
  };
  const Eigen::Vector2d exact = end(24);
  const double coarse = (end(2) - exact).norm(), fine = (end(4) - exact).norm();
  // Halving the step divides the error by 2^6.
  EXPECT_NEAR(std::log2(coarse / fine), 6.0, 0.5);
}

TEST(Swimmer, SubstepsKeepManyLinksExact) {
  // 60 steps against the same ones in eight times as many substeps, whose error is 8^6 times
  // smaller.
  Random random(10, Stream::kStart, 0);
  for (int links : {2, 3, 4, 5, 6, 8, 12, 20, 32}) {
    const Model model = model_of(links);
    const int sub = substeps(model, 0.1, 1.0);
    SwimmerState state = random_state(random, model), exact = state;
    double work = 0, exact_work = 0;
    for (int k = 0; k < 60; ++k) {
      const HingeVector rates = random_rates(random, model.hinges());
      work += advance(model, state, rates, 0.1, sub).work;
      exact_work += advance(model, exact, rates, 0.1, 8 * sub).work;
    }
    const double error =
        std::max({(state.centroid - exact.centroid).norm(), std::abs(state.heading - exact.heading),
                  std::abs(work - exact_work)});
    EXPECT_LT(error, 1e-10) << links << " links";
  }
}

TEST(Swimmer, LandsExactlyOnTheJointLimit) {
  const Model model;
  for (double sign : {1.0, -1.0}) {
    SwimmerState state;
    state.alpha = HingeVector::Zero(2);
    state.alpha[0] = sign * (model.joint_limit - 0.03);
    const HingeVector rates = (HingeVector(2) << sign * 1.0, 0.2).finished();
    const StepResult result = step(model, state, rates);
    EXPECT_EQ(state.alpha[0], sign * model.joint_limit);
    EXPECT_NEAR(result.rates[0], sign * 0.3, 1e-12);
    EXPECT_EQ(result.rates[1], 0.2);
    EXPECT_EQ(step(model, state, rates).rates[0], 0.0);
    EXPECT_EQ(state.alpha[0], sign * model.joint_limit);
  }
}

TEST(Swimmer, NeverPassesTheJointLimit) {
  const Model model;
  Random random(8, Stream::kStart, 0);
  SwimmerState state;
  state.alpha = HingeVector::Zero(2);
  double largest = 0;
  for (int k = 0; k < 100000; ++k) {
    // Rates that keep their sign for a while reach the limits often.
    const double bias = (k / 50) % 2 == 0 ? 0.5 : -0.5;
    HingeVector rates = random_rates(random, 2);
    rates.array() += bias;
    step(model, state, rates);
    largest = std::max(largest, state.alpha.cwiseAbs().maxCoeff());
  }
  EXPECT_EQ(largest, model.joint_limit);
  EXPECT_TRUE(state.centroid.allFinite());
}

TEST(Swimmer, CoordinatesConvertBackAndForth) {
  Random random(9, Stream::kStart, 0);
  for (int links = 2; links <= 9; ++links) {
    const Model model = model_of(links);
    const SwimmerState state = random_state(random, model);
    const LinkVector theta = link_angles(model, state);
    EXPECT_EQ(theta[model.heading_link()], state.heading);
    const SwimmerState again =
        state_from_free_end(model, free_end(model, state), theta[0], state.alpha);
    EXPECT_LT((again.centroid - state.centroid).norm(), 1e-15);
    EXPECT_NEAR(again.heading, state.heading, 1e-14);
    EXPECT_LT((link_midpoints(model, state).rowwise().mean() - state.centroid).norm(), 1e-15);
  }
}

TEST(Swimmer, RefusesStatesThatAreNone) {
  const Model model;
  SwimmerState state;
  state.alpha = HingeVector::Zero(2);
  EXPECT_NO_THROW(validate(model, state));
  const auto refused = [&](const SwimmerState& wrong, const std::string& field) {
    try {
      validate(model, wrong);
      ADD_FAILURE() << field << " was accepted";
    } catch (const std::invalid_argument& error) {
      EXPECT_NE(std::string(error.what()).find(field), std::string::npos) << error.what();
    }
  };
  SwimmerState wrong = state;
  wrong.centroid.x() = NAN;
  refused(wrong, "centroid");
  wrong = state;
  wrong.heading = INFINITY;
  refused(wrong, "heading");
  wrong = state;
  wrong.alpha = HingeVector::Zero(3);
  refused(wrong, "hinges");
  wrong = state;
  wrong.alpha[1] = 2.2;
  refused(wrong, "alpha_2 = 2.2");
  wrong.alpha[1] = NAN;
  refused(wrong, "alpha_2");
}

TEST(Model, RefusesValuesOutOfBounds) {
  const auto refused = [](Model model, const std::string& field) {
    try {
      model.validate();
      ADD_FAILURE() << field << " was accepted";
    } catch (const std::invalid_argument& error) {
      EXPECT_NE(std::string(error.what()).find(field), std::string::npos) << error.what();
    }
  };
  Model model;
  EXPECT_NO_THROW(model.validate());
  model.links = 1;
  refused(model, "links = 1");
  model.links = kMaxLinks + 1;
  refused(model, "links");
  model = Model();
  model.gamma = 0;
  refused(model, "gamma");
  model.gamma = NAN;
  refused(model, "gamma");
  model = Model();
  model.joint_limit = 4;
  refused(model, "joint_limit");
}

}  // namespace
}  // namespace threelink_tests

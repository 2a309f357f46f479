// Thermal motion against the theory of the diffusion of a rigid body.
#include <cmath>
#include <vector>

#include <gtest/gtest.h>

#include "small_world.hpp"
#include "threelink_sim/environment.hpp"

namespace threelink_tests {
namespace {

using namespace threelink_sim;

constexpr double kT = 1e-3;
constexpr std::size_t kSwimmers = 20'000;

struct Statistics {
  double xx = 0, yy = 0, rr = 0, cosine = 0;
};

// Locked swimmers that begin at the origin with heading 0: means at the time t.
Statistics diffuse(const HingeVector& alpha, double dt, double t) {
  EnvironmentConfig config;
  config.dt = dt;
  config.world = world_of("thermal_noise: 1.0e-3");
  Environment environment(config, kSwimmers);
  SwimmerState start;
  start.alpha = alpha;
  for (std::size_t i = 0; i < kSwimmers; ++i)
    environment.reset(i, start, {5, static_cast<std::uint32_t>(i)});
  const std::vector<double> none(2 * kSwimmers, 0.0);
  for (int k = 0; k < std::lround(t / dt); ++k) environment.step(none.data());
  Statistics mean;
  for (std::size_t i = 0; i < kSwimmers; ++i) {
    const Eigen::Vector2d x = environment.centroid(i);
    mean.xx += x.x() * x.x() / kSwimmers;
    mean.yy += x.y() * x.y() / kSwimmers;
    mean.rr += x.squaredNorm() / kSwimmers;
    mean.cosine += std::cos(environment.batch().heading()[i]) / kSwimmers;
  }
  return mean;
}

// D_parallel = 2 kT, D_perp = kT, D_r = 12 kT of the straight swimmer give
// <x^2>, <y^2> = 3 kT t +- kT (1 - exp(-4 D_r t)) / (4 D_r) and <cos theta> = exp(-D_r t).
TEST(Thermal, StraightSwimmerDiffusesAsARod) {
  for (const double dt : {0.1, 0.5})
    for (const double t : {5.0, 40.0}) {
      const Statistics mean = diffuse(HingeVector::Zero(2), dt, t);
      const double turn = 12 * kT;
      const double difference = kT * (1 - std::exp(-4 * turn * t)) / (4 * turn);
      // A mean square of n normals scatters by sqrt(2 / n) of itself; four standard errors.
      const double error = 4 * std::sqrt(2.0 / kSwimmers);
      EXPECT_NEAR(mean.xx / (3 * kT * t + difference), 1, error) << dt << " " << t;
      EXPECT_NEAR(mean.yy / (3 * kT * t - difference), 1, error) << dt << " " << t;
      EXPECT_NEAR(mean.cosine, std::exp(-turn * t), 4 / std::sqrt(kSwimmers));
    }
}

// Bent, the centroid lies beside the centre of mobility, about which turning and moving are
// independent: <r^2> = 2 (D_par + D_perp) t + 2 |c_m - c|^2 (1 - exp(-D_r t)).
TEST(Thermal, BentSwimmerDiffusesAboutItsCentreOfMobility) {
  HingeVector alpha(2);
  alpha << 1, 1;
  const double t = 400;
  const Statistics mean = diffuse(alpha, 0.5, t);
  const double theory =
      2 * kT * (1.35865 + 1.30894) * t + 2 * 0.06785 * 0.06785 * (1 - std::exp(-24.63628 * kT * t));
  // <r^2> of two independent components scatters by 1 / sqrt(n) of itself: 0.7 % here. An error of
  // the drift would be 4 %.
  EXPECT_NEAR(mean.rr / theory, 1, 3 / std::sqrt(kSwimmers));
}

TEST(Thermal, IsKeyedByEpisodeAndStepAlone) {
  EnvironmentConfig config;
  config.world = world_of("thermal_noise: 1.0e-4");
  SwimmerState start;
  start.alpha = HingeVector::Zero(2);
  const auto end_of = [&](std::uint64_t seed, std::uint32_t episode, std::size_t lanes) {
    Environment environment(config, lanes);
    const std::size_t lane = lanes - 1;
    environment.reset(lane, start, {seed, episode});
    const std::vector<double> rates(2 * lanes, 0.3);
    for (int k = 0; k < 10; ++k) environment.step(rates.data());
    return environment.centroid(lane);
  };
  EXPECT_EQ(end_of(1, 4, 1), end_of(1, 4, 9));
  EXPECT_NE(end_of(1, 4, 1), end_of(1, 5, 1));
  EXPECT_NE(end_of(1, 4, 1), end_of(2, 4, 1));
}

}  // namespace
}  // namespace threelink_tests

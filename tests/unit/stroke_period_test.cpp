// The period of strokes of which it is known.
#include "threelink_sim/stroke_period.hpp"

#include <cmath>

#include <gtest/gtest.h>

#include "threelink_sim/model.hpp"
#include "threelink_sim/random.hpp"

namespace threelink_tests {
namespace {

using namespace threelink_sim;

// A wave that runs along the hinges, around a shape that is bent: as a sine, or with hinges that
// turn at one speed to and fro, as those of fast strokes do.
Eigen::MatrixXd wave(int hinges, double period, int states, bool triangle) {
  Eigen::MatrixXd angles(hinges, states);
  for (int k = 0; k < states; ++k)
    for (int j = 0; j < hinges; ++j) {
      const double phase = 2 * kPi * (k / period + 0.17 * j);
      const double swing = triangle ? std::asin(std::cos(phase)) * 2 / kPi : std::cos(phase);
      angles(j, k) = 0.1 * j - 0.2 + (1 - 0.05 * j) * swing;
    }
  return angles;
}

TEST(StrokePeriod, IsThatOfAKnownStroke) {
  for (int links = 3; links <= 8; ++links)
    for (double period : {20.3, 32.17, 41.72, 55.04, 72.0, 116.4})
      for (bool triangle : {false, true}) {
        const Eigen::MatrixXd angles = wave(links - 1, period, 501, triangle);
        EXPECT_NEAR(stroke_period(angles), period, 2e-3 * period) << links << " " << triangle;
        const WholeStrokes strokes = whole_strokes(in_stroke_plane(angles));
        EXPECT_EQ(strokes.count, std::floor(500 / period)) << links << " " << period;
      }
}

TEST(StrokePeriod, DoesNotDependOnWhereAndHowTheShapeIsSeen) {
  // Counted from the other end, in a mirror, and later: the same stroke.
  const Eigen::MatrixXd angles = wave(5, 41.72, 601, true);
  const double period = stroke_period(angles.leftCols(501));
  EXPECT_NEAR(stroke_period(-angles.leftCols(501).colwise().reverse()), period, 1e-9);
  EXPECT_NEAR(stroke_period(-angles.leftCols(501)), period, 1e-9);
  EXPECT_NEAR(stroke_period(angles.rightCols(501)), period, 0.05);
}

TEST(StrokePeriod, ThreeLinksAreSeenAsTheyAre) {
  const Eigen::MatrixXd angles = wave(2, 72, 501, false);
  EXPECT_EQ(in_stroke_plane(angles), angles);
}

TEST(StrokePeriod, ThereIsNoneWithoutAStroke) {
  for (int hinges : {1, 2, 3, 5, 7}) {
    EXPECT_TRUE(std::isnan(stroke_period(Eigen::MatrixXd::Constant(hinges, 501, 0.3)))) << hinges;
    // To and fro on one line.
    Eigen::MatrixXd line(hinges, 501);
    for (int k = 0; k < 501; ++k) line.col(k).setConstant(std::sin(0.1 * k));
    EXPECT_TRUE(std::isnan(stroke_period(line))) << hinges;
    const WholeStrokes strokes = whole_strokes(in_stroke_plane(line));
    EXPECT_EQ(strokes.count, 0);
    EXPECT_EQ(strokes.steps, 500);
  }
}

TEST(Smoothing, IsTheOddNumberNextToThePeriod) {
  for (int hinges = 3; hinges <= 7; ++hinges) {
    EXPECT_EQ(smoothing(wave(hinges, 41.72, 501, true)), 41);
    EXPECT_EQ(smoothing(wave(hinges, 55.04, 501, true)), 55);
    EXPECT_EQ(smoothing(wave(hinges, 32.17, 501, false)), 33);
    EXPECT_EQ(smoothing(Eigen::MatrixXd::Constant(hinges, 501, 0.3)), kSmoothing);
  }
}

TEST(Smoothing, IsFixedForThreeLinks) {
  EXPECT_EQ(smoothing(wave(2, 41.72, 501, true)), 71);
  EXPECT_EQ(smoothing(wave(2, 72, 501, false)), 71);
}

}  // namespace
}  // namespace threelink_tests

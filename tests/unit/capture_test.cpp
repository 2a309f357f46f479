// When a swimmer has reached a point: at the ends of steps, and between them.
#include "threelink_sim/task/capture.hpp"

#include <limits>
#include <stdexcept>

#include <gtest/gtest.h>

namespace {

using Eigen::Vector2d;
using threelink_sim::Capture;
using threelink_sim::CaptureParameters;
using threelink_sim::segment_distance;

TEST(SegmentDistance, IsThatOfTheNearestPoint) {
  const Vector2d from(1, 1), to(4, 5);                                // of length 5
  EXPECT_DOUBLE_EQ(segment_distance(from, to, {1 - 3, 1 - 4}), 5);    // behind the start
  EXPECT_DOUBLE_EQ(segment_distance(from, to, {4 + 3, 5 + 4}), 5);    // beyond the end
  EXPECT_DOUBLE_EQ(segment_distance(from, to, {2.5 + 4, 3 - 3}), 5);  // beside the middle
  EXPECT_DOUBLE_EQ(segment_distance(from, to, {2.5, 3}), 0);          // on it
  EXPECT_DOUBLE_EQ(segment_distance(from, from, {1, 3}), 2);          // a segment without length
}

TEST(CaptureTest, IsStrictlyBelowTheThreshold) {
  Capture capture({0.25, false});
  EXPECT_FALSE(capture.captured({0, 0}, {0.25, 0}));
  EXPECT_TRUE(capture.captured({0, 0}, {0, std::nextafter(0.25, 0)}));
}

TEST(CaptureTest, LooksBetweenStepsOnlyIfAsked) {
  const Vector2d target(0, 0);
  for (const bool between_steps : {false, true}) {
    Capture capture({0.1, between_steps});
    EXPECT_FALSE(capture.captured({-1, 0.05}, target));
    EXPECT_EQ(capture.captured({1, 0.05}, target), between_steps);
    // Straight on, away from it.
    EXPECT_FALSE(capture.captured({2, 0.05}, target));
  }
}

TEST(CaptureTest, ForgetsTheLastEpisodesEnd) {
  Capture capture({0.1, true});
  EXPECT_FALSE(capture.captured({-1, 0}, {0, 0}));
  capture.reset();
  EXPECT_FALSE(capture.captured({1, 0}, {0, 0}));
}

TEST(CaptureTest, RefusesAThresholdThatIsNone) {
  for (const double threshold : {0.0, -1.0, std::numeric_limits<double>::infinity(),
                                 std::numeric_limits<double>::quiet_NaN()})
    EXPECT_THROW(Capture({threshold, false}), std::invalid_argument) << threshold;
}

}  // namespace

/// @file
/// The paper's measures of a policy: speed, efficiency and success of navigation.
///
/// kEvaluationSteps steps with the mean action towards theta_T = 0. The centroid's path is smoothed
/// by the mean of about a stroke's positions, as many before as after (threelink_sim::smoothing()
/// of the last kSteadySteps steps): 71 of three links, so that it reaches from step 35 to step
/// 1465; of other numbers as many as the stroke turns out to take. theta_s(k) is the angle of the
/// smoothed path from step k to step k + 1. Steering ends at the first step with |theta_s| <= 2.5
/// degrees; the translation stage is all that follows.
///
/// Speed and power are means over the steady window: the last kSteadySteps steps of the smoothed
/// path, cut at their beginning to whole strokes. A stroke is one turn of the shape around its mean
/// over these steps (stroke_period.hpp); where it makes no turn, the window is all of them. A
/// swimmer that is stuck has speed 0 and no period.
#pragma once

#include <cstdint>
#include <vector>

#include <Eigen/Core>

#include "threelink_agent/policy.hpp"
#include "threelink_sim/swimmer.hpp"

namespace threelink_agent {

/// Steps of an evaluation.
constexpr int kEvaluationSteps = 1500;
constexpr double kTranslationAngle = 2.5 * threelink_sim::kPi / 180;  ///< [rad]
/// [steps] at the end of an evaluation, over which the measures are taken.
constexpr int kSteadySteps = 500;
/// [L/T0] A lower speed counts as stuck. It is less than 1 % of the optimum, 0.0129; the direction
/// of such a path has no meaning.
constexpr double kStuckSpeed = 1e-4;

/// The measures from one start.
struct StartResult {
  double theta_2;     ///< [rad] heading at the start
  double speed;       ///< [L/T0] of the smoothed path along theta_T, over the steady window
  double efficiency;  ///< [1] gamma v^2 / Phi with v = speed and Phi the mean power of that window
  double power;       ///< [C_perp L^3/T0^2] Phi of that window
  double period_steps;  ///< [steps] of the stroke in the steady window; NaN if there is none
  double theta_s;       ///< [rad] mean over the translation stage; NaN if it never begins
  int steering_steps;   ///< [steps] before the translation stage, and at least those before the
                        /// smoothed path, 35 of three links; kEvaluationSteps if it never begins
  bool success;  ///< the translation stage began, |theta_s| < 2.5 degrees, and the speed in the
                 /// end is above kStuckSpeed
};

/// The measures of a policy over several starts.
struct Evaluation {
  std::vector<StartResult> starts;  ///< straight, theta_2 = 0, pi/3, pi/2
  double speed;                     ///< their means
  double efficiency;
  double success_rate;  ///< of `trials` random starts; NaN if there are none
  double theta_s;       ///< [rad] mean of |theta_s| over the successful random starts; NaN if none
  int trials;
};

/// Shapes of the random starts: random hinge angles, or all of them 0.
enum class RandomStarts { kBent, kStraight };

/// The motion of one swimmer; index k is after k steps.
struct Track {
  std::vector<double> x, y;     ///< [L] centroid
  std::vector<double> heading;  ///< [rad] angle of the heading link, theta_2 of three
  Eigen::MatrixXd alpha;        ///< [rad] (N-1, steps + 1) hinge angles
  std::vector<double> work;     ///< [C_perp L^3/T0] since the start
};

/// The motions from the starts of Evaluation::starts, each from x_c = (0, 0).
std::vector<Track> straight_tracks(const Policy& policy);

/// Random starts are those of threelink_sim::random_start(model, seed, trial), with that shape or
/// straight. trials >= 0.
/// Deterministic: the same on every machine with fused multiply-adds.
Evaluation evaluate(const Policy& policy, int trials, std::uint64_t seed,
                    RandomStarts random_starts = RandomStarts::kBent);

}  // namespace threelink_agent

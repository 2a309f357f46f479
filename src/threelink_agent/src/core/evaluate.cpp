#include "threelink_agent/evaluate.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "threelink_agent/actor.hpp"
#include "threelink_sim/environment.hpp"
#include "threelink_sim/stroke_period.hpp"

namespace threelink_agent {
namespace {

using threelink_sim::Environment;
using threelink_sim::SwimmerState;

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
// Swimmers at a time: enough to fill the lanes, few enough to keep the paths in memory.
constexpr std::size_t kLanes = 64;

std::vector<SwimmerState> straight_starts(const threelink_sim::Model& model) {
  std::vector<SwimmerState> starts;
  for (double heading : {0.0, threelink_sim::kPi / 3, threelink_sim::kPi / 2}) {
    SwimmerState straight;
    straight.heading = heading;
    straight.alpha = threelink_sim::HingeVector::Zero(model.hinges());
    starts.push_back(straight);
  }
  return starts;
}

std::vector<Track> play(const Policy& policy, const std::vector<SwimmerState>& starts) {
  const std::size_t n = starts.size();
  Environment environment(policy.metadata().environment(), n);
  for (std::size_t i = 0; i < n; ++i) environment.reset(i, starts[i]);
  std::vector<Track> tracks(n);
  for (Track& track : tracks) track.alpha.resize(policy.hinges(), kEvaluationSteps + 1);
  std::vector<double> work(n);
  const auto record = [&] {
    const threelink_sim::Batch& batch = environment.batch();
    for (std::size_t i = 0; i < n; ++i) {
      tracks[i].x.push_back(batch.x()[i]);
      tracks[i].y.push_back(batch.y()[i]);
      tracks[i].heading.push_back(batch.heading()[i]);
      for (int j = 0; j < policy.hinges(); ++j)
        tracks[i].alpha(j, static_cast<Eigen::Index>(tracks[i].x.size()) - 1) = batch.alpha(j)[i];
      tracks[i].work.push_back(work[i]);
    }
  };
  Actor actor(policy);
  record();
  for (int step = 0; step < kEvaluationSteps; ++step) {
    environment.step(actor.act(environment));
    for (std::size_t i = 0; i < n; ++i) work[i] += environment.batch().work()[i];
    record();
  }
  return tracks;
}

// [rad] the change from a to b, in [-pi, pi].
double turn(double a, double b) { return std::remainder(b - a, 2 * threelink_sim::kPi); }

void measure_direction(const Track& track, int half, StartResult& result) {
  result.steering_steps = kEvaluationSteps;
  double angle = kNaN, sum = 0;
  int count = 0;
  for (int k = half; k < kEvaluationSteps - half; ++k) {
    // The means at k and k + 1 differ by the one position that enters and the one that leaves.
    const double dx = track.x[k + 1 + half] - track.x[k - half];
    const double dy = track.y[k + 1 + half] - track.y[k - half];
    if (dx == 0 && dy == 0) continue;  // stands still: no direction
    const double slope = std::atan2(dy, dx);
    if (count == 0) {
      if (std::abs(slope) > kTranslationAngle) continue;
      result.steering_steps = k;
      angle = slope;
    }
    // Continuous, so that swimming backwards or in circles does not average to ahead.
    angle += turn(angle, slope);
    sum += angle;
    ++count;
  }
  result.theta_s = count > 0 ? sum / count : kNaN;
}

// Between the values at whole steps.
double at(const std::vector<double>& values, double step) {
  const auto k = std::min(static_cast<std::size_t>(step), values.size() - 2);
  return values[k] + (step - k) * (values[k + 1] - values[k]);
}

double smoothed_x(const Track& track, int half, double step) {
  double sum = 0;
  for (int k = -half; k <= half; ++k) sum += at(track.x, step + k);
  return sum / (2 * half + 1);
}

StartResult measure(const Policy& policy, const SwimmerState& start, const Track& track) {
  const double dt = policy.metadata().dt;
  StartResult result{};
  result.theta_2 = start.heading;
  const int half = threelink_sim::smoothing(track.alpha.rightCols(kSteadySteps + 1)) / 2;
  measure_direction(track, half, result);

  const int last = kEvaluationSteps - half;
  const auto [strokes, length] = threelink_sim::whole_strokes(threelink_sim::in_stroke_plane(
      track.alpha.middleCols(last - kSteadySteps, kSteadySteps + 1)));
  result.period_steps = strokes > 0 ? length / strokes : kNaN;
  const double time = length * dt;
  result.speed = (smoothed_x(track, half, last) - smoothed_x(track, half, last - length)) / time;
  result.power = (at(track.work, last) - at(track.work, last - length)) / time;
  result.efficiency =
      result.power > 0 ? policy.metadata().gamma * result.speed * result.speed / result.power : 0;
  result.success = std::abs(result.theta_s) < kTranslationAngle && result.speed > kStuckSpeed;
  return result;
}

std::vector<StartResult> measure_all(const Policy& policy,
                                     const std::vector<SwimmerState>& starts) {
  std::vector<StartResult> results;
  for (std::size_t first = 0; first < starts.size(); first += kLanes) {
    const std::size_t n = std::min(kLanes, starts.size() - first);
    const std::vector<SwimmerState> some(starts.begin() + first, starts.begin() + first + n);
    const std::vector<Track> tracks = play(policy, some);
    for (std::size_t i = 0; i < n; ++i) results.push_back(measure(policy, some[i], tracks[i]));
  }
  return results;
}

}  // namespace

std::vector<Track> straight_tracks(const Policy& policy) {
  return play(policy, straight_starts(policy.metadata().environment().model));
}

Evaluation evaluate(const Policy& policy, int trials, std::uint64_t seed,
                    RandomStarts random_starts) {
  const threelink_sim::Model model = policy.metadata().environment().model;
  std::vector<SwimmerState> starts = straight_starts(model);
  const std::size_t straight = starts.size();
  for (int trial = 0; trial < trials; ++trial) {
    starts.push_back(random_start(model, seed, static_cast<std::uint32_t>(trial)));
    if (random_starts == RandomStarts::kStraight) starts.back().alpha.setZero();
  }

  const std::vector<StartResult> results = measure_all(policy, starts);
  Evaluation evaluation{};
  evaluation.starts.assign(results.begin(), results.begin() + straight);
  for (const StartResult& result : evaluation.starts) {
    evaluation.speed += result.speed / straight;
    evaluation.efficiency += result.efficiency / straight;
  }
  int successes = 0;
  double deviation = 0;
  for (auto result = results.begin() + straight; result != results.end(); ++result) {
    if (!result->success) continue;
    ++successes;
    deviation += std::abs(result->theta_s);
  }
  evaluation.trials = trials;
  evaluation.success_rate = trials > 0 ? static_cast<double>(successes) / trials : kNaN;
  evaluation.theta_s = successes > 0 ? deviation / successes : kNaN;
  return evaluation;
}

}  // namespace threelink_agent

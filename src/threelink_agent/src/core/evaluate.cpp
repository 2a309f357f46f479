#include "threelink_agent/evaluate.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "threelink_agent/actor.hpp"
#include "threelink_sim/environment.hpp"

namespace threelink_agent {
namespace {

using threelink_sim::Environment;
using threelink_sim::SwimmerState;

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
constexpr int kHalf = kSmoothing / 2;
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
  std::vector<double> work(n);
  const auto record = [&] {
    const threelink_sim::Batch& batch = environment.batch();
    for (std::size_t i = 0; i < n; ++i) {
      tracks[i].x.push_back(batch.x()[i]);
      tracks[i].y.push_back(batch.y()[i]);
      tracks[i].heading.push_back(batch.heading()[i]);
      tracks[i].alpha_1.push_back(batch.alpha(0)[i]);
      tracks[i].alpha_2.push_back(policy.hinges() > 1 ? batch.alpha(1)[i] : 0);
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

void measure_direction(const Track& track, StartResult& result) {
  result.steering_steps = kEvaluationSteps;
  double angle = kNaN, sum = 0;
  int count = 0;
  for (int k = kHalf; k < kEvaluationSteps - kHalf; ++k) {
    // The means at k and k + 1 differ by the one position that enters and the one that leaves.
    const double dx = track.x[k + 1 + kHalf] - track.x[k - kHalf];
    const double dy = track.y[k + 1 + kHalf] - track.y[k - kHalf];
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

double smoothed_x(const Track& track, double step) {
  double sum = 0;
  for (int k = -kHalf; k <= kHalf; ++k) sum += at(track.x, step + k);
  return sum / kSmoothing;
}

// [steps] how far before `last` the last whole stroke of the steady window begins; strokes = 0 and
// kSteadySteps if there is none.
double whole_strokes(const Track& track, int last, int& strokes) {
  const int first = last - kSteadySteps;
  double mean_1 = 0, mean_2 = 0;
  for (int k = first; k < last; ++k) {
    mean_1 += track.alpha_1[k] / kSteadySteps;
    mean_2 += track.alpha_2[k] / kSteadySteps;
  }
  const auto phase = [&](int k) {
    return std::atan2(track.alpha_2[k] - mean_2, track.alpha_1[k] - mean_1);
  };
  strokes = 0;
  double length = kSteadySteps;
  double angle = 0;  // turned between step k and `last`
  for (int k = last - 1; k >= first; --k) {
    const double before = angle;
    angle += turn(phase(k), phase(k + 1));
    const double wanted = 2 * threelink_sim::kPi * (strokes + 1);
    if (std::abs(angle) >= wanted) {
      const double fraction = (wanted - std::abs(before)) / std::abs(angle - before);
      length = last - (k + 1) + fraction;
      ++strokes;
    }
  }
  return length;
}

StartResult measure(const Policy& policy, const SwimmerState& start, const Track& track) {
  const double dt = policy.metadata().dt;
  StartResult result{};
  result.theta_2 = start.heading;
  measure_direction(track, result);

  const int last = kEvaluationSteps - kHalf;
  int strokes;
  const double length = whole_strokes(track, last, strokes);
  result.period_steps = strokes > 0 ? length / strokes : kNaN;
  const double time = length * dt;
  result.speed = (smoothed_x(track, last) - smoothed_x(track, last - length)) / time;
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

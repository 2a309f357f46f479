// Rollouts: what is stored, what it depends on, and the symmetries.
#include "threelink_agent/training/rollout.hpp"

#include <cmath>
#include <numeric>
#include <vector>

#include <gtest/gtest.h>

#include "threelink_agent/symmetry.hpp"
#include "threelink_agent/training/minibatches.hpp"
#include "threelink_agent/training/schedule.hpp"
#include "threelink_sim/random.hpp"

namespace threelink_tests {
namespace {

using namespace threelink_agent;
using threelink_sim::Environment;
using threelink_sim::EnvironmentConfig;
using threelink_sim::ObservationKind;

EnvironmentConfig environment(int links = 3,
                              ObservationKind observation = ObservationKind::kDirection) {
  EnvironmentConfig config;
  config.observation = observation;
  config.model.links = links;
  config.c = 2;
  config.steps = 20;
  return config;
}

// A network with random weights.
Mlp network(const EnvironmentConfig& config) {
  const int inputs = threelink_sim::observation_size(config.observation, config.model);
  const int outputs = config.model.hinges();
  threelink_sim::Random random(1, threelink_sim::Stream::kInitialisation, 0);
  std::vector<Linear> layers(2);
  layers[0].weight.resize(8, inputs);
  layers[1].weight.resize(outputs, 8);
  for (Linear& layer : layers) {
    layer.bias.resize(layer.weight.rows());
    for (int i = 0; i < layer.weight.size(); ++i)
      layer.weight.data()[i] = static_cast<float>(random.uniform(-1, 1));
    for (int i = 0; i < layer.bias.size(); ++i)
      layer.bias[i] = static_cast<float>(random.uniform(-1, 1));
  }
  return Mlp(layers);
}

Rollout rollout(std::uint32_t first, int episodes, Symmetry canonical = Symmetry::kNone) {
  const EnvironmentConfig config = environment();
  Rollout result(config, episodes);
  collect({config,
           {},
           canonical,
           network(config),
           Eigen::VectorXf::Constant(config.model.hinges(), std::log(0.5f)),
           7,
           first},
          0, episodes, result);
  return result;
}

// The element (component, step, episode) of an array with `rows` steps.
float at(const std::vector<float>& array, const Rollout& r, int rows, int component, int t, int i) {
  return array[(std::size_t(component) * rows + t) * r.episodes + i];
}

TEST(Rollout, AnEpisodeDoesNotDependOnItsCompany) {
  const Rollout many = rollout(3, 5), alone = rollout(5, 1);
  for (int t = 0; t < many.steps; ++t) {
    EXPECT_EQ(many.rewards[t * 5 + 2], alone.rewards[t]);
    EXPECT_EQ(many.log_probs[t * 5 + 2], alone.log_probs[t]);
    for (int k = 0; k < many.observation_size; ++k)
      EXPECT_EQ(at(many.observations, many, many.steps + 1, k, t, 2),
                at(alone.observations, alone, alone.steps + 1, k, t, 0));
  }
}

TEST(Rollout, LogProbabilityIsThatOfTheUnclippedAction) {
  const Rollout r = rollout(0, 4);
  const Mlp actor = network(environment());
  const double log_std = std::log(0.5);
  bool beyond_the_limit = false;
  for (int t = 0; t < r.steps; ++t)
    for (int i = 0; i < r.episodes; ++i) {
      float seen[4], mean[2];
      for (int k = 0; k < 4; ++k) seen[k] = at(r.observations, r, r.steps + 1, k, t, i);
      actor.forward(seen, mean);
      double expected = -std::log(2 * threelink_sim::kPi) - 2 * log_std;
      for (int j = 0; j < 2; ++j) {
        const float action = at(r.actions, r, r.steps, j, t, i);
        expected -= 0.5 * std::pow((action - mean[j]) / 0.5, 2);
        beyond_the_limit = beyond_the_limit || std::abs(action) > 1;
      }
      EXPECT_NEAR(r.log_probs[t * r.episodes + i], expected, 1e-4);
    }
  EXPECT_TRUE(beyond_the_limit);
}

TEST(Rollout, RewardsAreThoseOfTheStoredActions) {
  const Rollout r = rollout(11, 1, Symmetry::kReversal);
  const EnvironmentConfig config = environment();
  Environment replay(config, 1);
  replay.reset(0, threelink_sim::random_start(config.model, 7, 11));
  bool reversed = false, straight = false;
  for (int t = 0; t < r.steps; ++t) {
    double observation[4], rates[2];
    replay.observe(observation);
    for (int j = 0; j < 2; ++j) rates[j] = at(r.actions, r, r.steps, j, t, 0);
    if (observation[0] < 0) {
      reverse_rates(rates, 2, 1, 0);
      reverse_observation(observation, 4, 2, 1, 0);
      reversed = true;
    } else {
      straight = true;
    }
    for (int k = 0; k < 4; ++k)
      EXPECT_EQ(at(r.observations, r, r.steps + 1, k, t, 0), static_cast<float>(observation[k]));
    replay.step(rates);
    EXPECT_EQ(r.rewards[t], static_cast<float>(replay.rewards()[0]));
  }
  EXPECT_TRUE(reversed || straight);
}

TEST(Rollout, MirroringKeepsTheBehaviourLogProbability) {
  const Rollout before = rollout(0, 32);
  Rollout after = before;
  mirror_half(after, 7, 0);
  EXPECT_EQ(after.log_probs, before.log_probs);
  EXPECT_EQ(after.rewards, before.rewards);
  int mirrored = 0;
  for (int i = 0; i < before.episodes; ++i) {
    const bool flipped = at(after.actions, after, after.steps, 0, 0, i) !=
                         at(before.actions, before, before.steps, 0, 0, i);
    mirrored += flipped;
    for (int t = 0; t <= before.steps; ++t)
      for (int k = 0; k < 4; ++k)
        EXPECT_EQ(at(after.observations, after, after.steps + 1, k, t, i),
                  (flipped && k > 0 ? -1 : 1) *
                      at(before.observations, before, before.steps + 1, k, t, i));
    for (int t = 0; t < before.steps; ++t)
      for (int j = 0; j < 2; ++j)
        EXPECT_EQ(at(after.actions, after, after.steps, j, t, i),
                  (flipped ? -1 : 1) * at(before.actions, before, before.steps, j, t, i));
  }
  EXPECT_GT(mirrored, 4);
  EXPECT_LT(mirrored, 28);
}

// A swimmer and its image under a symmetry, driven by rates and their image, have the same rewards,
// and their observations stay images of each other.
template <class MapObservation, class MapRates>
void expect_equivariant(int links, ObservationKind kind, double heading_sign, double turn,
                        bool reversed_hinges, MapObservation map_observation, MapRates map_rates) {
  const EnvironmentConfig config = environment(links, kind);
  const int hinges = config.model.hinges();
  Environment pair(config, 2);
  const int size = pair.observation_size();
  const threelink_sim::SwimmerState start = threelink_sim::random_start(config.model, 5, 0);
  threelink_sim::SwimmerState image = start;
  // Of an even number of links the heading link of the image is the other one of the middle two.
  const int heading_link = config.model.heading_link();
  const int same_link = reversed_hinges ? links - 1 - heading_link : heading_link;
  image.heading = heading_sign * link_angles(config.model, start)[same_link] + turn;
  image.alpha = reversed_hinges ? (-start.alpha.reverse()).eval() : (-start.alpha).eval();
  pair.reset(0, start);
  pair.reset(1, image);
  threelink_sim::Random random(2, threelink_sim::Stream::kExploration, 0);
  std::vector<double> observation(2 * size), rates(2 * hinges);
  for (int t = 0; t < 100; ++t) {
    for (int i = 0; i < 2; ++i) pair.aim(i, {0.2, 0});  // on the axis of the mirror
    pair.observe(observation.data());
    map_observation(observation.data(), size, hinges, 2, 1);
    for (int k = 0; k < size; ++k)
      EXPECT_NEAR(observation[2 * k], observation[2 * k + 1], 1e-11) << "component " << k;
    for (int j = 0; j < hinges; ++j) rates[2 * j] = rates[2 * j + 1] = random.uniform(-1.5, 1.5);
    map_rates(rates.data(), hinges, 2, 1);
    pair.step(rates.data());
    EXPECT_NEAR(pair.rewards()[0], pair.rewards()[1], 1e-13);
    EXPECT_NEAR(pair.centroid(0).x(), pair.centroid(1).x(), 1e-12);
    EXPECT_NEAR(pair.centroid(0).y(), heading_sign * pair.centroid(1).y(), 1e-12);
  }
}

TEST(Symmetry, MirrorMapsMotionsToMotions) {
  for (ObservationKind kind : {ObservationKind::kDirection, ObservationKind::kTarget})
    for (int links = 2; links <= 8; ++links)
      expect_equivariant(links, kind, -1, 0, false, mirror_observation<double>,
                         mirror_rates<double>);
}

TEST(Symmetry, ReversalMapsMotionsToMotions) {
  for (ObservationKind kind : {ObservationKind::kDirection, ObservationKind::kTarget})
    for (int links = 2; links <= 8; ++links)
      expect_equivariant(links, kind, 1, threelink_sim::kPi, true, reverse_observation<double>,
                         reverse_rates<double>);
}

TEST(Minibatches, VisitEachSampleOnceAndInAnotherOrderEachTime) {
  const std::vector<std::int64_t> order = shuffled(1001, 0, 3, 1);
  std::vector<std::int64_t> sorted = order, all(1001);
  std::sort(sorted.begin(), sorted.end());
  std::iota(all.begin(), all.end(), 0);
  EXPECT_EQ(sorted, all);
  EXPECT_EQ(shuffled(1001, 0, 3, 1), order);
  EXPECT_NE(shuffled(1001, 0, 3, 2), order);
  EXPECT_NE(shuffled(1001, 0, 4, 1), order);
  EXPECT_NE(shuffled(1001, 1, 3, 1), order);
  EXPECT_EQ(shuffled(1, 0, 0, 0), std::vector<std::int64_t>{0});
}

TEST(Minibatches, EverySampleGetsEverywhere) {
  // Sample 0 over 6000 shuffles of 6: 1000 a place, standard deviation 29, five of them.
  int places[6] = {};
  for (std::uint32_t update = 0; update < 6000; ++update) {
    const std::vector<std::int64_t> order = shuffled(6, 9, update, 0);
    ++places[std::find(order.begin(), order.end(), 0) - order.begin()];
  }
  for (int count : places) EXPECT_NEAR(count, 1000, 145);
}

TEST(Schedule, LearningRateIsLinearAndStdLogLinear) {
  EXPECT_NEAR(annealed(2, 0.1, 0), 2, 1e-15);
  EXPECT_NEAR(annealed(2, 0.1, 0.5), 1.1, 1e-15);
  EXPECT_NEAR(decayed_std(0.8, 0.2, 0.5, 0), 0.8, 1e-15);
  EXPECT_NEAR(decayed_std(0.8, 0.2, 0.5, 0.25), 0.4, 1e-15);  // the geometric mean half-way
  EXPECT_NEAR(decayed_std(0.8, 0.2, 0.5, 0.5), 0.2, 1e-15);
  EXPECT_NEAR(decayed_std(0.8, 0.2, 0.5, 0.9), 0.2, 1e-15);
}

}  // namespace
}  // namespace threelink_tests

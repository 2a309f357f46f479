#include "threelink_agent/distributed/fingerprint.hpp"

#include <cmath>
#include <optional>
#include <utility>
#include <vector>

#include <Eigen/Core>

#include "threelink_agent/distributed/episode_batch.hpp"
#include "threelink_agent/training/rollout.hpp"
#include "threelink_sim/random.hpp"
#include "threelink_sim/sha256.hpp"

namespace threelink_agent {
namespace {

// Weights and biases normal with deviation 1 / sqrt(inputs).
Linear random_layer(int inputs, int outputs, threelink_sim::Random& random) {
  Linear layer;
  layer.weight.resize(outputs, inputs);
  layer.bias.resize(outputs);
  const double scale = 1 / std::sqrt(inputs);
  for (int j = 0; j < outputs; ++j) {
    for (int k = 0; k < inputs; ++k)
      layer.weight(j, k) = static_cast<float>(scale * random.normal());
    layer.bias(j) = static_cast<float>(scale * random.normal());
  }
  return layer;
}

// Plays nine episodes, more than a register holds; eight of them side by side, one alone.
std::string hash_of_episodes(int links, std::optional<threelink_sim::PointsGoal> points = {}) {
  constexpr int kWidth = 64, kTogether = 8, kAlone = 1;
  Play play{};
  play.environment.model.links = links;
  play.environment.steps = 25;
  if (points) play.environment.observation = threelink_sim::ObservationKind::kTarget;
  play.goal.points = points;
  play.canonical = Symmetry::kReversal;
  const int hinges = play.environment.model.hinges();
  threelink_sim::Random random(1, threelink_sim::Stream::kInitialisation, 0);
  std::vector<Linear> layers;
  layers.push_back(random_layer(
      observation_size(play.environment.observation, play.environment.model), kWidth, random));
  layers.push_back(random_layer(kWidth, hinges, random));
  play.actor = Mlp(std::move(layers));
  play.log_std = Eigen::VectorXf::Constant(hinges, -0.7F);
  Rollout rollout(play.environment, kTogether + kAlone);
  collect(play, 0, kTogether, rollout);
  collect(play, kTogether, kTogether + kAlone, rollout);
  EpisodeBatch batch;
  put(std::move(rollout), batch);
  return checksum(batch);
}

}  // namespace

std::string fingerprint() {
  threelink_sim::PointsGoal points;
  points.direction_share = 0.2;
  points.nearest = 0.002;
  points.farthest = 0.02;
  points.threshold = 0.004;
  points.bonus = 1.5;
  return threelink_sim::sha256(hash_of_episodes(3) + hash_of_episodes(5) +
                               hash_of_episodes(3, points));
}

}  // namespace threelink_agent

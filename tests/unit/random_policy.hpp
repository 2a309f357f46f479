// A policy with random weights, for tests that need one before any is trained.
#pragma once

#include <cmath>
#include <utility>
#include <vector>

#include "threelink_agent/policy.hpp"
#include "threelink_sim/random.hpp"

namespace threelink_tests {

// sizes: inputs, hidden widths, outputs. Weights normal with variance 1 / inputs, biases likewise
// with standard deviation 0.3.
inline std::vector<threelink_agent::Linear> random_layers(const std::vector<int>& sizes,
                                                          std::uint64_t seed) {
  threelink_sim::Random random(seed, threelink_sim::Stream::kInitialisation, 0);
  std::vector<threelink_agent::Linear> layers(sizes.size() - 1);
  for (std::size_t l = 0; l < layers.size(); ++l) {
    layers[l].weight.resize(sizes[l + 1], sizes[l]);
    layers[l].bias.resize(sizes[l + 1]);
    const double scale = 1 / std::sqrt(sizes[l]);
    for (int j = 0; j < sizes[l + 1]; ++j) {
      for (int k = 0; k < sizes[l]; ++k)
        layers[l].weight(j, k) = static_cast<float>(scale * random.normal());
      layers[l].bias(j) = static_cast<float>(0.3 * random.normal());
    }
  }
  return layers;
}

inline threelink_agent::Policy random_policy(
    std::uint64_t seed, threelink_agent::Symmetry symmetry = threelink_agent::Symmetry::kReversal,
    int links = 3,
    threelink_sim::ObservationKind observation = threelink_sim::ObservationKind::kDirection) {
  threelink_agent::PolicyMetadata metadata;
  metadata.observation = observation;
  metadata.links = links;
  metadata.symmetry = symmetry;
  metadata.config = "seed: 1  # \"quoted\", \xc3\xa9\n";
  const int hinges = links - 1;
  return threelink_agent::Policy(
      metadata,
      threelink_agent::Mlp(random_layers({metadata.observation_size(), 64, 64, hinges}, seed)),
      Eigen::VectorXf::Constant(hinges, -1.2F));
}

// n observations, component k of observation i at [k * n + i].
inline std::vector<double> random_observations(
    std::size_t n, int hinges, std::uint64_t seed,
    threelink_sim::ObservationKind kind = threelink_sim::ObservationKind::kDirection) {
  threelink_sim::Random random(seed, threelink_sim::Stream::kStart, 0);
  const bool target = kind == threelink_sim::ObservationKind::kTarget;
  std::vector<double> values(n * (2 + hinges + (target ? 3 : 0)));
  for (std::size_t i = 0; i < n; ++i) {
    const double theta_d = random.uniform(-3.14, 3.14);
    values[i] = std::cos(theta_d);
    values[n + i] = std::sin(theta_d);
    for (int j = 0; j < hinges; ++j) values[(2 + j) * n + i] = random.uniform(-2.1, 2.1);
    if (!target) continue;
    const double r = std::exp(random.uniform(std::log(5e-4), std::log(0.5)));
    values[(2 + hinges) * n + i] = std::tanh(r / 0.1) * values[i];
    values[(3 + hinges) * n + i] = std::tanh(r / 0.1) * values[n + i];
    values[(4 + hinges) * n + i] = (std::log(r) + 4) / 2;
  }
  return values;
}

}  // namespace threelink_tests

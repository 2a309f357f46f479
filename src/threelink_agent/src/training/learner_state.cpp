#include "threelink_agent/training/learner_state.hpp"

#include <algorithm>
#include <cmath>

#include "threelink_sim/random.hpp"

namespace threelink_agent {
namespace {

using threelink_sim::ObservationKind;

constexpr std::uint32_t kActor = 0, kCritic = 1;  // keys of the random numbers

std::vector<Linear> initial_layers(const TrainConfig& config, ObservationKind observation,
                                   int outputs, std::uint32_t network, double last_gain) {
  std::vector<int> sizes{threelink_sim::observation_size(observation, config.environment.model)};
  sizes.insert(sizes.end(), config.hidden.begin(), config.hidden.end());
  sizes.push_back(outputs);
  std::vector<Linear> layers(sizes.size() - 1);
  for (std::size_t l = 0; l < layers.size(); ++l) {
    threelink_sim::Random random(config.seed, threelink_sim::Stream::kInitialisation, network,
                                 static_cast<std::uint32_t>(l));
    const int inputs = sizes[l], width = sizes[l + 1];
    const double gain = l + 1 == layers.size() ? last_gain : 1.0;
    const double bound = gain * std::sqrt(6.0 / (inputs + width));
    layers[l].weight.resize(width, inputs);
    for (int i = 0; i < width * inputs; ++i)
      layers[l].weight.data()[i] = static_cast<float>(random.uniform(-bound, bound));
    layers[l].bias.setZero(width);
  }
  return layers;
}

std::vector<Linear> zeros_like(std::vector<Linear> layers) {
  for (Linear& layer : layers) {
    layer.weight.setZero();
    layer.bias.setZero();
  }
  return layers;
}

LearnerTensors zeros_like(const LearnerTensors& tensors) {
  return {zeros_like(tensors.actor), Eigen::VectorXf::Zero(tensors.log_std.size()),
          zeros_like(tensors.critic)};
}

bool finite(const std::vector<Linear>& layers) {
  return std::all_of(layers.begin(), layers.end(), [](const Linear& layer) {
    return layer.weight.allFinite() && layer.bias.allFinite();
  });
}

bool finite(const LearnerTensors& tensors) {
  return finite(tensors.actor) && tensors.log_std.allFinite() && finite(tensors.critic);
}

}  // namespace

bool LearnerState::all_finite() const {
  return finite(parameters) && finite(mean) && finite(variance);
}

LearnerState initial_state(const TrainConfig& config) {
  const int hinges = config.environment.model.hinges();
  LearnerState state;
  state.parameters.actor = initial_layers(config, config.observation, hinges, kActor, 0.01);
  state.parameters.log_std =
      Eigen::VectorXf::Constant(hinges, static_cast<float>(std::log(config.exploration.std)));
  state.parameters.critic = initial_layers(config, config.environment.observation, 1, kCritic, 1.0);
  state.mean = state.variance = zeros_like(state.parameters);
  return state;
}

}  // namespace threelink_agent

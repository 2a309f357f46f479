#include "threelink_agent/training/networks.hpp"

#include <cmath>

#include "threelink_sim/random.hpp"

namespace threelink_agent {

TanhNetwork::TanhNetwork(const std::string& name, const std::vector<int>& sizes) {
  torch::nn::Sequential layers;
  for (std::size_t k = 0; k + 1 < sizes.size(); ++k) {
    if (k > 0) layers->push_back(torch::nn::Tanh());
    layers_.push_back(torch::nn::Linear(sizes[k], sizes[k + 1]));
    layers->push_back(layers_.back());
  }
  register_module(name, layers);
}

void TanhNetwork::initialise(std::uint64_t seed, std::uint32_t network, double last_gain) {
  torch::NoGradGuard no_grad;
  for (std::size_t k = 0; k < layers_.size(); ++k) {
    threelink_sim::Random random(seed, threelink_sim::Stream::kInitialisation, network,
                                 static_cast<std::uint32_t>(k));
    torch::Tensor weight = layers_[k]->weight;
    const double gain = k + 1 == layers_.size() ? last_gain : 1.0;
    const double bound = gain * std::sqrt(6.0 / (weight.size(0) + weight.size(1)));
    float* element = weight.data_ptr<float>();
    for (std::int64_t i = 0; i < weight.numel(); ++i)
      element[i] = static_cast<float>(random.uniform(-bound, bound));
    layers_[k]->bias.zero_();
  }
}

torch::Tensor TanhNetwork::forward(torch::Tensor x) {
  for (std::size_t k = 0; k < layers_.size(); ++k) {
    if (k > 0) x = torch::tanh(x);
    x = torch::linear(x, layers_[k]->weight, layers_[k]->bias);
  }
  return x;
}

Mlp TanhNetwork::mlp() const {
  std::vector<Linear> layers;
  for (const auto& layer : layers_) {
    const std::int64_t outputs = layer->weight.size(0), inputs = layer->weight.size(1);
    Linear linear;
    linear.weight =
        Eigen::Map<const decltype(linear.weight)>(layer->weight.data_ptr<float>(), outputs, inputs);
    linear.bias = Eigen::Map<const Eigen::VectorXf>(layer->bias.data_ptr<float>(), outputs);
    layers.push_back(std::move(linear));
  }
  return Mlp(std::move(layers));
}

}  // namespace threelink_agent

#include "threelink_agent/training/networks.hpp"

namespace threelink_agent {

TanhNetwork::TanhNetwork(const std::string& name, const std::vector<Linear>& layers) {
  torch::nn::Sequential sequence;
  for (const Linear& layer : layers) {
    if (!layers_.empty()) sequence->push_back(torch::nn::Tanh());
    layers_.push_back(torch::nn::Linear(layer.weight.cols(), layer.weight.rows()));
    sequence->push_back(layers_.back());
  }
  register_module(name, sequence);
  set_layers(layers);
}

torch::Tensor TanhNetwork::forward(torch::Tensor x) {
  for (std::size_t k = 0; k < layers_.size(); ++k) {
    if (k > 0) x = torch::tanh(x);
    x = torch::linear(x, layers_[k]->weight, layers_[k]->bias);
  }
  return x;
}

std::vector<Linear> TanhNetwork::layers() const {
  std::vector<Linear> layers;
  for (const auto& layer : layers_) {
    const std::int64_t outputs = layer->weight.size(0), inputs = layer->weight.size(1);
    Linear linear;
    linear.weight =
        Eigen::Map<const decltype(linear.weight)>(layer->weight.data_ptr<float>(), outputs, inputs);
    linear.bias = Eigen::Map<const Eigen::VectorXf>(layer->bias.data_ptr<float>(), outputs);
    layers.push_back(std::move(linear));
  }
  return layers;
}

void TanhNetwork::set_layers(const std::vector<Linear>& layers) {
  for (std::size_t k = 0; k < layers_.size(); ++k) {
    const Linear& layer = layers.at(k);
    Eigen::Map<decltype(Linear::weight)>(layers_[k]->weight.data_ptr<float>(), layer.weight.rows(),
                                         layer.weight.cols()) = layer.weight;
    Eigen::Map<Eigen::VectorXf>(layers_[k]->bias.data_ptr<float>(), layer.bias.size()) = layer.bias;
  }
}

}  // namespace threelink_agent

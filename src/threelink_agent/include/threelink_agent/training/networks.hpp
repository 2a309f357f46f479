// Actor and critic as LibTorch modules.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include <torch/torch.h>

#include "threelink_agent/mlp.hpp"

namespace threelink_agent {

// Linear layers with tanh between them, the last one linear. Registered under `name`, so that the
// parameters of the actor are called actor.0.weight, actor.0.bias, actor.2.weight, ...
class TanhNetwork : public torch::nn::Module {
 public:
  // sizes: inputs, hidden widths, outputs.
  TanhNetwork(const std::string& name, const std::vector<int>& sizes);

  // Weights uniform in +- gain sqrt(6 / (inputs + outputs)) (Glorot and Bengio 2010), gain 1 but
  // for the last layer; biases 0. Keyed by (seed, network).
  void initialise(std::uint64_t seed, std::uint32_t network, double last_gain);

  torch::Tensor forward(torch::Tensor x);  // (n, inputs) -> (n, outputs)

  // A copy that is evaluated without LibTorch.
  Mlp mlp() const;

 private:
  std::vector<torch::nn::Linear> layers_;
};

}  // namespace threelink_agent

/// @file
/// Actor and critic as LibTorch modules.
#pragma once

#include <string>
#include <vector>

#include <torch/torch.h>

#include "threelink_agent/mlp.hpp"

namespace threelink_agent {

/// Linear layers with tanh between them, the last one linear. Registered under `name`, so that the
/// parameters of the actor are called actor.0.weight, actor.0.bias, actor.2.weight, ...
class TanhNetwork : public torch::nn::Module {
 public:
  TanhNetwork(const std::string& name, const std::vector<Linear>& layers);

  std::int64_t inputs() const { return layers_.front()->weight.size(1); }
  torch::Tensor forward(torch::Tensor x);  ///< (n, inputs) -> (n, outputs)

  /// Copies of the parameters. The argument of set_layers() must have the shapes of layers().
  std::vector<Linear> layers() const;
  void set_layers(const std::vector<Linear>& layers);

 private:
  std::vector<torch::nn::Linear> layers_;
};

}  // namespace threelink_agent

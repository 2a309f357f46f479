// Networks and optimiser of the LibTorch backend.
#include "threelink_agent/training/networks.hpp"

#include <gtest/gtest.h>

#include "small_training.hpp"
#include "threelink_agent/training/optimiser.hpp"

namespace threelink_tests {
namespace {

using namespace threelink_agent;

TEST(Network, LibTorchAndOurOwnEvaluationAgree) {
  const TrainConfig config = load_train_config(THREELINK_CONFIG "/train_vfs.yaml");
  TanhNetwork network("actor", initial_state(config).parameters.critic);
  const Mlp mlp(network.layers());
  torch::manual_seed(0);
  const torch::Tensor input = torch::randn({37, 4});
  const torch::Tensor expected = network.forward(input).detach();
  const torch::Tensor columns = input.t().contiguous();
  torch::Tensor actual = torch::empty({1, 37});
  mlp.forward(37, columns.data_ptr<float>(), actual.data_ptr<float>());
  EXPECT_LT((actual.t() - expected).abs().max().item<float>(), 1e-5f);
}

TEST(Network, ParametersAreNamedAsInPolicyFiles) {
  const TanhNetwork network("actor", initial_state(small()).parameters.actor);
  EXPECT_EQ(network.named_parameters().keys(),
            (std::vector<std::string>{"actor.0.weight", "actor.0.bias", "actor.2.weight",
                                      "actor.2.bias", "actor.4.weight", "actor.4.bias"}));
}

TEST(FlatAdam, StepsLikeAdamOnEachParameterAndLimitsTheGradient) {
  // One parameter of each kind of shape; the gradient of |p|^2 / 2 is p.
  torch::Tensor a = torch::tensor({{3.0f, 0.0f}}, torch::requires_grad());
  torch::Tensor b = torch::tensor({4.0f}, torch::requires_grad());
  torch::Tensor reference = torch::tensor({3.0f, 0.0f, 4.0f}, torch::requires_grad());
  FlatAdam flat({a, b}, 1.0);
  flat.set_learning_rate(0.1);
  torch::optim::Adam adam({reference}, torch::optim::AdamOptions(0.1));
  for (int step = 0; step < 5; ++step) {
    flat.descend((a.square().sum() + b.square().sum()) / 2);
    adam.zero_grad();
    (reference.square().sum() / 2).backward();
    torch::nn::utils::clip_grad_norm_({reference}, 1.0);
    adam.step();
  }
  EXPECT_NEAR(a[0][0].item<double>(), reference[0].item<double>(), 1e-6);
  EXPECT_NEAR(a[0][1].item<double>(), 0, 1e-6);
  EXPECT_NEAR(b[0].item<double>(), reference[2].item<double>(), 1e-6);
}

}  // namespace
}  // namespace threelink_tests

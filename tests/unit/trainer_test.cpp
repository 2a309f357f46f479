// Small trainings: determinism, progress, the policy that comes out.
#include "threelink_agent/training/trainer.hpp"

#include <cmath>

#include <gtest/gtest.h>

#include "threelink_agent/training/losses.hpp"
#include "threelink_agent/training/networks.hpp"
#include "threelink_agent/training/optimiser.hpp"

namespace threelink_tests {
namespace {

using namespace threelink_agent;

// A training of a second or so; two thirds of an update are left over for the last one.
TrainConfig small(std::uint64_t seed = 0) {
  TrainConfig config = load_train_config(THREELINK_CONFIG "/train_vfs.yaml");
  config.seed = seed;
  config.episodes = 32;
  config.evaluate_every = 2;
  config.environment.steps = 50;
  config.hidden = {16, 16};
  config.update.episodes = 12;
  config.update.epochs = 3;
  config.update.minibatch = 250;
  return config;
}

std::string sha256_of_training(const TrainConfig& config, int threads = 1) {
  Trainer trainer(config, threads);
  while (!trainer.finished()) trainer.update();
  return trainer.policy().sha256();
}

TEST(Trainer, SameSeedSamePolicy) {
  const std::string policy = sha256_of_training(small(0));  // 0 is a seed like any other
  EXPECT_EQ(sha256_of_training(small(0)), policy);
  EXPECT_EQ(sha256_of_training(small(0), 2), policy);  // threads
  EXPECT_NE(sha256_of_training(small(1)), policy);
}

TEST(Trainer, ReportsWhatItDid) {
  Trainer trainer(small(), 1);
  const UpdateReport first = trainer.update();
  EXPECT_EQ(first.update, 1u);
  EXPECT_EQ(first.episodes, 12u);
  EXPECT_EQ(first.steps, 600u);
  EXPECT_NEAR(first.std, 0.6, 1e-6);
  EXPECT_NEAR(first.rates.actor, trainer.config().update.actor_learning_rate, 1e-12);
  EXPECT_FALSE(first.evaluation);
  EXPECT_FALSE(trainer.best());
  const UpdateReport second = trainer.update();
  EXPECT_TRUE(second.evaluation);
  EXPECT_TRUE(trainer.best());
  EXPECT_GE(second.statistics.kl, 0);
  EXPECT_FALSE(trainer.finished());
  const UpdateReport last = trainer.update();
  EXPECT_EQ(last.episodes, 32u);
  EXPECT_TRUE(last.evaluation);
  EXPECT_TRUE(trainer.finished());
}

TEST(Trainer, PolicyTellsWhereItComesFrom) {
  TrainConfig config = small();
  config.environment.model.gamma = 0.6;
  const Policy policy = Trainer(config, 1).policy();
  EXPECT_EQ(policy.metadata().gamma, 0.6);
  EXPECT_EQ(policy.metadata().symmetry, config.symmetry.canonical);
  EXPECT_EQ(to_yaml(parse_train_config(policy.metadata().config, "policy")), to_yaml(config));
  EXPECT_NEAR(policy.log_std()[0], std::log(0.6), 1e-6);
}

TEST(Trainer, LearnsAndKeepsTheLearnedStd) {
  TrainConfig config = small();
  config.exploration.learned = true;
  config.update.entropy_weight = 0.1;
  Trainer trainer(config, 1);
  for (int update = 0; update < 3; ++update) trainer.update();
  EXPECT_GT(trainer.policy().log_std().maxCoeff(), std::log(0.6) + 1e-4);
}

TEST(Trainer, AShortTrainingImprovesTheReturn) {
  TrainConfig config = load_train_config(THREELINK_CONFIG "/train_vfs.yaml");
  config.episodes = 1600;
  config.update.episodes = 20;
  Trainer trainer(config, 2);
  const double first = trainer.update().mean_return;
  double last = first;
  while (!trainer.finished()) last = trainer.update().mean_return;
  // 200 steps at the optimal speed return 1.55; noise at random returns 0 on average.
  EXPECT_LT(first, 0.2);
  EXPECT_GT(last, 0.4);
}

TEST(Trainer, ManyLinks) {
  TrainConfig config = small();
  config.environment.model.links = 5;
  EXPECT_EQ(sha256_of_training(config), sha256_of_training(config));
}

TEST(Network, LibTorchAndOurOwnEvaluationAgree) {
  TanhNetwork network("actor", {4, 64, 64, 2});
  network.initialise(1, 0, 1.0);
  const Mlp mlp = network.mlp();
  torch::manual_seed(0);
  const torch::Tensor input = torch::randn({37, 4});
  const torch::Tensor expected = network.forward(input).detach();
  const torch::Tensor columns = input.t().contiguous();
  torch::Tensor actual = torch::empty({2, 37});
  mlp.forward(37, columns.data_ptr<float>(), actual.data_ptr<float>());
  EXPECT_LT((actual.t() - expected).abs().max().item<float>(), 1e-5f);
}

TEST(Network, ParametersAreNamedAsInPolicyFiles) {
  const TanhNetwork network("actor", {4, 8, 2});
  EXPECT_EQ(network.named_parameters().keys(),
            (std::vector<std::string>{"actor.0.weight", "actor.0.bias", "actor.2.weight",
                                      "actor.2.bias"}));
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

#include "threelink_agent/training/losses.hpp"

#include "threelink_agent/training/gaussian.hpp"

namespace threelink_agent {

torch::Tensor log_probability(const torch::Tensor& actions, const torch::Tensor& mean,
                              const torch::Tensor& log_std) {
  const torch::Tensor z = (actions - mean) * torch::exp(-log_std);
  return z.square().sum(1) * -0.5 - log_std.sum() - actions.size(1) * kLogSqrt2Pi;
}

torch::Tensor entropy(const torch::Tensor& log_std) {
  return log_std.sum() + log_std.numel() * gaussian_entropy(0.0f);
}

torch::Tensor clipped_policy_loss(const torch::Tensor& log_ratio, const torch::Tensor& advantages,
                                  double epsilon) {
  const torch::Tensor ratio = log_ratio.exp();
  const torch::Tensor clipped = ratio.clamp(1 - epsilon, 1 + epsilon);
  return -torch::min(ratio * advantages, clipped * advantages).mean();
}

torch::Tensor value_loss(const torch::Tensor& values, const torch::Tensor& returns) {
  return (returns - values).square().mean() * 0.5;
}

torch::Tensor kl_estimate(const torch::Tensor& log_ratio) {
  return (log_ratio.expm1() - log_ratio).mean();
}

torch::Tensor clip_fraction(const torch::Tensor& log_ratio, double epsilon) {
  return (log_ratio.expm1().abs() > epsilon).to(torch::kFloat).mean();
}

}  // namespace threelink_agent

/// @file
/// The terms of PPO's loss (Schulman et al. 2017, arXiv:1707.06347) as LibTorch expressions.
///
/// n samples, A hinges; tensors are float32.
#pragma once

#include <torch/torch.h>

namespace threelink_agent {

/// (n) log-probability of actions (n, A) under the normal distributions of mean (n, A) and log_std
/// (A):
///   sum_j  -z_j^2/2 - log std_j - log sqrt(2 pi),   z = (action - mean) / std
torch::Tensor log_probability(const torch::Tensor& actions, const torch::Tensor& mean,
                              const torch::Tensor& log_std);

/// Entropy of that distribution, summed over hinges:  sum_j  1/2 + log std_j + log sqrt(2 pi)
torch::Tensor entropy(const torch::Tensor& log_std);

/// -E[min(r A, clip(r, 1 - epsilon, 1 + epsilon) A)] with r = exp(log_ratio); log_ratio, advantages
/// (n). The gradient is 0 where r is outside the interval on the side towards which the advantage
/// pushes it.
torch::Tensor clipped_policy_loss(const torch::Tensor& log_ratio, const torch::Tensor& advantages,
                                  double epsilon);

/// E[(R - V)^2] / 2; values, returns (n).
torch::Tensor value_loss(const torch::Tensor& values, const torch::Tensor& returns);

/// Estimate of KL(old || new), never negative:  E[r - 1 - log r]  (Schulman, "Approximating KL
/// divergence", 2020).
torch::Tensor kl_estimate(const torch::Tensor& log_ratio);

/// Fraction of the samples whose ratio is outside [1 - epsilon, 1 + epsilon].
torch::Tensor clip_fraction(const torch::Tensor& log_ratio, double epsilon);

}  // namespace threelink_agent

#include "threelink_agent/training/optimiser.hpp"

#include <memory>
#include <string>
#include <type_traits>

namespace threelink_agent {
namespace {

torch::Tensor flattened(const std::vector<torch::Tensor>& parameters) {
  torch::NoGradGuard no_grad;
  std::vector<torch::Tensor> pieces;
  for (const torch::Tensor& parameter : parameters) pieces.push_back(parameter.flatten());
  return torch::cat(pieces);
}

}  // namespace

FlatAdam::FlatAdam(const std::vector<torch::Tensor>& parameters, double max_gradient_norm)
    : values_(flattened(parameters)),
      max_gradient_norm_(max_gradient_norm),
      adam_({values_}, torch::optim::AdamOptions()) {
  values_.mutable_grad() = torch::zeros_like(values_);
  std::int64_t offset = 0;
  for (torch::Tensor parameter : parameters) {
    const auto view = [&](const torch::Tensor& flat) {
      return flat.narrow(0, offset, parameter.numel()).view(parameter.sizes());
    };
    parameter.set_data(view(values_));
    parameter.mutable_grad() = view(values_.grad());
    offset += parameter.numel();
  }
}

void FlatAdam::set_learning_rate(double rate) {
  static_cast<torch::optim::AdamOptions&>(adam_.param_groups()[0].options()).lr(rate);
}

void FlatAdam::descend(const torch::Tensor& loss) {
  torch::Tensor gradient = values_.grad();
  gradient.zero_();
  loss.backward();  // adds to the views
  const double norm = gradient.norm().item<double>();
  if (norm > max_gradient_norm_) gradient.mul_(max_gradient_norm_ / norm);
  adam_.step();
}

namespace {

// What LibTorch keys the state of a parameter by: an address, which older versions turn into text.
template <class Key>
Key state_key(const torch::Tensor& parameter) {
  if constexpr (std::is_same_v<Key, std::string>)
    return c10::guts::to_string(parameter.unsafeGetTensorImpl());
  else
    return parameter.unsafeGetTensorImpl();
}

}  // namespace

FlatAdam::State FlatAdam::state() const {
  const auto& states = adam_.state();
  using Key = typename std::decay_t<decltype(states)>::key_type;
  const auto found = states.find(state_key<Key>(values_));
  if (found == states.end())  // before the first step
    return {torch::zeros_like(values_), torch::zeros_like(values_), 0};
  const auto& state = static_cast<const torch::optim::AdamParamState&>(*found->second);
  return {state.exp_avg().clone(), state.exp_avg_sq().clone(), state.step()};
}

void FlatAdam::restore(const State& state) {
  auto& states = adam_.state();
  using Key = typename std::decay_t<decltype(states)>::key_type;
  auto copy = std::make_unique<torch::optim::AdamParamState>();
  copy->step(state.steps);
  copy->exp_avg(state.mean.clone());
  copy->exp_avg_sq(state.variance.clone());
  states[state_key<Key>(values_)] = std::move(copy);
}

}  // namespace threelink_agent

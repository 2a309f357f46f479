#include "threelink_agent/policy.hpp"

#include <algorithm>
#include <utility>

#include <fmt/format.h>

#include "policy_file.hpp"
#include "threelink_agent/files.hpp"
#include "threelink_agent/symmetry.hpp"
#include "threelink_sim/environment.hpp"

namespace threelink_agent {
namespace {

// Whether the network is to see this observation from the swimmer's other end.
bool reversed(const PolicyMetadata& metadata, double cos_theta_d) {
  return metadata.symmetry == Symmetry::kReversal && cos_theta_d < 0;
}

double clip(float rate) { return std::clamp(static_cast<double>(rate), -1.0, 1.0); }

}  // namespace

std::string to_string(Symmetry symmetry) {
  return symmetry == Symmetry::kReversal ? "reversal" : "none";
}

Symmetry symmetry_from_string(const std::string& name) {
  for (Symmetry symmetry : {Symmetry::kNone, Symmetry::kReversal})
    if (name == to_string(symmetry)) return symmetry;
  throw std::invalid_argument(
      fmt::format("symmetry \"{}\": must be \"none\" or \"reversal\"", name));
}

void PolicyMetadata::validate() const {
  environment().validate();
  if (observation != "direction")
    throw std::invalid_argument(
        fmt::format("observation \"{}\": must be \"direction\"", observation));
  if (action != "hinge_rates")
    throw std::invalid_argument(fmt::format("action \"{}\": must be \"hinge_rates\"", action));
  if (symmetry == Symmetry::kReversal && links % 2 == 0)
    throw std::invalid_argument(
        fmt::format("symmetry \"reversal\" with {} links: needs an odd number", links));
}

threelink_sim::EnvironmentConfig PolicyMetadata::environment() const {
  threelink_sim::EnvironmentConfig config;
  config.model.links = links;
  config.model.gamma = gamma;
  config.dt = dt;
  return config;
}

int PolicyMetadata::observation_size() const {
  return threelink_sim::direction_observation_size(environment().model);
}

Policy::Policy(PolicyMetadata metadata, Mlp actor, Eigen::VectorXf log_std)
    : metadata_(std::move(metadata)), actor_(std::move(actor)), log_std_(std::move(log_std)) {
  try {
    const Container container = to_container({metadata_, actor_.layers(), log_std_});
    from_container(container);  // for its checks
    SerializedContainer file = threelink_agent::serialize(container);
    bytes_ = std::move(file.bytes);
    sha256_ = std::move(file.sha256);
  } catch (const ContainerError& error) {
    throw PolicyError(error.what());
  }
}

Policy Policy::load(const std::string& path) {
  try {
    return parse(read_file(path, kMaxContainerBytes), path);
  } catch (const FileError& error) {
    throw PolicyError(error.what());
  }
}

Policy Policy::parse(const std::string& bytes, const std::string& source) {
  const auto refuse = [&](const std::exception& error) {
    return PolicyError(fmt::format("{}: {}", source, error.what()));
  };
  try {
    std::string data_hash;
    PolicyParts parts = from_container(parse_container(bytes, data_hash));
    Policy policy(std::move(parts.metadata), Mlp(std::move(parts.layers)),
                  std::move(parts.log_std));
    // Another program may have laid out the same tensors in another order.
    policy.bytes_ = bytes;
    policy.sha256_ = data_hash;
    return policy;
  } catch (const ContainerError& error) {
    throw refuse(error);
  } catch (const PolicyError& error) {
    throw refuse(error);
  }
}

void Policy::save(const std::string& path) const { write_file(path, bytes_); }

void Policy::act(const double* observation, double* rates) const {
  float x[Mlp::kMaxWidth], y[Mlp::kMaxWidth];
  std::copy_n(observation, observation_size(), x);
  const bool reverse = reversed(metadata_, observation[0]);
  if (reverse) reverse_observation(x, hinges(), 1, 0);
  actor_.forward(x, y);
  if (reverse) reverse_rates(y, hinges(), 1, 0);
  std::transform(y, y + hinges(), rates, clip);
}

void Policy::act(std::size_t n, const double* observations, double* rates,
                 std::vector<float>& scratch) const {
  const std::size_t inputs = n * observation_size(), outputs = n * hinges();
  scratch.resize(inputs + outputs);
  float* x = scratch.data();
  float* y = x + inputs;
  std::copy_n(observations, inputs, x);
  for (std::size_t i = 0; i < n; ++i)
    if (reversed(metadata_, observations[i])) reverse_observation(x, hinges(), n, i);
  actor_.forward(n, x, y);
  for (std::size_t i = 0; i < n; ++i)
    if (reversed(metadata_, observations[i])) reverse_rates(y, hinges(), n, i);
  std::transform(y, y + outputs, rates, clip);
}

}  // namespace threelink_agent

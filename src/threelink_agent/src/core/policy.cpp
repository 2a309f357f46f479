#include "threelink_agent/policy.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include <fmt/format.h>

#include "policy_file.hpp"
#include "threelink_agent/symmetry.hpp"
#include "threelink_sim/environment.hpp"
#include "threelink_sim/files.hpp"
#include "threelink_sim/kernel/kernels.hpp"
#include "threelink_sim/random.hpp"

namespace threelink_agent {
namespace {

// Whether the network is to see this observation from the swimmer's other end.
bool reversed(const PolicyMetadata& metadata, double cos_theta_d) {
  return metadata.symmetry == Symmetry::kReversal && cos_theta_d < 0;
}

double clip(float rate) { return std::clamp(static_cast<double>(rate), -1.0, 1.0); }

// Mean rates (hinges, n) of lane i -> sampled ones.
void add_noise(const ActionKey& key, const Eigen::VectorXf& std, std::size_t n, std::size_t i,
               float* rates) {
  const std::uint32_t seed[] = {static_cast<std::uint32_t>(key.seed),
                                static_cast<std::uint32_t>(key.seed >> 32)};
  threelink_sim::RandomCounter counter{
      0, key.step, key.episode, static_cast<std::uint32_t>(threelink_sim::Stream::kExploration)};
  double pair[2];
  for (int j = 0; j < std.size(); ++j) {
    if (j % 2 == 0) threelink_sim::kernels().normals(1, seed, &counter.draw, pair);
    rates[j * n + i] += std[j] * static_cast<float>(pair[j % 2]);
    counter.draw += j % 2;
  }
}

}  // namespace

threelink_sim::Words<Symmetry> words_of(Symmetry) {
  return {{Symmetry::kNone, "none"}, {Symmetry::kReversal, "reversal"}};
}

std::string to_string(Symmetry symmetry) { return threelink_sim::word_of(symmetry); }

Symmetry symmetry_from_string(const std::string& name) {
  for (const auto& [symmetry, word] : words_of(Symmetry()))
    if (name == word) return symmetry;
  throw std::invalid_argument(
      fmt::format("symmetry \"{}\": must be \"none\" or \"reversal\"", name));
}

void PolicyMetadata::validate() const {
  environment().validate();
  if (action != "hinge_rates")
    throw std::invalid_argument(fmt::format("action \"{}\": must be \"hinge_rates\"", action));
}

threelink_sim::EnvironmentConfig PolicyMetadata::environment() const {
  threelink_sim::EnvironmentConfig config;
  config.model.links = links;
  config.model.gamma = gamma;
  config.model.joint_limit = joint_limit;
  config.dt = dt;
  config.observation = observation;
  return config;
}

int PolicyMetadata::observation_size() const {
  return threelink_sim::observation_size(observation, environment().model);
}

Policy::Policy(PolicyMetadata metadata, Mlp actor, Eigen::VectorXf log_std)
    : metadata_(std::move(metadata)), actor_(std::move(actor)), log_std_(std::move(log_std)) {
  std_ = log_std_.unaryExpr([](float value) { return std::exp(value); });
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
    return parse(threelink_sim::read_file(path, kMaxContainerBytes), path);
  } catch (const threelink_sim::FileError& error) {
    throw PolicyError(error.what());
  }
}

Policy Policy::parse(const std::string& bytes, const std::string& source) {
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
    throw threelink_sim::within<PolicyError>(source, error);
  } catch (const PolicyError& error) {
    throw PolicyError(fmt::format("{}: {}", source, error.what()),
                      source + ": is no policy that can be used; the log of its reader says why");
  }
}

void Policy::save(const std::string& path) const { threelink_sim::write_file(path, bytes_); }

void Policy::act_or_sample(std::size_t n, const double* observations, const ActionKey* keys,
                           double* rates, float* x, float* y) const {
  std::copy_n(observations, n * observation_size(), x);
  for (std::size_t i = 0; i < n; ++i)
    if (reversed(metadata_, observations[i]))
      reverse_observation(x, observation_size(), hinges(), n, i);
  n == 1 ? actor_.forward(x, y) : actor_.forward(n, x, y);
  for (std::size_t i = 0; i < n; ++i) {
    if (keys) add_noise(keys[i], std_, n, i, y);
    if (reversed(metadata_, observations[i])) reverse_rates(y, hinges(), n, i);
  }
  std::transform(y, y + n * hinges(), rates, clip);
}

void Policy::act(const double* observation, double* rates) const {
  float x[Mlp::kMaxWidth], y[Mlp::kMaxWidth];
  act_or_sample(1, observation, nullptr, rates, x, y);
}

void Policy::sample(const double* observation, const ActionKey& key, double* rates) const {
  float x[Mlp::kMaxWidth], y[Mlp::kMaxWidth];
  act_or_sample(1, observation, &key, rates, x, y);
}

void Policy::act(std::size_t n, const double* observations, double* rates,
                 std::vector<float>& scratch) const {
  sample(n, observations, nullptr, rates, scratch);
}

void Policy::sample(std::size_t n, const double* observations, const ActionKey* keys, double* rates,
                    std::vector<float>& scratch) const {
  scratch.resize(n * (observation_size() + hinges()));
  act_or_sample(n, observations, keys, rates, scratch.data(),
                scratch.data() + n * observation_size());
}

}  // namespace threelink_agent

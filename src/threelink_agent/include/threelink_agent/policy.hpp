/// @file
/// A policy: the actor network, its kind of observation and the swimmer that it was trained for.
///
/// The file is a safetensors container; docs/learning.md gives the format and a reader in numpy.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "threelink_agent/mlp.hpp"
#include "threelink_sim/environment.hpp"
#include "threelink_sim/usage_error.hpp"
#include "threelink_sim/words.hpp"

namespace threelink_agent {

/// Error for a file that is not a policy, or not one for this swimmer. what() names the file and
/// the reason.
class PolicyError : public threelink_sim::UsageError {
 public:
  using UsageError::UsageError;
};

/// Symmetry that is imposed on the policy outside the network.
enum class Symmetry {
  kNone,
  /// Swapping the two ends (symmetry.hpp). If cos theta_d < 0 the network sees the swimmer
  /// from its other end,
  /// (-cos, -sin, -alpha_{N-1}, .., -alpha_1), and its rates are swapped back, r_j = -r'_{N-j}.
  kReversal,
};
/// The names of the symmetries.
threelink_sim::Words<Symmetry> words_of(Symmetry);
std::string to_string(Symmetry symmetry);           ///< "none", "reversal"
Symmetry symmetry_from_string(const std::string&);  ///< throws std::invalid_argument

/// Everything that a policy file says beside the weights.
struct PolicyMetadata {
  threelink_sim::ObservationKind observation = threelink_sim::ObservationKind::kDirection;
  std::string action = "hinge_rates";
  int links = 3;                                            ///< N
  double dt = 0.1;                                          ///< [T0] action step it was trained for
  double gamma = 0.5;                                       ///< drag ratio it was trained for
  double joint_limit = threelink_sim::Model().joint_limit;  ///< [rad] likewise
  Symmetry symmetry = Symmetry::kNone;
  bool sampled = false;  ///< play sampled actions; else their mean
  std::string config;    ///< YAML: the complete effective training configuration

  /// Throws std::invalid_argument that names field, value and bound.
  void validate() const;
  int observation_size() const;
  /// The environment with these links, drag ratio, joint limit, action step and observation; the
  /// other values are defaults.
  threelink_sim::EnvironmentConfig environment() const;
};

/// Key of the noise of a sampled action, which depends on nothing else.
struct ActionKey {
  std::uint64_t seed;
  std::uint32_t episode;
  std::uint32_t step;
};

/// An actor network with its metadata; immutable and equal to its file.
class Policy {
 public:
  /// log_std (N-1): logarithm of the standard deviation of the sampled rates. Throws PolicyError if
  /// metadata, shapes and values are inconsistent.
  Policy(PolicyMetadata metadata, Mlp actor, Eigen::VectorXf log_std);

  /// Reads a policy file. load() and parse() check format, hashes, shapes and every number, and
  /// throw PolicyError that names the file (or `source`), the tensor, its shape and the expected
  /// shape.
  static Policy load(const std::string& path);
  static Policy parse(const std::string& bytes, const std::string& source);

  /// The bytes of the policy file. save() writes them by write_file() and throws FileError.
  const std::string& serialize() const { return bytes_; }
  void save(const std::string& path) const;

  const PolicyMetadata& metadata() const { return metadata_; }
  const Mlp& actor() const { return actor_; }
  const Eigen::VectorXf& log_std() const { return log_std_; }
  const std::string& sha256() const { return sha256_; }     ///< of the data part, 64 hex digits
  std::string id() const { return sha256_.substr(0, 16); }  ///< identifier in HingeRates messages

  int observation_size() const { return actor_.inputs(); }
  int hinges() const { return actor_.outputs(); }

  /// Mean action for one observation (observation_size()): rates (hinges()) [1/T0], clipped to [-1,
  /// 1] and finite for observations within +- kMaxObservation. Does not allocate.
  void act(const double* observation, double* rates) const;

  /// Mean actions for n observations, component k of lane i at [k * n + i], equal to the bit to
  /// those of single observations. scratch is resized as needed and can be kept between calls.
  void act(std::size_t n, const double* observations, double* rates,
           std::vector<float>& scratch) const;

  /// Sampled action: the mean plus exp(log_std) times standard normals (Stream::kExploration), then
  /// clipped. Normal d of the key belongs to hinge d of the swimmer as the network observes it.
  void sample(const double* observation, const ActionKey& key, double* rates) const;
  /// Sampled actions for n observations; keys (n), or null for the mean. Equal to the bit to those
  /// of single observations.
  void sample(std::size_t n, const double* observations, const ActionKey* keys, double* rates,
              std::vector<float>& scratch) const;

 private:
  /// Mean or sampled actions; the mean if keys is null.
  void act_or_sample(std::size_t n, const double* observations, const ActionKey* keys,
                     double* rates, float* x, float* y) const;

  PolicyMetadata metadata_;
  Mlp actor_;
  Eigen::VectorXf log_std_, std_;
  std::string bytes_, sha256_;
};

/// Largest absolute value of a component of an observation. It is far above any value in use, and
/// no sum of the network overflows within this bound and kMaxParameter.
constexpr double kMaxObservation = 1e6;
/// Largest absolute value of a number in a policy file.
constexpr float kMaxParameter = 1e6F;

}  // namespace threelink_agent

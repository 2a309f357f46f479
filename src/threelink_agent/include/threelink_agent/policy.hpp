// A policy: the actor network, what it observes and for which swimmer it was trained.
//
// The file is a safetensors container; docs/learning.md gives the format and ten lines of numpy
// that read it.
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

// A file that is no policy, or not one for this swimmer; what() names the file and the reason.
class PolicyError : public threelink_sim::UsageError {
 public:
  using UsageError::UsageError;
};

// Symmetry that the policy uses outside the network.
enum class Symmetry {
  kNone,
  // Swapping the two ends (symmetry.hpp). If cos theta_d < 0 the network sees the swimmer
  // from its other end,
  // (-cos, -sin, -alpha_{N-1}, .., -alpha_1), and its rates are swapped back, r_j = -r'_{N-j}.
  kReversal,
};
threelink_sim::Words<Symmetry> words_of(Symmetry);
std::string to_string(Symmetry symmetry);           // "none", "reversal"
Symmetry symmetry_from_string(const std::string&);  // throws std::invalid_argument

struct PolicyMetadata {
  threelink_sim::ObservationKind observation = threelink_sim::ObservationKind::kDirection;
  std::string action = "hinge_rates";
  int links = 3;                                            // N
  double dt = 0.1;                                          // [T0] action step it was trained for
  double gamma = 0.5;                                       // drag ratio it was trained for
  double joint_limit = threelink_sim::Model().joint_limit;  // [rad] likewise
  Symmetry symmetry = Symmetry::kNone;
  bool sampled = false;  // how it is best played: with sampled actions, else with their mean
  std::string config;    // YAML: the whole effective training configuration

  // Throws std::invalid_argument that names field, value and bound.
  void validate() const;
  int observation_size() const;
  // Links, drag ratio, joint limit, step and observation; the rest is the default.
  threelink_sim::EnvironmentConfig environment() const;
};

// Where an action is sampled. Its noise is keyed by this, and depends on nothing else.
struct ActionKey {
  std::uint64_t seed;
  std::uint32_t episode;
  std::uint32_t step;
};

class Policy {
 public:
  // log_std (N-1): logarithm of the standard deviation of the sampled rates. Throws PolicyError if
  // metadata, shapes and values do not fit each other.
  Policy(PolicyMetadata metadata, Mlp actor, Eigen::VectorXf log_std);

  // Both check format, hashes, shapes and every number, and throw PolicyError naming the file (or
  // `source`), the tensor, its shape and the one expected.
  static Policy load(const std::string& path);
  static Policy parse(const std::string& bytes, const std::string& source);

  // The file's bytes; save() puts them into a file by write_file() and throws FileError.
  const std::string& serialize() const { return bytes_; }
  void save(const std::string& path) const;

  const PolicyMetadata& metadata() const { return metadata_; }
  const Mlp& actor() const { return actor_; }
  const Eigen::VectorXf& log_std() const { return log_std_; }
  const std::string& sha256() const { return sha256_; }     // of the data part, 64 hex digits
  std::string id() const { return sha256_.substr(0, 16); }  // what hinge_rates carry

  int observation_size() const { return actor_.inputs(); }
  int hinges() const { return actor_.outputs(); }

  // Mean action of one observation (observation_size()) -> rates (hinges()) [1/T0], clipped to
  // [-1, 1]; finite for observations within +- kMaxObservation. Does not allocate.
  void act(const double* observation, double* rates) const;

  // Of n observations, component k of lane i at [k * n + i]; the same bits as act() for each lane.
  // scratch is resized as needed and can be kept between calls.
  void act(std::size_t n, const double* observations, double* rates,
           std::vector<float>& scratch) const;

  // The same with noise: the mean plus exp(log_std) times standard normals (Stream::kExploration),
  // then clipped. Normal d of the key goes to hinge d of the swimmer as the network sees it.
  void sample(const double* observation, const ActionKey& key, double* rates) const;
  // keys (n), or null for the mean; the same bits for each lane.
  void sample(std::size_t n, const double* observations, const ActionKey* keys, double* rates,
              std::vector<float>& scratch) const;

 private:
  // Both kinds of action; without keys the mean.
  void act_or_sample(std::size_t n, const double* observations, const ActionKey* keys,
                     double* rates, float* x, float* y) const;

  PolicyMetadata metadata_;
  Mlp actor_;
  Eigen::VectorXf log_std_, std_;
  std::string bytes_, sha256_;
};

// Bounds on the numbers of an observation and of a policy file: far beyond any in use, and within
// them no sum of the network overflows.
constexpr double kMaxObservation = 1e6;
constexpr float kMaxParameter = 1e6F;

}  // namespace threelink_agent

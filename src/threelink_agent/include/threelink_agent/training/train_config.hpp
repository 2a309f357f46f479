// Everything that decides what a training does; config/train_vfs.yaml explains each value.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "threelink_agent/policy.hpp"
#include "threelink_agent/training/homing.hpp"
#include "threelink_sim/environment.hpp"
#include "threelink_sim/usage_error.hpp"

namespace threelink_agent {

// A configuration that cannot be used; what() names the file, the key, its value and the bound. A
// peer is told no value.
class ConfigError : public threelink_sim::UsageError {
 public:
  using UsageError::UsageError;
};

struct TrainConfig {
  std::uint64_t seed = 0;            // of every random number; any value, 0 too; below 2^63
  std::uint32_t episodes = 0;        // N_E, in [1, 1e8]
  std::uint32_t evaluate_every = 0;  // [updates] between deterministic evaluations, at least 1

  // Links, drag ratio, dt, b, c and N_s. Its observation is what the critic is shown: "target" with
  // homing, else "direction".
  threelink_sim::EnvironmentConfig environment;

  std::optional<HomingConfig> homing;  // points to reach; without them there is only a direction

  // Widths of the tanh layers of actor and critic, 1 to 8 of them in [1, Mlp::kMaxWidth].
  std::vector<int> hidden;

  struct {
    Symmetry canonical = Symmetry::kNone;  // applied to what the networks see
    bool mirror = false;                   // show a random half of the episodes mirrored
  } symmetry;

  struct {
    bool learned = false;       // by gradient, from `std` on; else scheduled
    double std = 0;             // [1/T0] of the noise on the rates, at the start, in [1e-3, 10]
    double std_final = 0;       // [1/T0] scheduled only, in [1e-3, 10]
    double decay_fraction = 0;  // of the training after which std_final is reached, in (0, 1]
  } exploration;

  struct {
    double discount = 0;                  // Gamma, in [0, 1)
    double lambda = 0;                    // of GAE, in [0, 1]; 1: Monte-Carlo returns
    bool bootstrap_at_time_limit = true;  // the time limit cuts the episode, but ends nothing
    bool normalise = true;                // to mean 0 and deviation 1 in each update
  } advantage;

  struct {
    std::uint32_t episodes = 0;       // M, rolled out before each update, in [1, 1e6]
    std::uint32_t epochs = 0;         // K, in [1, 1000]
    std::uint32_t minibatch = 0;      // [samples] in [1, M N_s]
    double clip = 0;                  // epsilon, in (0, 1)
    double entropy_weight = 0;        // chi, in [0, 10]; needs a learned std
    double max_gradient_norm = 0;     // of each network, in (0, 1e9]
    double actor_learning_rate = 0;   // at the start, in (0, 1]
    double critic_learning_rate = 0;  // at the start, in (0, 1]
    double final_learning_rate = 0;   // of both, at the end, as a fraction of the start; in [0, 1]
  } update;

  // Throws ConfigError that names key, value and bound.
  void validate() const;

  threelink_sim::ObservationKind actor_observation() const {
    return homing ? homing->observation : environment.observation;
  }
  // Number of updates; the last one has fewer episodes if M does not divide N_E.
  std::uint32_t updates() const { return (episodes + update.episodes - 1) / update.episodes; }
};

// Reads YAML that holds every key, no other, each once and of its type, and validates it. What
// other programs would take for text is no number: quotes, and 1e-3 without its point (YAML 1.1).
// Throws ConfigError; for an unknown key it names the nearest known one.
TrainConfig load_train_config(const std::string& path);
TrainConfig parse_train_config(const std::string& yaml, const std::string& source);

// The YAML that parse_train_config() reads back to the same configuration.
std::string to_yaml(const TrainConfig& config);

// The first key in which two configurations differ, with both values as to_yaml() writes them.
struct ConfigDifference {
  std::string key, a, b;
};
std::optional<ConfigDifference> first_difference(const TrainConfig& a, const TrainConfig& b);

}  // namespace threelink_agent

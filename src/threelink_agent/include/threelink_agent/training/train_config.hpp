/// @file
/// The configuration of a training. docs/learning.md explains each key.
#pragma once

#include <cstdint>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "threelink_agent/mlp.hpp"
#include "threelink_agent/policy.hpp"
#include "threelink_agent/training/advantage.hpp"
#include "threelink_sim/environment.hpp"
#include "threelink_sim/fields.hpp"
#include "threelink_sim/goal/goals.hpp"
#include "threelink_sim/parameter_map.hpp"

namespace threelink_agent {

/// Error of a configuration. what() names the file, the key, its value and the bound; for_peers()
/// leaves the value out.
using ConfigError = threelink_sim::ParameterError;

/// Version of the keys that to_yaml() writes. Files of version 1 have no key `version`. They have
/// neither environment.joint_limit (it was 2 pi / 3) nor `goal` and `observation`, but may have a
/// section `homing` with the goal "points" and the observation.
constexpr int kConfigVersion = 2;

/// Section `symmetry`.
struct SymmetryConfig {
  Symmetry canonical = Symmetry::kNone;
  bool mirror = false;

  template <class Self, class Visit>
  static void fields(Self& self, Visit&& visit) {
    visit("canonical", self.canonical, "applied to what the networks see");
    visit("mirror", self.mirror, "show a random half of the episodes mirrored");
  }
};

/// Section `exploration`.
struct ExplorationConfig {
  bool learned = false;
  double std = 0;
  double std_final = 0;
  double decay_fraction = 0;

  template <class Self, class Visit>
  static void fields(Self& self, Visit&& visit) {
    using threelink_sim::Range;
    visit("learned", self.learned, "by gradient, from `std` on; else scheduled");
    visit("std", self.std, Range<double>{1e-3, 10},
          "[1/T0] of the noise on the rates, at the start");
    if (self.learned) return;
    visit("std_final", self.std_final, Range<double>{1e-3, 10}, "[1/T0] reached, log-linearly,");
    visit("decay_fraction", self.decay_fraction, Range<double>{0, 1, true},
          "after this fraction of the training");
  }
};

/// Section `update`.
struct UpdateConfig {
  std::uint32_t episodes = 0;
  std::uint32_t epochs = 0;
  std::uint32_t minibatch = 0;
  double clip = 0;
  double entropy_weight = 0;
  double max_gradient_norm = 0;
  double actor_learning_rate = 0;
  double critic_learning_rate = 0;
  double final_learning_rate = 0;

  template <class Self, class Visit>
  static void fields(Self& self, Visit&& visit) {
    using threelink_sim::Range;
    visit("episodes", self.episodes, Range<std::uint32_t>{1, 1'000'000},
          "M, rolled out before each update");
    visit("epochs", self.epochs, Range<std::uint32_t>{1, 1000},
          "K, times that each sample is used");
    visit("minibatch", self.minibatch, Range<std::uint32_t>{1, kMostSamples},
          "[samples], of the M N_s");
    visit("clip", self.clip, Range<double>{0, 1, true, true}, "epsilon of the ratio");
    visit("entropy_weight", self.entropy_weight, Range<double>{0, 10}, "chi; needs a learned std");
    visit("max_gradient_norm", self.max_gradient_norm, Range<double>{0, 1e9, true},
          "of each network");
    visit("actor_learning_rate", self.actor_learning_rate, Range<double>{0, 1, true},
          "at the start");
    visit("critic_learning_rate", self.critic_learning_rate, Range<double>{0, 1, true},
          "at the start");
    visit("final_learning_rate", self.final_learning_rate, Range<double>{0, 1},
          "of both, at the end, as a fraction of the start");
  }

  static constexpr std::uint32_t kMostSamples = 10'000'000;
};

/// All sections.
struct TrainConfig {
  std::uint64_t seed = 0;            ///< key of all random numbers
  std::uint32_t episodes = 0;        ///< N_E
  std::uint32_t evaluate_every = 0;  ///< [updates] between deterministic evaluations

  /// Links, drag ratio, joint limit, dt, b, c, N_s and the world. Its observation is that of the
  /// critic: "target" if the goal has a target, else "direction".
  threelink_sim::EnvironmentConfig environment;

  /// Observation of the policy.
  threelink_sim::ObservationKind observation = threelink_sim::ObservationKind::kDirection;

  threelink_sim::GoalConfig goal;

  /// Widths of the tanh layers of actor and critic, 1 to 8 of them.
  std::vector<int> hidden;

  SymmetryConfig symmetry;
  ExplorationConfig exploration;
  AdvantageSettings advantage;
  UpdateConfig update;

  /// All fields but the goal. version: version of the file that is read.
  template <class Self, class Visit>
  static void fields(Self& self, Visit&& visit, int version = kConfigVersion) {
    using threelink_sim::Range;
    constexpr auto kMaxSeed = static_cast<std::uint64_t>(std::numeric_limits<std::int64_t>::max());
    visit("seed", self.seed, Range<std::uint64_t>{0, kMaxSeed}, "of every random number");
    visit("episodes", self.episodes, Range<std::uint32_t>{1, 100'000'000}, "N_E");
    visit("evaluate_every", self.evaluate_every, Range<std::uint32_t>{1, 1'000'000},
          "[updates] between evaluations");
    const auto of_version = [&](const std::string& name, auto& field, const auto&... rest) {
      if (version >= 2 || name != "environment.joint_limit") visit(name, field, rest...);
    };
    threelink_sim::visit_section("environment", self.environment, of_version);
    if (version >= 2) visit("observation", self.observation, "what the policy is shown");
    visit("hidden", self.hidden, Range<int>{1, Mlp::kMaxWidth},
          "widths of the tanh layers of actor and critic");
    threelink_sim::visit_section("symmetry", self.symmetry, visit);
    threelink_sim::visit_section("exploration", self.exploration, visit);
    threelink_sim::visit_section("advantage", self.advantage, visit);
    threelink_sim::visit_section("update", self.update, visit);
  }

  /// Throws ConfigError that names key, value and bound.
  void validate() const;

  /// Observation of the critic.
  threelink_sim::ObservationKind critic_observation() const {
    return goal.has_target() ? threelink_sim::ObservationKind::kTarget
                             : threelink_sim::ObservationKind::kDirection;
  }
  /// Number of updates; the last one has fewer episodes if M does not divide N_E.
  std::uint32_t updates() const { return (episodes + update.episodes - 1) / update.episodes; }
};

/// Reads and validates a YAML file that holds every key once, and no other. Values that other
/// programs would read as text are not numbers: values in quotes, and 1e-3 without a decimal point
/// (YAML 1.1). Throws ConfigError, which names the nearest known key for an unknown one.
TrainConfig load_train_config(const std::string& path);
/// The same for text. source: its name in messages.
TrainConfig parse_train_config(const std::string& yaml, const std::string& source);

/// YAML that parse_train_config() reads back to the same configuration.
std::string to_yaml(const TrainConfig& config);

/// The first key in which two configurations differ, with both values as to_yaml() writes them;
/// empty if they are equal.
std::optional<threelink_sim::FieldDifference> first_difference(const TrainConfig& a,
                                                               const TrainConfig& b);

}  // namespace threelink_agent

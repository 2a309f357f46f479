#include "threelink_agent/training/train_config.hpp"

#include <limits>

#include <fmt/format.h>

#include "threelink_agent/mlp.hpp"

namespace threelink_agent {
namespace {

template <class Number>
[[noreturn]] void refuse(const char* key, Number value, const std::string& bound) {
  throw ConfigError(fmt::format("{} = {}: must be {}", key, value, bound),
                    fmt::format("{}: must be {}", key, bound));
}

void check_count(const char* key, std::uint32_t value, std::uint32_t most) {
  if (value < 1 || value > most) refuse(key, value, fmt::format("in [1, {}]", most));
}

}  // namespace

void TrainConfig::validate() const {
  if (seed > static_cast<std::uint64_t>(std::numeric_limits<std::int64_t>::max()))
    refuse("seed", seed, "below 2^63");
  check_count("episodes", episodes, 100'000'000);
  check_count("evaluate_every", evaluate_every, 1'000'000);
  try {
    environment.validate();
  } catch (const std::invalid_argument& error) {
    throw ConfigError(fmt::format("environment.{}", error.what()), "environment: out of bounds");
  }
  check_count("environment.steps", environment.steps, 1'000'000);

  using threelink_sim::ObservationKind;
  const auto critic = homing ? ObservationKind::kTarget : ObservationKind::kDirection;
  if (environment.observation != critic)
    refuse("environment.observation", to_string(environment.observation), to_string(critic));
  if (homing) {
    const auto check = [](const char* key, double value, double least, double most) {
      if (!(value >= least && value <= most))
        refuse(key, value, fmt::format("in [{}, {}]", least, most));
    };
    check("homing.direction_share", homing->direction_share, 0, 1);
    check("homing.nearest", homing->nearest, 1e-9, 1e3);
    check("homing.farthest", homing->farthest, homing->nearest, 1e3);
    check("homing.threshold", homing->threshold, 1e-9, 1e3);
    check("homing.bonus", homing->bonus, 0, 1e6);
  }

  if (hidden.empty() || hidden.size() > 8)
    refuse("hidden", fmt::format("{} layers", hidden.size()), "1 to 8 layers");
  for (int width : hidden)
    if (width < 1 || width > Mlp::kMaxWidth)
      refuse("hidden", width, fmt::format("in [1, {}] for each layer", Mlp::kMaxWidth));
  if (symmetry.canonical == Symmetry::kReversal && environment.model.links % 2 == 0)
    refuse("symmetry.canonical", to_string(symmetry.canonical),
           fmt::format("none for {} links: only an odd number has a middle link",
                       environment.model.links));

  const auto check_std = [](const char* key, double value) {
    if (!(value >= 1e-3 && value <= 10)) refuse(key, value, "in [0.001, 10]");
  };
  check_std("exploration.std", exploration.std);
  if (!exploration.learned) {
    check_std("exploration.std_final", exploration.std_final);
    if (!(exploration.decay_fraction > 0 && exploration.decay_fraction <= 1))
      refuse("exploration.decay_fraction", exploration.decay_fraction, "in (0, 1]");
  }

  if (!(advantage.discount >= 0 && advantage.discount < 1))
    refuse("advantage.discount", advantage.discount, "in [0, 1)");
  if (!(advantage.lambda >= 0 && advantage.lambda <= 1))
    refuse("advantage.lambda", advantage.lambda, "in [0, 1]");

  check_count("update.episodes", update.episodes, 1'000'000);
  check_count("update.epochs", update.epochs, 1000);
  const std::uint64_t samples = std::uint64_t{update.episodes} * environment.steps;
  if (samples > 10'000'000)
    refuse("update.episodes", update.episodes,
           fmt::format("at most {} for environment.steps = {}", 10'000'000 / environment.steps,
                       environment.steps));
  check_count("update.minibatch", update.minibatch, static_cast<std::uint32_t>(samples));
  if (!(update.clip > 0 && update.clip < 1)) refuse("update.clip", update.clip, "in (0, 1)");
  if (!(update.entropy_weight >= 0 && update.entropy_weight <= 10))
    refuse("update.entropy_weight", update.entropy_weight, "in [0, 10]");
  if (update.entropy_weight > 0 && !exploration.learned)
    refuse("update.entropy_weight", update.entropy_weight,
           "0 unless exploration.learned: a scheduled std has no gradient");
  if (!(update.max_gradient_norm > 0 && update.max_gradient_norm <= 1e9))
    refuse("update.max_gradient_norm", update.max_gradient_norm, "in (0, 1e9]");
  const auto check_rate = [](const char* key, double value) {
    if (!(value > 0 && value <= 1)) refuse(key, value, "in (0, 1]");
  };
  check_rate("update.actor_learning_rate", update.actor_learning_rate);
  check_rate("update.critic_learning_rate", update.critic_learning_rate);
  if (!(update.final_learning_rate >= 0 && update.final_learning_rate <= 1))
    refuse("update.final_learning_rate", update.final_learning_rate, "in [0, 1]");
}

}  // namespace threelink_agent

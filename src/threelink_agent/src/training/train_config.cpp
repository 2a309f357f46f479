#include "threelink_agent/training/train_config.hpp"

#include <fmt/format.h>

#include "threelink_sim/files.hpp"
#include "threelink_sim/yaml.hpp"

namespace threelink_agent {
namespace {

using threelink_sim::FieldReader;
using threelink_sim::FieldTexts;
using threelink_sim::ObservationKind;
using threelink_sim::ParameterMap;

constexpr threelink_sim::YamlLimits kLimits{65536, 1000};

template <class Value>
[[noreturn]] void refuse(const char* key, const Value& value, const std::string& bound) {
  throw ConfigError(fmt::format("{} = {}: must be {}", key, value, bound),
                    fmt::format("{}: must be {}", key, bound));
}

// A file of version 1 has no key for it.
int read_version(ParameterMap& map) {
  if (!map.has("version")) {
    if (map.has("environment.joint_limit"))
      map.refuse("environment.joint_limit", "is a key of version 2: write `version: 2`, too");
    return 1;
  }
  return map.integer("version", {2, kConfigVersion});
}

}  // namespace

void TrainConfig::validate() const {
  threelink_sim::check_fields<ConfigError>(*this);
  const auto critic = homing ? ObservationKind::kTarget : ObservationKind::kDirection;
  if (environment.observation != critic)
    refuse("environment.observation", to_string(environment.observation), to_string(critic));
  if (homing && homing->farthest < homing->nearest)
    refuse("homing.farthest", homing->farthest,
           fmt::format("at least homing.nearest = {}", homing->nearest));
  if (hidden.empty() || hidden.size() > 8)
    refuse("hidden", fmt::format("{} layers", hidden.size()), "1 to 8 layers");
  if (symmetry.canonical == Symmetry::kReversal && environment.model.links % 2 == 0)
    refuse("symmetry.canonical", to_string(symmetry.canonical),
           fmt::format("none for {} links: only an odd number has a middle link",
                       environment.model.links));
  const std::uint64_t samples = std::uint64_t{update.episodes} * environment.steps;
  if (samples > UpdateConfig::kMostSamples)
    refuse("update.episodes", update.episodes,
           fmt::format("at most {} for environment.steps = {}",
                       UpdateConfig::kMostSamples / environment.steps, environment.steps));
  if (update.minibatch > samples)
    refuse("update.minibatch", update.minibatch, fmt::format("in [1, {}]", samples));
  if (update.entropy_weight > 0 && !exploration.learned)
    refuse("update.entropy_weight", update.entropy_weight,
           "0 unless exploration.learned: a scheduled std has no gradient");
}

TrainConfig parse_train_config(const std::string& yaml, const std::string& source) {
  ParameterMap map = threelink_sim::parse_config(source, yaml, kLimits);
  const int version = read_version(map);
  TrainConfig config;
  if (map.has_section("homing")) {
    config.homing.emplace();
    config.environment.observation = ObservationKind::kTarget;
  }
  TrainConfig::fields(config, FieldReader(map), version);
  map.finish();
  try {
    config.validate();
  } catch (const ConfigError& error) {
    throw threelink_sim::within<ConfigError>(source, error);
  }
  return config;
}

TrainConfig load_train_config(const std::string& path) {
  try {
    return parse_train_config(threelink_sim::read_file(path, kLimits.bytes), path);
  } catch (const threelink_sim::FileError& error) {
    throw ConfigError(error.what());
  }
}

std::string to_yaml(const TrainConfig& config) {
  return fmt::format("version: {}\n", kConfigVersion) +
         threelink_sim::to_yaml(threelink_sim::field_texts(config));
}

std::optional<threelink_sim::FieldDifference> first_difference(const TrainConfig& a,
                                                               const TrainConfig& b) {
  return threelink_sim::first_difference(threelink_sim::field_texts(a),
                                         threelink_sim::field_texts(b));
}

}  // namespace threelink_agent

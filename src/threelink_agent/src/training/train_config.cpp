#include "threelink_agent/training/train_config.hpp"

#include <algorithm>
#include <filesystem>

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
constexpr char kWorld[] = "environment.world";

template <class Value>
[[noreturn]] void refuse(const char* key, const Value& value, const std::string& bound) {
  throw ConfigError(fmt::format("{} = {}: must be {}", key, value, bound),
                    fmt::format("{}: must be {}", key, bound));
}

// A file of version 1 has no key for it.
int read_version(ParameterMap& map) {
  if (map.has("version")) return map.integer("version", {2, kConfigVersion});
  for (const char* name : {"environment.joint_limit", "observation", "goal"})
    if (map.has_section(name)) map.refuse(name, "is a key of version 2: write `version: 2`, too");
  return 1;
}

// The goal and the observation of version 1.
void read_homing(ParameterMap& section, TrainConfig& config) {
  const FieldReader read(section);
  read("observation", config.observation, "");
  threelink_sim::PointsGoal::fields(config.goal.points.emplace(), read);
}

// `environment.world`: the name of a file, from the folder of the configuration, or what such a
// file says. Absent: still water.
void read_world(ParameterMap& map, const std::string& source, TrainConfig& config) {
  const std::string folder = std::filesystem::path(source).parent_path().string();
  const std::string place = source + ": " + kWorld;
  if (map.has(kWorld)) {
    config.environment.world = threelink_sim::World::read(map.text(kWorld), place, folder);
  } else if (map.has_section(kWorld)) {
    YAML::Emitter text;
    text << map.section_values(kWorld);
    config.environment.world = threelink_sim::World::parse(text.c_str(), place, folder);
  }
}

FieldTexts texts_of(const TrainConfig& config) {
  FieldTexts texts = threelink_sim::field_texts(config);
  const auto& world = config.environment.world;
  if (world && !world->still()) {
    // Behind the other keys of its section.
    const auto other = std::find_if(texts.begin(), texts.end(),
                                    [](const auto& text) { return text.first == "observation"; });
    texts.emplace(other, kWorld, threelink_sim::yaml_text(world->yaml()));
  }
  for (const auto& [name, value] : threelink_sim::field_texts(config.goal))
    texts.emplace_back("goal." + name, value);
  if (config.goal.task)
    for (const auto& [name, value] : config.goal.task->parameters)
      texts.emplace_back("goal." + name, value);
  return texts;
}

}  // namespace

void TrainConfig::validate() const {
  threelink_sim::check_fields<ConfigError>(*this);
  try {
    threelink_sim::check_fields<ConfigError>(goal);
  } catch (const ConfigError& error) {
    throw ConfigError(std::string("goal.") + error.what(), "goal." + error.for_peers());
  }
  if (environment.observation != critic_observation())
    refuse("the critic's observation", to_string(environment.observation),
           to_string(critic_observation()));
  if (observation == ObservationKind::kTarget && !goal.has_target())
    refuse("observation", to_string(observation), "direction, since the goal has no target");
  if (goal.points && goal.points->farthest < goal.points->nearest)
    refuse("goal.farthest", goal.points->farthest,
           fmt::format("at least goal.nearest = {}", goal.points->nearest));
  const auto& world = environment.world;
  if (symmetry.mirror && world && (world->has_flow() || !world->obstacles().empty()))
    refuse("symmetry.mirror", symmetry.mirror,
           "false: flow and obstacles are not their own mirror images");
  if (world)
    world->check_step(environment.dt,
                      threelink_sim::substeps(environment.model, environment.dt, 1));
  if (hidden.empty() || hidden.size() > 8)
    refuse("hidden", fmt::format("{} layers", hidden.size()), "1 to 8 layers");
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
  TrainConfig::fields(config, FieldReader(map), version);
  read_world(map, source, config);
  std::optional<ParameterMap> section;
  if (version >= 2) {
    if (map.has_section("homing"))
      map.refuse("homing",
                 "is of version 1; now it is `goal: {kind: points, ..}`, and observation");
    section.emplace(map.section("goal"));
    config.goal = threelink_sim::read_goal(*section, config.environment.dt);
  } else if (map.has_section("homing")) {
    section.emplace(map.section("homing"));
    read_homing(*section, config);
  }
  map.finish();  // first, since what is not known says more than what is missing
  if (section) section->finish();
  config.environment.observation = config.critic_observation();
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
  return fmt::format("version: {}\n", kConfigVersion) + threelink_sim::to_yaml(texts_of(config));
}

std::optional<threelink_sim::FieldDifference> first_difference(const TrainConfig& a,
                                                               const TrainConfig& b) {
  return threelink_sim::first_difference(texts_of(a), texts_of(b));
}

}  // namespace threelink_agent

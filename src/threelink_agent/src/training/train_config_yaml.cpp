// Reading and writing a TrainConfig as YAML, both from one list of its keys.
#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <sstream>
#include <type_traits>
#include <utility>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "threelink_agent/training/train_config.hpp"
#include "threelink_sim/excerpt.hpp"
#include "threelink_sim/files.hpp"
#include "threelink_sim/nearest_name.hpp"
#include "threelink_sim/parameter_map.hpp"
#include "threelink_sim/yaml.hpp"

namespace threelink_agent {
namespace {

using threelink_sim::excerpt;

constexpr threelink_sim::YamlLimits kLimits{65536, 1000};

// The keys, dots for nesting, each with the field that it sets.
template <class Config, class Visitor>
void visit_fields(Config& config, Visitor&& visit) {
  visit("seed", config.seed);
  visit("episodes", config.episodes);
  visit("evaluate_every", config.evaluate_every);
  visit("environment.links", config.environment.model.links);
  visit("environment.gamma", config.environment.model.gamma);
  visit("environment.dt", config.environment.dt);
  visit("environment.b", config.environment.b);
  visit("environment.c", config.environment.c);
  visit("environment.steps", config.environment.steps);
  visit("hidden", config.hidden);
  visit("symmetry.canonical", config.symmetry.canonical);
  visit("symmetry.mirror", config.symmetry.mirror);
  visit("exploration.learned", config.exploration.learned);
  visit("exploration.std", config.exploration.std);
  if (!config.exploration.learned) {
    visit("exploration.std_final", config.exploration.std_final);
    visit("exploration.decay_fraction", config.exploration.decay_fraction);
  }
  visit("advantage.discount", config.advantage.discount);
  visit("advantage.lambda", config.advantage.lambda);
  visit("advantage.bootstrap_at_time_limit", config.advantage.bootstrap_at_time_limit);
  visit("advantage.normalise", config.advantage.normalise);
  visit("update.episodes", config.update.episodes);
  visit("update.epochs", config.update.epochs);
  visit("update.minibatch", config.update.minibatch);
  visit("update.clip", config.update.clip);
  visit("update.entropy_weight", config.update.entropy_weight);
  visit("update.max_gradient_norm", config.update.max_gradient_norm);
  visit("update.actor_learning_rate", config.update.actor_learning_rate);
  visit("update.critic_learning_rate", config.update.critic_learning_rate);
  visit("update.final_learning_rate", config.update.final_learning_rate);
  if (config.homing) {
    visit("homing.observation", config.homing->observation);
    visit("homing.direction_share", config.homing->direction_share);
    visit("homing.nearest", config.homing->nearest);
    visit("homing.farthest", config.homing->farthest);
    visit("homing.threshold", config.homing->threshold);
    visit("homing.bonus", config.homing->bonus);
  }
}

// --- Reading -------------------------------------------------------------------------------------

using Leaves = std::map<std::string, YAML::Node>;

void flatten(const YAML::Node& map, const std::string& prefix, Leaves& leaves) {
  for (const auto& entry : map) {
    const std::string key = prefix + entry.first.Scalar();
    if (entry.second.IsMap()) {
      flatten(entry.second, key + ".", leaves);
    } else if (!leaves.emplace(key, entry.second).second) {  // "a.b" beside {a: {b: ..}}
      throw ConfigError(excerpt(key) + ": given twice", "a key is given twice");
    }
  }
}

std::string shown(const YAML::Node& node) {
  std::ostringstream text;
  text << node;
  return excerpt(text.str());
}

// A value that is not what it must be.
ConfigError refusal(const std::string& key, const std::string& value, const std::string& reason) {
  return ConfigError(fmt::format("{} = {}: {}", key, value, reason),
                     fmt::format("{}: {}", key, reason));
}

// yaml-cpp converts the contents of quotes too; a quoted number is a string.
template <class Value>
Value scalar(const std::string& key, const YAML::Node& node, const char* type) {
  Value value;
  if (!node.IsScalar() || node.Tag() == "!" || !YAML::convert<Value>::decode(node, value))
    throw refusal(key, shown(node), fmt::format("must be {}", type));
  return value;
}

void read(const std::string& key, const YAML::Node& node, double& field) {
  field = scalar<double>(key, node, "a number");
  const std::string& text = node.Scalar();
  const std::size_t e = text.find_first_of("eE");
  if (e == std::string::npos || !std::isfinite(field)) return;
  const bool signed_exponent = text.find_first_of("+-", e) == e + 1;
  if (text.find('.') == std::string::npos || !signed_exponent)
    throw ConfigError(
        fmt::format("{} = {}: must be a number, but YAML 1.1 takes this for text; write {}", key,
                    excerpt(text), threelink_sim::yaml_number(field)),
        key + ": must be a number, but YAML 1.1 takes this for text");
}

void read(const std::string& key, const YAML::Node& node, bool& field) {
  field = scalar<bool>(key, node, "true or false");
}

// Through a signed type: the streams under yaml-cpp read -1 as a large unsigned number.
template <class Integer>
std::enable_if_t<std::is_integral_v<Integer>> read(const std::string& key, const YAML::Node& node,
                                                   Integer& field) {
  const auto value = scalar<std::int64_t>(key, node, "a whole number below 2^63");
  const std::string& text = node.Scalar();
  if (text.size() > 1 && (text[0] == '0' || text.find('x') != std::string::npos))
    throw refusal(key, excerpt(text), "must be written in decimal, without a 0 in front");
  field = static_cast<Integer>(value);
  if (static_cast<std::int64_t>(field) != value || (std::is_unsigned_v<Integer> && value < 0))
    throw refusal(key, fmt::format("{}", value),
                  fmt::format("must be in [{}, {}]", std::numeric_limits<Integer>::min(),
                              std::numeric_limits<Integer>::max()));
}

void read(const std::string& key, const YAML::Node& node, std::vector<int>& field) {
  if (!node.IsSequence()) throw refusal(key, shown(node), "must be a list of whole numbers");
  field.assign(node.size(), 0);
  for (std::size_t i = 0; i < field.size(); ++i)
    read(fmt::format("{}[{}]", key, i), node[i], field[i]);
}

// Of a word that `parse` knows.
template <class Parse>
auto word(const std::string& key, const YAML::Node& node, Parse parse) {
  try {
    return parse(scalar<std::string>(key, node, "a word"));
  } catch (const std::invalid_argument& error) {
    throw ConfigError(fmt::format("{} = {}: {}", key, shown(node), error.what()),
                      key + ": must be a word that is known");
  }
}

void read(const std::string& key, const YAML::Node& node, Symmetry& field) {
  field = word(key, node, symmetry_from_string);
}

void read(const std::string& key, const YAML::Node& node, threelink_sim::ObservationKind& field) {
  field = word(key, node, threelink_sim::observation_kind_from_string);
}

TrainConfig read(const YAML::Node& root) {
  if (!root.IsMap()) throw ConfigError("must be a map of keys to values");
  Leaves leaves;
  flatten(root, "", leaves);
  TrainConfig config;
  if (root["homing"]) {
    config.homing.emplace();
    config.environment.observation = threelink_sim::ObservationKind::kTarget;
  }
  std::vector<std::string> known, missing;
  visit_fields(config, [&](const char* key, auto& field) {
    known.push_back(key);
    const auto leaf = leaves.find(key);
    if (leaf == leaves.end()) {
      missing.push_back(key);
    } else {
      read(key, leaf->second, field);
      leaves.erase(leaf);
    }
  });
  if (!leaves.empty())
    throw ConfigError(
        fmt::format("{}: unknown key (the nearest known one is {})", excerpt(leaves.begin()->first),
                    threelink_sim::nearest_name(leaves.begin()->first, known)),
        "holds a key that is not known");
  if (!missing.empty()) throw ConfigError(missing.front() + ": missing");
  config.validate();
  return config;
}

// --- Writing -------------------------------------------------------------------------------------

template <class Integer>
std::string written(const Integer& value) {
  return fmt::format("{}", value);
}
std::string written(Symmetry value) { return to_string(value); }
std::string written(threelink_sim::ObservationKind value) { return to_string(value); }
std::string written(const std::vector<int>& value) {
  return fmt::format("[{}]", fmt::join(value, ", "));
}

std::string written(double value) { return threelink_sim::yaml_number(value); }

// Every key with its value as text.
using Pairs = std::vector<std::pair<std::string, std::string>>;

Pairs pairs_of(const TrainConfig& config) {
  Pairs pairs;
  visit_fields(
      config, [&](const char* key, const auto& field) { pairs.emplace_back(key, written(field)); });
  return pairs;
}

}  // namespace

TrainConfig parse_train_config(const std::string& yaml, const std::string& source) {
  try {
    return read(threelink_sim::parse_yaml(yaml, kLimits));
  } catch (const threelink_sim::UsageError& error) {
    throw threelink_sim::within<ConfigError>(source, error);
  }
}

TrainConfig load_train_config(const std::string& path) {
  try {
    return parse_train_config(threelink_sim::read_file(path, kLimits.bytes), path);
  } catch (const threelink_sim::FileError& error) {
    throw ConfigError(error.what());
  }
}

std::string to_yaml(const TrainConfig& config) {
  std::string text, section;
  for (const auto& [key, value] : pairs_of(config)) {
    const std::size_t dot = key.find('.');
    if (dot == std::string::npos) {
      text += key + ": " + value + "\n";
      continue;
    }
    if (section != key.substr(0, dot)) text += (section = key.substr(0, dot)) + ":\n";
    text += "  " + key.substr(dot + 1) + ": " + value + "\n";
  }
  return text;
}

std::optional<ConfigDifference> first_difference(const TrainConfig& a, const TrainConfig& b) {
  // The keys are the same up to the first value that differs, or to the end of one of them.
  const Pairs of_a = pairs_of(a), of_b = pairs_of(b);
  const std::pair<std::string, std::string> nothing{"", "nothing"};
  for (std::size_t i = 0; i < std::max(of_a.size(), of_b.size()); ++i) {
    const auto& in_a = i < of_a.size() ? of_a[i] : nothing;
    const auto& in_b = i < of_b.size() ? of_b[i] : nothing;
    if (in_a != in_b)
      return ConfigDifference{std::max(in_a.first, in_b.first), in_a.second, in_b.second};
  }
  return {};
}

}  // namespace threelink_agent

/// @file
/// YAML of others, read so that no text can do harm.
#pragma once

#include <cstddef>
#include <string>

#include <yaml-cpp/yaml.h>

#include "threelink_sim/usage_error.hpp"

namespace threelink_sim {

struct YamlLimits {
  std::size_t bytes = std::size_t{1} << 20;
  std::size_t nodes = 50'000;
};
constexpr std::size_t kMaxYamlDepth = 32;  ///< of maps and lists within each other
constexpr std::size_t kMaxYamlKey = 250;   ///< [bytes] the library cannot read back longer ones

/// One YAML document, or none, which is null. Throws FormatError with line and column for text that
/// is not YAML, exceeds a limit, is not printable UTF-8, holds anchors, aliases, tags or a second
/// document, or whose maps have a key twice or one that is not a word: all that our files never
/// use, and that lets short texts become endless ones. Nothing is built before this is known.
YAML::Node parse_yaml(const std::string& text, const YamlLimits& limits = {});

}  // namespace threelink_sim

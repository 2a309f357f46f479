/// @file
/// A YAML reader that is safe for untrusted text.
#pragma once

#include <cstddef>
#include <string>

#include <yaml-cpp/yaml.h>

#include "threelink_sim/usage_error.hpp"

namespace threelink_sim {

/// Largest size of a text and of its tree.
struct YamlLimits {
  std::size_t bytes = std::size_t{1} << 20;
  std::size_t nodes = 50'000;
};
constexpr std::size_t kMaxYamlDepth = 32;  ///< largest nesting of maps and lists
constexpr std::size_t kMaxYamlKey = 250;   ///< [bytes] the library cannot read back longer keys

/// Parses one YAML document; an empty text gives null. Throws FormatError with line and column for
/// text that is not YAML, exceeds a limit, is not printable UTF-8, contains anchors, aliases, tags
/// or a second document, or has a map with a repeated key or a key that is not a word. The files of
/// this project need none of these, and some let a short text expand without bound. No node is
/// built before these checks.
YAML::Node parse_yaml(const std::string& text, const YamlLimits& limits = {});

}  // namespace threelink_sim

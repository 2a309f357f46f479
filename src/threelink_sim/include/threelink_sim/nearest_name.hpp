/// @file
/// The nearest known name, for messages about an unknown name.
#pragma once

#include <algorithm>
#include <numeric>
#include <string>
#include <vector>

namespace threelink_sim {

/// Levenshtein distance: insertions, deletions and substitutions that turn a into b.
inline std::size_t edit_distance(const std::string& a, const std::string& b) {
  std::vector<std::size_t> row(b.size() + 1);
  std::iota(row.begin(), row.end(), 0);
  for (std::size_t i = 0; i < a.size(); ++i) {
    std::size_t diagonal = row[0]++;
    for (std::size_t j = 0; j < b.size(); ++j) {
      const std::size_t substituted = diagonal + (a[i] != b[j]);
      diagonal = row[j + 1];
      row[j + 1] = std::min({row[j] + 1, row[j + 1] + 1, substituted});
    }
  }
  return row.back();
}

/// Distance of a name from a known one of the form "section.key", whose section may be missing or
/// wrong.
inline std::size_t name_distance(const std::string& name, const std::string& known) {
  const auto key = [](const std::string& text) { return text.substr(text.rfind('.') + 1); };
  const bool has_section = name.find('.') != std::string::npos;
  return std::min(edit_distance(name, known),
                  edit_distance(key(name), key(known)) + (has_section ? 3 : 0));
}

/// The nearest of the known names, the first of equals; empty if there are none.
inline std::string nearest_name(const std::string& given, const std::vector<std::string>& known) {
  constexpr std::size_t kLongest = 100;  // no known name is longer, and time grows with the length
  const std::string name = given.substr(0, kLongest);
  const auto nearest =
      std::min_element(known.begin(), known.end(), [&](const auto& a, const auto& b) {
        return name_distance(name, a) < name_distance(name, b);
      });
  return nearest == known.end() ? "" : *nearest;
}

}  // namespace threelink_sim

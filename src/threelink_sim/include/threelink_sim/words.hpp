/// @file
/// Names of the values of an enumeration.
#pragma once

#include <stdexcept>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

namespace threelink_sim {

/// Each enumeration that is read or written has an overload of words_of(Enum) in its namespace,
/// which returns all values with their words.
template <class Enum>
using Words = std::vector<std::pair<Enum, std::string>>;

/// The word of a value. Throws std::invalid_argument if it has none.
template <class Enum, class = std::enable_if_t<std::is_enum_v<Enum>>>
std::string word_of(Enum value) {
  for (const auto& [known, word] : words_of(value))
    if (known == value) return word;
  throw std::invalid_argument("a value without a word");
}

}  // namespace threelink_sim

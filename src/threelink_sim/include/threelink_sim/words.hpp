/// @file
/// The words for the values of an enumeration.
#pragma once

#include <stdexcept>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

namespace threelink_sim {

/// Each enumeration that is read or written has an overload of words_of(Enum), found by its
/// namespace, which returns all of its values with their words.
template <class Enum>
using Words = std::vector<std::pair<Enum, std::string>>;

template <class Enum, class = std::enable_if_t<std::is_enum_v<Enum>>>
std::string word_of(Enum value) {
  for (const auto& [known, word] : words_of(value))
    if (known == value) return word;
  throw std::invalid_argument("a value without a word");
}

}  // namespace threelink_sim

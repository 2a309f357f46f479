/// @file
/// One list of the fields of a struct: their names, bounds and meanings. Reading, checking, writing
/// and comparing of the struct follow from this list.
///
///   struct Swing {
///     double period = 500;
///     template <class Self, class Visit>
///     static void fields(Self& self, Visit&& visit) {
///       visit("period", self.period, Range<double>{1, 1e6}, "[T0] of the way to and fro");
///     }
///   };
///
/// A field is a double, a whole number or a list of them (with the range of each), a bool, text, or
/// an enumeration whose words words_of() returns. Sections are parts of the name: "update.clip".
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <optional>
#include <stdexcept>
#include <string>
#include <tuple>
#include <type_traits>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "threelink_sim/parameter_map.hpp"
#include "threelink_sim/range.hpp"
#include "threelink_sim/words.hpp"

namespace threelink_sim {

/// Visits the fields of a part of the struct, with `section` and a dot before their names.
template <class Part, class Visit>
void visit_section(const std::string& section, Part& part, Visit& visit) {
  std::remove_const_t<Part>::fields(part,
                                    [&](const std::string& name, auto& field, const auto&... rest) {
                                      visit(section + "." + name, field, rest...);
                                    });
}

// --- Reading -------------------------------------------------------------------------------------

/// Reads each field by a getter of the map. A field that the map lacks keeps its value, unless the
/// map wants all of them (ParameterMap::Style::kFile) or the number is NaN, which stands for "no
/// default".
class FieldReader {
 public:
  explicit FieldReader(ParameterMap& map) : map_(map) {}

  void operator()(const std::string& name, double& field, const Range<double>& range,
                  const char* /*meaning*/) const {
    field = map_.real(name, range, default_of(field));
  }
  template <class Whole, class = std::enable_if_t<std::is_integral_v<Whole>>>
  void operator()(const std::string& name, Whole& field, const Range<Whole>& range,
                  const char* /*meaning*/) const {
    field = static_cast<Whole>(map_.whole(
        name, {static_cast<std::int64_t>(range.low), static_cast<std::int64_t>(range.high)},
        default_of(static_cast<std::int64_t>(field))));
  }
  template <std::size_t n>
  void operator()(const std::string& name, double (&field)[n], const Range<double>& range,
                  const char* /*meaning*/) const {
    map_.reals(name, field, {n}, range, has_default(field[0]));
  }
  template <std::size_t rows, std::size_t columns>
  void operator()(const std::string& name, double (&field)[rows][columns],
                  const Range<double>& range, const char* /*meaning*/) const {
    map_.reals(name, field[0], {rows, columns}, range, has_default(field[0][0]));
  }
  void operator()(const std::string& name, bool& field, const char* /*meaning*/) const {
    field = map_.flag(name, default_of(field));
  }
  void operator()(const std::string& name, std::string& field, const char* /*meaning*/) const {
    field = map_.text(name, default_of(field));
  }
  void operator()(const std::string& name, std::vector<int>& field, const Range<int>& range,
                  const char* /*meaning*/) const {
    field = map_.integers(name, range);
  }
  template <class Enum, class = std::enable_if_t<std::is_enum_v<Enum>>>
  void operator()(const std::string& name, Enum& field, const char* /*meaning*/) const {
    const Words<Enum> known = words_of(field);
    std::vector<std::string> words;
    for (const auto& entry : known) words.push_back(entry.second);
    const std::string word = map_.choice(name, words, default_of(word_of(field)));
    for (const auto& [value, called] : known)
      if (called == word) field = value;
  }

 private:
  template <class Value>
  std::optional<Value> default_of(const Value& value) const {
    if (!has_default(value)) return {};
    return value;
  }
  /// NaN stands for "no default".
  template <class Value>
  bool has_default(const Value& value) const {
    if constexpr (std::is_floating_point_v<Value>)
      if (std::isnan(value)) return false;
    return map_.style() != ParameterMap::Style::kFile;
  }

  ParameterMap& map_;
};

// --- Checking ------------------------------------------------------------------------------------

/// Throws Error, constructed from the full text and the text for peers, for a number that is out of
/// its range.
template <class Error>
class FieldChecker {
 public:
  void operator()(const std::string& name, const std::vector<int>& field, const Range<int>& range,
                  const char* meaning) const {
    for (const int value : field) (*this)(name, value, range, meaning);
  }
  template <class Number, class = std::enable_if_t<std::is_arithmetic_v<Number>>>
  void operator()(const std::string& name, const Number& field, const Range<Number>& range,
                  const char* /*meaning*/) const {
    if (range.contains(field)) return;
    const std::string bound = "must be " + range.text();
    if constexpr (std::is_base_of_v<UsageError, Error>)
      throw Error(fmt::format("{} = {}: {}", name, field, bound),
                  fmt::format("{}: {}", name, bound));
    else
      throw Error(fmt::format("{} = {}: {}", name, field, bound));
  }
  template <class Any>
  void operator()(const std::string& /*name*/, const Any& /*field*/,
                  const char* /*meaning*/) const {}
};

/// Throws Error that names field, value and bound if a field of the struct is out of its range.
template <class Error = std::invalid_argument, class Struct>
void check_fields(const Struct& checked) {
  Struct::fields(checked, FieldChecker<Error>());
}

// --- Writing and comparing -----------------------------------------------------------------------

/// A value as YAML that is read back to the same bits.
inline std::string field_yaml(double value) { return yaml_number(value); }
/// "true" or "false".
inline std::string field_yaml(bool value) { return value ? "true" : "false"; }
/// Text in quotes if YAML needs them.
inline std::string field_yaml(const std::string& value) { return yaml_text(value); }
/// A list in brackets.
inline std::string field_yaml(const std::vector<int>& values) {
  return fmt::format("[{}]", fmt::join(values, ", "));
}
/// A whole number in decimal, or the word of an enumeration.
template <class Value, class = std::enable_if_t<std::is_integral_v<Value> || std::is_enum_v<Value>>>
std::string field_yaml(Value value) {
  if constexpr (std::is_enum_v<Value>)
    return word_of(value);
  else
    return fmt::format("{}", value);
}

/// The name of every field with its value as YAML.
using FieldTexts = std::vector<std::pair<std::string, std::string>>;

/// Names and values of all fields of a struct.
template <class Struct>
FieldTexts field_texts(const Struct& written) {
  FieldTexts texts;
  Struct::fields(written, [&](const std::string& name, const auto& field, const auto&...) {
    texts.emplace_back(name, field_yaml(field));
  });
  return texts;
}

/// A line for each field, for the help of a program: "  ~gamma [0.5]  drag ratio .., in [0.001,
/// 10]".
template <class Struct>
std::string field_help(const Struct& defaults, const std::string& prefix) {
  std::string help;
  const auto line = [&](const std::string& name, const std::string& value,
                        const std::string& meaning) {
    help += fmt::format("  {:<31}  {}\n", fmt::format("{}{} [{}]", prefix, name, value), meaning);
  };
  const auto shown = [](const auto& value) {
    if constexpr (std::is_floating_point_v<std::decay_t<decltype(value)>>)
      return fmt::format("{:.10g}", value);
    else
      return field_yaml(value);
  };
  Struct::fields(defaults, [&](const std::string& name, const auto& field, const auto&... rest) {
    const auto tuple = std::forward_as_tuple(rest...);
    if constexpr (sizeof...(rest) == 2) {
      line(name, shown(field),
           fmt::format("{}, {}", std::get<1>(tuple), std::get<0>(tuple).text()));
    } else {
      std::string words;
      if constexpr (std::is_enum_v<std::decay_t<decltype(field)>>)
        for (const auto& entry : words_of(field))
          words += (words.empty() ? ": " : " or ") + entry.second;
      line(name, shown(field), std::get<0>(tuple) + words);
    }
  });
  return help;
}

/// Lines of YAML that are read back to the same values to the bit. Sections become maps, one level
/// deep.
std::string to_yaml(const FieldTexts& texts);

/// The first field in which two lists differ, with both values; "nothing" stands for a missing
/// field.
struct FieldDifference {
  std::string name, a, b;
};
/// Returns nothing if the lists are equal.
std::optional<FieldDifference> first_difference(const FieldTexts& a, const FieldTexts& b);

}  // namespace threelink_sim

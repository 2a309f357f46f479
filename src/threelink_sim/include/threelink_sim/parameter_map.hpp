/// @file
/// Strict reading of named values: a wrong value is an error and is never replaced by a default.
///
/// The values are YAML from a file, a message or (threelink_sim/node/parameters.hpp) ROS
/// parameters.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include <Eigen/Core>
#include <yaml-cpp/yaml.h>

#include "threelink_sim/range.hpp"
#include "threelink_sim/usage_error.hpp"
#include "threelink_sim/yaml.hpp"

namespace threelink_sim {

/// Error of a parameter. what() gives its full name, value and type, and the expected value.
class ParameterError : public UsageError {
 public:
  using UsageError::UsageError;
};

/// A number with all digits and a decimal point, without which ROS 1 reads 5e-05 as text and 1 as a
/// whole number.
std::string yaml_number(double value);
/// Text in quotes, with the necessary escapes.
std::string yaml_text(const std::string& text);

/// Every getter throws ParameterError if the parameter is of another type or out of range, or if it
/// is absent and has no default. A whole number is accepted as a real number, but not the reverse.
/// NaN, infinities and numbers in quotes are never accepted.
class ParameterMap {
 public:
  using Points = std::vector<Eigen::Vector2d>;

  /// Source of the values, which determines the form of messages.
  enum class Style {
    /// "SCOPE/NAME = VALUE (type): .."; the reader of the message has provided the values.
    kParameters,
    /// "SCOPE: NAME = VALUE: .."; the value is left out for a peer, who may only have named the
    /// file (UsageError::for_peers()). Every value is required and fallbacks are not used: finish()
    /// names what is missing. Numbers have the same syntax as in ROS.
    kFile,
  };

  /// `values` is a map, or null for an empty one. `scope` is the prefix of names in messages.
  ParameterMap(const std::string& scope, const YAML::Node& values,
               Style style = Style::kParameters);
  Style style() const { return style_; }

  double real(const std::string& name, Range<double> range, std::optional<double> fallback = {});
  int integer(const std::string& name, Range<int> range, std::optional<int> fallback = {});
  /// A whole number of any width; the range must be within that of a signed 64-bit number.
  std::int64_t whole(const std::string& name, Range<std::int64_t> range,
                     std::optional<std::int64_t> fallback = {});
  /// A list of whole numbers, each within the range.
  std::vector<int> integers(const std::string& name, Range<int> range);
  /// Reads numbers of the given shape into `values`, with the last index varying fastest: {2}
  /// expects [a, b], {2, 2} expects [[a, b], [c, d]]. If `optional`, the content of `values` is the
  /// default.
  void reals(const std::string& name, double* values, const std::vector<std::size_t>& shape,
             Range<double> range, bool optional);
  bool flag(const std::string& name, std::optional<bool> fallback = {});
  std::string text(const std::string& name, std::optional<std::string> fallback = {});
  /// One of several words.
  std::string choice(const std::string& name, const std::vector<std::string>& words,
                     const std::optional<std::string>& fallback = {});
  /// A list of pairs [x, y], each number within the range; or text, which `from_text` converts to
  /// such a list or refuses with UsageError. Without a default the parameter is required.
  Points points(const std::string& name, Range<double> range,
                const std::function<Points(const std::string&)>& from_text,
                const Points* fallback = nullptr);

  /// A list of maps, each with its own reader, which must call finish(); empty if absent.
  std::vector<ParameterMap> list(const std::string& name);

  /// A nested map, likewise.
  ParameterMap map(const std::string& name);

  bool has(const std::string& name) const { return values_.IsMap() && values_[name]; }

  /// Whether a file has a section of that name, or a value in its place.
  bool has_section(const std::string& name) const;
  /// The section of a file, with names without the prefix "NAME.", for its own reader, which must
  /// call finish().
  ParameterMap section(const std::string& name);

  /// The values in that section with the nesting of the file, for another kind of reader.
  YAML::Node section_values(const std::string& name);

  /// To be called after the last getter: refuses parameters that no getter has read, naming the
  /// nearest known one, and then reports missing keys of a file.
  void finish() const;
  /// Makes finish() accept a parameter of another reader.
  void ignore(const std::string& name) { known_.insert(name); }
  /// A copy for another reader, whose finish() knows the parameters that were read so far, but
  /// whose effective() does not.
  ParameterMap for_another_reader() const {
    ParameterMap copy(*this);
    copy.effective_.clear();
    return copy;
  }

  /// Throws ParameterError for a well-formed but wrong value, such as the name of a broken file.
  [[noreturn]] void refuse(const std::string& name, const std::string& reason) const;

  /// The values that the getters returned, in the order of the calls: one line "NAME: VALUE" of
  /// YAML for each, which is read back to the same bits.
  std::string effective(const std::string& indent = "") const;
  /// The same as pairs of name and value.
  const std::vector<std::pair<std::string, std::string>>& effective_values() const {
    return effective_;
  }

 private:
  /// The value; undefined if it is absent and either optional or missing in a file.
  YAML::Node find(const std::string& name, bool required);
  double number(const std::string& name, const YAML::Node& value, Range<double> range) const;
  std::int64_t whole_number(const std::string& name, const YAML::Node& value,
                            Range<std::int64_t> range) const;
  std::string read_reals(const std::string& name, const YAML::Node& value, double*& next,
                         const std::size_t* shape, std::size_t dimensions,
                         Range<double> range) const;
  std::string described(const YAML::Node& value) const;
  std::string full_name(const std::string& name) const;  ///< the name in messages
  ParameterError error(const std::string& name, const std::string& value,
                       const std::string& reason) const;
  template <class Value>
  Value keep(const std::string& name, const Value& value, const std::string& yaml);

  std::string scope_;
  std::string section_;  ///< with a final dot, or empty
  YAML::Node values_;
  Style style_;
  std::set<std::string> known_;
  std::vector<std::string> missing_;
  std::vector<std::pair<std::string, std::string>> effective_;
};

/// Reads a YAML text by parse_yaml(). Throws ParameterError that begins with `scope`.
ParameterMap parse_parameters(const std::string& scope, const std::string& yaml);

/// Reads the text of a configuration file in the style kFile. Nested keys have names with dots:
/// "update.clip". Throws ParameterError that begins with `source`.
ParameterMap parse_config(const std::string& source, const std::string& yaml,
                          const YamlLimits& limits);

}  // namespace threelink_sim

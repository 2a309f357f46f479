/// @file
/// Strict reading of named values: what is wrong is an error, never a default.
///
/// The values are YAML, of a file, a message or (threelink_sim/node/parameters.hpp) ROS parameters.
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

/// what() gives the parameter's full name, its value, its type and what it must be.
class ParameterError : public UsageError {
 public:
  using UsageError::UsageError;
};

/// All digits, and with the point without which ROS 1 takes 5e-05 for text and 1 for a whole
/// number.
std::string yaml_number(double value);
/// In quotes, with whatever escapes it needs.
std::string yaml_text(const std::string& text);

/// Every getter throws ParameterError if the parameter is of another type or out of range, or if it
/// is absent and has no default. A whole number is accepted where a real one is wanted, not the
/// other way round; NaN and infinities never are, nor is a number in quotes.
class ParameterMap {
 public:
  using Points = std::vector<Eigen::Vector2d>;

  enum class Style {
    /// "SCOPE/NAME = VALUE (type): .."; whoever reads the message has given the values.
    kParameters,
    /// "SCOPE: NAME = VALUE: .."; a peer, who may have named the file only, is told no value
    /// (UsageError::for_peers()). Every value must be there, fallbacks are not used: finish() names
    /// what is missing. Numbers are taken in no other way than ROS takes them.
    kFile,
  };

  /// `values` is a map, or null for an empty one; `scope` is what names begin with in messages.
  ParameterMap(const std::string& scope, const YAML::Node& values,
               Style style = Style::kParameters);
  Style style() const { return style_; }

  double real(const std::string& name, Range<double> range, std::optional<double> fallback = {});
  int integer(const std::string& name, Range<int> range, std::optional<int> fallback = {});
  /// Of any width; the range must be within that of a signed 64-bit number.
  std::int64_t whole(const std::string& name, Range<std::int64_t> range,
                     std::optional<std::int64_t> fallback = {});
  /// A list of whole numbers, each within the range.
  std::vector<int> integers(const std::string& name, Range<int> range);
  /// Numbers of that shape into `values`, the last index running fastest: {2} wants [a, b], {2, 2}
  /// [[a, b], [c, d]]. `optional`: what is in `values` is the default.
  void reals(const std::string& name, double* values, const std::vector<std::size_t>& shape,
             Range<double> range, bool optional);
  bool flag(const std::string& name, std::optional<bool> fallback = {});
  std::string text(const std::string& name, std::optional<std::string> fallback = {});
  /// One of several words.
  std::string choice(const std::string& name, const std::vector<std::string>& words,
                     const std::optional<std::string>& fallback = {});
  /// A list of pairs [x, y], each number within the range; or text, which `from_text` turns into
  /// such a list, or throws UsageError. A default that is null makes the parameter required.
  Points points(const std::string& name, Range<double> range,
                const std::function<Points(const std::string&)>& from_text,
                const Points* fallback = nullptr);

  /// A list of maps, each for a reader of its own, who calls its finish(); none if it is absent.
  std::vector<ParameterMap> list(const std::string& name);

  /// A map within, likewise.
  ParameterMap map(const std::string& name);

  bool has(const std::string& name) const { return values_.IsMap() && values_[name]; }

  /// Whether a file has a section of that name, or a value in its place.
  bool has_section(const std::string& name) const;
  /// The names in that section of a file, without "NAME." before them, for a reader of its own, who
  /// calls its finish().
  ParameterMap section(const std::string& name);

  /// The values in that section, as the file nests them, for a reader of another kind.
  YAML::Node section_values(const std::string& name);

  /// To be called after the last getter: refuses parameters that no getter asked for, and names the
  /// nearest one that exists; then what a file lacks.
  void finish() const;
  /// Makes finish() accept a parameter that is for somebody else.
  void ignore(const std::string& name) { known_.insert(name); }
  /// The same values for another reader: finish() knows what was asked for up to now, effective()
  /// does not.
  ParameterMap for_another_reader() const {
    ParameterMap copy(*this);
    copy.effective_.clear();
    return copy;
  }

  /// For values that are well formed and yet wrong, such as the name of a broken file.
  [[noreturn]] void refuse(const std::string& name, const std::string& reason) const;

  /// What the getters returned, in the order of the calls: a line "NAME: VALUE" of YAML each, which
  /// reads back to the same values, to the bit.
  std::string effective(const std::string& indent = "") const;
  /// The same as names and values.
  const std::vector<std::pair<std::string, std::string>>& effective_values() const {
    return effective_;
  }

 private:
  /// Undefined if it is absent and may be, and if a file lacks it.
  YAML::Node find(const std::string& name, bool required);
  double number(const std::string& name, const YAML::Node& value, Range<double> range) const;
  std::int64_t whole_number(const std::string& name, const YAML::Node& value,
                            Range<std::int64_t> range) const;
  std::string read_reals(const std::string& name, const YAML::Node& value, double*& next,
                         const std::size_t* shape, std::size_t dimensions,
                         Range<double> range) const;
  std::string described(const YAML::Node& value) const;
  std::string full_name(const std::string& name) const;  ///< as messages begin
  ParameterError error(const std::string& name, const std::string& value,
                       const std::string& reason) const;
  template <class Value>
  Value keep(const std::string& name, const Value& value, const std::string& yaml);

  std::string scope_;
  std::string section_;  ///< with the dot after it, or empty
  YAML::Node values_;
  Style style_;
  std::set<std::string> known_;
  std::vector<std::string> missing_;
  std::vector<std::pair<std::string, std::string>> effective_;
};

/// Of a YAML text, as parse_yaml() reads it; throws ParameterError that begins with `scope`.
ParameterMap parse_parameters(const std::string& scope, const std::string& yaml);

/// Of a configuration file's text, in the style kFile. Maps within maps are read by names with
/// dots: "update.clip". Throws ParameterError that begins with `source`.
ParameterMap parse_config(const std::string& source, const std::string& yaml,
                          const YamlLimits& limits);

}  // namespace threelink_sim

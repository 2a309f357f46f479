#include "threelink_sim/parameter_map.hpp"

#include <algorithm>
#include <cctype>
#include <cerrno>
#include <cmath>
#include <cstdlib>
#include <limits>
#include <sstream>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "threelink_sim/excerpt.hpp"
#include "threelink_sim/nearest_name.hpp"
#include "threelink_sim/yaml.hpp"

namespace threelink_sim {
namespace {

enum class Type { kBool, kInt, kDouble, kString, kList, kDictionary, kOther };

// A word without quotes as a number, all of it; nothing if it is none.
std::optional<long> as_whole(const std::string& word) {
  if (word.find_first_not_of("0123456789+-") != std::string::npos) return {};
  char* end = nullptr;
  errno = 0;
  const long number = std::strtol(word.c_str(), &end, 10);
  if (word.empty() || *end != '\0' || errno == ERANGE) return {};
  return number;
}

std::optional<double> as_real(const std::string& word) {
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  if (word == ".nan") return std::numeric_limits<double>::quiet_NaN();
  if (word == ".inf") return kInfinity;
  if (word == "-.inf") return -kInfinity;
  if (word.find_first_not_of("0123456789.eE+-") != std::string::npos) return {};
  char* end = nullptr;
  const double number = std::strtod(word.c_str(), &end);
  if (word.empty() || *end != '\0') return {};
  return number;
}

Type type_of(const YAML::Node& value) {
  if (value.IsSequence()) return Type::kList;
  if (value.IsMap()) return Type::kDictionary;
  if (!value.IsScalar()) return Type::kOther;
  const std::string& word = value.Scalar();
  if (value.Tag() == "!") return Type::kString;  // in quotes
  if (word == "true" || word == "false") return Type::kBool;
  if (as_whole(word)) return Type::kInt;
  return as_real(word) ? Type::kDouble : Type::kString;
}

std::string describe(const YAML::Node& value) {
  switch (type_of(value)) {
    case Type::kBool:
      return value.Scalar() + " (bool)";
    case Type::kInt:
      return excerpt(value.Scalar()) + " (int)";
    case Type::kDouble:
      return fmt::format("{:.10g} (double)", *as_real(value.Scalar()));
    case Type::kString:
      return fmt::format("\"{}\" (string)", excerpt(value.Scalar()));
    case Type::kList:
      return "a list";
    case Type::kDictionary:
      return "a dictionary";
    default:
      return "a value of another type";
  }
}

// How YAML wants a number that it took for text: with a point, and with a sign in the exponent.
std::string advice_on_text(const std::string& text) {
  const std::optional<double> number = as_real(text);
  if (!number || !std::isfinite(*number)) return "";
  const std::size_t e = std::min(text.find_first_of("eE"), text.size());
  std::string mantissa = text.substr(0, e), exponent = text.substr(e);
  if (exponent.empty()) return "; write it without quotes";
  if (mantissa.find('.') == std::string::npos) mantissa += ".0";
  if (std::isdigit(exponent[1])) exponent.insert(1, "+");
  return fmt::format("; write {}{}, which YAML takes for a number", mantissa, exponent);
}

// Whether ROS 1, whose YAML is version 1.1, takes a number that is written like this for text: with
// an exponent, but without a point or without the exponent's sign.
bool ros_takes_for_text(const std::string& number) {
  const std::size_t e = number.find_first_of("eE");
  if (e == std::string::npos) return false;
  return number.find('.') == std::string::npos || number.find_first_of("+-", e) != e + 1;
}

// Maps within `map` become names with dots.
void flatten(const YAML::Node& map, const std::string& prefix, YAML::Node& flat) {
  for (const auto& entry : map) {
    const std::string name = prefix + entry.first.Scalar();
    if (entry.second.IsMap() && entry.second.size() > 0) {
      flatten(entry.second, name + ".", flat);
    } else {
      if (flat[name])  // "a.b" beside {a: {b: ..}}
        throw FormatError(excerpt(name) + ": given twice", "a key is given twice");
      flat[name] = entry.second;
    }
  }
}

}  // namespace

std::string yaml_number(double value) {
  if (std::isnan(value)) return ".nan";
  if (std::isinf(value)) return value > 0 ? ".inf" : "-.inf";
  std::string text = fmt::format("{}", value);
  if (text.find('.') == std::string::npos) text.insert(std::min(text.find('e'), text.size()), ".0");
  return text;
}

std::string yaml_text(const std::string& text) {
  YAML::Emitter emitter;
  emitter << YAML::DoubleQuoted << text;
  return emitter.c_str();
}

ParameterMap::ParameterMap(const std::string& scope, const YAML::Node& values, Style style)
    : scope_(scope), values_(values), style_(style) {
  if (values_.IsMap()) return;
  if (style_ == Style::kFile) throw ParameterError(scope_ + ": must be a map of keys to values");
  if (values_.IsDefined() && !values_.IsNull())
    throw ParameterError(
        fmt::format("{} = {}: must be a dictionary of parameters", scope_, describe(values_)));
}

YAML::Node ParameterMap::find(const std::string& name, bool required) {
  known_.insert(name);
  if (has(name)) return values_[name];
  if (required && style_ == Style::kFile)
    missing_.push_back(name);
  else if (required)
    throw ParameterError(fmt::format("{}/{} is missing", scope_, name));
  return YAML::Node(YAML::NodeType::Undefined);
}

std::string ParameterMap::described(const YAML::Node& value) const {
  if (style_ == Style::kParameters) return describe(value);
  std::ostringstream text;
  text << value;
  return excerpt(text.str());
}

std::string ParameterMap::full_name(const std::string& name) const {
  if (style_ == Style::kFile) return fmt::format("{}: {}{}", scope_, section_, name);
  return fmt::format("{}/{}", scope_, name);
}

ParameterError ParameterMap::error(const std::string& name, const std::string& value,
                                   const std::string& reason) const {
  const std::string key = full_name(name);
  const std::string text = fmt::format("{}{}: {}", key, value.empty() ? "" : " = " + value, reason);
  if (style_ == Style::kParameters) return ParameterError(text);
  return ParameterError(text, fmt::format("{}: {}", key, reason));
}

void ParameterMap::refuse(const std::string& name, const std::string& reason) const {
  throw error(name, has(name) ? described(values_[name]) : "", reason);
}

template <class Value>
Value ParameterMap::keep(const std::string& name, const Value& value, const std::string& yaml) {
  effective_.emplace_back(name, yaml);
  return value;
}

double ParameterMap::number(const std::string& name, const YAML::Node& value,
                            Range<double> range) const {
  const Type type = type_of(value);
  const auto refuse = [&](const std::string& reason) {
    throw error(name, described(value), reason);
  };
  if (type == Type::kString) refuse("must be a number" + advice_on_text(value.Scalar()));
  if (type != Type::kInt && type != Type::kDouble) refuse("must be a number");
  const double number = *as_real(value.Scalar());
  if (!std::isfinite(number)) refuse("must be finite");
  if (style_ == Style::kFile && ros_takes_for_text(value.Scalar()))
    refuse("must be a number" + advice_on_text(value.Scalar()));
  if (!range.contains(number)) refuse("must be " + range.text());
  return number;
}

double ParameterMap::real(const std::string& name, Range<double> range,
                          std::optional<double> fallback) {
  const YAML::Node value = find(name, !fallback);
  const double result = value.IsDefined() ? number(name, value, range) : fallback.value_or(0);
  return keep(name, result, yaml_number(result));
}

std::int64_t ParameterMap::whole_number(const std::string& name, const YAML::Node& value,
                                        Range<std::int64_t> range) const {
  const Type type = type_of(value);
  const auto refuse = [&](const std::string& reason) {
    throw error(name, described(value), reason);
  };
  const std::string word = value.IsScalar() ? value.Scalar() : "";
  // Other readers take 010 for eight and 0x10 for sixteen.
  if (value.Tag() != "!" && word.size() > 1 && word[0] == '0' &&
      word.find('.') == std::string::npos)
    refuse("must be written in decimal, without a 0 in front");
  if (type == Type::kString) refuse("must be a whole number" + advice_on_text(word));
  if (type == Type::kDouble && word.find_first_not_of("0123456789+-") == std::string::npos)
    refuse("must be a whole number below 2^63");
  if (type != Type::kInt) refuse("must be a whole number");
  const std::int64_t number = *as_whole(word);
  if (!range.contains(number)) refuse("must be " + range.text());
  return number;
}

std::int64_t ParameterMap::whole(const std::string& name, Range<std::int64_t> range,
                                 std::optional<std::int64_t> fallback) {
  const YAML::Node value = find(name, !fallback);
  const std::int64_t result =
      value.IsDefined() ? whole_number(name, value, range) : fallback.value_or(0);
  return keep(name, result, fmt::format("{}", result));
}

int ParameterMap::integer(const std::string& name, Range<int> range, std::optional<int> fallback) {
  return static_cast<int>(whole(name, {range.low, range.high}, fallback));
}

std::vector<int> ParameterMap::integers(const std::string& name, Range<int> range) {
  const YAML::Node values = find(name, true);
  std::vector<int> result;
  if (values.IsDefined() && !values.IsSequence()) refuse(name, "must be a list of whole numbers");
  for (std::size_t i = 0; values.IsDefined() && i < values.size(); ++i)
    result.push_back(static_cast<int>(
        whole_number(fmt::format("{}[{}]", name, i), values[i], {range.low, range.high})));
  return keep(name, result, fmt::format("[{}]", fmt::join(result, ", ")));
}

bool ParameterMap::flag(const std::string& name, std::optional<bool> fallback) {
  const YAML::Node value = find(name, !fallback);
  if (value.IsDefined() && type_of(value) != Type::kBool) refuse(name, "must be true or false");
  const bool result = value.IsDefined() ? value.Scalar() == "true" : fallback.value_or(false);
  return keep(name, result, result ? "true" : "false");
}

// The values as YAML; those that are undefined stay as they are.
std::string ParameterMap::read_reals(const std::string& name, const YAML::Node& value,
                                     double*& next, const std::size_t* shape,
                                     std::size_t dimensions, Range<double> range) const {
  if (dimensions == 0) {
    if (value.IsDefined()) *next = number(name, value, range);
    return yaml_number(*next++);
  }
  if (value.IsDefined() && (!value.IsSequence() || value.size() != *shape))
    refuse(name, dimensions == 1 ? fmt::format("must be a list of {} numbers", *shape)
                                 : fmt::format("must be a list of {} lists of {} numbers", *shape,
                                               *(shape + 1)));
  std::vector<std::string> texts;
  for (std::size_t i = 0; i < *shape; ++i)
    texts.push_back(read_reals(name, value.IsDefined() ? value[i] : value, next, shape + 1,
                               dimensions - 1, range));
  return fmt::format("[{}]", fmt::join(texts, ", "));
}

void ParameterMap::reals(const std::string& name, double* values,
                         const std::vector<std::size_t>& shape, Range<double> range,
                         bool optional) {
  const YAML::Node value = find(name, !optional);
  effective_.emplace_back(name, read_reals(name, value, values, shape.data(), shape.size(), range));
}

std::vector<ParameterMap> ParameterMap::list(const std::string& name) {
  constexpr bool kRequired = false;
  const YAML::Node value = find(name, kRequired);
  std::vector<ParameterMap> maps;
  if (!value.IsDefined()) return maps;
  if (!value.IsSequence()) refuse(name, "must be a list of maps of keys to values");
  for (const YAML::Node& entry : value) {
    const std::string scope = fmt::format("{}[{}]", full_name(name), maps.size());
    if (!entry.IsMap()) throw ParameterError(scope + ": must be a map of keys to values");
    maps.emplace_back(scope, entry, style_);
  }
  return maps;
}

ParameterMap ParameterMap::map(const std::string& name) {
  constexpr bool kRequired = true;
  const YAML::Node value = find(name, kRequired);
  if (!value.IsMap()) refuse(name, "must be a map of keys to values");
  return ParameterMap(full_name(name), value, style_);
}

std::string ParameterMap::text(const std::string& name, std::optional<std::string> fallback) {
  const YAML::Node value = find(name, !fallback);
  if (value.IsDefined() && type_of(value) != Type::kString) refuse(name, "must be text");
  const std::string result = value.IsDefined() ? value.Scalar() : fallback.value_or("");
  return keep(name, result, yaml_text(result));
}

std::string ParameterMap::choice(const std::string& name, const std::vector<std::string>& words,
                                 const std::optional<std::string>& fallback) {
  std::string word = text(name, fallback);
  if (!has(name) && !fallback) return words.front();  // finish() says that it is missing
  if (std::find(words.begin(), words.end(), word) == words.end())
    refuse(name, fmt::format("must be one of: {}", fmt::join(words, ", ")));
  return word;
}

ParameterMap::Points ParameterMap::points(
    const std::string& name, Range<double> range,
    const std::function<Points(const std::string&)>& from_text, const Points* fallback) {
  const YAML::Node value = find(name, !fallback);
  Points points;
  if (!value.IsDefined()) {
    points = *fallback;
  } else if (type_of(value) == Type::kString) {
    try {
      points = from_text(value.Scalar());
    } catch (const UsageError& error) {
      throw within<ParameterError>(fmt::format("{} = {}", full_name(name), described(value)),
                                   error);
    }
  } else if (type_of(value) != Type::kList) {
    refuse(name, "must be a list of pairs [x, y], or a file of them");
  } else {
    for (const YAML::Node& pair : value) {
      if (!pair.IsSequence() || pair.size() != 2)
        refuse(name, fmt::format("entry {} must be a pair [x, y]", points.size()));
      points.emplace_back(number(name, pair[0], range), number(name, pair[1], range));
    }
  }
  std::vector<std::string> pairs;
  for (const Eigen::Vector2d& point : points)
    pairs.push_back(fmt::format("[{}, {}]", yaml_number(point.x()), yaml_number(point.y())));
  return keep(name, points, fmt::format("[{}]", fmt::join(pairs, ", ")));
}

bool ParameterMap::has_section(const std::string& name) const {
  if (!values_.IsMap()) return false;
  return std::any_of(values_.begin(), values_.end(), [&](const auto& item) {
    const std::string& key = item.first.Scalar();
    return key == name || key.rfind(name + ".", 0) == 0;
  });
}

ParameterMap ParameterMap::section(const std::string& name) {
  const std::string prefix = name + ".";
  if (has(name) && !values_[name].IsMap()) refuse(name, "must be a map of keys to values");
  known_.insert(name);
  YAML::Node values(YAML::NodeType::Map);
  for (const auto& item : values_) {
    const std::string& key = item.first.Scalar();
    if (key.rfind(prefix, 0) != 0) continue;
    values[key.substr(prefix.size())] = item.second;
    known_.insert(key);
  }
  ParameterMap part(scope_, values, style_);
  part.section_ = section_ + prefix;
  return part;
}

YAML::Node ParameterMap::section_values(const std::string& name) {
  const std::string prefix = name + ".";
  known_.insert(name);
  YAML::Node nested(YAML::NodeType::Map);
  for (const auto& item : values_) {
    const std::string& key = item.first.Scalar();
    if (key.rfind(prefix, 0) != 0) continue;
    known_.insert(key);
    YAML::Node map = nested;
    std::size_t begin = prefix.size(), dot;
    while ((dot = key.find('.', begin)) != std::string::npos) {
      map.reset(map[key.substr(begin, dot - begin)]);
      begin = dot + 1;
    }
    map[key.substr(begin)] = item.second;
  }
  return nested;
}

void ParameterMap::finish() const {
  if (!values_.IsMap()) return;
  const bool file = style_ == Style::kFile;
  std::set<std::string> given;
  for (const auto& item : values_) {
    const std::string name = item.first.IsScalar() ? item.first.Scalar() : "";
    if (!given.insert(name).second) throw error(excerpt(name), "", "given twice");
    if (known_.count(name)) continue;
    if (known_.empty()) throw error(excerpt(name), "", "no such parameter");
    const std::string nearest = nearest_name(name, {known_.begin(), known_.end()});
    if (file)
      throw ParameterError(fmt::format("{}: {}{}: unknown key (the nearest known one is {}{})",
                                       scope_, section_, excerpt(name), section_, nearest),
                           scope_ + ": holds a key that is not known");
    throw error(excerpt(name), "",
                fmt::format("no such parameter; the nearest one is {}/{}", scope_, nearest));
  }
  if (!missing_.empty()) throw error(missing_.front(), "", "missing");
}

ParameterMap parse_parameters(const std::string& scope, const std::string& yaml) {
  try {
    return ParameterMap(scope, parse_yaml(yaml));
  } catch (const FormatError& error) {
    throw within<ParameterError>(scope, error);
  }
}

ParameterMap parse_config(const std::string& source, const std::string& yaml,
                          const YamlLimits& limits) {
  try {
    const YAML::Node root = parse_yaml(yaml, limits);
    if (!root.IsMap()) return ParameterMap(source, root, ParameterMap::Style::kFile);
    YAML::Node flat(YAML::NodeType::Map);
    flatten(root, "", flat);
    return ParameterMap(source, flat, ParameterMap::Style::kFile);
  } catch (const FormatError& error) {
    throw within<ParameterError>(source, error);
  }
}

std::string ParameterMap::effective(const std::string& indent) const {
  std::string text;
  for (const auto& [name, value] : effective_)
    text += fmt::format("{}{}: {}\n", indent, name, value);
  return text;
}

}  // namespace threelink_sim

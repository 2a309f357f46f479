#include "threelink_sim/node/parameters.hpp"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <cstdlib>

#include <fmt/format.h>
#include <ros/param.h>

#include "threelink_sim/nearest_name.hpp"

namespace threelink_sim {
namespace {

using XmlRpc::XmlRpcValue;

const char* type_name(const XmlRpcValue& value) {
  switch (value.getType()) {
    case XmlRpcValue::TypeBoolean:
      return "bool";
    case XmlRpcValue::TypeInt:
      return "int";
    case XmlRpcValue::TypeDouble:
      return "double";
    case XmlRpcValue::TypeString:
      return "string";
    case XmlRpcValue::TypeArray:
      return "list";
    case XmlRpcValue::TypeStruct:
      return "dictionary";
    default:
      return "value of another type";
  }
}

// The getters of XmlRpcValue are not const.
std::string describe(XmlRpcValue value) {
  switch (value.getType()) {
    case XmlRpcValue::TypeBoolean:
      return fmt::format("{} (bool)", static_cast<bool>(value));
    case XmlRpcValue::TypeInt:
      return fmt::format("{} (int)", static_cast<int>(value));
    case XmlRpcValue::TypeDouble:
      return fmt::format("{:.10g} (double)", static_cast<double>(value));
    case XmlRpcValue::TypeString:
      return fmt::format("\"{}\" (string)", static_cast<std::string&>(value));
    default:
      return fmt::format("a {}", type_name(value));
  }
}

// How YAML wants a number that it took for text: with a point, and with a sign in the exponent.
std::string advice_on_text(const std::string& text) {
  char* end = nullptr;
  const double number = std::strtod(text.c_str(), &end);
  if (text.empty() || *end != '\0' || !std::isfinite(number)) return "";
  const std::size_t e = std::min(text.find_first_of("eE"), text.size());
  std::string mantissa = text.substr(0, e), exponent = text.substr(e);
  if (exponent.empty()) return "; write it without quotes";
  if (mantissa.find('.') == std::string::npos) mantissa += ".0";
  if (std::isdigit(exponent[1])) exponent.insert(1, "+");
  return fmt::format("; write {}{}, which YAML takes for a number", mantissa, exponent);
}

XmlRpcValue values_under(const std::string& scope) {
  XmlRpcValue values;
  ros::param::get(scope, values);
  return values;
}

}  // namespace

Parameters::Parameters(const ros::NodeHandle& private_handle)
    : Parameters(private_handle.getNamespace(), values_under(private_handle.getNamespace())) {}

Parameters::Parameters(const std::string& scope, const XmlRpcValue& values)
    : scope_(scope), values_(values) {
  if (values_.valid() && values_.getType() != XmlRpcValue::TypeStruct)
    throw ParameterError(fmt::format("{} = {}: must be a dictionary of this node's parameters",
                                     scope_, describe(values_)));
}

const XmlRpcValue* Parameters::find(const std::string& name, bool required) {
  known_.insert(name);
  if (values_.valid() && values_.hasMember(name)) return &values_[name];
  if (required) throw ParameterError(fmt::format("{}/{} is missing", scope_, name));
  return nullptr;
}

void Parameters::refuse(const std::string& name, const std::string& reason) const {
  XmlRpcValue values = values_;
  if (!values.valid() || !values.hasMember(name))
    throw ParameterError(fmt::format("{}/{}: {}", scope_, name, reason));
  throw ParameterError(fmt::format("{}/{} = {}: {}", scope_, name, describe(values[name]), reason));
}

double Parameters::real(const std::string& name, Range<double> range,
                        std::optional<double> fallback) {
  const XmlRpcValue* found = find(name, !fallback);
  if (!found) return *fallback;
  XmlRpcValue value = *found;
  double number;
  if (value.getType() == XmlRpcValue::TypeInt) {
    number = static_cast<int>(value);
  } else if (value.getType() == XmlRpcValue::TypeDouble) {
    number = static_cast<double>(value);
  } else if (value.getType() == XmlRpcValue::TypeString) {
    refuse(name, "must be a number" + advice_on_text(static_cast<std::string&>(value)));
  } else {
    refuse(name, "must be a number");
  }
  if (!std::isfinite(number)) refuse(name, "must be finite");
  if (number < range.low || number > range.high)
    refuse(name, fmt::format("must be in [{:.10g}, {:.10g}]", range.low, range.high));
  return number;
}

int Parameters::integer(const std::string& name, Range<int> range, std::optional<int> fallback) {
  const XmlRpcValue* found = find(name, !fallback);
  if (!found) return *fallback;
  XmlRpcValue value = *found;
  if (value.getType() == XmlRpcValue::TypeString)
    refuse(name, "must be a whole number" + advice_on_text(static_cast<std::string&>(value)));
  if (value.getType() != XmlRpcValue::TypeInt) refuse(name, "must be a whole number");
  const int number = static_cast<int>(value);
  if (number < range.low || number > range.high)
    refuse(name, fmt::format("must be in [{}, {}]", range.low, range.high));
  return number;
}

bool Parameters::flag(const std::string& name, std::optional<bool> fallback) {
  const XmlRpcValue* found = find(name, !fallback);
  if (!found) return *fallback;
  XmlRpcValue value = *found;
  if (value.getType() != XmlRpcValue::TypeBoolean) refuse(name, "must be true or false");
  return static_cast<bool>(value);
}

std::string Parameters::text(const std::string& name, std::optional<std::string> fallback) {
  const XmlRpcValue* found = find(name, !fallback);
  if (!found) return *fallback;
  XmlRpcValue value = *found;
  if (value.getType() != XmlRpcValue::TypeString) refuse(name, "must be text");
  return static_cast<std::string&>(value);
}

std::string Parameters::choice(const std::string& name, const std::vector<std::string>& words,
                               std::optional<std::string> fallback) {
  const std::string word = text(name, fallback);
  if (std::find(words.begin(), words.end(), word) == words.end())
    refuse(name, fmt::format("must be one of: {}", fmt::join(words, ", ")));
  return word;
}

void Parameters::finish() const {
  if (!values_.valid()) return;
  XmlRpcValue values = values_;
  for (auto& item : values) {
    const std::string& name = item.first;
    if (known_.count(name)) continue;
    if (known_.empty()) throw ParameterError(fmt::format("{}/{}: no such parameter", scope_, name));
    throw ParameterError(fmt::format("{}/{}: no such parameter; the nearest one is {}/{}", scope_,
                                     name, scope_,
                                     nearest_name(name, {known_.begin(), known_.end()})));
  }
}

}  // namespace threelink_sim

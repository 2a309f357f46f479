#include "threelink_sim/stroke_file.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "threelink_sim/files.hpp"
#include "threelink_sim/json.hpp"
#include "threelink_sim/usage_error.hpp"

namespace threelink_sim {
namespace {

using nlohmann::json;

constexpr char kFormat[] = "threelink-stroke-1";

std::vector<double> values(const HingeVector& v) { return {v.data(), v.data() + v.size()}; }

// A value that is not what it must be.
FormatError refusal(const std::string& name, const json& value, const std::string& reason) {
  return FormatError(fmt::format("{} = {}: {}", name, json_excerpt(value), reason),
                     fmt::format("{}: {}", name, reason));
}

const json& member(const json& object, const char* key) {
  const auto found = object.is_object() ? object.find(key) : object.end();
  if (found == object.end()) throw FormatError(fmt::format("has no \"{}\"", key));
  return *found;
}

double number(const json& object, const char* key) {
  const json& value = member(object, key);
  if (!value.is_number()) throw refusal(key, value, "must be a number");
  return value;
}

int links_of(const json& object) {
  const double value = number(object, "links");
  if (!(value >= 2 && value <= kMaxLinks && value == std::floor(value)))
    throw refusal("links", object["links"],
                  fmt::format("must be a whole number in [2, {}]", kMaxLinks));
  return static_cast<int>(value);
}

HingeVector hinges(const json& list, const std::string& name) {
  if (!list.is_array() || list.size() > kMaxHinges ||
      !std::all_of(list.begin(), list.end(), [](const json& value) { return value.is_number(); }))
    throw refusal(name, list, fmt::format("must be a list of numbers, {} at most", kMaxHinges));
  const auto v = list.get<std::vector<double>>();
  return HingeVector::Map(v.data(), v.size());
}

}  // namespace

json stroke_to_json(const Stroke& stroke, const SwimmerState& start) {
  const StrokeMeasures m = measure(stroke);
  const Eigen::Vector2d x_1 = free_end(stroke.model, start);
  std::vector<std::vector<double>> rates;
  for (const HingeVector& row : stroke.rates) rates.push_back(values(row));
  return {{"format", kFormat},
          {"links", stroke.model.links},
          {"gamma", stroke.model.gamma},
          {"joint_limit", stroke.model.joint_limit},
          {"dt", stroke.dt},
          {"pieces", stroke.pieces()},
          {"period", stroke.period()},
          {"start",
           {{"x_1", {x_1.x(), x_1.y()}},
            {"theta_1", link_angles(stroke.model, start)[0]},
            {"alpha", values(start.alpha)}}},
          {"rates", rates},
          {"displacement", m.displacement.norm()},
          {"rotation", m.rotation},
          {"work", m.work},
          {"speed", m.speed},
          {"power", m.power},
          {"efficiency", m.efficiency}};
}

Stroke parse_stroke(const std::string& text) {
  const json all = parse_json(text);
  const json& format = member(all, "format");
  if (format != kFormat) throw refusal("format", format, fmt::format("must be \"{}\"", kFormat));
  Stroke stroke;
  stroke.model.links = links_of(all);
  stroke.model.gamma = number(all, "gamma");
  stroke.model.joint_limit = number(all, "joint_limit");
  stroke.dt = number(all, "dt");
  stroke.start = hinges(member(member(all, "start"), "alpha"), "start.alpha");
  const json& rates = member(all, "rates");
  if (!rates.is_array()) throw refusal("rates", rates, "must be a list of rows");
  for (const json& row : rates)
    stroke.rates.push_back(hinges(row, fmt::format("rates, row {}", stroke.pieces() + 1)));
  try {
    stroke.validate();
  } catch (const std::invalid_argument& error) {
    throw FormatError(error.what(), "is no stroke of this swimmer");
  }
  return stroke;
}

Stroke load_stroke(const std::string& path) {
  constexpr std::size_t kMostBytes = std::size_t{16} << 20;
  const std::string text = read_input(path, kMostBytes);
  try {
    return parse_stroke(text);
  } catch (const UsageError& error) {
    throw within(path, error);
  }
}

std::string rates_as_csv(const json& rates) {
  std::string text;
  for (const json& row : rates)
    text += fmt::format("{:.17g}\n", fmt::join(row.get<std::vector<double>>(), ","));
  return text;
}

}  // namespace threelink_sim

#include "threelink_sim/stroke_file.hpp"

#include <algorithm>
#include <cmath>
#include <fstream>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "threelink_sim/parameter_map.hpp"

namespace threelink_sim {
namespace {

using nlohmann::json;

constexpr char kFormat[] = "threelink-stroke-1";

std::vector<double> values(const HingeVector& v) { return {v.data(), v.data() + v.size()}; }

double number(const json& object, const char* key) {
  const json& value = object.at(key);
  if (!value.is_number())
    throw std::invalid_argument(fmt::format("{} = {}: must be a number", key, value.dump()));
  return value;
}

int links_of(const json& object) {
  constexpr int kMost = kMaxHinges + 1;
  const double value = number(object, "links");
  if (!(value >= 2 && value <= kMost && value == std::floor(value)))
    throw std::invalid_argument(
        fmt::format("links = {}: must be a whole number in [2, {}]", value, kMost));
  return static_cast<int>(value);
}

HingeVector hinges(const json& list, const std::string& name) {
  if (!list.is_array() || list.size() > kMaxHinges ||
      !std::all_of(list.begin(), list.end(), [](const json& value) { return value.is_number(); }))
    throw std::invalid_argument(fmt::format("{}: {}: must be a list of numbers, {} at most", name,
                                            list.dump(), kMaxHinges));
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

Stroke load_stroke(const std::string& path) {
  std::ifstream file(path);
  if (!file) throw UsageError(fmt::format("{}: cannot be read", path));
  try {
    const json all = json::parse(file);
    if (all.at("format") != kFormat)
      throw std::invalid_argument(
          fmt::format("format {}: must be \"{}\"", all["format"].dump(), kFormat));
    Stroke stroke;
    stroke.model.links = links_of(all);
    stroke.model.gamma = number(all, "gamma");
    stroke.model.joint_limit = number(all, "joint_limit");
    stroke.dt = number(all, "dt");
    stroke.start = hinges(all.at("start").at("alpha"), "start.alpha");
    for (const json& row : all.at("rates"))
      stroke.rates.push_back(hinges(row, fmt::format("rates, row {}", stroke.pieces() + 1)));
    stroke.validate();
    return stroke;
  } catch (const json::exception& error) {
    throw UsageError(fmt::format("{}: {}", path, error.what()));
  } catch (const std::invalid_argument& error) {
    throw UsageError(fmt::format("{}: {}", path, error.what()));
  }
}

std::string rates_as_csv(const json& rates) {
  std::string text;
  for (const json& row : rates)
    text += fmt::format("{:.17g}\n", fmt::join(row.get<std::vector<double>>(), ","));
  return text;
}

}  // namespace threelink_sim

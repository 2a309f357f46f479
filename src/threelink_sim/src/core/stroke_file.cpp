#include "threelink_sim/stroke_file.hpp"

#include <fstream>

#include <fmt/format.h>

#include "threelink_sim/parameter_map.hpp"

namespace threelink_sim {
namespace {

using nlohmann::json;

constexpr char kFormat[] = "threelink-stroke-1";

std::vector<double> values(const HingeVector& v) { return {v.data(), v.data() + v.size()}; }

HingeVector hinges(const json& list) {
  const auto v = list.get<std::vector<double>>();
  if (v.size() > kMaxHinges)
    throw std::invalid_argument(
        fmt::format("{} values for hinges, {} at most", v.size(), kMaxHinges));
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
    stroke.model.links = all.at("links");
    stroke.model.gamma = all.at("gamma");
    stroke.model.joint_limit = all.at("joint_limit");
    stroke.dt = all.at("dt");
    stroke.start = hinges(all.at("start").at("alpha"));
    for (const json& row : all.at("rates")) stroke.rates.push_back(hinges(row));
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

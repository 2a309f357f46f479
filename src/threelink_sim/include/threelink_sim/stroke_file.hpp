/// @file
/// Files of strokes: JSON with the stroke and its results, and CSV with its rates for `swim`.
#pragma once

#include <string>

#include <nlohmann/json.hpp>

#include "threelink_sim/stroke.hpp"

namespace threelink_sim {

/// format, links, gamma, joint_limit, dt, pieces, period, start {x_1, theta_1, alpha}, rates,
/// displacement, rotation, work, speed, power, efficiency: docs/strokes.md describes each.
nlohmann::json stroke_to_json(const Stroke& stroke, const SwimmerState& start);

/// Reads a stroke. Throws UsageError that names the field and the fault; load_stroke() also names
/// the file.
Stroke parse_stroke(const std::string& text);
/// Reads a stroke from a file, likewise.
Stroke load_stroke(const std::string& path);

/// `rates` of stroke_to_json(): one row per piece, one column per hinge, 17 significant digits, no
/// header.
std::string rates_as_csv(const nlohmann::json& rates);

}  // namespace threelink_sim

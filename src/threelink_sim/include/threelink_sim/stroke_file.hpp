/// @file
/// Strokes as files: JSON with all that a stroke is and does; CSV with its rates, for `swim`.
#pragma once

#include <string>

#include <nlohmann/json.hpp>

#include "threelink_sim/stroke.hpp"

namespace threelink_sim {

/// format, links, gamma, joint_limit, dt, pieces, period, start {x_1, theta_1, alpha}, rates,
/// displacement, rotation, work, speed, power, efficiency: docs/strokes.md describes each.
nlohmann::json stroke_to_json(const Stroke& stroke, const SwimmerState& start);

/// Both throw UsageError that names the field and what is wrong, load_stroke() the file, too.
Stroke parse_stroke(const std::string& text);
Stroke load_stroke(const std::string& path);

/// `rates` of stroke_to_json(): one row a piece, one column a hinge, 17 significant digits, no
/// header.
std::string rates_as_csv(const nlohmann::json& rates);

}  // namespace threelink_sim

// One climb of the search for optimal strokes: from a stroke to a local optimum.
#pragma once

#include "threelink_sim/optimal_stroke.hpp"
#include "threelink_sim/stroke_gradient.hpp"

namespace threelink_sim {

enum class Period { kFree, kFixed };

// What varies: all rates; or fewer unknowns for a climb from near the optimum. Where rates are
// bounded, most are at a bound and stay: only the others vary, and those that turn out to want to.
// Else, in the search for efficiency, the optimum is smooth: its first harmonics vary.
enum class Rates { kAll, kFewer };

// Climbs from x with NLopt's SLSQP and writes where it ends back to x. Nodes whose angle is within
// `margin` [rad] of the joint limit are held to it; if another one passes it, it is added and the
// climb goes on.
Climb climb(const StrokeSearch& search, const std::string& name, Period period, double margin,
            Rates rates, const ClimbWatch& on_step, StrokeVariables& x);

}  // namespace threelink_sim

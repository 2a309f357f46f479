// What users write of each kind of flow and obstacle; equations are in kernel/flow.
#pragma once

#include <limits>
#include <string>

#include "threelink_sim/kernel/flows.hpp"
#include "threelink_sim/range.hpp"

namespace threelink_sim {

constexpr double kNoDefault = std::numeric_limits<double>::quiet_NaN();
constexpr Range<double> kPlace{-1e6, 1e6};         // [L]
constexpr Range<double> kLength{1e-6, 1e6};        // [L]
constexpr Range<double> kFlowSpeed{-1e3, 1e3};     // [L/T0]
constexpr Range<double> kFlowGradient{-1e3, 1e3};  // [1/T0]

struct UniformFlow {
  double U[2] = {kNoDefault, kNoDefault};
};

template <class Self, class Visit>
void uniform_fields(Self& flow, Visit&& visit) {
  visit("U", flow.U, kFlowSpeed, "[L/T0] everywhere");
}

template <class Self, class Visit>
void linear_fields(Self& flow, Visit&& visit) {
  visit("A", flow.A, kFlowGradient, "[1/T0] the gradient, [[du/dx, du/dy], [dv/dx, dv/dy]]");
  visit("U", flow.U, kFlowSpeed, "[L/T0] at x0");
  visit("x0", flow.x0, kPlace, "[L] where the flow is U");
}

template <class Self, class Visit>
void poiseuille_fields(Self& flow, Visit&& visit) {
  visit("U", flow.U, kFlowSpeed, "[L/T0] on the axis");
  visit("H", flow.H, kLength, "[L] half the width");
  visit("y0", flow.y0, kPlace, "[L] of the axis");
}

template <class Self, class Visit>
void taylor_green_fields(Self& flow, Visit&& visit) {
  visit("u0", flow.u0, kFlowSpeed, "[L/T0] largest speed");
  visit("k", flow.k, Range<double>{1e-6, 1e3}, "[1/L] wave number: a vortex is pi / k wide");
  visit("phase", flow.phase, Range<double>{-1e3, 1e3}, "[rad] of x and y");
}

template <class Self, class Visit>
void vortex_fields(Self& flow, Visit&& visit) {
  visit("Gamma", flow.Gamma, kFlowSpeed, "[L^2/T0] circulation, counter-clockwise positive");
  visit("epsilon", flow.epsilon, kLength, "[L] radius of the core");
  visit("x0", flow.x0, kPlace, "[L] of the centre");
}

template <class Self, class Visit>
void double_gyre_fields(Self& flow, Visit&& visit) {
  visit("A", flow.A, kFlowSpeed, "[L/T0] the largest speed is pi A");
  visit("epsilon", flow.epsilon, Range<double>{0, 0.5}, "of the border's swing");
  visit("omega", flow.omega, Range<double>{0, 1e3}, "[1/T0] of the swing");
  visit("size", flow.size, kLength, "[L] width of a gyre");
}

// How random modes are drawn; see random_modes.cpp.
struct RandomModes {
  double u0 = kNoDefault, wavelength = kNoDefault, correlation_time = 0;
  int modes = 32, seed = 0;
};

template <class Self, class Visit>
void random_modes_fields(Self& flow, Visit&& visit) {
  visit("u0", flow.u0, Range<double>{0, 1e3}, "[L/T0] root of the mean square speed");
  visit("modes", flow.modes, Range<int>{1, 4096}, "waves of random direction");
  visit("wavelength", flow.wavelength, kLength, "[L] of each");
  visit("correlation_time", flow.correlation_time, Range<double>{0, 1e6}, "[T0]; 0: steady");
  visit("seed", flow.seed, Range<int>{0, 2'147'483'647}, "of the waves");
}

// A file of values; see grid_file.hpp.
struct GridSource {
  std::string file, sha256;
  double length = 1, time = 1;
};

template <class Self, class Visit>
void grid_fields(Self& flow, Visit&& visit) {
  visit("length", flow.length, Range<double>{1e-9, 1e9}, "the file's length unit, in L");
  visit("time", flow.time, Range<double>{1e-9, 1e9}, "the file's time unit, in T0");
}

// Of a kind, with NaN where there is no default.
constexpr LinearFlow kLinearFlow{
    {{kNoDefault, kNoDefault}, {kNoDefault, kNoDefault}}, {0, 0}, {0, 0}};
constexpr PoiseuilleFlow kPoiseuilleFlow{kNoDefault, kNoDefault, 0};
constexpr TaylorGreenFlow kTaylorGreenFlow{kNoDefault, kNoDefault, {0, 0}};
constexpr VortexFlow kVortexFlow{kNoDefault, kNoDefault, {0, 0}};
constexpr DoubleGyreFlow kDoubleGyreFlow{kNoDefault, 0, 0, kNoDefault};

}  // namespace threelink_sim

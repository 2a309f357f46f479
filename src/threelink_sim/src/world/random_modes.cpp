// u = u0 sqrt(2/M) sum over M modes of e_m cos(k_m . X + omega_m t + phase_m), |k_m| = 2 pi /
// wavelength in a direction that is uniform, e_m at right angles to it. The mean of u.u over places
// is u0^2. With omega_m from a Cauchy distribution of the width 1/tau the covariance in time is
// exp(-|t| / tau), that of an Ornstein-Uhlenbeck process, and yet any time can be looked up without
// those before it. Its tails are cut at 10/tau, which action steps still resolve.
#include <cmath>

#include "flow_set.hpp"
#include "threelink_sim/model.hpp"
#include "threelink_sim/random.hpp"

namespace threelink_sim {

std::vector<FlowMode> draw_modes(const RandomModes& config) {
  constexpr double kFastest = 10;  // [1 / correlation_time]
  const double k = 2 * kPi / config.wavelength;
  const double amplitude = config.u0 * std::sqrt(2.0 / config.modes);
  const double widest = std::atan(kFastest);
  std::vector<FlowMode> modes;
  for (int m = 0; m < config.modes; ++m) {
    Random random(static_cast<std::uint64_t>(config.seed), Stream::kFlow,
                  static_cast<std::uint32_t>(m));
    const double direction = random.uniform(-kPi, kPi), phase = random.uniform(-kPi, kPi);
    const double quantile = random.uniform(-widest, widest);
    FlowMode mode{};
    mode.kx = k * std::cos(direction);
    mode.ky = k * std::sin(direction);
    mode.ux = -amplitude * std::sin(direction);
    mode.uy = amplitude * std::cos(direction);
    mode.omega = config.correlation_time > 0 ? std::tan(quantile) / config.correlation_time : 0;
    mode.phase = phase;
    modes.push_back(mode);
  }
  return modes;
}

}  // namespace threelink_sim

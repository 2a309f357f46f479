/// @file
/// The two symmetries of the swimmer, applied to many observations and rates at once.
///
/// Observation of N links, component k of sample i at [k * stride + i]:
/// c = cos theta_d, s = sin theta_d, alpha_1 .. alpha_{N-1}; rates likewise, r_1 .. r_{N-1}. Those
/// of "target" go on with w c, w s, which turn as c and s do, and the logarithm of the distance,
/// which stays.
///
///   mirror    reflection across the target's direction:
///             (c, s, alpha_j) -> (c, -s, -alpha_j),               r_j -> -r_j
///   reversal  calling the last link the first, which turns the axis by pi (observation.hpp):
///             (c, s, alpha_j) -> (-c, -s, -alpha_{N-j}),          r_j -> -r_{N-j}
///
/// Either maps a motion to a motion with the same rewards. Both are their own inverse.
#pragma once

#include <cstddef>

namespace threelink_agent {

/// Replaces observation i by its mirror image. size: components of an observation; hinges: N-1.
template <class Real>
void mirror_observation(Real* observation, int size, int hinges, std::size_t stride,
                        std::size_t i) {
  for (int k = 1; k < 2 + hinges; ++k) observation[k * stride + i] = -observation[k * stride + i];
  if (size > 2 + hinges)
    observation[(3 + hinges) * stride + i] = -observation[(3 + hinges) * stride + i];
}

/// Replaces rates i by their mirror image.
template <class Real>
void mirror_rates(Real* rates, int hinges, std::size_t stride, std::size_t i) {
  for (int j = 0; j < hinges; ++j) rates[j * stride + i] = -rates[j * stride + i];
}

/// Replaces rates i by those of the reversed swimmer.
template <class Real>
void reverse_rates(Real* rates, int hinges, std::size_t stride, std::size_t i) {
  for (int j = 0, last = hinges - 1; j <= last; ++j, --last) {
    const Real first = rates[j * stride + i];
    rates[j * stride + i] = -rates[last * stride + i];
    rates[last * stride + i] = -first;
  }
}

/// Replaces observation i by that of the reversed swimmer. size: components of an observation;
/// hinges: N-1.
template <class Real>
void reverse_observation(Real* observation, int size, int hinges, std::size_t stride,
                         std::size_t i) {
  observation[i] = -observation[i];
  observation[stride + i] = -observation[stride + i];
  reverse_rates(observation + 2 * stride, hinges, stride, i);  // angles and rates turn alike
  if (size > 2 + hinges)
    for (int k = 2 + hinges; k < 4 + hinges; ++k)
      observation[k * stride + i] = -observation[k * stride + i];
}

}  // namespace threelink_agent

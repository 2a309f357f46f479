/// @file
/// The diagonal normal distribution from which rates are sampled, one component per hinge.
#pragma once

namespace threelink_agent {

constexpr float kLogSqrt2Pi = 0.918938533204672742f;  ///< log sqrt(2 pi)

/// log N(a; mean, std) of one component, with z = (a - mean) / std:  -z^2/2 - log std - log sqrt(2
/// pi)
inline float log_density(float z, float log_std) { return -0.5f * z * z - log_std - kLogSqrt2Pi; }

/// Entropy of one component:  1/2 + log std + log sqrt(2 pi)
inline float gaussian_entropy(float log_std) { return 0.5f + log_std + kLogSqrt2Pi; }

}  // namespace threelink_agent

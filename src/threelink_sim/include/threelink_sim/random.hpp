/// @file
/// Random numbers that depend on their place of use, not on the number of earlier draws.
///
///
/// A counter-based generator (Philox4x32-10) turns (seed, stream, episode, step, draw) into
/// numbers, so that an episode can be repeated alone, in any order, on any worker, on any machine,
/// to the bit.
#pragma once

#include <cstdint>

namespace threelink_sim {

/// Use of the numbers. The values are part of the file formats: append, never renumber.
enum class Stream : std::uint32_t {
  kStart = 1,           ///< start states
  kExploration = 2,     ///< noise on the actions
  kTarget = 3,          ///< motion of the target
  kInitialisation = 4,  ///< network weights
  kMinibatch = 5,       ///< order of the samples in an update
  kMirror = 6,          ///< which episodes of an update are mirrored
  kStroke = 7,          ///< starts of the search for an optimal stroke
  kThermal = 8,         ///< thermal motion
  kFlow = 9,            ///< waves of a random flow
};

/// Word layout of a Philox counter: {draw, step, episode, stream}; the key is the 64-bit seed.
struct RandomCounter {
  std::uint32_t draw;
  std::uint32_t step;
  std::uint32_t episode;
  std::uint32_t stream;
};

/// A sequence of draws for one key.
class Random {
 public:
  Random(std::uint64_t seed, Stream stream, std::uint32_t episode, std::uint32_t step = 0);

  /// Uniform in (0, 1), ends excluded; 52 bits.
  double uniform();
  /// Uniform in (low, high).
  double uniform(double low, double high);
  /// Standard normal.
  double normal();
  /// Whole number in [0, bound), bound > 0; unbiased (Lemire 2019).
  std::uint32_t below(std::uint32_t bound);

 private:
  std::uint32_t key_[2];
  RandomCounter counter_;
};

}  // namespace threelink_sim

/// @file
/// Random numbers that depend on where they are used, not on how many were drawn before.
///
/// A counter-based generator (Philox4x32-10) turns (seed, stream, episode, step, draw) into
/// numbers, so that an episode can be repeated alone, in any order, on any worker, on any machine,
/// to the bit.
#pragma once

#include <cstdint>

namespace threelink_sim {

/// What the numbers are for. Values are part of the file formats: append, never renumber.
enum class Stream : std::uint32_t {
  kStart = 1,           ///< start states
  kExploration = 2,     ///< noise on the actions
  kTarget = 3,          ///< motion of the target
  kInitialisation = 4,  ///< network weights
  kMinibatch = 5,       ///< order of the samples in an update
  kMirror = 6,          ///< which episodes of an update are mirrored
  kStroke = 7,          ///< where the search for an optimal stroke starts
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

/// A sequence of draws at one place.
class Random {
 public:
  Random(std::uint64_t seed, Stream stream, std::uint32_t episode, std::uint32_t step = 0);

  /// In (0, 1), ends excluded; 52 bits.
  double uniform();
  /// In (low, high).
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

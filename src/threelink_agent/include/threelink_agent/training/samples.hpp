/// @file
/// A rollout arranged by samples, for epochs that visit the samples in random order.
#pragma once

#include <cstdint>

#include "threelink_agent/packed.hpp"
#include "threelink_agent/training/advantage.hpp"
#include "threelink_agent/training/rollout.hpp"

namespace threelink_agent {

/// Positions of the numbers of a sample in its row. The observation comes first, so that a row is
/// also an input row of the networks.
struct SampleRow {
  int observation_size;  ///< O
  int hinges;            ///< A

  int action() const { return observation_size; }
  int log_prob() const { return action() + hinges; }
  int advantage() const { return log_prob() + 1; }
  int value_target() const { return advantage() + 1; }  ///< the return
  /// Floats from one row to the next: a multiple of 64 bytes.
  int stride() const { return (value_target() + kPackedFloats) / kPackedFloats * kPackedFloats; }
};

/// All samples of a rollout with their advantages and returns.
class Samples {
 public:
  Samples(const Rollout& rollout, const Advantages& advantages);

  std::uint32_t count() const { return count_; }

  /// Copies the rows of n chosen samples into `rows` (n, stride), aligned to 64 bytes.
  void gather(const std::int64_t* chosen, int n, float* rows) const;

 private:
  SampleRow row_;
  std::uint32_t count_;
  AlignedFloats values_;
};

}  // namespace threelink_agent

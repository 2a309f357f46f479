/// @file
/// A rollout sample by sample, for epochs that visit the samples in random order.
#pragma once

#include <cstdint>

#include "threelink_agent/packed.hpp"
#include "threelink_agent/training/advantage.hpp"
#include "threelink_agent/training/rollout.hpp"

namespace threelink_agent {

/// Where the numbers of a sample are in its row. The observation comes first: a row of samples is
/// also a row of inputs of the networks.
struct SampleRow {
  int observation_size;  ///< O
  int hinges;            ///< A

  int action() const { return observation_size; }
  int log_prob() const { return action() + hinges; }
  int advantage() const { return log_prob() + 1; }
  int value_target() const { return advantage() + 1; }  ///< the return
  /// Floats from one row to the next: whole lines of 64 bytes.
  int stride() const { return (value_target() + kPackedFloats) / kPackedFloats * kPackedFloats; }
};

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

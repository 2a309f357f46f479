// How a training goes, for the one who waits for it.
#pragma once

#include <chrono>
#include <string>

#include "threelink_agent/training/trainer.hpp"

namespace threelink_agent {

// On a terminal a bar that is redrawn in place; elsewhere a line for each tenth of the training.
class Progress {
 public:
  explicit Progress(const TrainConfig& config);
  ~Progress();

  void show(const UpdateReport& report);

  double seconds() const;                              // [s] since the start
  double steps_per_s() const { return steps_per_s_; }  // of the last update shown

 private:
  using Clock = std::chrono::steady_clock;

  std::uint32_t episodes_;
  bool terminal_;
  Clock::time_point start_;
  double last_seconds_ = 0;
  std::uint64_t last_steps_ = 0;
  double steps_per_s_ = 0;
  std::string speed_ = "-";  // by the last evaluation
  int tenths_ = 0;           // shown
};

}  // namespace threelink_agent

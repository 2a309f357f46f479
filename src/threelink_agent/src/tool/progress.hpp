// How a training goes, for the one who waits for it.
#pragma once

#include <chrono>
#include <cstdint>
#include <string>

#include "threelink_agent/training/trainer.hpp"

namespace threelink_agent {

// On a terminal a bar that is redrawn in place; elsewhere a line for each tenth of the training.
class Progress {
 public:
  // Of a run that goes on after `episodes` of them and `seconds` of work.
  Progress(const TrainConfig& config, std::uint32_t episodes, double seconds);
  ~Progress();

  void show(const UpdateReport& report);
  // A line of its own, on standard error.
  void warn(const std::string& text);

  double seconds() const;                              // [s] of work on the run
  double seconds_left() const { return left_; }        // [s] as of the last update shown
  double steps_per_s() const { return steps_per_s_; }  // of the last update shown

 private:
  using Clock = std::chrono::steady_clock;

  std::uint32_t episodes_;  // in all
  bool terminal_;
  Clock::time_point start_;
  std::uint32_t first_episode_;  // of this process
  double first_seconds_;
  double last_seconds_;
  std::uint64_t last_steps_;
  double steps_per_s_ = 0;
  double smoothed_ = 0;      // [steps/s]
  double left_ = 0;          // [s]
  std::string speed_ = "-";  // by the last evaluation
  int tenths_;               // shown
};

}  // namespace threelink_agent

/// @file
/// Where the episodes of an update come from.
#pragma once

#include <exception>
#include <stdexcept>

#include "threelink_agent/training/crew.hpp"
#include "threelink_agent/training/rollout.hpp"

namespace threelink_agent {

/// The source was told to end; play() was left in the middle.
class Interrupted : public std::exception {
 public:
  const char* what() const noexcept override { return "interrupted"; }
};

/// The source cannot go on; what() gives the reason.
class NoRollout : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

class RolloutSource {
 public:
  virtual ~RolloutSource() = default;

  /// Plays that many episodes, from play.first_episode on. They are those of collect(), to the bit,
  /// wherever they are played. Throws Interrupted or NoRollout, where that can happen.
  virtual Rollout play(const Play& play, int episodes) = 0;

  /// Whether there is any sense in play() now. From any thread, at any time.
  virtual bool ready() { return true; }
};

/// In this process.
class LocalRollouts : public RolloutSource {
 public:
  explicit LocalRollouts(int threads) : threads_(threads), crew_(threads) {}

  Rollout play(const Play& play, int episodes) override;

 private:
  int threads_;
  Crew crew_;
};

}  // namespace threelink_agent

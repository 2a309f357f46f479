/// @file
/// Sources of the episodes of an update.
#pragma once

#include <exception>
#include <stdexcept>

#include "threelink_agent/training/crew.hpp"
#include "threelink_agent/training/rollout.hpp"

namespace threelink_agent {

/// Thrown by play() if the source was told to end.
class Interrupted : public std::exception {
 public:
  const char* what() const noexcept override { return "interrupted"; }
};

/// Error of a source that cannot continue. what() gives the reason.
class NoRollout : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// Interface of a source of rollouts.
class RolloutSource {
 public:
  virtual ~RolloutSource() = default;

  /// Plays `episodes` episodes, beginning with number play.first_episode. They are equal to the bit
  /// to those of collect(), wherever they are played. May throw Interrupted or NoRollout.
  virtual Rollout play(const Play& play, int episodes) = 0;

  /// Whether play() can succeed now. May be called from any thread at any time.
  virtual bool ready() { return true; }
};

/// Plays the episodes in this process.
class LocalRollouts : public RolloutSource {
 public:
  explicit LocalRollouts(int threads) : threads_(threads), crew_(threads) {}

  Rollout play(const Play& play, int episodes) override;

 private:
  int threads_;
  Crew crew_;
};

}  // namespace threelink_agent

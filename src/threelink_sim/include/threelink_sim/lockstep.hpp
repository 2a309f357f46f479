/// @file
/// The lock-step between simulator, task and agent, as a state machine without ROS.
///
///   start()                       state(0) is out, its target is awaited
///   target(stamp of state(k))     -> observation(k) goes out, its rates are awaited
///   rates(episode, k)             -> when the pace allows, poll() returns kStep: the owner takes
///                                    the step, publishes state(k+1) and calls stepped()
///
/// Every other message is refused with a reason. Times are those of the steady clock. The owner
/// calls poll() after every event and at deadline().
///
/// Without a pace (period 0) a step follows its command at once, and a peer that stays silent for
/// peer_timeout ends the episode. With a pace, steps begin one period apart. A late command delays
/// the step until its observation is `watchdog` old. From then on steps are taken with zero rates,
/// each when its observation is one period old, until a command for the current step arrives in
/// time. A silent task ends the episode with and without a pace.
#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace threelink_sim {

/// Why a message was refused; kAccepted if it was not.
enum class Verdict {
  kAccepted,
  kWrongLength,  ///< the number of rates is not that of the hinges
  kNotFinite,    ///< NaN or infinite
  kOutOfRange,   ///< a rate outside [-1, 1]
  kStale,        ///< for a step that already has its answer
  kFuture,       ///< for a later step or observation
};

/// For people: "stale", ...
const char* to_string(Verdict verdict);

/// The state machine of the lock-step.
class Lockstep {
 public:
  using Time = std::chrono::steady_clock::time_point;
  using Duration = std::chrono::steady_clock::duration;

  /// Timing of the lock-step.
  struct Config {
    std::size_t hinges = 0;   ///< N-1
    std::uint64_t tick = 0;   ///< [ns] simulation time of a step, > 0
    Duration period{};        ///< wall time of a step; 0: as fast as possible
    Duration peer_timeout{};  ///< silence that ends an episode
    Duration watchdog{};  ///< age of an unanswered observation that trips the watchdog, >= period
  };

  /// What is awaited: nothing, a target, rates, or the time of the next step.
  enum class Phase { kIdle, kAwaitTarget, kAwaitRates, kAwaitPace };
  /// What the owner has to do: wait, take a step, or abort the episode.
  enum class Action { kWait, kStep, kAbort };

  explicit Lockstep(const Config& config);

  /// Begins a new episode at step 0 and ends the current one, if any.
  void start(Time now);
  /// Ends the episode. Every message is refused until start().
  void end() { phase_ = Phase::kIdle; }

  /// Handles the target (x, y), in any unit of length, for the state with this stamp [ns]. Once it
  /// is accepted, the owner publishes the observation.
  Verdict target(std::uint64_t stamp, double x, double y, Time now);

  /// Handles the agent's rates (count) [1/T0] for observation(step) of the episode.
  Verdict rates(std::uint32_t episode, std::uint64_t step, const double* values, std::size_t count);

  /// kStep: take a step with command(), then call stepped(). kAbort: the peer that phase() waits
  /// for has been silent for too long; report it, then call end().
  Action poll(Time now);
  /// Records that the step was taken. The target of the next state is awaited.
  void stepped(Time now);

  /// When to call poll() if nothing arrives; Time::max() if never.
  Time deadline() const;

  Phase phase() const { return phase_; }
  std::uint32_t episode() const { return episode_; }               ///< 0 before the first
  std::uint64_t step() const { return step_; }                     ///< of the current state
  std::uint64_t stamp() const { return ticks_ * config_.tick; }    ///< [ns] of the current state
  const std::vector<double>& command() const { return command_; }  ///< [1/T0] (N-1)
  bool watchdog_tripped() const { return watchdog_tripped_; }

 private:
  bool paced() const { return config_.period > Duration::zero(); }

  Config config_;
  Phase phase_ = Phase::kIdle;
  std::uint32_t episode_ = 0;
  std::uint64_t step_ = 0;
  std::uint64_t ticks_ = 1;  ///< over all episodes, so that time never decreases; above zero
  std::vector<double> command_;
  bool watchdog_tripped_ = false;
  Time asked_;  ///< when the awaited answer was requested
  Time due_;    ///< when the pace allows the next step
};

}  // namespace threelink_sim

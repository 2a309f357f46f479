/// @file
/// The lock-step between simulator, task and agent, as a state machine without ROS.
///
///   start()                       state(0) is out, its target is awaited
///   target(stamp of state(k))     -> observation(k) goes out, its rates are awaited
///   rates(episode, k)             -> when the pace allows, poll() returns kStep: the owner takes
///                                    the step, publishes state(k+1) and calls stepped()
///
/// Everything else that arrives is refused, with a reason. Time is that of the steady clock; the
/// owner calls poll() after every event, and when deadline() has come.
///
/// Without a pace (period 0) a step follows its command at once, and a peer that stays silent for
/// peer_timeout ends the episode. With one, steps begin one period apart. A command that is late
/// holds everything up until its observation is `watchdog` old; from then on steps are taken with
/// zero rates, each when its observation is one period old, until a command for the current step
/// arrives in time. A silent task ends the episode with and without a pace.
#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace threelink_sim {

/// Why a message was refused; kAccepted if it was not.
enum class Verdict {
  kAccepted,
  kWrongLength,  ///< not one rate a hinge
  kNotFinite,    ///< NaN or infinite
  kOutOfRange,   ///< a rate outside [-1, 1]
  kStale,        ///< for a step that has its answer
  kFuture,       ///< for a step, or an observation, that is yet to come
};

/// For people: "stale", ...
const char* to_string(Verdict verdict);

class Lockstep {
 public:
  using Time = std::chrono::steady_clock::time_point;
  using Duration = std::chrono::steady_clock::duration;

  struct Config {
    std::size_t hinges = 0;   ///< N-1
    std::uint64_t tick = 0;   ///< [ns] simulation time of a step, > 0
    Duration period{};        ///< wall time of a step; 0: as fast as possible
    Duration peer_timeout{};  ///< silence that ends an episode
    Duration watchdog{};  ///< age of an unanswered observation that trips the watchdog, >= period
  };

  enum class Phase { kIdle, kAwaitTarget, kAwaitRates, kAwaitPace };
  enum class Action { kWait, kStep, kAbort };

  explicit Lockstep(const Config& config);

  /// A new episode begins, at step 0; the one that runs, if any, is over.
  void start(Time now);
  /// The episode is over; until start(), everything is refused.
  void end() { phase_ = Phase::kIdle; }

  /// The task's answer to the state of that stamp [ns], in any unit of length. Once it is accepted,
  /// the owner publishes the observation.
  Verdict target(std::uint64_t stamp, double x, double y, Time now);

  /// The agent's answer to observation(step) of the episode.
  Verdict rates(std::uint32_t episode, std::uint64_t step, const double* values, std::size_t count);

  /// kStep: take a step with command(), then call stepped(). kAbort: the peer that phase() waits
  /// for has been silent for too long; report it, then call end().
  Action poll(Time now);
  /// The step is taken; the target of the next state is awaited.
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
  std::uint64_t ticks_ = 1;  ///< over all episodes, so that time never goes back; above zero
  std::vector<double> command_;
  bool watchdog_tripped_ = false;
  Time asked_;  ///< when the answer that is awaited was asked for
  Time due_;    ///< when the pace allows the step
};

}  // namespace threelink_sim

/// @file
/// Rollouts that workers in other processes play.
#pragma once

#include <condition_variable>
#include <functional>
#include <mutex>
#include <string>
#include <vector>

#include "threelink_agent/distributed/dispatcher.hpp"
#include "threelink_agent/training/rollout_source.hpp"
#include "threelink_agent/training/train_config.hpp"

namespace threelink_agent {

/// Distributed rollouts without lag: play() returns when every episode of the current policy has
/// arrived.
class RemoteRollouts : public RolloutSource {
 public:
  /// The connection to the workers. Its methods are called from several threads, one at a time, and
  /// must not block for long.
  class Wire {
   public:
    virtual ~Wire() = default;
    /// Sends a policy file to all workers.
    virtual void send_policy(std::uint64_t version, const std::string& bytes) = 0;
    /// Sends leases and refusals.
    virtual void send(std::uint64_t session, const Update& update,
                      const Dispatcher::Sending& sending) = 0;
  };

  /// Settings of the distribution and of the wait for workers.
  struct Settings {
    DispatcherSettings dispatcher;
    std::chrono::nanoseconds worker_timeout = std::chrono::seconds(30);  ///< without workers
  };

  /// keep_going: play() calls it several times a second and ends when it returns false.
  RemoteRollouts(const TrainConfig& config, const Settings& settings, Wire& wire,
                 std::function<bool()> keep_going);

  /// Plays a rollout on the workers. Throws Interrupted if keep_going() returns false, NoRollout
  /// that names the refused workers if there is no worker for too long, and PolicyError if the
  /// policy cannot be sent.
  Rollout play(const Play& play, int episodes) override;

  /// Runs react(dispatcher, now) under the lock, then sends the resulting messages. May be called
  /// from any thread.
  void with(const std::function<void(Dispatcher&, Dispatcher::Time)>& react);

 private:
  using Clock = std::chrono::steady_clock;

  void send_what_is_due();
  void refuse_to_wait_alone();  ///< throws NoRollout

  TrainConfig config_;
  Settings settings_;
  Wire& wire_;
  std::function<bool()> keep_going_;
  std::mutex mutex_;  ///< guards the members below and the wire
  std::condition_variable complete_;
  Dispatcher dispatcher_;
  Clock::time_point last_alive_;  ///< time at which a worker was last present
};

}  // namespace threelink_agent

/// @file
/// Rollouts that workers play elsewhere.
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

/// Lag 0: play() returns when every episode of this policy is in.
class RemoteRollouts : public RolloutSource {
 public:
  /// The way to the workers. Called from several threads, one at a time; must not block for long.
  class Wire {
   public:
    virtual ~Wire() = default;
    virtual void send_policy(std::uint64_t version, const std::string& bytes) = 0;
    virtual void send(std::uint64_t session, const Update& update,
                      const Dispatcher::Sending& sending) = 0;
  };

  struct Settings {
    DispatcherSettings dispatcher;
    std::chrono::nanoseconds worker_timeout = std::chrono::seconds(30);  ///< without any worker
  };

  /// keep_going: asked some times a second by play().
  RemoteRollouts(const TrainConfig& config, const Settings& settings, Wire& wire,
                 std::function<bool()> keep_going);

  /// Throws Interrupted if keep_going() says no, NoRollout if there is no worker for too long,
  /// naming those that were refused, and PolicyError if the policy cannot be
  /// sent.
  Rollout play(const Play& play, int episodes) override;

  /// Runs react(dispatcher, now) alone, then sends what follows from it. From any thread.
  void with(const std::function<void(Dispatcher&, Dispatcher::Time)>& react);

 private:
  using Clock = std::chrono::steady_clock;

  void send_what_is_due();
  void refuse_to_wait_alone();  ///< throws NoRollout

  TrainConfig config_;
  Settings settings_;
  Wire& wire_;
  std::function<bool()> keep_going_;
  std::mutex mutex_;  ///< of all that follows, and the wire
  std::condition_variable complete_;
  Dispatcher dispatcher_;
  Clock::time_point last_alive_;  ///< when there was a worker
};

}  // namespace threelink_agent

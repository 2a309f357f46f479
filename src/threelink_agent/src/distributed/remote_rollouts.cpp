#include "threelink_agent/distributed/remote_rollouts.hpp"

#include <utility>

#include <fmt/format.h>

#include "threelink_agent/training/trainer.hpp"
#include "threelink_sim/sha256.hpp"

namespace threelink_agent {

RemoteRollouts::RemoteRollouts(const TrainConfig& config, const Settings& settings, Wire& wire,
                               std::function<bool()> keep_going)
    : config_(config),
      settings_(settings),
      wire_(wire),
      keep_going_(std::move(keep_going)),
      dispatcher_(settings.dispatcher) {}

Rollout RemoteRollouts::play(const Play& play, int episodes) {
  using namespace std::chrono_literals;
  const Policy policy(policy_metadata(config_), play.actor, play.log_std);
  const std::uint64_t version = play.first_episode / config_.update.episodes;
  std::unique_lock<std::mutex> lock(mutex_);
  wire_.send_policy(version, policy.serialize());
  dispatcher_.open(
      {version, threelink_sim::sha256(policy.serialize()), play.first_episode, episodes},
      Rollout(play.environment, episodes), play);
  last_alive_ = Clock::now();
  send_what_is_due();
  while (!complete_.wait_for(lock, 20ms, [this] { return dispatcher_.complete(); })) {
    if (!keep_going_()) throw Interrupted();
    refuse_to_wait_alone();
    send_what_is_due();
  }
  return dispatcher_.take();
}

void RemoteRollouts::with(const std::function<void(Dispatcher&, Dispatcher::Time)>& react) {
  const std::lock_guard<std::mutex> lock(mutex_);
  react(dispatcher_, Clock::now());
  send_what_is_due();
  if (dispatcher_.complete()) complete_.notify_one();
}

void RemoteRollouts::send_what_is_due() {
  const Dispatcher::Sending sending = dispatcher_.tick(Clock::now());
  if (!sending.leases.empty() || !sending.refusals.empty())
    wire_.send(dispatcher_.session(), dispatcher_.update(), sending);
}

void RemoteRollouts::refuse_to_wait_alone() {
  const Clock::time_point now = Clock::now();
  if (dispatcher_.roster().alive() > 0) last_alive_ = now;
  if (now - last_alive_ <= settings_.worker_timeout) return;
  if (!dispatcher_.roster().aside().empty()) return;  // they may play again, after their time
  std::string refused;
  for (const auto& [name, worker] : dispatcher_.roster().workers())
    if (!worker.refused.empty()) refused += fmt::format("; refused {}: {}", name, worker.refused);
  throw NoRollout(fmt::format("no worker for {:g} s{}",
                              std::chrono::duration<double>(settings_.worker_timeout).count(),
                              refused));
}

}  // namespace threelink_agent

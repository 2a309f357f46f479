// A learner with one update to fill, for the tests of the dispatcher.
#pragma once

#include <chrono>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "small_training.hpp"
#include "threelink_agent/distributed/dispatcher.hpp"
#include "threelink_agent/distributed/fingerprint.hpp"
#include "threelink_agent/distributed/lease_player.hpp"
#include "threelink_sim/sha256.hpp"

namespace {

using namespace threelink_agent;
using namespace std::chrono_literals;
using Time = Dispatcher::Time;

constexpr std::uint64_t kSession = 77;
constexpr int kEpisodes = 12;

DispatcherSettings settings() {
  DispatcherSettings settings;
  settings.roster.session = kSession;
  settings.roster.fingerprint = "abc";
  settings.lease_time = 10s;
  return settings;
}

WorkerStatus status_of(std::uint64_t instance, const std::string& name) {
  WorkerStatus status;
  status.name = name;
  status.instance = instance;
  status.protocol = kProtocol;
  status.fingerprint = "abc";
  return status;
}
WorkerStatus status_of(std::uint64_t instance) {
  return status_of(instance, "worker_" + std::to_string(instance));
}

// A learner with one update to fill, at a time that only the test moves.
class DispatcherTest : public testing::Test {
 protected:
  DispatcherTest() {
    TrainConfig config = threelink_tests::small();
    config.environment.steps = 5;
    config.hidden = {4};
    config.update.minibatch = 30;
    open(config, 3);
  }

  // The update after `version` of them.
  void open(const TrainConfig& config, std::uint32_t version) {
    config_ = config;
    const Trainer trainer = threelink_tests::trainer_of(config);
    const Policy policy = trainer.policy();
    player_.load(policy.serialize(), "test");
    update_ = {version, threelink_sim::sha256(policy.serialize()), version * kEpisodes, kEpisodes};
    play_ = Play{config.environment, config.goal, config.symmetry.canonical, policy.actor(),
                 policy.log_std(),   config.seed, update_.first_episode};
    expected_ = LocalRollouts(1).play(*play_, kEpisodes);
    dispatcher_.open(update_, Rollout(config.environment, kEpisodes), play_);
  }

  void join(std::uint64_t instance) {
    dispatcher_.connect(status_of(instance).name);
    dispatcher_.hear(status_of(instance), now_);
  }
  std::vector<Lease> leases() { return dispatcher_.tick(now_).leases; }
  Lease only_lease() {
    const std::vector<Lease> given = leases();
    EXPECT_EQ(given.size(), 1u);
    return given.empty() ? Lease{} : given[0];
  }
  EpisodeBatch play(const Lease& lease) {
    return player_.play({kSession, update_.version, update_.policy, lease.id, lease.worker,
                         update_.first_episode + lease.first,
                         static_cast<std::uint32_t>(lease.count)});
  }
  Verdict deliver(const EpisodeBatch& batch) {
    return dispatcher_.deliver(batch, status_of(batch.worker).name, now_);
  }
  // What an idle worker says once a second.
  void say_idle(std::uint64_t instance) {
    WorkerStatus status = status_of(instance);
    status.session = kSession;
    dispatcher_.hear(status, now_);
  }
  const WorkerRoster::Worker& worker(std::uint64_t instance) {
    return dispatcher_.roster().workers().at(status_of(instance).name);
  }
  void expect_the_rollout() {
    ASSERT_TRUE(dispatcher_.complete());
    const Rollout rollout = dispatcher_.take();
    EXPECT_EQ(rollout.observations, expected_->observations);
    EXPECT_EQ(rollout.actions, expected_->actions);
    EXPECT_EQ(rollout.log_probs, expected_->log_probs);
    EXPECT_EQ(rollout.rewards, expected_->rewards);
    EXPECT_EQ(rollout.captured, expected_->captured);
  }

  Time now_{};
  TrainConfig config_;
  LeasePlayer player_{std::make_unique<LocalRollouts>(1)};
  Update update_{};
  std::optional<Play> play_;
  std::optional<Rollout> expected_;
  Dispatcher dispatcher_{settings()};
};

}  // namespace

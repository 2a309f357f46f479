// The learner's side of the protocol among strangers: what they send changes nothing.
#include <functional>
#include <limits>

#include "dispatcher_fixture.hpp"

namespace {

TEST_F(DispatcherTest, WhatAnotherNodeSendsInAWorkersNameHasNoEffect) {
  join(1);
  const Lease lease = only_lease();
  EpisodeBatch good = play(lease), empty;
  empty.session = kSession, empty.version = update_.version, empty.worker = 1;
  EpisodeBatch back = empty;
  back.policy = update_.policy, back.lease = lease.id, back.given_back = "so that it starves";
  for (int i = 0; i < 1000; ++i)
    for (const EpisodeBatch* batch : {&empty, &back, &good})
      ASSERT_EQ(dispatcher_.deliver(*batch, "stranger", now_), Verdict::kStranger);
  EXPECT_EQ(dispatcher_.batches(Verdict::kStranger), 3000u);
  EXPECT_EQ(worker(1).batches_refused, 0u);
  EXPECT_EQ(worker(1).refused, "");
  EXPECT_EQ(dispatcher_.episodes_in(), 0);
  EXPECT_EQ(deliver(good), Verdict::kAccepted);
  expect_the_rollout();
}

// The name of a sender can be forged, too: what is true still counts, whatever else was sent.
TEST_F(DispatcherTest, ForgedBatchesAndStatusesDoNotKeepTheTrueOneOut) {
  join(1);
  for (int update = 0; update < 20; ++update) {
    open(config_, 3);
    say_idle(1);
    std::vector<Lease> held{only_lease()};
    for (int i = 0; i < 100; ++i) {
      EpisodeBatch forged = play(held.back());
      forged.rewards[0] += 1;
      EXPECT_EQ(deliver(forged), Verdict::kBadChecksum);
      say_idle(1);  // forged as well
      for (const Lease& lease : leases()) held.push_back(lease);
      now_ += 10ms;
    }
    EXPECT_EQ(held.size(), 3u);  // then it is set aside
    EXPECT_EQ(deliver(play(held[0])), Verdict::kAccepted);
    expect_the_rollout();
    EXPECT_EQ(worker(1).pauses, 0);
    for (const Lease& lease : held) deliver(play(lease));  // too late
    leases();
  }
}

TEST_F(DispatcherTest, OneWrongEpisodeIsFoundByLot) {
  int found = 0;
  for (int i = 0; i < 300; ++i) {
    open(config_, 3);
    dispatcher_ = Dispatcher(settings());
    dispatcher_.open(update_, Rollout(config_.environment, kEpisodes), play_);
    join(1);
    EpisodeBatch batch = play(only_lease());
    batch.rewards[5] += 1;  // of one of twelve
    batch.checksum = checksum(batch);
    found += deliver(batch) == Verdict::kOtherBits;
  }
  EXPECT_GT(found, 5);
  EXPECT_LT(found, 60);
  DispatcherSettings all = settings();
  all.replays = kEpisodes;
  dispatcher_ = Dispatcher(all);
  dispatcher_.open(update_, Rollout(config_.environment, kEpisodes), play_);
  join(1);
  EpisodeBatch batch = play(only_lease());
  batch.observations.back() += 1;
  batch.checksum = checksum(batch);
  EXPECT_EQ(deliver(batch), Verdict::kOtherBits);
  EXPECT_EQ(deliver(play({1, 1, 0, kEpisodes})), Verdict::kAccepted);
}

TEST_F(DispatcherTest, TheRosterForgetsAndPlaysOn) {
  join(1);
  EXPECT_EQ(deliver(play(only_lease())), Verdict::kAccepted);
  expect_the_rollout();
  for (std::uint64_t i = 100; i < 20100; ++i) {
    WorkerStatus invented = status_of(i);
    if (i % 2 == 0) invented.fingerprint = "other";
    dispatcher_.hear(invented, now_);
    ASSERT_LE(dispatcher_.tick(now_).refusals.size(), 1u);
    now_ += 100us;
  }
  EXPECT_LE(dispatcher_.roster().workers().size(), 251u);
  EXPECT_EQ(worker(1).episodes, 12u);
  open(config_, 4);
  say_idle(1);
  EXPECT_EQ(deliver(play(only_lease())), Verdict::kAccepted);
  expect_the_rollout();
}

TEST_F(DispatcherTest, StatusesThatNoWorkerSaysAreRefused) {
  join(1);
  const auto refused = [&](const std::function<void(WorkerStatus&)>& change) {
    WorkerStatus status = status_of(2);
    change(status);
    const std::uint64_t before = dispatcher_.statuses_refused();
    dispatcher_.hear(status, now_);
    return dispatcher_.statuses_refused() == before + 1;
  };
  EXPECT_FALSE(refused([](WorkerStatus&) {}));
  EXPECT_TRUE(refused([](WorkerStatus& s) { s.instance = 0; }));
  EXPECT_TRUE(refused([](WorkerStatus& s) { s.instance = 1; }));  // of another one
  EXPECT_TRUE(refused([](WorkerStatus& s) { s.name = ""; }));
  EXPECT_TRUE(refused([](WorkerStatus& s) { s.name = "/a\033[2J"; }));
  EXPECT_TRUE(refused([](WorkerStatus& s) { s.name = std::string(256, 'a'); }));
  EXPECT_TRUE(refused([](WorkerStatus& s) { s.host = "a\nb"; }));
  EXPECT_TRUE(refused([](WorkerStatus& s) { s.host = std::string(100000, 'h'); }));
  EXPECT_TRUE(refused([](WorkerStatus& s) { s.fingerprint = "\xff"; }));
  EXPECT_TRUE(refused([](WorkerStatus& s) { s.instructions = "\x07"; }));
  EXPECT_EQ(dispatcher_.roster().workers().size(), 2u);
}

TEST_F(DispatcherTest, ARefusalIsToldOnceInAWhile) {
  WorkerStatus other = status_of(1);
  other.fingerprint = "abd";
  std::size_t told = 0;
  for (int i = 0; i < 1000; ++i, now_ += 10ms) {
    dispatcher_.hear(other, now_);
    told += dispatcher_.tick(now_).refusals.size();
  }
  EXPECT_EQ(told, 2u);  // in ten seconds
}

}  // namespace

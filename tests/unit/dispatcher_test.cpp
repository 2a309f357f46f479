// The learner's side of the protocol: what enters a rollout, and what does not.
#include "threelink_agent/distributed/dispatcher.hpp"

#include <limits>
#include <map>
#include <optional>
#include <random>
#include <set>
#include <string>
#include <thread>
#include <vector>

#include <gtest/gtest.h>

#include "dispatcher_fixture.hpp"
#include "threelink_agent/distributed/fingerprint.hpp"
#include "threelink_agent/distributed/lease_player.hpp"
#include "threelink_agent/distributed/remote_rollouts.hpp"
#include "threelink_sim/isa.hpp"
#include "threelink_sim/sha256.hpp"

namespace {

TEST_F(DispatcherTest, OneWorkerPlaysTheRollout) {
  join(1);
  const Lease lease = only_lease();
  EXPECT_EQ(lease.first, 0);
  EXPECT_EQ(lease.count, kEpisodes);
  EXPECT_TRUE(leases().empty());  // no more than it holds
  EXPECT_EQ(deliver(play(lease)), Verdict::kAccepted);
  EXPECT_EQ(worker(1).episodes, 12u);
  expect_the_rollout();
}

TEST_F(DispatcherTest, AWorkerNeedsAConnectionAndAVoice) {
  dispatcher_.hear(status_of(1), now_);
  EXPECT_TRUE(leases().empty());
  dispatcher_.connect("worker_2");
  EXPECT_TRUE(leases().empty());
  dispatcher_.connect("worker_1");
  EXPECT_EQ(only_lease().worker, 1u);
}

TEST_F(DispatcherTest, WorkIsDividedBySpeed) {
  join(1), join(2);
  std::vector<Lease> given = leases();
  ASSERT_EQ(given.size(), 2u);
  EXPECT_EQ(given[0].count, 6);
  EXPECT_EQ(given[1].count, 6);
  now_ += 1s;
  deliver(play(given[0]));
  now_ += 1s;
  deliver(play(given[1]));  // half as fast
  expect_the_rollout();
  open(config_, 4);
  given = leases();
  ASSERT_EQ(given.size(), 2u);
  EXPECT_EQ(given[0].count, 8);
  EXPECT_EQ(given[1].count, 4);
}

// One that comes back alone leaves the others their part.
TEST_F(DispatcherTest, WhatIsOpenIsSharedWithThoseThatAreBusy) {
  join(1), join(2), join(3);
  std::vector<Lease> given = leases();
  ASSERT_EQ(given.size(), 3u);
  dispatcher_.disconnect("worker_3", now_);
  EpisodeBatch bad = play(given[0]);
  bad.checksum = "";
  deliver(bad);
  EXPECT_TRUE(leases().empty());  // the true batch may still come
  say_idle(1);
  const Lease half = only_lease();
  EXPECT_EQ(half.worker, 1u);
  EXPECT_EQ(half.count, 4);
  deliver(play(half));
  EXPECT_EQ(only_lease().count, 2);
}

TEST_F(DispatcherTest, LeasesAreBounded) {
  DispatcherSettings small = settings();
  small.lease_episodes = 5;
  dispatcher_ = Dispatcher(small);
  dispatcher_.open(update_, Rollout(config_.environment, kEpisodes));
  join(1);
  for (int count : {5, 5, 2}) {
    const Lease lease = only_lease();
    EXPECT_EQ(lease.count, count);
    EXPECT_EQ(deliver(play(lease)), Verdict::kAccepted);
  }
  expect_the_rollout();
}

TEST_F(DispatcherTest, AnExpiredLeaseIsGivenAgainAndCountsOnce) {
  join(1);
  const Lease lost = only_lease();
  now_ += 2s, join(2), now_ += 2s;
  dispatcher_.hear(status_of(1), now_), dispatcher_.hear(status_of(2), now_);
  EXPECT_TRUE(leases().empty());
  for (int i = 0; i < 3; ++i) {  // worker 1 goes on to say that it holds the lease
    now_ += 2s;
    WorkerStatus busy = status_of(1);
    busy.session = kSession, busy.lease = lost.id;
    dispatcher_.hear(busy, now_), dispatcher_.hear(status_of(2), now_);
  }
  const Lease again = only_lease();  // and gets no other
  EXPECT_EQ(again.worker, 2u);
  EXPECT_EQ(again.count, kEpisodes);
  EXPECT_EQ(dispatcher_.leases_lost(), 1u);
  EXPECT_EQ(worker(1).leases_lost, 1u);
  EXPECT_EQ(deliver(play(again)), Verdict::kAccepted);
  EXPECT_EQ(deliver(play(lost)), Verdict::kDouble);
  EXPECT_EQ(worker(1).episodes, 0u);
  expect_the_rollout();
}

TEST_F(DispatcherTest, AWorkerMayGiveALeaseBack) {
  join(1);
  const auto give_back = [&](const Lease& lease) {
    EpisodeBatch batch = play({});
    batch.lease = lease.id, batch.worker = lease.worker;
    batch.given_back = "the robot is tired";
    return deliver(batch);
  };
  EXPECT_EQ(give_back(only_lease()), Verdict::kGivenBack);
  EXPECT_TRUE(leases().empty());  // until it is heard again
  EXPECT_EQ(dispatcher_.roster().alive(), 0);
  join(2);
  const Lease lease = only_lease();
  EXPECT_EQ(lease.worker, 2u);
  EXPECT_EQ(lease.count, kEpisodes);
  EXPECT_EQ(give_back(lease), Verdict::kGivenBack);
  EXPECT_EQ(give_back(lease), Verdict::kGivenBack);  // whatever comes twice
  dispatcher_.hear(status_of(1), now_);
  EXPECT_EQ(deliver(play(only_lease())), Verdict::kAccepted);
  expect_the_rollout();
  EXPECT_EQ(give_back(lease), Verdict::kLate);
  EXPECT_EQ(dispatcher_.batches(Verdict::kGivenBack), 3u);
  EXPECT_EQ(dispatcher_.leases_lost(), 0u);

  open(config_, 4);
  for (int i = 0; i < 10; ++i) {
    dispatcher_.hear(status_of(1), now_);
    EXPECT_EQ(worker(1).refused, "");
    EXPECT_EQ(give_back(only_lease()), Verdict::kGivenBack);
  }
  dispatcher_.hear(status_of(1), now_);
  const Dispatcher::Sending sending = dispatcher_.tick(now_);
  EXPECT_TRUE(sending.leases.empty());
  ASSERT_EQ(sending.refusals.size(), 1u);
  EXPECT_EQ(
      sending.refusals[0].reason,
      "set aside for 5 s: it gave 10 leases in a row back, the last one since the robot is tired");
  now_ += 5s;
  dispatcher_.hear(status_of(1), now_);
  EXPECT_EQ(only_lease().worker, 1u);
}

// Otherwise a worker that needs longer than a lease lasts would work for ever, for nothing.
TEST_F(DispatcherTest, ALostLeaseThatComesAfterAllIsTaken) {
  join(1);
  const Lease lost = only_lease();
  now_ += 11s;
  join(2);
  const Lease again = only_lease();
  EXPECT_EQ(deliver(play(lost)), Verdict::kAccepted);
  EXPECT_TRUE(dispatcher_.complete());
  EXPECT_EQ(deliver(play(again)), Verdict::kDouble);
  expect_the_rollout();
}

TEST_F(DispatcherTest, ADeliveryCountsOnce) {
  join(1);
  join(2);
  const std::vector<Lease> given = leases();
  EXPECT_EQ(deliver(play(given[0])), Verdict::kAccepted);
  EXPECT_EQ(deliver(play(given[0])), Verdict::kDouble);
  EXPECT_EQ(dispatcher_.episodes_in(), 6);
  EXPECT_EQ(deliver(play(given[1])), Verdict::kAccepted);
  EXPECT_EQ(dispatcher_.batches(Verdict::kAccepted), 2u);
  EXPECT_EQ(dispatcher_.batches(Verdict::kDouble), 1u);
  expect_the_rollout();
  EXPECT_EQ(deliver(play(given[1])), Verdict::kLate);
  open(config_, 4);
  EXPECT_EQ(deliver([&] {
              EpisodeBatch late = play(given[1]);
              late.version = 3;
              return late;
            }()),
            Verdict::kLate);
  EXPECT_EQ(dispatcher_.batches(Verdict::kLate), 2u);
}

TEST_F(DispatcherTest, WhatDisconnectsOrFallsSilentLosesItsLease) {
  join(1);
  only_lease();
  dispatcher_.disconnect("worker_1", now_);
  EXPECT_EQ(dispatcher_.roster().alive(), 0);
  join(2);
  EXPECT_EQ(only_lease().worker, 2u);
  now_ += 2s;
  dispatcher_.hear(status_of(2), now_);
  now_ += 3s;
  EXPECT_TRUE(leases().empty());
  EXPECT_EQ(dispatcher_.roster().alive(), 1);
  join(3);
  now_ += 1ms;
  EXPECT_EQ(only_lease().worker, 3u);
  EXPECT_EQ(worker(2).leases_lost, 1u);
}

TEST_F(DispatcherTest, ARespawnedWorkerTakesThePlaceOfTheOldOne) {
  join(1);
  const Lease lost = only_lease();
  dispatcher_.hear(status_of(9, "worker_1"), now_);  // before the old connection is seen to break
  const Lease again = only_lease();
  EXPECT_EQ(again.worker, 9u);
  EXPECT_EQ(worker(1).instances, 2u);
  EXPECT_EQ(worker(1).leases_lost, 1u);
  EXPECT_EQ(deliver(play(lost)), Verdict::kAccepted);  // it was under way
  expect_the_rollout();
}

TEST_F(DispatcherTest, AWorkerThatStartsOverAndOverIsSetAside) {
  dispatcher_.connect("worker_1");
  for (std::uint64_t instance = 1; instance <= 6; ++instance) {
    EXPECT_EQ(dispatcher_.roster().alive(), instance > 1);
    dispatcher_.hear(status_of(instance, "worker_1"), now_);
    now_ += 1s;
  }
  EXPECT_EQ(dispatcher_.roster().alive(), 0);
  EXPECT_EQ(worker(1).refused, "set aside for 5 s: it started anew 5 times within 60 s");
  const Dispatcher::Sending sending = dispatcher_.tick(now_);
  EXPECT_TRUE(sending.leases.empty());
  ASSERT_EQ(sending.refusals.size(), 1u);
  EXPECT_EQ(sending.refusals[0].worker, 6u);
  dispatcher_.hear(status_of(7, "worker_1"), now_);
  EXPECT_TRUE(leases().empty());
  now_ += 5s;
  dispatcher_.hear(status_of(7, "worker_1"), now_);
  EXPECT_EQ(only_lease().worker, 7u);
}

TEST_F(DispatcherTest, RestartsThatAreFarApartAreForgiven) {
  dispatcher_.connect("worker_1");
  for (std::uint64_t instance = 1; instance <= 20; ++instance, now_ += 16s)
    dispatcher_.hear(status_of(instance, "worker_1"), now_);
  EXPECT_EQ(dispatcher_.roster().workers().at("worker_1").refused, "");
}

TEST_F(DispatcherTest, AWorkerWithOtherBitsIsRefusedWithTheReason) {
  dispatcher_.connect("worker_1");
  WorkerStatus status = status_of(1);
  status.fingerprint = "abd";
  status.instructions = "baseline";
  dispatcher_.hear(status, now_);
  Dispatcher::Sending sending = dispatcher_.tick(now_);
  EXPECT_TRUE(sending.leases.empty());
  ASSERT_EQ(sending.refusals.size(), 1u);
  EXPECT_EQ(sending.refusals[0].reason,
            "it computes other bits (baseline kernels; fingerprint abd, the learner's abc): it "
            "lacks fused multiply-adds, or is another build");
  status = status_of(1);
  status.protocol = kProtocol + 1;
  dispatcher_.hear(status, now_);
  sending = dispatcher_.tick(now_);
  EXPECT_TRUE(sending.leases.empty());
  EXPECT_EQ(sending.refusals.at(0).reason, "it speaks version 3 of the protocol, the learner 2");
}

// Everything that may be wrong with a batch, and what it is called.
TEST_F(DispatcherTest, PoisonIsRefusedCountedAndGivenAgain) {
  const auto sealed = [](EpisodeBatch batch) {
    batch.checksum = checksum(batch);
    return batch;
  };
  const float nan = std::numeric_limits<float>::quiet_NaN();
  const float infinity = std::numeric_limits<float>::infinity();
  using Spoil = std::function<void(EpisodeBatch&)>;
  const std::vector<std::pair<Verdict, Spoil>> cases = {
      {Verdict::kWrongPolicy, [](EpisodeBatch& b) { ++b.version; }},
      {Verdict::kWrongPolicy, [](EpisodeBatch& b) { b.policy[5] ^= 1; }},
      {Verdict::kNotLeased, [](EpisodeBatch& b) { b.lease += 1000; }},
      {Verdict::kNotLeased, [](EpisodeBatch& b) { b.lease = 0; }},
      {Verdict::kMalformed, [](EpisodeBatch& b) { ++b.first_episode; }},
      {Verdict::kMalformed, [](EpisodeBatch& b) { b.episodes = 0; }},
      {Verdict::kMalformed, [](EpisodeBatch& b) { b.steps = 0; }},
      {Verdict::kMalformed, [](EpisodeBatch& b) { b.steps = 0xffffffff; }},
      {Verdict::kMalformed, [](EpisodeBatch& b) { b.hinges = 3; }},
      {Verdict::kMalformed, [](EpisodeBatch& b) { b.observation_size = 5; }},
      {Verdict::kMalformed, [](EpisodeBatch& b) { b.observations.pop_back(); }},
      {Verdict::kMalformed, [](EpisodeBatch& b) { b.actions.push_back(0); }},
      {Verdict::kMalformed, [](EpisodeBatch& b) { b.log_probs.clear(); }},
      {Verdict::kMalformed, [](EpisodeBatch& b) { b.rewards.resize(1); }},
      {Verdict::kMalformed, [](EpisodeBatch& b) { b.captured.pop_back(); }},
      {Verdict::kMalformed, [](EpisodeBatch& b) { b.captured.front() = 2; }},
      {Verdict::kNotFinite, [=](EpisodeBatch& b) { b.observations.back() = nan; }},
      {Verdict::kNotFinite, [=](EpisodeBatch& b) { b.actions[3] = infinity; }},
      {Verdict::kNotFinite, [=](EpisodeBatch& b) { b.log_probs[0] = -infinity; }},
      {Verdict::kNotFinite, [=](EpisodeBatch& b) { b.rewards[7] = nan; }},
      {Verdict::kOtherBits,
       [](EpisodeBatch& b) {
         for (float& r : b.rewards) r += 1e-6F;
       }},
      {Verdict::kOtherBits,
       [](EpisodeBatch& b) {
         for (float& a : b.actions) a = -a;
       }},
      {Verdict::kOtherBits,
       [](EpisodeBatch& b) {
         for (float& o : b.observations) o = 0;
       }},
      {Verdict::kOtherBits,
       [](EpisodeBatch& b) {
         for (float& p : b.log_probs) p = -1;
       }},
      {Verdict::kOtherBits,
       [](EpisodeBatch& b) {
         for (auto& c : b.captured) c = 1;
       }},
  };
  std::uint64_t instance = 1, lost = 0;
  std::map<Verdict, std::uint64_t> counts;
  const auto expect_refused = [&](Verdict verdict, const EpisodeBatch& batch) {
    EXPECT_EQ(deliver(batch), verdict);
    EXPECT_EQ(dispatcher_.batches(verdict), ++counts[verdict]);
    EXPECT_EQ(worker(instance).batches_refused, 1u);
    EXPECT_EQ(dispatcher_.episodes_in(), 0);
    say_idle(instance);
    // A batch that is for no lease of the worker says nothing about the one that it holds.
    lost += verdict == Verdict::kNotLeased;
    dispatcher_.disconnect(status_of(instance++).name, now_);
    EXPECT_EQ(dispatcher_.leases_lost(), lost);
  };
  for (const auto& [verdict, spoil] : cases) {
    join(instance);
    EpisodeBatch batch = play(only_lease());
    spoil(batch);
    expect_refused(verdict, sealed(batch));
  }
  join(instance);
  EpisodeBatch flipped = play(only_lease());
  flipped.rewards[3] = -flipped.rewards[3];
  expect_refused(Verdict::kBadChecksum, flipped);
  join(instance);
  EpisodeBatch unsealed = play(only_lease());
  unsealed.checksum.clear();
  expect_refused(Verdict::kBadChecksum, unsealed);

  join(instance);
  const Lease lease = only_lease();
  EXPECT_EQ(lease.count, kEpisodes);
  EXPECT_EQ(deliver(play(lease)), Verdict::kAccepted);
  expect_the_rollout();
}

TEST_F(DispatcherTest, AWorkerWithOneBadBatchAfterTheOtherIsSetAsideForAWhile) {
  join(1);
  const auto spoil = [&] {
    EpisodeBatch batch = play(only_lease());
    batch.checksum = "";
    EXPECT_EQ(deliver(batch), Verdict::kBadChecksum);
    say_idle(1);
  };
  for (int i = 0; i < 3; ++i) spoil();
  EXPECT_EQ(
      worker(1).refused,
      "set aside for 5 s: it spoilt 3 leases in a row by bad batches, the last one bad checksum");
  for (int pause : {5, 10, 20, 40, 80, 160, 300, 300}) {  // [s]
    SCOPED_TRACE(pause);
    EXPECT_TRUE(leases().empty());
    EXPECT_EQ(dispatcher_.roster().aside().size(), 1u);
    now_ += std::chrono::seconds(pause) - 1ms;
    say_idle(1);
    EXPECT_TRUE(leases().empty());
    now_ += 1ms;
    say_idle(1);
    spoil();
  }
  now_ += 300s;
  say_idle(1);
  EXPECT_EQ(deliver(play(only_lease())), Verdict::kAccepted);
  expect_the_rollout();
  open(config_, 4);
  say_idle(1);
  spoil();  // all is forgiven
  EXPECT_EQ(worker(1).refused, "");
}

TEST_F(DispatcherTest, WhatAnotherLearnerLeasedIsLateAndItsWorkerBusy) {
  dispatcher_.connect("worker_1");
  WorkerStatus busy = status_of(1);
  busy.session = kSession - 1, busy.lease = 5;
  dispatcher_.hear(busy, now_);
  EXPECT_TRUE(leases().empty());
  EpisodeBatch batch = play({5, 1, 0, kEpisodes});
  batch.session = kSession - 1;
  EXPECT_EQ(deliver(batch), Verdict::kLate);
  EXPECT_EQ(worker(1).batches_refused, 0u);
  EXPECT_EQ(only_lease().count, kEpisodes);
}

// A worker that has been fast, and hangs, goes on to say that it lives.
TEST_F(DispatcherTest, PatienceIsTenTimesWhatTheLastLeasesTook) {
  for (const auto& [taken, patience] : {std::pair{500ms, 5s}, {10ms, 3s}, {9000ms, 10s}}) {
    SCOPED_TRACE(taken.count());
    dispatcher_ = Dispatcher(settings());
    dispatcher_.open(update_, Rollout(config_.environment, kEpisodes));
    join(1);
    const Lease first = only_lease();
    for (auto played = 0ms; played < taken; played += 500ms)
      dispatcher_.hear(status_of(1), now_), now_ += std::min(500ms, taken - played);
    EXPECT_EQ(deliver(play(first)), Verdict::kAccepted);
    expect_the_rollout();
    open(config_, 3);
    dispatcher_.hear(status_of(1), now_);
    const Lease second = only_lease();
    EXPECT_EQ(second.count, kEpisodes);
    const Time begin = now_;
    while (dispatcher_.leases_lost() == 0 && now_ < begin + 20s) {
      now_ += 100ms;
      WorkerStatus busy = status_of(1);
      busy.session = kSession, busy.lease = second.id;
      dispatcher_.hear(busy, now_);
      leases();
    }
    EXPECT_EQ(now_ - begin, patience);
    EXPECT_EQ(deliver(play(second)), Verdict::kAccepted);  // what comes after all is not in vain
    expect_the_rollout();
  }
}

// A worker, and what is between it and the learner, at the mercy of a random number generator.
struct Chaos {
  std::uint64_t instance = 0;
  bool up = false;
  std::optional<Lease> holds;
  std::optional<EpisodeBatch> old;  // to be delivered again some time
};

TEST_F(DispatcherTest, WhateverHappensTheRolloutIsThatOfOneProcess) {
  constexpr int kSchedules = 3000;
  std::uint64_t happened[kVerdicts] = {}, lost = 0;
  for (int schedule = 0; schedule < kSchedules; ++schedule) {
    SCOPED_TRACE(schedule);
    std::mt19937 random(schedule);
    const auto below = [&](int n) { return static_cast<int>(random() % n); };
    DispatcherSettings patient = settings();
    patient.roster.most_restarts = patient.roster.most_bad_batches = 1 << 30;
    patient.lease_episodes = 1 + below(kEpisodes);
    dispatcher_ = Dispatcher(patient);
    dispatcher_.open(update_, Rollout(config_.environment, kEpisodes));
    const auto hand_in = [&](const EpisodeBatch& batch, const std::string& name) {
      return dispatcher_.deliver(batch, name, now_);
    };
    std::vector<Chaos> workers(1 + below(5));
    std::uint64_t next_instance = 1;
    for (int events = 0; !dispatcher_.complete(); ++events) {
      ASSERT_LT(events, 20000);
      const int index = below(static_cast<int>(workers.size()));
      Chaos& chaos = workers[index];
      const std::string name = "worker_" + std::to_string(index);
      now_ += std::chrono::milliseconds(below(800));
      const auto say = [&] {
        WorkerStatus status = status_of(chaos.instance, name);
        status.session = kSession;
        status.lease = chaos.holds ? chaos.holds->id : 0;
        dispatcher_.hear(status, now_);
      };
      if (!chaos.up) {
        chaos = {next_instance++, true, {}, std::move(chaos.old)};
        dispatcher_.connect(name);
        say();
      }
      switch (below(10)) {
        case 0:  // killed
          dispatcher_.disconnect(name, now_);
          chaos.up = false;
          break;
        case 1:
          if (chaos.old) hand_in(*chaos.old, name);
          break;
        case 2:  // a message is lost
          chaos.holds.reset();
          break;
        case 3:
          if (chaos.holds) {
            EpisodeBatch bad = play(*chaos.holds);
            bad.rewards[below(static_cast<int>(bad.rewards.size()))] += 1;
            hand_in(bad, name);
            chaos.holds.reset();
          }
          break;
        case 4:
        case 5:
        case 6:
          say();
          break;
        default:
          if (chaos.holds) {
            chaos.old = play(*chaos.holds);
            hand_in(*chaos.old, name);
            chaos.holds.reset();
          }
      }
      for (const Lease& lease : dispatcher_.tick(now_).leases)
        for (Chaos& worker : workers)
          if (worker.instance == lease.worker) {
            ASSERT_FALSE(worker.up && worker.holds) << "leased twice";
            worker.holds = lease;
          }
    }
    expect_the_rollout();
    for (int i = 0; i < kVerdicts; ++i) happened[i] += dispatcher_.batches(Verdict(i));
    lost += dispatcher_.leases_lost();
  }
  EXPECT_GT(happened[int(Verdict::kAccepted)], 3000u);
  EXPECT_GT(happened[int(Verdict::kDouble)], 300u);
  EXPECT_GT(happened[int(Verdict::kBadChecksum)], 300u);
  EXPECT_GT(lost, 300u);
}

TEST(FingerprintTest, IsTheSameEachTime) {
  EXPECT_EQ(fingerprint().size(), 64u);
  EXPECT_EQ(fingerprint(), fingerprint());
  // Workers of other versions have it, too: a change of it is a change of all trainings.
  if (threelink_sim::isa_in_use() != threelink_sim::Isa::kBaseline) {
    EXPECT_EQ(fingerprint(), "fa2de02ad77d1be518f4972b053bdea584316a042a1c7bdc4df4dd9db75c5621");
  }
}

TEST(EpisodeBatchTest, TheChecksumCoversEveryField) {
  EpisodeBatch batch;
  batch.policy = "p";
  batch.observations = batch.actions = batch.log_probs = batch.rewards = {1, 2};
  batch.captured = {0, 0};
  std::set<std::string> sums{checksum(batch)};
  const auto changed = [&](auto change) {
    EpisodeBatch other = batch;
    change(other);
    EXPECT_TRUE(sums.insert(checksum(other)).second);
  };
  changed([](EpisodeBatch& b) { b.session = 1; });
  changed([](EpisodeBatch& b) { b.version = 1; });
  changed([](EpisodeBatch& b) { b.policy = "q"; });
  changed([](EpisodeBatch& b) { b.lease = 1; });
  changed([](EpisodeBatch& b) { b.worker = 1; });
  changed([](EpisodeBatch& b) { b.first_episode = 1; });
  changed([](EpisodeBatch& b) { b.episodes = 1; });
  changed([](EpisodeBatch& b) { b.steps = 1; });
  changed([](EpisodeBatch& b) { b.observation_size = 1; });
  changed([](EpisodeBatch& b) { b.hinges = 1; });
  changed([](EpisodeBatch& b) { b.observations[1] = 3; });
  changed([](EpisodeBatch& b) { b.actions[1] = 3; });
  changed([](EpisodeBatch& b) { b.log_probs[1] = 3; });
  changed([](EpisodeBatch& b) { b.rewards[1] = 3; });
  changed([](EpisodeBatch& b) { b.captured[1] = 1; });
}

// Workers in threads of their own, over a wire that is a function call.
class Threads : public RemoteRollouts::Wire {
 public:
  void send_policy(std::uint64_t, const std::string& bytes) override { policy_ = bytes; }
  void send(std::uint64_t session, const Update& update,
            const Dispatcher::Sending& sending) override {
    for (const Lease& lease : sending.leases)
      workers_.emplace_back([this, session, update, lease, policy = policy_] {
        LeasePlayer player(std::make_unique<LocalRollouts>(1));
        player.load(policy, "test");
        const EpisodeBatch batch = player.play({session, update.version, update.policy, lease.id,
                                                lease.worker, update.first_episode + lease.first,
                                                static_cast<std::uint32_t>(lease.count)});
        rollouts_->with([&](Dispatcher& dispatcher, Time now) {
          dispatcher.deliver(batch, status_of(lease.worker).name, now);
        });
      });
  }
  void serve(RemoteRollouts& rollouts) { rollouts_ = &rollouts; }
  void join() {
    for (std::thread& worker : workers_) worker.join();
  }

 private:
  RemoteRollouts* rollouts_ = nullptr;
  std::string policy_;
  std::vector<std::thread> workers_;
};

RemoteRollouts::Settings remote_settings() {
  RemoteRollouts::Settings remote;
  remote.dispatcher = settings();
  remote.dispatcher.roster.silence = 1h;
  remote.worker_timeout = 50ms;
  return remote;
}

TEST(RemoteRolloutsTest, ATrainingEndsWithThePolicyOfOneProcess) {
  for (const TrainConfig& config : {threelink_tests::small(5), threelink_tests::small_homing(5)}) {
    Threads threads;
    auto source =
        std::make_unique<RemoteRollouts>(config, remote_settings(), threads, [] { return true; });
    RemoteRollouts& rollouts = *source;
    threads.serve(rollouts);
    for (int i = 1; i <= 3; ++i)
      rollouts.with([&](Dispatcher& dispatcher, Time now) {
        dispatcher.connect(status_of(i).name);
        dispatcher.hear(status_of(i), now);
      });
    Trainer trainer(config, make_ppo_update(Backend::kFused, config, 1), std::move(source));
    while (!trainer.finished()) trainer.update();
    threads.join();
    EXPECT_EQ(trainer.policy().sha256(), threelink_tests::sha256_of_training(config));
  }
}

TEST(RemoteRolloutsTest, WithoutWorkersItSaysWhoWasRefused) {
  const TrainConfig config = threelink_tests::small();
  Threads threads;
  auto source =
      std::make_unique<RemoteRollouts>(config, remote_settings(), threads, [] { return true; });
  threads.serve(*source);
  source->with([&](Dispatcher& dispatcher, Time now) {
    WorkerStatus status = status_of(1);
    status.protocol = 9;
    dispatcher.connect(status.name);
    dispatcher.hear(status, now);
  });
  Trainer trainer(config, make_ppo_update(Backend::kFused, config, 1), std::move(source));
  try {
    trainer.update();
    FAIL();
  } catch (const NoRollout& error) {
    EXPECT_EQ(error.what(),
              std::string("no worker for 0.05 s; refused worker_1: it speaks version 9 of the "
                          "protocol, the learner 2"));
  }
  EXPECT_EQ(trainer.state().update, 0u);
}

// A learner whose workers are all set aside waits for them: they may play again.
TEST(RemoteRolloutsTest, WaitsForWorkersThatAreSetAside) {
  const TrainConfig config = threelink_tests::small();
  Threads threads;
  RemoteRollouts::Settings settings = remote_settings();
  settings.dispatcher.roster.most_restarts = 1;
  settings.dispatcher.roster.first_pause = 300ms;  // and 50 ms without a worker are the most
  auto source = std::make_unique<RemoteRollouts>(config, settings, threads, [] { return true; });
  threads.serve(*source);
  source->with([&](Dispatcher& dispatcher, Time now) {
    dispatcher.connect("worker_2");
    dispatcher.hear(status_of(1, "worker_2"), now);
    dispatcher.hear(status_of(2, "worker_2"), now);
    EXPECT_EQ(dispatcher.roster().alive(), 0);
  });
  const Time begin = std::chrono::steady_clock::now();
  const Policy policy = threelink_tests::trainer_of(config).policy();
  source->play(Play{config.environment, config.goal, config.symmetry.canonical, policy.actor(),
                    policy.log_std(), config.seed, 0},
               config.update.episodes);
  EXPECT_GE(std::chrono::steady_clock::now() - begin, 250ms);
  threads.join();
}

TEST(RemoteRolloutsTest, CanBeInterrupted) {
  const TrainConfig config = threelink_tests::small();
  Threads threads;
  int asked = 0;
  auto source = std::make_unique<RemoteRollouts>(config, remote_settings(), threads,
                                                 [&] { return ++asked < 2; });
  Trainer trainer(config, make_ppo_update(Backend::kFused, config, 1), std::move(source));
  EXPECT_THROW(trainer.update(), Interrupted);
  EXPECT_EQ(trainer.state().update, 0u);
}

}  // namespace

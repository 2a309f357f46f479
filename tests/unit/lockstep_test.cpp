#include "threelink_sim/lockstep.hpp"

#include <cmath>
#include <limits>
#include <vector>

#include <gtest/gtest.h>

namespace threelink_sim {
namespace {

using std::chrono::milliseconds;
using Phase = Lockstep::Phase;
using Action = Lockstep::Action;
using Time = Lockstep::Time;

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr std::uint64_t kTick = 100'000'000;
const Time kStart = Time() + std::chrono::hours(1);
const std::vector<double> kRates = {1.0, -0.5};

Lockstep::Config config(milliseconds period) {
  return {2, kTick, period, milliseconds(1000), 3 * period};
}

Verdict send(Lockstep& lockstep, const std::vector<double>& rates) {
  return lockstep.rates(lockstep.episode(), lockstep.step(), rates.data(), rates.size());
}

Verdict aim(Lockstep& lockstep, Time now) { return lockstep.target(lockstep.stamp(), 1, 2, now); }

TEST(Lockstep, AsFastAsPossibleAStepFollowsItsCommand) {
  Lockstep lockstep(config(milliseconds(0)));
  EXPECT_EQ(lockstep.phase(), Phase::kIdle);
  EXPECT_EQ(lockstep.deadline(), Time::max());
  lockstep.start(kStart);
  for (std::uint64_t k = 0; k < 5; ++k) {
    EXPECT_EQ(lockstep.step(), k);
    EXPECT_EQ(lockstep.poll(kStart), Action::kWait);
    EXPECT_EQ(aim(lockstep, kStart), Verdict::kAccepted);
    EXPECT_EQ(lockstep.poll(kStart), Action::kWait);
    EXPECT_EQ(send(lockstep, kRates), Verdict::kAccepted);
    EXPECT_EQ(lockstep.poll(kStart), Action::kStep);
    EXPECT_EQ(lockstep.command(), kRates);
    lockstep.stepped(kStart);
  }
}

TEST(Lockstep, TimeNeverStandsStillNorGoesBack) {
  Lockstep lockstep(config(milliseconds(0)));
  EXPECT_EQ(lockstep.stamp(), kTick);
  std::uint64_t last = lockstep.stamp();
  for (std::uint32_t episode = 1; episode <= 3; ++episode) {
    lockstep.start(kStart);
    EXPECT_EQ(lockstep.episode(), episode);
    EXPECT_EQ(lockstep.step(), 0u);
    EXPECT_EQ(lockstep.stamp(), last + kTick);
    lockstep.stepped(kStart);
    EXPECT_EQ(lockstep.stamp(), last + 2 * kTick);
    last = lockstep.stamp();
  }
}

TEST(Lockstep, RefusesRatesByReason) {
  Lockstep lockstep(config(milliseconds(0)));
  EXPECT_EQ(send(lockstep, kRates), Verdict::kStale) << "idle";
  lockstep.start(kStart);
  EXPECT_EQ(send(lockstep, kRates), Verdict::kFuture) << "there is no observation yet";
  ASSERT_EQ(aim(lockstep, kStart), Verdict::kAccepted);

  EXPECT_EQ(send(lockstep, {}), Verdict::kWrongLength);
  EXPECT_EQ(send(lockstep, {0.1}), Verdict::kWrongLength);
  EXPECT_EQ(send(lockstep, {0.1, 0.1, kNan}), Verdict::kWrongLength);
  EXPECT_EQ(send(lockstep, {0.1, kNan}), Verdict::kNotFinite);
  EXPECT_EQ(send(lockstep, {-kInfinity, 2}), Verdict::kNotFinite);
  EXPECT_EQ(send(lockstep, {0, std::nextafter(1.0, 2.0)}), Verdict::kOutOfRange);
  EXPECT_EQ(send(lockstep, {-1e308, 0}), Verdict::kOutOfRange);
  const auto at = [&](std::uint32_t episode, std::uint64_t step) {
    return lockstep.rates(episode, step, kRates.data(), kRates.size());
  };
  EXPECT_EQ(at(0, 0), Verdict::kStale);
  EXPECT_EQ(at(0, 7), Verdict::kStale);
  EXPECT_EQ(at(1, 1), Verdict::kFuture);
  EXPECT_EQ(at(2, 0), Verdict::kFuture);
  EXPECT_EQ(lockstep.poll(kStart), Action::kWait);

  EXPECT_EQ(send(lockstep, {1, -1}), Verdict::kAccepted) << "the bounds themselves";
  EXPECT_EQ(send(lockstep, kRates), Verdict::kStale) << "it has its answer";
  EXPECT_EQ(lockstep.command(), (std::vector<double>{1, -1}));
}

TEST(Lockstep, RefusesTargetsByReason) {
  Lockstep lockstep(config(milliseconds(0)));
  EXPECT_EQ(aim(lockstep, kStart), Verdict::kStale) << "idle";
  lockstep.start(kStart);
  const std::uint64_t stamp = lockstep.stamp();
  EXPECT_EQ(lockstep.target(stamp, kNan, 0, kStart), Verdict::kNotFinite);
  EXPECT_EQ(lockstep.target(stamp, 0, kInfinity, kStart), Verdict::kNotFinite);
  EXPECT_EQ(lockstep.target(stamp - 1, 0, 0, kStart), Verdict::kStale);
  EXPECT_EQ(lockstep.target(stamp + 1, 0, 0, kStart), Verdict::kFuture);
  EXPECT_EQ(lockstep.target(stamp, 1e308, -1e308, kStart), Verdict::kAccepted);
  EXPECT_EQ(lockstep.target(stamp, 0, 0, kStart), Verdict::kStale) << "it has its answer";
}

TEST(Lockstep, ResetAndEndDropWhatWasUnderWay) {
  Lockstep lockstep(config(milliseconds(0)));
  lockstep.start(kStart);
  aim(lockstep, kStart);
  send(lockstep, kRates);
  lockstep.start(kStart);
  EXPECT_EQ(lockstep.phase(), Phase::kAwaitTarget);
  EXPECT_EQ(lockstep.poll(kStart), Action::kWait);
  lockstep.end();
  EXPECT_EQ(lockstep.phase(), Phase::kIdle);
  EXPECT_EQ(aim(lockstep, kStart), Verdict::kStale);
  EXPECT_EQ(lockstep.poll(kStart + std::chrono::hours(1)), Action::kWait);
}

TEST(Lockstep, ASilentPeerEndsTheEpisode) {
  Lockstep lockstep(config(milliseconds(0)));
  lockstep.start(kStart);
  EXPECT_EQ(lockstep.deadline(), kStart + milliseconds(1000));
  EXPECT_EQ(lockstep.poll(kStart + milliseconds(999)), Action::kWait);
  EXPECT_EQ(lockstep.poll(kStart + milliseconds(1000)), Action::kAbort);
  EXPECT_EQ(lockstep.phase(), Phase::kAwaitTarget) << "names the peer";

  // The agent's time begins with its observation.
  const Time late = kStart + milliseconds(900);
  ASSERT_EQ(aim(lockstep, late), Verdict::kAccepted);
  EXPECT_EQ(lockstep.poll(late + milliseconds(999)), Action::kWait);
  EXPECT_EQ(lockstep.poll(late + milliseconds(1000)), Action::kAbort);
  EXPECT_EQ(lockstep.phase(), Phase::kAwaitRates);
}

TEST(Lockstep, PacedStepsAreOnePeriodApart) {
  const milliseconds period(50);
  Lockstep lockstep(config(period));
  lockstep.start(kStart);
  const auto answer = [&](Time now) {
    ASSERT_EQ(aim(lockstep, now), Verdict::kAccepted);
    ASSERT_EQ(send(lockstep, kRates), Verdict::kAccepted);
  };
  answer(kStart);
  EXPECT_EQ(lockstep.deadline(), kStart + period);
  EXPECT_EQ(lockstep.poll(kStart + milliseconds(49)), Action::kWait);
  // A step that begins 10 ms late does not delay the next one,
  EXPECT_EQ(lockstep.poll(kStart + milliseconds(60)), Action::kStep);
  lockstep.stepped(kStart + milliseconds(60));
  answer(kStart + milliseconds(61));
  EXPECT_EQ(lockstep.deadline(), kStart + 2 * period);
  // and one that was held up for more than a period does: there is no catching up.
  lockstep.stepped(kStart + milliseconds(170));
  answer(kStart + milliseconds(171));
  EXPECT_EQ(lockstep.deadline(), kStart + milliseconds(220));
}

TEST(Lockstep, ALateCommandHoldsTimeUpUntilTheWatchdogTrips) {
  const milliseconds period(50);
  Lockstep lockstep(config(period));
  lockstep.start(kStart);
  ASSERT_EQ(aim(lockstep, kStart), Verdict::kAccepted);
  // Late, but before the watchdog: the step waits for its command.
  EXPECT_EQ(lockstep.poll(kStart + milliseconds(149)), Action::kWait);
  ASSERT_EQ(send(lockstep, kRates), Verdict::kAccepted);
  EXPECT_EQ(lockstep.poll(kStart + milliseconds(149)), Action::kStep);
  EXPECT_EQ(lockstep.command(), kRates);
  EXPECT_FALSE(lockstep.watchdog_tripped());
  Time now = kStart + milliseconds(149);
  lockstep.stepped(now);

  // No command at all: zero rates after three periods, then once a period.
  ASSERT_EQ(aim(lockstep, now), Verdict::kAccepted);
  EXPECT_EQ(lockstep.poll(now + milliseconds(149)), Action::kWait);
  now += milliseconds(150);
  EXPECT_EQ(lockstep.poll(now), Action::kStep);
  EXPECT_TRUE(lockstep.watchdog_tripped());
  EXPECT_EQ(lockstep.command(), (std::vector<double>{0, 0}));
  lockstep.stepped(now);
  ASSERT_EQ(aim(lockstep, now), Verdict::kAccepted);
  EXPECT_EQ(lockstep.poll(now + milliseconds(49)), Action::kWait);
  now += period;
  EXPECT_EQ(lockstep.poll(now), Action::kStep);
  lockstep.stepped(now);

  // The agent is back: what it says of an old step is refused, of the current one obeyed.
  ASSERT_EQ(aim(lockstep, now), Verdict::kAccepted);
  EXPECT_EQ(lockstep.rates(1, lockstep.step() - 2, kRates.data(), 2), Verdict::kStale);
  EXPECT_EQ(send(lockstep, kRates), Verdict::kAccepted);
  EXPECT_FALSE(lockstep.watchdog_tripped());
  EXPECT_EQ(lockstep.poll(now + period), Action::kStep);
  EXPECT_EQ(lockstep.command(), kRates);

  // The task has no watchdog: without a target there is no observation to answer.
  now += period;
  lockstep.stepped(now);
  EXPECT_EQ(lockstep.poll(now + milliseconds(999)), Action::kWait);
  EXPECT_EQ(lockstep.poll(now + milliseconds(1000)), Action::kAbort);
}

}  // namespace
}  // namespace threelink_sim

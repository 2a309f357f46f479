#include "threelink_agent/distributed/dispatcher.hpp"

#include <algorithm>
#include <utility>

#include "threelink_agent/distributed/live_episode.hpp"

namespace threelink_agent {

const char* to_string(Verdict verdict) {
  switch (verdict) {
    case Verdict::kAccepted:
      return "accepted";
    case Verdict::kLate:
      return "late";
    case Verdict::kDouble:
      return "double";
    case Verdict::kGivenBack:
      return "given back";
    case Verdict::kStranger:
      return "of a stranger";
    case Verdict::kNotLeased:
      return "not leased";
    case Verdict::kWrongPolicy:
      return "wrong policy";
    case Verdict::kMalformed:
      return "malformed";
    case Verdict::kBadChecksum:
      return "bad checksum";
    case Verdict::kNotFinite:
      return "not finite";
    case Verdict::kOtherBits:
      return "other bits";
  }
  return "";
}

Dispatcher::Dispatcher(const DispatcherSettings& settings)
    : settings_(settings), roster_(settings.roster) {}

void Dispatcher::open(const Update& update, Rollout&& empty, const std::optional<Play>& play) {
  update_ = update;
  rollout_ = std::move(empty);
  play_ = play;
  book_.open(update.episodes);
}

Rollout Dispatcher::take() {
  Rollout whole = std::move(*rollout_);
  rollout_.reset();
  return whole;
}

void Dispatcher::lose(const std::vector<Lease>& leases, Time now) {
  leases_lost_ += leases.size();
  for (const Lease& lease : leases) roster_.lost(lease, now);
}

void Dispatcher::hear(const WorkerStatus& status, Time now) {
  const WorkerRoster::Heard heard =
      roster_.hear(status, now, [&](std::uint64_t instance) { lose(book_.revoke(instance), now); });
  if (!heard.worker) {
    ++statuses_refused_;
    return;
  }
  if (heard.spoilt_lease != 0) book_.reopen(heard.spoilt_lease);
  if (roster_.must_be_told(status.name, now))
    refusals_.push_back({status.instance, heard.worker->refused});
}

void Dispatcher::disconnect(const std::string& name, Time now) {
  lose(book_.revoke(roster_.disconnect(name)), now);
}

Verdict Dispatcher::judge(const EpisodeBatch& batch, const std::string& publisher) {
  const bool done = batch.version == update_.version && !rollout_;
  if (batch.session != session() || batch.version < update_.version || done) return Verdict::kLate;
  if (!roster_.is(publisher, batch.worker)) return Verdict::kStranger;
  if (batch.version != update_.version || batch.policy != update_.policy)
    return Verdict::kWrongPolicy;
  const Lease* lease = book_.find(batch.lease);
  if (!lease || lease->worker != batch.worker) return Verdict::kNotLeased;
  if (!batch.given_back.empty()) return Verdict::kGivenBack;
  if (batch.first_episode != update_.first_episode + lease->first ||
      !well_formed(batch, *rollout_, lease->count))
    return Verdict::kMalformed;
  if (batch.checksum != checksum(batch)) return Verdict::kBadChecksum;
  if (!all_finite(batch)) return Verdict::kNotFinite;
  return replays_differ(batch) ? Verdict::kOtherBits : Verdict::kAccepted;
}

bool Dispatcher::replays_differ(const EpisodeBatch& batch) {
  if (!play_) return false;
  play_->first_episode = batch.first_episode;
  const int episodes = static_cast<int>(batch.episodes);
  int left = std::min(settings_.replays, episodes);
  for (int i = 0; left > 0; ++i) {  // each set of them with the same chance
    if (std::uniform_int_distribution<int>(1, episodes - i)(lots_) > left) continue;
    --left;
    if (!difference_from_collect(*play_, batch, i).empty()) return true;
  }
  return false;
}

Verdict Dispatcher::deliver(const EpisodeBatch& batch, const std::string& publisher, Time now) {
  Verdict verdict = judge(batch, publisher);
  if (verdict == Verdict::kAccepted) {
    const Lease lease = *book_.find(batch.lease);
    int fresh = 0;
    for (const LeaseBook::Run& run : book_.settle(lease.id)) {
      copy_episodes(batch, run.first - lease.first, run.count, *rollout_, run.first);
      fresh += run.count;
    }
    roster_.accepted(lease, fresh, now);
    if (fresh == 0) verdict = Verdict::kDouble;
  }
  // A batch that is refused changes nothing but that: the name of its sender may be forged, and the
  // true batch of the lease may still come. The worker says itself that it holds the lease no more.
  if (is_fault(verdict))
    roster_.bad_batch(publisher, batch, to_string(verdict));
  else if (roster_.is(publisher, batch.worker))
    roster_.returned(batch.worker, batch.session, batch.lease);
  if (verdict == Verdict::kGivenBack) {
    book_.reopen(batch.lease);
    roster_.gave_back(batch.worker, batch.given_back, now);
  }
  ++batches_[static_cast<int>(verdict)];
  return verdict;
}

Dispatcher::Sending Dispatcher::tick(Time now) {
  for (std::uint64_t instance : roster_.silent(now)) lose(book_.revoke(instance), now);
  lose(book_.expire(now), now);
  roster_.let_in(now);
  Sending sending;
  sending.refusals.swap(refusals_);
  if (!rollout_ || book_.complete()) return sending;
  sending.leases = book_.give(roster_.hands(), settings_.lease_episodes, [&](const Lease& lease) {
    return now + roster_.patience(lease, settings_.lease_time);
  });
  leases_given_ += sending.leases.size();
  for (const Lease& lease : sending.leases) roster_.leased(lease, now);
  return sending;
}

}  // namespace threelink_agent

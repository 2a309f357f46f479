#include "threelink_agent/distributed/dispatcher.hpp"

#include <utility>

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
  }
  return "";
}

Dispatcher::Dispatcher(const DispatcherSettings& settings)
    : settings_(settings), roster_(settings.roster) {}

void Dispatcher::open(const Update& update, Rollout&& empty) {
  update_ = update;
  rollout_ = std::move(empty);
  book_.open(update.episodes);
}

Rollout Dispatcher::take() {
  Rollout whole = std::move(*rollout_);
  rollout_.reset();
  return whole;
}

void Dispatcher::lose(const std::vector<Lease>& leases) {
  leases_lost_ += leases.size();
  for (const Lease& lease : leases) roster_.lost(lease);
}

void Dispatcher::hear(const WorkerStatus& status, Time now) {
  const WorkerRoster::Worker& worker =
      roster_.hear(status, now, [this](std::uint64_t instance) { lose(book_.revoke(instance)); });
  if (!worker.refused.empty()) refusals_.push_back({status.instance, worker.refused});
}

void Dispatcher::disconnect(const std::string& name) {
  lose(book_.revoke(roster_.disconnect(name)));
}

Verdict Dispatcher::judge(const EpisodeBatch& batch) const {
  const bool done = batch.version == update_.version && !rollout_;
  if (batch.session != session() || batch.version < update_.version || done) return Verdict::kLate;
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
  return Verdict::kAccepted;
}

Verdict Dispatcher::deliver(const EpisodeBatch& batch, Time now) {
  Verdict verdict = judge(batch);
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
  if (is_fault(verdict))
    book_.reopen(roster_.bad_batch(batch.worker, to_string(verdict)));
  else
    roster_.returned(batch.worker, batch.session, batch.lease);
  if (verdict == Verdict::kGivenBack) {
    book_.reopen(batch.lease);
    roster_.gave_back(batch.worker, batch.given_back);
  }
  ++batches_[static_cast<int>(verdict)];
  return verdict;
}

Dispatcher::Sending Dispatcher::tick(Time now) {
  for (std::uint64_t instance : roster_.silent(now)) lose(book_.revoke(instance));
  lose(book_.expire(now));
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

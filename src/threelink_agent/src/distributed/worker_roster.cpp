#include "threelink_agent/distributed/worker_roster.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include <fmt/format.h>

#include "threelink_agent/distributed/fingerprint.hpp"
#include "threelink_sim/excerpt.hpp"

namespace threelink_agent {
namespace {

// Workers whose speeds differ by less than this part of the mean are taken for equally fast.
constexpr double kNoise = 0.25;

// A lease may take so many times as long as the worker's last ones suggest.
constexpr double kPatience = 10;

double seconds(std::chrono::nanoseconds time) {
  return std::chrono::duration<double>(time).count();
}

}  // namespace

bool well_formed(const WorkerStatus& status) {
  constexpr std::size_t kLongest = 255;
  const auto of_name = [](char c) {
    return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '_' ||
           c == '/';
  };
  return status.instance != 0 && !status.name.empty() && status.name.size() <= kLongest &&
         std::all_of(status.name.begin(), status.name.end(), of_name) &&
         threelink_sim::is_harmless(status.host, kLongest) &&
         threelink_sim::is_harmless(status.instructions, kLongest) &&
         threelink_sim::is_harmless(status.fingerprint, kLongest);
}

std::string WorkerRoster::objection(const WorkerStatus& status) const {
  if (status.protocol != kProtocol)
    return fmt::format("it speaks version {} of the protocol, the learner {}", status.protocol,
                       kProtocol);
  if (status.fingerprint != settings_.fingerprint)
    return fmt::format(
        "it computes other bits ({} kernels; fingerprint {}, the learner's {}): it lacks fused "
        "multiply-adds, or is another build",
        status.instructions, status.fingerprint.substr(0, 16), settings_.fingerprint.substr(0, 16));
  return "";
}

void WorkerRoster::set_aside(Worker& worker, Time now, const std::string& what_it_did) {
  const double longest = seconds(settings_.longest_pause);
  const double pause =
      std::min(longest, std::ldexp(seconds(settings_.first_pause), std::min(worker.pauses++, 30)));
  worker.set_aside = true;
  worker.until =
      now + std::chrono::duration_cast<Time::duration>(std::chrono::duration<double>(pause));
  worker.refused = fmt::format("set aside for {:g} s: {}", pause, what_it_did);
}

void WorkerRoster::let_in(Time now) {
  for (auto& [name, worker] : workers_) {
    if (!worker.set_aside || now < worker.until) continue;
    worker.set_aside = false;
    worker.restarts.clear();
    worker.refused = objection(worker.status);
  }
}

void WorkerRoster::start_anew(Worker& worker, Time now) {
  constexpr std::size_t kFormer = 10;
  worker.former.push_back(worker.status.instance);
  if (worker.former.size() > kFormer) worker.former.pop_front();
  worker.lease = 0;
  worker.overdue = false;
  worker.spoilt.clear();
  worker.speed = 0;
  worker.bad_in_a_row = 0;
  worker.given_back_in_a_row = 0;
  if (worker.set_aside) return;
  worker.restarts.push_back(now);
  while (now - worker.restarts.front() > settings_.restart_window) worker.restarts.pop_front();
  if (static_cast<int>(worker.restarts.size()) >= settings_.most_restarts)
    set_aside(worker, now,
              fmt::format("it started anew {} times within {:.0f} s", worker.restarts.size(),
                          seconds(settings_.restart_window)));
}

void WorkerRoster::spoil(Worker& worker, Time now) {
  ++worker.bad_in_a_row;
  if (worker.bad_in_a_row >= settings_.most_bad_batches && worker.refused.empty())
    set_aside(worker, now,
              fmt::format("it spoilt {} leases in a row by bad batches, the last one {}",
                          worker.bad_in_a_row, worker.spoilt));
  worker.spoilt.clear();
}

// The one that is missed least: not alive, and not heard for the longest time.
void WorkerRoster::make_room(const std::function<void(std::uint64_t)>& lost) {
  std::size_t unproven = 0;
  for (const auto& [name, worker] : workers_) unproven += worker.episodes == 0;
  const bool full = workers_.size() >= settings_.most_workers;
  if (!full && unproven < settings_.most_unproven) return;
  const auto rank = [this](const Worker& worker) {
    return std::make_pair(alive(worker), worker.heard);
  };
  auto least = workers_.end();
  for (auto it = workers_.begin(); it != workers_.end(); ++it) {
    if (it->second.episodes > 0 && !full) continue;
    if (least == workers_.end() || rank(it->second) < rank(least->second)) least = it;
  }
  lost(least->second.status.instance);
  workers_.erase(least);
}

WorkerRoster::Heard WorkerRoster::hear(const WorkerStatus& status, Time now,
                                       const std::function<void(std::uint64_t)>& lost) {
  if (!well_formed(status)) return {};
  const Worker* other = find(status.instance);
  if (other && other->status.name != status.name && other->present) return {};
  if (workers_.count(status.name) == 0) make_room(lost);
  Worker& worker = workers_[status.name];
  Heard heard{&worker, 0};
  if (worker.instances == 0 || worker.status.instance != status.instance) {
    if (worker.instances++ > 0) {
      lost(worker.status.instance);
      start_anew(worker, now);
    }
  } else if (worker.lease != 0 && (worker.overdue || !worker.spoilt.empty()) &&
             (status.session != settings_.session || status.lease != worker.lease)) {
    if (!worker.spoilt.empty()) {
      heard.spoilt_lease = worker.lease;
      spoil(worker, now);
    }
    worker.lease = 0;  // it does not play what it lost
    worker.overdue = false;
  }
  worker.status = status;
  worker.heard = now;
  worker.present = true;
  if (!worker.set_aside) worker.refused = objection(status);
  return heard;
}

bool WorkerRoster::must_be_told(const std::string& name, Time now) {
  constexpr std::chrono::seconds kAgain(5);
  Worker& worker = workers_.at(name);
  if (worker.refused.empty() ||
      (worker.refused == worker.told_reason && now - worker.told < kAgain))
    return false;
  worker.told = now;
  worker.told_reason = worker.refused;
  return true;
}

bool WorkerRoster::is(const std::string& name, std::uint64_t instance) const {
  const auto found = workers_.find(name);
  if (found == workers_.end()) return false;
  const Worker& worker = found->second;
  return worker.status.instance == instance ||
         std::count(worker.former.begin(), worker.former.end(), instance) > 0;
}

void WorkerRoster::connect(const std::string& name) { ++connections_[name]; }

std::uint64_t WorkerRoster::disconnect(const std::string& name) {
  const auto connections = connections_.find(name);
  if (connections == connections_.end() || --connections->second > 0) return 0;
  connections_.erase(connections);
  const auto worker = workers_.find(name);
  if (worker == workers_.end() || !worker->second.present) return 0;
  worker->second.present = false;
  return worker->second.status.instance;
}

std::vector<std::uint64_t> WorkerRoster::silent(Time now) {
  std::vector<std::uint64_t> instances;
  for (auto& [name, worker] : workers_) {
    if (!worker.present || now - worker.heard <= settings_.silence) continue;
    worker.present = false;
    instances.push_back(worker.status.instance);
  }
  return instances;
}

std::vector<const WorkerRoster::Worker*> WorkerRoster::aside() const {
  std::vector<const Worker*> aside;
  for (const auto& [name, worker] : workers_)
    if (worker.set_aside && worker.present && objection(worker.status).empty() &&
        connections_.count(name) > 0)
      aside.push_back(&worker);
  return aside;
}

bool WorkerRoster::alive(const Worker& worker) const {
  return worker.present && worker.refused.empty() && connections_.count(worker.status.name) > 0;
}

int WorkerRoster::alive() const {
  int count = 0;
  for (const auto& [name, worker] : workers_) count += alive(worker);
  return count;
}

std::vector<LeaseBook::Hand> WorkerRoster::hands() const {
  std::vector<LeaseBook::Hand> hands;
  double sum = 0;
  int known = 0;
  for (const auto& [name, worker] : workers_) {
    if (worker.speed > 0) sum += worker.speed, ++known;
    const bool holds_another_learners =
        worker.status.session != settings_.session && worker.status.lease != 0;
    if (alive(worker) && !worker.overdue)
      hands.push_back(
          {worker.status.instance, worker.speed, worker.lease == 0 && !holds_another_learners});
  }
  const double mean = known > 0 ? sum / known : 1;
  for (LeaseBook::Hand& hand : hands)
    if (!(hand.speed > 0) || std::abs(hand.speed - mean) < kNoise * mean) hand.speed = mean;
  return hands;
}

WorkerRoster::Worker* WorkerRoster::find(std::uint64_t instance) {
  for (auto& [name, worker] : workers_)
    if (worker.status.instance == instance) return &worker;
  return nullptr;
}

std::chrono::nanoseconds WorkerRoster::patience(const Lease& lease, std::chrono::nanoseconds most) {
  const Worker* worker = find(lease.worker);
  if (!worker || !(worker->speed > 0)) return most;
  const std::chrono::duration<double> expected(kPatience * lease.count / worker->speed);
  if (expected > most) return most;
  const auto long_enough = std::chrono::duration_cast<std::chrono::nanoseconds>(expected);
  return std::min(most, std::max(long_enough, settings_.silence));
}

void WorkerRoster::leased(const Lease& lease, Time now) {
  Worker* worker = find(lease.worker);
  worker->lease = lease.id;
  worker->overdue = false;
  worker->spoilt.clear();
  worker->leased = now;
}

void WorkerRoster::lost(const Lease& lease, Time now) {
  Worker* worker = find(lease.worker);
  if (!worker) return;
  ++worker->leases_lost;
  worker->overdue = worker->lease == lease.id;
  if (worker->overdue && !worker->spoilt.empty()) spoil(*worker, now);
}

void WorkerRoster::accepted(const Lease& lease, int episodes, Time now) {
  Worker* worker = find(lease.worker);
  if (!worker) return;
  worker->episodes += episodes;
  worker->bad_in_a_row = 0;
  worker->given_back_in_a_row = 0;
  worker->pauses = 0;
  if (worker->set_aside) worker->until = now;  // what it hands in is good
  if (worker->lease != lease.id) return;
  worker->spoilt.clear();
  const double speed = lease.count / std::max(1e-6, seconds(now - worker->leased));
  worker->speed = worker->speed > 0 ? (worker->speed + speed) / 2 : speed;
}

void WorkerRoster::returned(std::uint64_t instance, std::uint64_t session, std::uint64_t lease) {
  Worker* worker = find(instance);
  if (!worker) return;
  WorkerStatus& status = worker->status;
  if (status.session == session && status.lease == lease) status.lease = 0;
  if (session != settings_.session || worker->lease != lease) return;
  worker->lease = 0;
  worker->overdue = false;
}

void WorkerRoster::gave_back(std::uint64_t instance, const std::string& reason, Time now) {
  Worker* worker = find(instance);
  if (!worker) return;
  worker->present = false;
  if (++worker->given_back_in_a_row < settings_.most_given_back || !worker->refused.empty()) return;
  set_aside(*worker, now,
            fmt::format("it gave {} leases in a row back, the last one since {}",
                        worker->given_back_in_a_row, threelink_sim::excerpt(reason, 200)));
}

void WorkerRoster::bad_batch(const std::string& publisher, const EpisodeBatch& batch,
                             const std::string& reason) {
  Worker* worker = find(batch.worker);
  if (!worker || worker->status.name != publisher) return;
  ++worker->batches_refused;
  if (batch.session == settings_.session && worker->lease != 0 && worker->lease == batch.lease)
    worker->spoilt = reason;
}

}  // namespace threelink_agent

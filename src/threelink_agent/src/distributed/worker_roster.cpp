#include "threelink_agent/distributed/worker_roster.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include <fmt/format.h>

#include "threelink_agent/distributed/fingerprint.hpp"

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

void WorkerRoster::start_anew(Worker& worker, Time now) {
  worker.lease = 0;
  worker.overdue = false;
  worker.speed = 0;
  worker.bad_in_a_row = 0;
  worker.given_back_in_a_row = 0;
  if (worker.given_up) return;
  worker.restarts.push_back(now);
  while (now - worker.restarts.front() > settings_.restart_window) worker.restarts.pop_front();
  if (static_cast<int>(worker.restarts.size()) < settings_.most_restarts) return;
  worker.given_up = true;
  worker.refused = fmt::format("given up: it started anew {} times within {:.0f} s",
                               worker.restarts.size(), seconds(settings_.restart_window));
}

const WorkerRoster::Worker& WorkerRoster::hear(const WorkerStatus& status, Time now,
                                               const std::function<void(std::uint64_t)>& lost) {
  Worker& worker = workers_[status.name];
  if (worker.instances == 0 || worker.status.instance != status.instance) {
    if (worker.instances++ > 0) {
      lost(worker.status.instance);
      start_anew(worker, now);
    }
  } else if (worker.overdue &&
             (status.session != settings_.session || status.lease != worker.lease)) {
    worker.lease = 0;  // it does not play what it lost
    worker.overdue = false;
  }
  worker.status = status;
  worker.heard = now;
  worker.present = true;
  if (!worker.given_up) worker.refused = objection(status);
  return worker;
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
  worker->leased = now;
}

void WorkerRoster::lost(const Lease& lease) {
  Worker* worker = find(lease.worker);
  if (!worker) return;
  ++worker->leases_lost;
  worker->overdue = worker->lease == lease.id;
}

void WorkerRoster::accepted(const Lease& lease, int episodes, Time now) {
  Worker* worker = find(lease.worker);
  if (!worker) return;
  worker->episodes += episodes;
  worker->bad_in_a_row = 0;
  worker->given_back_in_a_row = 0;
  if (worker->lease != lease.id) return;
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

void WorkerRoster::gave_back(std::uint64_t instance, const std::string& reason) {
  Worker* worker = find(instance);
  if (!worker) return;
  worker->present = false;
  if (++worker->given_back_in_a_row < settings_.most_given_back || !worker->refused.empty()) return;
  worker->given_up = true;
  worker->refused = fmt::format("given up: it gave {} leases in a row back, the last one since {}",
                                worker->given_back_in_a_row, reason);
}

std::uint64_t WorkerRoster::bad_batch(std::uint64_t instance, const std::string& reason) {
  Worker* worker = find(instance);
  if (!worker) return 0;
  ++worker->batches_refused;
  if (++worker->bad_in_a_row >= settings_.most_bad_batches && worker->refused.empty()) {
    worker->given_up = true;
    worker->refused = fmt::format("given up: it handed in {} bad batches in a row, the last one {}",
                                  worker->bad_in_a_row, reason);
  }
  worker->overdue = false;
  return std::exchange(worker->lease, 0);
}

}  // namespace threelink_agent

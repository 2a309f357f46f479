// The workers of a training, under their names: who may play, who is free, and how each has done.
#pragma once

#include <chrono>
#include <cstdint>
#include <deque>
#include <functional>
#include <map>
#include <string>
#include <vector>

#include "threelink_agent/distributed/lease_book.hpp"

namespace threelink_agent {

// What a worker says of itself: threelink_msgs/WorkerStatus without ROS.
struct WorkerStatus {
  std::string name;
  std::uint64_t instance = 0;
  std::string host;
  std::uint32_t protocol = 0;
  std::string fingerprint;
  std::string instructions;
  std::uint32_t threads = 0;
  std::uint64_t episodes = 0;
  std::uint64_t session = 0;  // of the leases that it heard last
  std::uint64_t lease = 0;    // of that session, that it holds; 0: none
};

struct RosterSettings {
  std::uint64_t session = 0;  // of this learner
  std::string fingerprint;    // that workers must have
  // A worker that says nothing for so long is taken for lost; it says something once a second.
  std::chrono::nanoseconds silence = std::chrono::seconds(3);
  // One that starts anew for the most_restarts-th time within restart_window is given up.
  int most_restarts = 5;
  std::chrono::nanoseconds restart_window = std::chrono::seconds(60);
  // Likewise one that hands in so many bad batches in a row, or gives so many leases back.
  int most_bad_batches = 3;
  int most_given_back = 10;
};

class WorkerRoster {
 public:
  using Time = std::chrono::steady_clock::time_point;

  struct Worker {
    WorkerStatus status;  // as heard last
    Time heard;
    bool present = false;     // heard, and neither disconnected nor silent since
    std::string refused;      // why it gets no leases; empty if it may
    bool given_up = false;    // refused for what it did, and not for what it is
    std::uint64_t lease = 0;  // that it may hold
    bool overdue = false;     // that lease was lost; it may hold it all the same
    Time leased;
    double speed = 0;  // [episodes/s] of its last leases; 0: not known
    int bad_in_a_row = 0, given_back_in_a_row = 0;
    std::deque<Time> restarts;
    // Over all instances of the name.
    std::uint64_t episodes = 0, leases_lost = 0, batches_refused = 0, instances = 0;
  };

  explicit WorkerRoster(const RosterSettings& settings) : settings_(settings) {}

  // Calls lost(instance) if an instance had the name before.
  const Worker& hear(const WorkerStatus& status, Time now,
                     const std::function<void(std::uint64_t)>& lost);
  // A connection to the learner's leases, without which a worker cannot hear of any.
  void connect(const std::string& name);
  // Returns the instance that is lost by it; 0: none.
  std::uint64_t disconnect(const std::string& name);
  // Those that have become silent.
  std::vector<std::uint64_t> silent(Time now);

  // Those that may play; and of them, those that hold no lost lease.
  int alive() const;
  bool alive(const Worker& worker) const;
  std::vector<LeaseBook::Hand> hands() const;

  // How long to wait for a lease, `most` at most: ten times what the worker's last leases suggest,
  // so that one that hangs, and says all the same that it lives, does not hold all others up. Too
  // little patience costs double work, and no episode.
  std::chrono::nanoseconds patience(const Lease& lease, std::chrono::nanoseconds most);

  void leased(const Lease& lease, Time now);
  void lost(const Lease& lease);
  // A batch has come: of so many episodes that were needed; and that frees the worker; or a bad
  // one, which frees it too. Returns the lease that it held, or 0.
  void accepted(const Lease& lease, int episodes, Time now);
  void returned(std::uint64_t instance, std::uint64_t session, std::uint64_t lease);
  std::uint64_t bad_batch(std::uint64_t instance, const std::string& reason);
  // A lease has come back unplayed: the worker gets none before it is heard again.
  void gave_back(std::uint64_t instance, const std::string& reason);

  const std::map<std::string, Worker>& workers() const { return workers_; }

 private:
  Worker* find(std::uint64_t instance);
  std::string objection(const WorkerStatus& status) const;
  void start_anew(Worker& worker, Time now);

  RosterSettings settings_;
  std::map<std::string, Worker> workers_;
  std::map<std::string, int> connections_;
};

}  // namespace threelink_agent

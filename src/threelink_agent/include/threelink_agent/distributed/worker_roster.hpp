/// @file
/// The workers of a training, under their names: who may play, who is free, and how each has done.
#pragma once

#include <chrono>
#include <cstdint>
#include <deque>
#include <functional>
#include <map>
#include <string>
#include <vector>

#include "threelink_agent/distributed/episode_batch.hpp"
#include "threelink_agent/distributed/lease_book.hpp"

namespace threelink_agent {

/// What a worker says of itself: threelink_msgs/WorkerStatus without ROS.
struct WorkerStatus {
  std::string name;
  std::uint64_t instance = 0;
  std::string host;
  std::uint32_t protocol = 0;
  std::string fingerprint;
  std::string instructions;
  std::uint32_t threads = 0;
  std::uint64_t episodes = 0;
  std::uint64_t session = 0;  ///< of the leases that it heard last
  std::uint64_t lease = 0;    ///< of that session, that it holds; 0: none
};

/// Whether it is what a worker can say: a node's name, printable texts, each of a bounded length.
bool well_formed(const WorkerStatus& status);

struct RosterSettings {
  std::uint64_t session = 0;  ///< of this learner
  std::string fingerprint;    ///< that workers must have
  /// A worker that says nothing for so long is taken for lost; it says something once a second.
  std::chrono::nanoseconds silence = std::chrono::seconds(3);
  /// One that starts anew for the most_restarts-th time within restart_window is set aside.
  int most_restarts = 5;
  std::chrono::nanoseconds restart_window = std::chrono::seconds(60);
  /// Likewise one that spoils so many leases in a row by bad batches, or gives so many back.
  int most_bad_batches = 3;
  int most_given_back = 10;
  /// For how long; twice as long each time, until a batch of it is taken.
  std::chrono::nanoseconds first_pause = std::chrono::seconds(5);
  std::chrono::nanoseconds longest_pause = std::chrono::minutes(5);
  /// Names that are remembered, and of them those that have handed nothing in.
  std::size_t most_workers = 2000, most_unproven = 250;
};

class WorkerRoster {
 public:
  using Time = std::chrono::steady_clock::time_point;

  struct Worker {
    WorkerStatus status;  ///< as heard last
    Time heard;
    bool present = false;     ///< heard, and neither disconnected nor silent since
    std::string refused;      ///< why it gets no leases; empty if it may
    bool set_aside = false;   ///< refused for what it did, and not for what it is,
    Time until;               ///< and so long
    int pauses = 0;           ///< since a batch was taken
    Time told;                ///< when it was told why it is refused,
    std::string told_reason;  ///< and what
    std::uint64_t lease = 0;  ///< that it may hold
    bool overdue = false;     ///< that lease was lost; it may hold it all the same
    std::string spoilt;       ///< a bad batch of that lease has come, and this is what was bad
    Time leased;
    double speed = 0;  ///< [episodes/s] of its last leases; 0: not known
    int bad_in_a_row = 0, given_back_in_a_row = 0;
    std::deque<Time> restarts;
    std::deque<std::uint64_t> former;  ///< instances; the last ones
    /// Over all instances of the name.
    std::uint64_t episodes = 0, leases_lost = 0, batches_refused = 0, instances = 0;
  };

  explicit WorkerRoster(const RosterSettings& settings) : settings_(settings) {}

  struct Heard {
    const Worker* worker = nullptr;  ///< null: the status is refused
    std::uint64_t spoilt_lease = 0;  ///< that it no longer holds, and whose batch was bad; 0: none
  };
  /// Calls lost(instance) if an instance had the name before, or is forgotten.
  Heard hear(const WorkerStatus& status, Time now, const std::function<void(std::uint64_t)>& lost);
  /// Whether it is refused, and was not told so lately; then it is now.
  bool must_be_told(const std::string& name, Time now);
  /// Whether a node is, or was, the worker of that instance.
  bool is(const std::string& name, std::uint64_t instance) const;
  /// A connection to the learner's leases, without which a worker cannot hear of any.
  void connect(const std::string& name);
  /// Returns the instance that is lost by it; 0: none.
  std::uint64_t disconnect(const std::string& name);
  /// Those that have become silent.
  std::vector<std::uint64_t> silent(Time now);
  /// Those whose time aside is over may play again.
  void let_in(Time now);

  /// Those that may play; and of them, those that hold no lost lease.
  int alive() const;
  bool alive(const Worker& worker) const;
  std::vector<LeaseBook::Hand> hands() const;
  /// Those that are there, and would be alive if they were not set aside.
  std::vector<const Worker*> aside() const;

  /// How long to wait for a lease, `most` at most: ten times what the worker's last leases suggest,
  /// so that one that hangs, and says all the same that it lives, does not hold all others up. Too
  /// little patience costs double work, and no episode.
  std::chrono::nanoseconds patience(const Lease& lease, std::chrono::nanoseconds most);

  void leased(const Lease& lease, Time now);
  void lost(const Lease& lease, Time now);
  /// A batch has come: of so many episodes that were needed; and that frees the worker; or a bad
  /// one, which does not.
  void accepted(const Lease& lease, int episodes, Time now);
  void returned(std::uint64_t instance, std::uint64_t session, std::uint64_t lease);
  void bad_batch(const std::string& publisher, const EpisodeBatch& batch,
                 const std::string& reason);
  /// A lease has come back unplayed: the worker gets none before it is heard again.
  void gave_back(std::uint64_t instance, const std::string& reason, Time now);

  const std::map<std::string, Worker>& workers() const { return workers_; }

 private:
  Worker* find(std::uint64_t instance);
  std::string objection(const WorkerStatus& status) const;
  void start_anew(Worker& worker, Time now);
  /// A spoilt lease is over.
  void spoil(Worker& worker, Time now);
  void set_aside(Worker& worker, Time now, const std::string& what_it_did);
  void make_room(const std::function<void(std::uint64_t)>& lost);

  RosterSettings settings_;
  std::map<std::string, Worker> workers_;
  std::map<std::string, int> connections_;
};

}  // namespace threelink_agent

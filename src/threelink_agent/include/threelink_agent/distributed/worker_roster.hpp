/// @file
/// The workers of a training by name: which may play, which are free, and the record of each.
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

/// Status message of a worker: threelink_msgs/WorkerStatus without ROS.
struct WorkerStatus {
  std::string name;
  std::uint64_t instance = 0;
  std::string host;
  std::uint32_t protocol = 0;
  std::string fingerprint;
  std::string instructions;
  std::uint32_t threads = 0;
  std::uint64_t episodes = 0;
  std::uint64_t session = 0;  ///< of the leases that it received last
  std::uint64_t lease = 0;    ///< lease of that session that it holds; 0: none
};

/// Whether the status is valid: a node's name and printable texts, each of a bounded length.
bool well_formed(const WorkerStatus& status);

/// Limits of the roster.
struct RosterSettings {
  std::uint64_t session = 0;  ///< of this learner
  std::string fingerprint;    ///< fingerprint that workers must have
  /// A worker whose status messages, one per second, are absent for this long is considered lost.
  std::chrono::nanoseconds silence = std::chrono::seconds(3);
  /// A worker that restarts most_restarts times within restart_window is suspended.
  int most_restarts = 5;
  std::chrono::nanoseconds restart_window = std::chrono::seconds(60);
  /// A worker is also suspended after this many consecutive leases with bad batches, or this many
  /// consecutive leases that it returned unplayed.
  int most_bad_batches = 3;
  int most_given_back = 10;
  /// Duration of the first suspension; it doubles each time until a batch of the worker is
  /// accepted.
  std::chrono::nanoseconds first_pause = std::chrono::seconds(5);
  std::chrono::nanoseconds longest_pause = std::chrono::minutes(5);
  /// Largest number of remembered names, and of those among them without an accepted batch.
  std::size_t most_workers = 2000, most_unproven = 250;
};

/// A pure state machine: all times are arguments.
class WorkerRoster {
 public:
  using Time = std::chrono::steady_clock::time_point;

  /// Everything that is known about a worker.
  struct Worker {
    WorkerStatus status;  ///< last status
    Time heard;
    bool present = false;     ///< heard, and neither disconnected nor silent since
    std::string refused;      ///< reason why it gets no leases; empty if it may play
    bool set_aside = false;   ///< refused because of its behaviour: suspended
    Time until;               ///< end of the suspension
    int pauses = 0;           ///< suspensions since a batch was accepted
    Time told;                ///< time of the last message with the reason of its refusal
    std::string told_reason;  ///< that reason
    std::uint64_t lease = 0;  ///< lease that it may hold
    bool overdue = false;     ///< that lease was lost, but the worker may still hold it
    std::string spoilt;       ///< fault of a bad batch of that lease; empty if there was none
    Time leased;
    double speed = 0;  ///< [episodes/s] of its last leases; 0: unknown
    int bad_in_a_row = 0, given_back_in_a_row = 0;
    std::deque<Time> restarts;
    std::deque<std::uint64_t> former;  ///< recent earlier instances
    /// Counts over all instances of the name.
    std::uint64_t episodes = 0, leases_lost = 0, batches_refused = 0, instances = 0;
  };

  explicit WorkerRoster(const RosterSettings& settings) : settings_(settings) {}

  /// Result of a status.
  struct Heard {
    const Worker* worker = nullptr;  ///< null: the status is refused
    std::uint64_t spoilt_lease = 0;  ///< lease with a bad batch that it no longer holds; 0: none
  };
  /// Handles a status. Calls lost(instance) if the name belonged to another instance before, or if
  /// an instance is forgotten.
  Heard hear(const WorkerStatus& status, Time now, const std::function<void(std::uint64_t)>& lost);
  /// Whether the worker is refused and has not been told so recently. If so, it counts as told now.
  bool must_be_told(const std::string& name, Time now);
  /// Whether the node is, or was, the worker of that instance.
  bool is(const std::string& name, std::uint64_t instance) const;
  /// Records a connection to the learner's topic of leases, which a worker needs.
  void connect(const std::string& name);
  /// Records its end. Returns the instance that is lost by it; 0: none.
  std::uint64_t disconnect(const std::string& name);
  /// The instances that have become silent.
  std::vector<std::uint64_t> silent(Time now);
  /// Ends the suspensions whose time has passed.
  void let_in(Time now);

  /// Number of workers that may play.
  int alive() const;
  /// Whether the worker may play.
  bool alive(const Worker& worker) const;
  /// The workers that may play and hold no lost lease.
  std::vector<LeaseBook::Hand> hands() const;
  /// The suspended workers that are present.
  std::vector<const Worker*> aside() const;

  /// Time to wait for a lease: ten times the duration that the worker's last leases suggest, but at
  /// most `most`. A worker that hangs but still sends its status then does not delay all others.
  /// Too short a time costs double work but no episode.
  std::chrono::nanoseconds patience(const Lease& lease, std::chrono::nanoseconds most);

  /// Records a lease.
  void leased(const Lease& lease, Time now);
  /// Records the loss of a lease.
  void lost(const Lease& lease, Time now);
  /// Records a batch with `episodes` episodes that were needed.
  void accepted(const Lease& lease, int episodes, Time now);
  /// Records a batch that frees the worker.
  void returned(std::uint64_t instance, std::uint64_t session, std::uint64_t lease);
  /// Records a refused batch, which does not free the worker.
  void bad_batch(const std::string& publisher, const EpisodeBatch& batch,
                 const std::string& reason);
  /// Records an unplayed lease: the worker gets none before its next status.
  void gave_back(std::uint64_t instance, const std::string& reason, Time now);

  const std::map<std::string, Worker>& workers() const { return workers_; }

 private:
  Worker* find(std::uint64_t instance);
  std::string objection(const WorkerStatus& status) const;
  void start_anew(Worker& worker, Time now);
  /// Ends a lease with a bad batch.
  void spoil(Worker& worker, Time now);
  void set_aside(Worker& worker, Time now, const std::string& what_it_did);
  void make_room(const std::function<void(std::uint64_t)>& lost);

  RosterSettings settings_;
  std::map<std::string, Worker> workers_;
  std::map<std::string, int> connections_;
};

}  // namespace threelink_agent

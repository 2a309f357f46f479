/// @file
/// The assignment of the episodes of an update to workers. It does not know the content of the
/// episodes.
#pragma once

#include <chrono>
#include <cstdint>
#include <functional>
#include <map>
#include <vector>

namespace threelink_agent {

/// Consecutive episodes for one worker.
struct Lease {
  std::uint64_t id = 0;      ///< counts from 1, over all updates
  std::uint64_t worker = 0;  ///< instance of the worker
  int first = 0, count = 0;  ///< episodes of the update, from 0
};

/// Each episode of the update is open, leased, or done (kIn); done is final. A lease ends when its
/// episodes are returned, when they are refused, or when it is lost. The book remembers a lost
/// lease: episodes that still arrive for it are equal to the bit to those of another worker.
class LeaseBook {
 public:
  using Time = std::chrono::steady_clock::time_point;

  /// A worker, its speed relative to the others, and whether it holds no lease.
  struct Hand {
    std::uint64_t worker;
    double speed;  ///< > 0
    bool free;
  };

  /// Begins a new update: all episodes are open, and all leases are forgotten.
  void open(int episodes);
  bool complete() const { return in_ == static_cast<int>(states_.size()); }
  int in() const { return in_; }

  /// Divides the open episodes among the workers in proportion to their speed. Each free worker
  /// gets a lease of its part, limited to consecutive episodes and to `most` of them. The parts of
  /// busy workers stay open until these are free.
  std::vector<Lease> give(const std::vector<Hand>& hands, int most,
                          const std::function<Time(const Lease&)>& deadline);

  /// The lease, or null if this update never gave it.
  const Lease* find(std::uint64_t id) const;

  /// Consecutive episodes.
  struct Run {
    int first, count;
  };
  /// Records that the episodes of the lease have arrived. Returns those that had not arrived
  /// before.
  std::vector<Run> settle(std::uint64_t id);
  /// Ends a running lease without its episodes: those that are not done are open again.
  void reopen(std::uint64_t id);

  /// Ends the leases whose deadline has passed, and returns them.
  std::vector<Lease> expire(Time now);
  /// Ends the leases of a worker, and returns them.
  std::vector<Lease> revoke(std::uint64_t worker);

 private:
  enum class State : char { kOpen, kLeased, kIn };
  struct Entry {
    Lease lease;
    Time deadline;
    bool running = false;
  };

  template <class Which>
  std::vector<Lease> lose(Which which);

  std::vector<State> states_;
  int in_ = 0;
  std::uint64_t last_id_ = 0;
  std::map<std::uint64_t, Entry> entries_;
};

}  // namespace threelink_agent

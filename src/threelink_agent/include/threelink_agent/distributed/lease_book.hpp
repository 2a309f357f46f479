/// @file
/// Who plays which episodes of an update. Knows nothing of what is in them.
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

/// Each episode of the update is open, leased, or in; in is final. A lease ends when its episodes
/// are handed in, when they are refused, or when it is lost. A lost one is still known: what comes
/// of it after all is as good as the same episodes of another worker, to the bit.
class LeaseBook {
 public:
  using Time = std::chrono::steady_clock::time_point;

  /// A worker, how fast it is relative to the others, and whether it holds nothing.
  struct Hand {
    std::uint64_t worker;
    double speed;  ///< > 0
    bool free;
  };

  /// A new update: all episodes are open, all leases forgotten.
  void open(int episodes);
  bool complete() const { return in_ == static_cast<int>(states_.size()); }
  int in() const { return in_; }

  /// Divides what is open among the hands in proportion to their speed. Each that is free gets a
  /// lease of its part, as far as that is consecutive and no more than `most` episodes; the parts
  /// of the others stay open until they come back.
  std::vector<Lease> give(const std::vector<Hand>& hands, int most,
                          const std::function<Time(const Lease&)>& deadline);

  /// Null for a lease that this update never gave.
  const Lease* find(std::uint64_t id) const;

  /// Consecutive episodes.
  struct Run {
    int first, count;
  };
  /// The lease is handed in: returns those of its episodes that were not in yet, which now are.
  std::vector<Run> settle(std::uint64_t id);
  /// A lease that runs ends without its episodes: they are open again, unless they are in.
  void reopen(std::uint64_t id);

  /// Loses what is past its deadline, or held by a worker, and returns it.
  std::vector<Lease> expire(Time now);
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

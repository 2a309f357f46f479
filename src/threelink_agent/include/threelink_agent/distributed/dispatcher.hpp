/// @file
/// The learner's side of the protocol (docs/distributed.md) as a state machine without clock,
/// threads or network: its inputs are events with their times, its outputs the messages to send.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <random>
#include <string>
#include <vector>

#include "threelink_agent/distributed/episode_batch.hpp"
#include "threelink_agent/distributed/lease_book.hpp"
#include "threelink_agent/distributed/worker_roster.hpp"

namespace threelink_agent {

/// Result of the check of a batch.
enum class Verdict {
  kAccepted,
  kLate,         ///< of a completed update, or of an earlier process of the learner
  kDouble,       ///< all of its episodes had already arrived
  kGivenBack,    ///< the worker could not play the episodes now
  kStranger,     ///< sent by another node than the worker that it names
  kNotLeased,    ///< this lease was not given to that worker
  kWrongPolicy,  ///< played with a policy other than this update's
  kMalformed,    ///< episodes, sizes or shapes differ from the lease
  kBadChecksum,
  kNotFinite,
  kOtherBits,  ///< an episode replayed by the learner gave other numbers
};
/// Number of verdicts.
constexpr int kVerdicts = 11;
const char* to_string(Verdict verdict);  ///< such as "accepted", "late" or "double"
/// Whether the batch is refused because of its content or sender.
constexpr bool is_fault(Verdict verdict) { return verdict > Verdict::kGivenBack; }

/// Settings of the distribution of episodes.
struct DispatcherSettings {
  RosterSettings roster;
  /// Reassign a lease after this time; earlier if the worker is known to be fast
  /// (WorkerRoster::patience).
  std::chrono::nanoseconds lease_time = std::chrono::seconds(60);
  int lease_episodes = 256;  ///< largest number of episodes of a lease
  /// Number of randomly chosen episodes of each batch that the learner replays before it accepts
  /// the batch. 0 for robots, whose episodes cannot be replayed.
  int replays = 1;
};

/// The update whose episodes are being collected.
struct Update {
  std::uint64_t version;        ///< of the policy: updates done
  std::string policy;           ///< sha256 of the policy file's bytes
  std::uint32_t first_episode;  ///< number in the training
  int episodes;
};

/// A refused worker and the reason.
struct Refusal {
  std::uint64_t worker;
  std::string reason;
};

/// Assembles the rollout of each update from the batches of the workers. An episode enters once, at
/// the position of its number: the rollout depends neither on the worker that played an episode nor
/// on the time.
class Dispatcher {
 public:
  using Time = LeaseBook::Time;

  explicit Dispatcher(const DispatcherSettings& settings);

  /// Begins the next update. The other methods may be called at any time, also before. `play`
  /// describes how episodes are played and is needed for replays.
  void open(const Update& update, Rollout&& empty, const std::optional<Play>& play = {});
  bool complete() const { return rollout_ && book_.complete(); }
  /// The rollout, once complete() is true. No lease is given until the next open().
  Rollout take();

  /// Handles a status message of a worker.
  void hear(const WorkerStatus& status, Time now);
  /// Handles a connection of a node to the topic of leases.
  void connect(const std::string& name) { roster_.connect(name); }
  /// Handles the end of such a connection.
  void disconnect(const std::string& name, Time now);
  /// Checks a batch and, if accepted, adds its episodes. publisher: name of the node that sent it.
  Verdict deliver(const EpisodeBatch& batch, const std::string& publisher, Time now);

  /// Messages to send.
  struct Sending {
    std::vector<Lease> leases;
    std::vector<Refusal> refusals;
  };
  /// The messages to send now. Call it after each of the above methods, and at least once a second.
  Sending tick(Time now);

  const Update& update() const { return update_; }
  std::uint64_t session() const { return settings_.roster.session; }
  const WorkerRoster& roster() const { return roster_; }
  int episodes_in() const { return book_.in(); }
  std::uint64_t leases_given() const { return leases_given_; }
  std::uint64_t leases_lost() const { return leases_lost_; }
  std::uint64_t statuses_refused() const { return statuses_refused_; }
  std::uint64_t batches(Verdict verdict) const { return batches_[static_cast<int>(verdict)]; }

 private:
  Verdict judge(const EpisodeBatch& batch, const std::string& publisher);
  bool replays_differ(const EpisodeBatch& batch);
  void lose(const std::vector<Lease>& leases, Time now);

  DispatcherSettings settings_;
  WorkerRoster roster_;
  LeaseBook book_;
  Update update_{};
  std::optional<Rollout> rollout_;  ///< empty after take()
  std::optional<Play> play_;        ///< for replays of its episodes
  std::mt19937 lots_{std::random_device()()};
  std::vector<Refusal> refusals_;  ///< to be sent
  std::uint64_t leases_given_ = 0, leases_lost_ = 0, statuses_refused_ = 0;
  std::array<std::uint64_t, kVerdicts> batches_{};
};

}  // namespace threelink_agent

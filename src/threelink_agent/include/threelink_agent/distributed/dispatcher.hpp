/// @file
/// The learner's side of the protocol (docs/distributed.md), as a state machine without clock,
/// threads or network: what happened goes in, with its time; what is to be sent comes out.
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

/// What becomes of a batch.
enum class Verdict {
  kAccepted,
  kLate,         ///< of an update that is done, or of a process of the learner that is gone
  kDouble,       ///< all of it had come already
  kGivenBack,    ///< the worker could not play them now
  kStranger,     ///< another node sent it than the worker whose it claims to be
  kNotLeased,    ///< no such lease was given to that worker
  kWrongPolicy,  ///< played with another policy than this update's
  kMalformed,    ///< other episodes, sizes or shapes than leased
  kBadChecksum,
  kNotFinite,
  kOtherBits,  ///< played here, an episode of it gave other numbers
};
constexpr int kVerdicts = 11;
const char* to_string(Verdict verdict);  ///< "accepted", "late", "double", ..
/// Whether it is refused for what it is.
constexpr bool is_fault(Verdict verdict) { return verdict > Verdict::kGivenBack; }

struct DispatcherSettings {
  RosterSettings roster;
  /// A lease that has not come back for so long is given again; sooner if the worker is known to be
  /// fast (WorkerRoster::patience).
  std::chrono::nanoseconds lease_time = std::chrono::seconds(60);
  int lease_episodes = 256;  ///< of a lease, at most
  /// Episodes of each batch, drawn by lot, that are played once more before it is taken. 0: none,
  /// as for robots, whose episodes nobody else could play.
  int replays = 1;
};

struct Update {
  std::uint64_t version;        ///< of the policy: updates done
  std::string policy;           ///< sha256 of the policy file's bytes
  std::uint32_t first_episode;  ///< number in the training
  int episodes;
};

struct Refusal {
  std::uint64_t worker;
  std::string reason;
};

/// Assembles the rollouts, one update after the other, from what the workers hand in. An episode
/// enters once, at the place of its number: the rollout does not depend on who played what, or
/// when.
class Dispatcher {
 public:
  using Time = LeaseBook::Time;

  explicit Dispatcher(const DispatcherSettings& settings);

  /// To be called for the next update; all else may happen at any time, also before it. `play` is
  /// how its episodes are played, for replays.
  void open(const Update& update, Rollout&& empty, const std::optional<Play>& play = {});
  bool complete() const { return rollout_ && book_.complete(); }
  /// The rollout, once it is complete. Until the next open() no lease is given.
  Rollout take();

  void hear(const WorkerStatus& status, Time now);
  void connect(const std::string& name) { roster_.connect(name); }
  void disconnect(const std::string& name, Time now);
  /// publisher: the node that sent it.
  Verdict deliver(const EpisodeBatch& batch, const std::string& publisher, Time now);

  /// What is to be sent now; to be called after each of the above, and at least once a second.
  struct Sending {
    std::vector<Lease> leases;
    std::vector<Refusal> refusals;
  };
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
  std::optional<Rollout> rollout_;  ///< until it is taken
  std::optional<Play> play_;        ///< of its episodes
  std::mt19937 lots_{std::random_device()()};
  std::vector<Refusal> refusals_;  ///< to be sent
  std::uint64_t leases_given_ = 0, leases_lost_ = 0, statuses_refused_ = 0;
  std::array<std::uint64_t, kVerdicts> batches_{};
};

}  // namespace threelink_agent

/// @file
/// A worker's side of the protocol (docs/distributed.md): plays leases with the policy they are
/// for.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <utility>

#include "threelink_agent/distributed/episode_batch.hpp"
#include "threelink_agent/distributed/lease_book.hpp"
#include "threelink_agent/policy.hpp"
#include "threelink_agent/training/rollout_source.hpp"
#include "threelink_agent/training/train_config.hpp"

namespace threelink_agent {

/// A lease, and what it is to be played with.
struct Assignment {
  std::uint64_t session = 0;
  std::uint64_t version = 0;
  std::string policy;  ///< sha256 of the policy file's bytes
  std::uint64_t lease = 0;
  std::uint64_t worker = 0;
  std::uint32_t first_episode = 0, episodes = 0;
};

class LeasePlayer {
 public:
  /// source: where the episodes are played.
  explicit LeasePlayer(std::unique_ptr<RolloutSource> source) : source_(std::move(source)) {}

  /// Whether episodes can be played now, as far as is known.
  bool ready() { return source_->ready(); }

  /// The policy file that a learner sent; swimmer, seed and the rest come with it, in its
  /// configuration. Throws PolicyError and ConfigError, and keeps the one it has.
  void load(const std::string& bytes, const std::string& source);

  /// Whether it has the policy for it.
  bool ready_for(const Assignment& assignment) const { return assignment.policy == policy_; }

  /// More than this in one lease are a mistake.
  static constexpr std::uint32_t kMostEpisodes = 1000000;

  /// Plays the episodes. Without their policy, or with a number of them that cannot be, the batch
  /// is empty, and will be refused. If they cannot be played now, it gives the lease back. Throws
  /// Interrupted if the source does.
  EpisodeBatch play(const Assignment& assignment);

 private:
  std::unique_ptr<RolloutSource> source_;
  std::string yaml_;  ///< what config_ was read from
  TrainConfig config_;
  std::string policy_;  ///< sha256 of the policy file's bytes
  std::optional<Play> play_;
};

}  // namespace threelink_agent

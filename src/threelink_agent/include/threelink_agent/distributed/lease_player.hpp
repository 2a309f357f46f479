/// @file
/// A worker's side of the protocol (docs/distributed.md): plays the episodes of leases.
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

/// A lease and the policy with which to play it.
struct Assignment {
  std::uint64_t session = 0;
  std::uint64_t version = 0;
  std::string policy;  ///< sha256 of the policy file's bytes
  std::uint64_t lease = 0;
  std::uint64_t worker = 0;
  std::uint32_t first_episode = 0, episodes = 0;
};

/// Plays assignments with the policy that the learner sent last.
class LeasePlayer {
 public:
  /// source: plays the episodes.
  explicit LeasePlayer(std::unique_ptr<RolloutSource> source) : source_(std::move(source)) {}

  /// Whether the source can play episodes now.
  bool ready() { return source_->ready(); }

  /// Loads the policy file of a learner. Its metadata hold the configuration with swimmer and seed.
  /// Throws PolicyError and ConfigError; the previous policy then remains.
  void load(const std::string& bytes, const std::string& source);

  /// Whether the policy of the assignment is loaded.
  bool ready_for(const Assignment& assignment) const { return assignment.policy == policy_; }

  /// Largest accepted number of episodes in a lease.
  static constexpr std::uint32_t kMostEpisodes = 1000000;

  /// Plays the episodes. The batch is empty, and will be refused, if their policy is not loaded or
  /// their number is out of bounds. If the source cannot play now, the batch returns the lease with
  /// the reason. Throws Interrupted if the source does.
  EpisodeBatch play(const Assignment& assignment);

 private:
  std::unique_ptr<RolloutSource> source_;
  std::string yaml_;  ///< text that config_ was read from
  TrainConfig config_;
  std::string policy_;  ///< sha256 of the policy file's bytes
  std::optional<Play> play_;
};

}  // namespace threelink_agent

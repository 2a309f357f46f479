/// @file
/// The episodes of a lease as a worker returns them: threelink_msgs/EpisodeBatch without ROS.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "threelink_agent/training/rollout.hpp"

namespace threelink_agent {

/// A batch of consecutive episodes.
struct EpisodeBatch {
  std::uint64_t session = 0;  ///< process of the learner that gave the lease
  std::uint64_t version = 0;  ///< of the policy: updates done
  std::string policy;         ///< sha256 of the policy file's bytes
  std::uint64_t lease = 0;
  std::uint64_t worker = 0;         ///< instance
  std::uint32_t first_episode = 0;  ///< number in the training
  std::uint32_t episodes = 0, steps = 0, observation_size = 0, hinges = 0;
  std::vector<float> observations, actions, log_probs, rewards;  ///< as in Rollout
  std::vector<std::uint8_t> captured;                            ///< likewise
  std::string checksum;
  std::string given_back;  ///< reason why the lease is returned without its episodes; empty if they
                           ///< were played
};

/// Moves the rollout's arrays and their shape into the batch.
void put(Rollout&& rollout, EpisodeBatch& batch);

/// sha256 (64 hex digits) of the text that follows, where [x] stands for the sha256 of an array's
/// bytes, float32 in little-endian order:
///   "session version policy lease worker first_episode episodes steps observation_size hinges
///    [observations] [actions] [log_probs] [rewards] [captured]"
/// separated by single spaces, numbers in decimal.
std::string checksum(const EpisodeBatch& batch);

/// Whether the batch holds `episodes` whole episodes of the shape of `whole`, and its arrays have
/// the announced sizes.
bool well_formed(const EpisodeBatch& batch, const Rollout& whole, int episodes);

/// Whether all numbers are finite.
bool all_finite(const EpisodeBatch& batch);

/// Copies `count` episodes of a well-formed batch, beginning at `from`, to the rollout, beginning
/// at `to`.
void copy_episodes(const EpisodeBatch& batch, int from, int count, Rollout& rollout, int to);

}  // namespace threelink_agent

#include "threelink_agent/distributed/lease_player.hpp"

#include <new>
#include <stdexcept>

#include "threelink_sim/sha256.hpp"

namespace threelink_agent {

void LeasePlayer::load(const std::string& bytes, const std::string& source) {
  const Policy policy = Policy::parse(bytes, source);
  const std::string& yaml = policy.metadata().config;
  if (yaml != yaml_) {  // only with another learner
    config_ = parse_train_config(yaml, source);
    yaml_ = yaml;
  }
  play_ = Play{config_.environment,
               config_.goal,
               config_.symmetry.canonical,
               policy.actor(),
               policy.log_std(),
               config_.seed,
               0};
  policy_ = threelink_sim::sha256(bytes);
}

EpisodeBatch LeasePlayer::play(const Assignment& assignment) {
  EpisodeBatch batch;
  batch.session = assignment.session;
  batch.version = assignment.version;
  batch.policy = assignment.policy;
  batch.lease = assignment.lease;
  batch.worker = assignment.worker;
  batch.first_episode = assignment.first_episode;
  if (ready_for(assignment) && assignment.episodes > 0 && assignment.episodes <= kMostEpisodes) {
    play_->first_episode = assignment.first_episode;
    try {
      put(source_->play(*play_, static_cast<int>(assignment.episodes)), batch);
    } catch (const NoRollout& error) {
      batch.given_back = error.what();
    } catch (const std::bad_alloc&) {
      batch.given_back = "they need more memory than there is";
    } catch (const std::length_error&) {
      batch.given_back = "they need more memory than there is";
    }
  }
  batch.checksum = checksum(batch);
  return batch;
}

}  // namespace threelink_agent

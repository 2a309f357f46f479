#include "training_messages.hpp"

#include <utility>

namespace threelink_agent {
namespace {

// Fields have the same names on both sides.
template <class From, class To>
void copy_status(const From& from, To& to) {
  to.name = from.name;
  to.instance = from.instance;
  to.host = from.host;
  to.protocol = from.protocol;
  to.fingerprint = from.fingerprint;
  to.instructions = from.instructions;
  to.threads = from.threads;
  to.episodes = from.episodes;
  to.session = from.session;
  to.lease = from.lease;
}

template <class From, class To>
void move_batch(From&& from, To& to) {
  to.session = from.session;
  to.version = from.version;
  to.policy = std::move(from.policy);
  to.lease = from.lease;
  to.worker = from.worker;
  to.first_episode = from.first_episode;
  to.episodes = from.episodes;
  to.steps = from.steps;
  to.observation_size = from.observation_size;
  to.hinges = from.hinges;
  to.observations = std::move(from.observations);
  to.actions = std::move(from.actions);
  to.log_probs = std::move(from.log_probs);
  to.rewards = std::move(from.rewards);
  to.captured = std::move(from.captured);
  to.checksum = std::move(from.checksum);
  to.given_back = std::move(from.given_back);
}

}  // namespace

WorkerStatus from_message(const threelink_msgs::WorkerStatus& message) {
  WorkerStatus status;
  copy_status(message, status);
  return status;
}

threelink_msgs::WorkerStatus to_message(const WorkerStatus& status) {
  threelink_msgs::WorkerStatus message;
  copy_status(status, message);
  return message;
}

EpisodeBatch from_message(threelink_msgs::EpisodeBatch&& message) {
  EpisodeBatch batch;
  move_batch(std::move(message), batch);
  return batch;
}

threelink_msgs::EpisodeBatch to_message(EpisodeBatch&& batch) {
  threelink_msgs::EpisodeBatch message;
  move_batch(std::move(batch), message);
  return message;
}

ros::Time wall_time() {
  const ros::WallTime now = ros::WallTime::now();
  return {now.sec, now.nsec};
}

}  // namespace threelink_agent

// A batch of episodes as bytes from the network: decoding and what the learner checks of it.
#include <cstring>

#include <ros/serialization.h>

#include "fuzz.hpp"
#include "threelink_agent/distributed/episode_batch.hpp"
#include "tiny_training.hpp"
#include "training_messages.hpp"

namespace {

// Whether no array or text of the message claims to be far larger than the input. roscpp allocates
// what is claimed; nodes refuse that by a bound in operator new, which sanitizers bring themselves.
bool claims_are_modest(const std::uint8_t* data, std::size_t size) {
  constexpr std::size_t kStamp = 12, kLease = 16, kWorkerAndShape = 36;
  std::size_t at = 0;
  const auto skip = [&](std::size_t bytes) { at += bytes; };
  const auto skip_array = [&](std::size_t element) {
    std::uint32_t count = 0;
    if (at + sizeof count > size) return true;  // overrun, which roscpp notices
    std::memcpy(&count, data + at, sizeof count);
    at += sizeof count + count * element;
    return count * element <= 100 * size + 4096;
  };
  skip(kStamp);
  if (!skip_array(1)) return false;  // frame_id
  skip(kLease);                      // session, version
  if (!skip_array(1)) return false;  // policy
  skip(kWorkerAndShape);             // lease, worker, and five numbers
  for (int i = 0; i < 4; ++i)
    if (!skip_array(sizeof(float))) return false;
  return skip_array(1) && skip_array(1) && skip_array(1);  // captured, checksum, given_back
}

}  // namespace

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace threelink_agent;
  static const TrainConfig config = threelink_fuzz::tiny_training();
  if (!claims_are_modest(data, size)) return 0;
  threelink_fuzz::value_or<ros::serialization::StreamOverrunException>([&] {
    threelink_msgs::EpisodeBatch message;
    ros::serialization::IStream stream(const_cast<std::uint8_t*>(data),
                                       static_cast<std::uint32_t>(size));
    ros::serialization::deserialize(stream, message);
    const EpisodeBatch batch = from_message(std::move(message));
    threelink_fuzz::require(checksum(batch).size() == 64, "no checksum");
    const int episodes = static_cast<int>(config.update.episodes);
    Rollout whole(config.environment, episodes);
    if (!well_formed(batch, whole, episodes) || !all_finite(batch)) return;
    copy_episodes(batch, 0, episodes, whole, 0);
    threelink_fuzz::require(whole.rewards == batch.rewards, "copied otherwise than received");
  });
  return 0;
}

#include "threelink_agent/distributed/episode_batch.hpp"

#include <algorithm>
#include <string_view>
#include <utility>

#include <fmt/format.h>

#include "threelink_sim/sha256.hpp"

namespace threelink_agent {
namespace {

template <class Value>
std::string hash_of(const std::vector<Value>& values) {
  return threelink_sim::sha256(
      {reinterpret_cast<const char*>(values.data()), values.size() * sizeof(Value)});
}

bool finite(const std::vector<float>& values) {
  float sum = 0;  // 0 * x is 0 unless x is not finite; without a branch, so that it goes in vectors
  for (float value : values) sum += 0 * value;
  return sum == 0;
}

}  // namespace

void put(Rollout&& rollout, EpisodeBatch& batch) {
  batch.episodes = rollout.episodes;
  batch.steps = rollout.steps;
  batch.observation_size = rollout.observation_size;
  batch.hinges = rollout.hinges;
  batch.observations = std::move(rollout.observations);
  batch.actions = std::move(rollout.actions);
  batch.log_probs = std::move(rollout.log_probs);
  batch.rewards = std::move(rollout.rewards);
  batch.captured = std::move(rollout.captured);
}

std::string checksum(const EpisodeBatch& b) {
  return threelink_sim::sha256(
      fmt::format("{} {} {} {} {} {} {} {} {} {} {} {} {} {} {}", b.session, b.version, b.policy,
                  b.lease, b.worker, b.first_episode, b.episodes, b.steps, b.observation_size,
                  b.hinges, hash_of(b.observations), hash_of(b.actions), hash_of(b.log_probs),
                  hash_of(b.rewards), hash_of(b.captured)));
}

bool well_formed(const EpisodeBatch& batch, const Rollout& whole, int episodes) {
  const std::size_t n = episodes, samples = n * whole.steps;
  return batch.episodes == n && batch.steps == static_cast<std::uint32_t>(whole.steps) &&
         batch.observation_size == static_cast<std::uint32_t>(whole.observation_size) &&
         batch.hinges == static_cast<std::uint32_t>(whole.hinges) &&
         batch.observations.size() == whole.observation_size * (samples + n) &&
         batch.actions.size() == whole.hinges * samples && batch.log_probs.size() == samples &&
         batch.rewards.size() == samples && batch.captured.size() == samples &&
         std::all_of(batch.captured.begin(), batch.captured.end(),
                     [](std::uint8_t captured) { return captured <= 1; });
}

bool all_finite(const EpisodeBatch& batch) {
  return finite(batch.observations) && finite(batch.actions) && finite(batch.log_probs) &&
         finite(batch.rewards);
}

void copy_episodes(const EpisodeBatch& batch, int from, int count, Rollout& rollout, int to) {
  const auto copy = [&](const auto& source, auto& target) {
    const std::size_t rows = target.size() / rollout.episodes;
    for (std::size_t row = 0; row < rows; ++row)
      std::copy_n(&source[row * batch.episodes + from], count,
                  &target[row * rollout.episodes + to]);
  };
  copy(batch.observations, rollout.observations);
  copy(batch.actions, rollout.actions);
  copy(batch.log_probs, rollout.log_probs);
  copy(batch.rewards, rollout.rewards);
  copy(batch.captured, rollout.captured);
}

}  // namespace threelink_agent

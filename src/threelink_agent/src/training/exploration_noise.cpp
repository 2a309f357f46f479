#include "threelink_agent/training/exploration_noise.hpp"

#include "threelink_sim/kernel/kernels.hpp"

namespace threelink_agent {

ExplorationNoise::ExplorationNoise(std::uint64_t seed, std::uint32_t first_episode, int episodes,
                                   int hinges)
    : key_{static_cast<std::uint32_t>(seed), static_cast<std::uint32_t>(seed >> 32)},
      draws_((hinges + 1) / 2),
      counters_(episodes * draws_),
      normals_(2 * counters_.size()) {
  for (std::size_t k = 0; k < counters_.size(); ++k)
    counters_[k] = {static_cast<std::uint32_t>(k % draws_), 0,
                    first_episode + static_cast<std::uint32_t>(k / draws_),
                    static_cast<std::uint32_t>(threelink_sim::Stream::kExploration)};
}

void ExplorationNoise::draw(std::uint32_t step) {
  for (threelink_sim::RandomCounter& counter : counters_) counter.step = step;
  threelink_sim::kernels().normals(counters_.size(), key_, &counters_[0].draw, normals_.data());
}

}  // namespace threelink_agent

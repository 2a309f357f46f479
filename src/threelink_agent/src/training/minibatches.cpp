#include "threelink_agent/training/minibatches.hpp"

#include <numeric>
#include <utility>

#include "threelink_sim/kernel/kernels.hpp"
#include "threelink_sim/random.hpp"

namespace threelink_agent {

using threelink_sim::RandomCounter;
using threelink_sim::Stream;

std::vector<std::int64_t> shuffled(std::uint32_t samples, std::uint64_t seed, std::uint32_t update,
                                   std::uint32_t epoch) {
  // All random words at once, two for each sample: 64 bits make the bias of scaling negligible.
  const std::uint32_t key[2] = {static_cast<std::uint32_t>(seed),
                                static_cast<std::uint32_t>(seed >> 32)};
  const std::uint32_t draws = (samples + 1) / 2;
  std::vector<RandomCounter> counters(draws);
  for (std::uint32_t draw = 0; draw < draws; ++draw)
    counters[draw] = {draw, epoch, update, static_cast<std::uint32_t>(Stream::kMinibatch)};
  std::vector<std::uint32_t> words(4 * draws);
  threelink_sim::kernels().philox(draws, key, &counters[0].draw, words.data());

  std::vector<std::int64_t> order(samples);
  std::iota(order.begin(), order.end(), 0);
  for (std::uint32_t left = samples; left > 1; --left) {
    const std::uint64_t random =
        (std::uint64_t{words[2 * (left - 1)]} << 32) | words[2 * (left - 1) + 1];
    const auto chosen =
        static_cast<std::uint32_t>(static_cast<unsigned __int128>(random) * left >> 64);
    std::swap(order[left - 1], order[chosen]);
  }
  return order;
}

}  // namespace threelink_agent

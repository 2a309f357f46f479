#include "threelink_sim/random.hpp"

#include "threelink_sim/kernel/kernels.hpp"

namespace threelink_sim {

Random::Random(std::uint64_t seed, Stream stream, std::uint32_t episode, std::uint32_t step)
    : key_{static_cast<std::uint32_t>(seed), static_cast<std::uint32_t>(seed >> 32)},
      counter_{0, step, episode, static_cast<std::uint32_t>(stream)} {}

// Each draw takes a fresh counter; a few words are thrown away so that a draw stays one line.
double Random::uniform() {
  std::uint32_t words[4];
  kernels().philox(1, key_, &counter_.draw, words);
  ++counter_.draw;
  const std::uint64_t fraction = ((std::uint64_t{words[0]} << 32) | words[1]) >> 12;
  return (static_cast<double>(fraction) + 0.5) * 0x1p-52;
}

double Random::uniform(double low, double high) { return low + (high - low) * uniform(); }

double Random::normal() {
  double pair[2];
  kernels().normals(1, key_, &counter_.draw, pair);
  ++counter_.draw;
  return pair[0];
}

std::uint32_t Random::below(std::uint32_t bound) {
  const std::uint32_t rejected_below = -bound % bound;
  while (true) {
    std::uint32_t words[4];
    kernels().philox(1, key_, &counter_.draw, words);
    ++counter_.draw;
    for (std::uint32_t word : words) {
      const std::uint64_t product = std::uint64_t{word} * bound;
      if (static_cast<std::uint32_t>(product) >= rejected_below)
        return static_cast<std::uint32_t>(product >> 32);
    }
  }
}

}  // namespace threelink_sim

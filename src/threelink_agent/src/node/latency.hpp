// A histogram of durations without allocation.
#pragma once

#include <array>
#include <chrono>
#include <cmath>
#include <cstdint>

namespace threelink_agent {

class Latency {
 public:
  using Duration = std::chrono::steady_clock::duration;

  void add(Duration duration) {
    const double nanoseconds = std::chrono::duration<double, std::nano>(duration).count();
    const double bin = kBinsAnOctave * std::log2(std::fmax(nanoseconds, 1.0));
    ++bins_[static_cast<std::size_t>(std::fmin(bin, kBins - 1))];
    ++count_;
  }

  // [us] that the given share of all durations does not exceed, 9 % too high at most; 0 if there
  // are none.
  double quantile(double share) const {
    std::uint64_t below = 0;
    for (std::size_t bin = 0; bin < kBins; ++bin) {
      below += bins_[bin];
      if (below > 0 && below >= share * count_)
        return 1e-3 * std::exp2((bin + 1.0) / kBinsAnOctave);
    }
    return 0;
  }

  void clear() { *this = Latency(); }

 private:
  static constexpr std::size_t kBinsAnOctave = 8;
  static constexpr std::size_t kBins = 34 * kBinsAnOctave;  // up to 17 s

  std::array<std::uint64_t, kBins> bins_{};
  std::uint64_t count_ = 0;
};

}  // namespace threelink_agent

// Sharing tasks between threads.
#include "threelink_agent/training/crew.hpp"

#include <atomic>
#include <vector>

#include <gtest/gtest.h>

namespace threelink_tests {
namespace {

using threelink_agent::Crew;

TEST(Crew, DoesEveryTaskOnceInEachOfManyRounds) {
  for (int threads : {1, 2, 5}) {
    Crew crew(threads);
    std::vector<std::atomic<int>> done(9);
    for (int round = 1; round <= 3000; ++round) {
      const int count = round % 10;  // none at all, too
      for (auto& d : done) d = 0;
      crew.run(count, [&](int task) { ++done.at(task); });
      for (int task = 0; task < 9; ++task) ASSERT_EQ(done[task], task < count ? 1 : 0);
    }
  }
}

TEST(Crew, SeesWhatTheCallerWroteAndTheCallerWhatItWrote) {
  Crew crew(3);
  std::vector<long> values(8, 0);
  for (long round = 0; round < 3000; ++round) {
    crew.run(8, [&](int task) { values[task] += round; });
    for (long& value : values) ++value;
  }
  for (long value : values) EXPECT_EQ(value, 3000L * 2999 / 2 + 3000);
}

}  // namespace
}  // namespace threelink_tests

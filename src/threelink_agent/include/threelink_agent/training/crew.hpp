/// @file
/// A few threads that share small tasks, thousands of rounds a second.
#pragma once

#include <atomic>
#include <condition_variable>
#include <cstdint>
#include <functional>
#include <mutex>
#include <thread>
#include <vector>

namespace threelink_agent {

class Crew {
 public:
  /// threads: the caller's included, at least 1.
  explicit Crew(int threads);
  ~Crew();
  Crew(const Crew&) = delete;
  Crew& operator=(const Crew&) = delete;

  /// Calls task(0), .., task(count - 1), each once, on whichever thread is free, and returns when
  /// all are done. count < 2^16; tasks must not throw.
  void run(int count, const std::function<void(int)>& task);

 private:
  void work(std::uint32_t round);
  void serve();
  bool wait_for_round(std::uint32_t last);  ///< false: time to go

  const std::function<void(int)>* task_ = nullptr;
  /// The round, its number of tasks, and the next of them, in one word: a thread that comes late
  /// cannot take a task of another round.
  std::atomic<std::uint64_t> next_{0};
  std::atomic<std::uint32_t> round_{0};
  std::atomic<int> done_{0};  ///< tasks of this round
  std::atomic<bool> stop_{false};

  /// Threads that have waited for long sleep here.
  std::atomic<int> sleepers_{0};
  std::mutex mutex_;
  std::condition_variable wake_;
  std::vector<std::thread> threads_;
};

}  // namespace threelink_agent

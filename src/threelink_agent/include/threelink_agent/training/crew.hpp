/// @file
/// A thread pool for small tasks, in thousands of rounds per second.
#pragma once

#include <atomic>
#include <condition_variable>
#include <cstdint>
#include <functional>
#include <mutex>
#include <thread>
#include <vector>

namespace threelink_agent {

/// The thread pool. The calling thread works too.
class Crew {
 public:
  /// threads: number of threads including the caller, at least 1.
  explicit Crew(int threads);
  ~Crew();
  Crew(const Crew&) = delete;
  Crew& operator=(const Crew&) = delete;

  /// Calls task(0), .., task(count - 1) once each on any free thread, and returns when all have
  /// returned. count < 2^16; tasks must not throw.
  void run(int count, const std::function<void(int)>& task);

 private:
  void work(std::uint32_t round);
  void serve();
  bool wait_for_round(std::uint32_t last);  ///< false: the pool ends

  const std::function<void(int)>* task_ = nullptr;
  /// The round, its number of tasks and the next task in one word, so that a late thread cannot
  /// take a task of another round.
  std::atomic<std::uint64_t> next_{0};
  std::atomic<std::uint32_t> round_{0};
  std::atomic<int> done_{0};  ///< tasks of this round
  std::atomic<bool> stop_{false};

  /// Threads that have waited for long sleep on this condition.
  std::atomic<int> sleepers_{0};
  std::mutex mutex_;
  std::condition_variable wake_;
  std::vector<std::thread> threads_;
};

}  // namespace threelink_agent

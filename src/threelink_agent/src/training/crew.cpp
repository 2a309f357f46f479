#include "threelink_agent/training/crew.hpp"

#if defined(__x86_64__)
#include <immintrin.h>
#endif

namespace threelink_agent {
namespace {

// Rounds follow each other within microseconds, far less than it takes to wake a thread: look at
// the condition for some 100 us before giving up the processor for good.
constexpr int kSpins = 1000;  // with a pause
constexpr int kYields = 200;

inline void pause() {
#if defined(__x86_64__)
  _mm_pause();
#endif
}

template <class Condition>
bool spin_until(Condition condition) {
  for (int i = 0; i < kSpins; ++i, pause())
    if (condition()) return true;
  for (int i = 0; i < kYields; ++i, std::this_thread::yield())
    if (condition()) return true;
  return false;
}

}  // namespace

Crew::Crew(int threads) {
  for (int i = 1; i < threads; ++i) threads_.emplace_back([this] { serve(); });
}

Crew::~Crew() {
  stop_ = true;
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    wake_.notify_all();
  }
  for (std::thread& thread : threads_) thread.join();
}

void Crew::run(int count, const std::function<void(int)>& task) {
  if (threads_.empty()) {
    for (int i = 0; i < count; ++i) task(i);
    return;
  }
  const std::uint32_t round = round_ + 1;
  task_ = &task;
  done_ = 0;
  next_ = (std::uint64_t{round} << 32) | (static_cast<std::uint64_t>(count) << 16);
  round_ = round;
  if (sleepers_ > 0) {
    const std::lock_guard<std::mutex> lock(mutex_);
    wake_.notify_all();
  }
  work(round);
  while (!spin_until([&] { return done_ == count; })) {
  }
}

void Crew::work(std::uint32_t round) {
  std::uint64_t next = next_;
  for (;;) {
    const int count = static_cast<int>((next >> 16) & 0xffff);
    const int index = static_cast<int>(next & 0xffff);
    if (static_cast<std::uint32_t>(next >> 32) != round || index >= count) return;
    if (!next_.compare_exchange_weak(next, next + 1)) continue;
    (*task_)(index);
    ++done_;
    next = next_;
  }
}

bool Crew::wait_for_round(std::uint32_t last) {
  const auto ready = [&] { return round_ != last || stop_; };
  if (!spin_until(ready)) {
    std::unique_lock<std::mutex> lock(mutex_);
    ++sleepers_;
    wake_.wait(lock, ready);
    --sleepers_;
  }
  return !stop_;
}

void Crew::serve() {
  std::uint32_t round = 0;
  while (wait_for_round(round)) {
    round = round_;
    work(round);
  }
}

}  // namespace threelink_agent

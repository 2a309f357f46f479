/// @file
/// A mutex for clang's thread safety analysis: -Wthread-safety rejects code that accesses a member
/// marked GUARDED_BY(mutex_), or calls a function marked REQUIRES(mutex_), without holding the
/// mutex. For other compilers it is a std::mutex. `./threelink lint` checks all nodes in this way.
#pragma once

#include <mutex>

#if defined(__clang__)
#define THREELINK_THREAD_SAFETY(attribute) __attribute__((attribute))
#else
#define THREELINK_THREAD_SAFETY(attribute)
#endif

#define GUARDED_BY(mutex) THREELINK_THREAD_SAFETY(guarded_by(mutex))
#define REQUIRES(mutex) THREELINK_THREAD_SAFETY(requires_capability(mutex))

namespace threelink_sim {

/// A std::mutex with annotations.
class THREELINK_THREAD_SAFETY(capability("mutex")) Mutex {
 public:
  void lock() THREELINK_THREAD_SAFETY(acquire_capability()) { mutex_.lock(); }
  void unlock() THREELINK_THREAD_SAFETY(release_capability()) { mutex_.unlock(); }

 private:
  std::mutex mutex_;
};

/// Holds a mutex during its lifetime; a std::condition_variable_any can wait with it.
class THREELINK_THREAD_SAFETY(scoped_lockable) Lock {
 public:
  explicit Lock(Mutex& mutex) THREELINK_THREAD_SAFETY(acquire_capability(mutex)) : mutex_(mutex) {
    mutex_.lock();
  }
  ~Lock() THREELINK_THREAD_SAFETY(release_capability()) { mutex_.unlock(); }
  Lock(const Lock&) = delete;
  Lock& operator=(const Lock&) = delete;

  /// For the condition variable.
  void lock() THREELINK_THREAD_SAFETY(acquire_capability()) { mutex_.lock(); }
  void unlock() THREELINK_THREAD_SAFETY(release_capability()) { mutex_.unlock(); }

 private:
  Mutex& mutex_;
};

}  // namespace threelink_sim

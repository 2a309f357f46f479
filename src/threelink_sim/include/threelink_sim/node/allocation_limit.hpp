/// @file
/// A bound on the memory that a message may allocate. A message of 48 bytes can announce an array
/// of gigabytes, which roscpp would allocate and fill with zeros before it notices that the
/// elements are missing.
///
/// A limit of the whole process (setrlimit) is not suitable: roscpp's network thread, which
/// allocates the announced length of a message, does not survive a bad_alloc.
#pragma once

#include <cstddef>

namespace threelink_sim {

/// During its lifetime operator new throws std::bad_alloc in this thread for more than `largest`
/// bytes. Limits can be nested; the smallest one applies. It has no effect in programs built with a
/// sanitizer, which has its own operator new.
class AllocationLimit {
 public:
  explicit AllocationLimit(std::size_t largest);
  ~AllocationLimit();
  AllocationLimit(const AllocationLimit&) = delete;
  AllocationLimit& operator=(const AllocationLimit&) = delete;

 private:
  std::size_t before_;
};

}  // namespace threelink_sim

/// @file
/// A bound on what one message may allocate: 48 bytes can claim an array of gigabytes, which roscpp
/// would allocate, and fill with zeros, before it notices that the array's numbers are missing.
///
/// A limit of the whole process (setrlimit) would be the wrong tool: roscpp's network thread, which
/// allocates what the length of a message promises, does not survive a bad_alloc.
#pragma once

#include <cstddef>

namespace threelink_sim {

/// While it lives, operator new throws std::bad_alloc in this thread for anything above `largest`
/// bytes. They nest; the smallest one counts. Without effect in programs built with a sanitizer,
/// which brings its own operator new.
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

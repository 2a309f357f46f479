#include "threelink_sim/node/allocation_limit.hpp"

#include <algorithm>
#include <cstdint>
#include <cstdlib>
#include <new>

#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
#define THREELINK_SANITIZER
#elif defined(__has_feature)
#if __has_feature(address_sanitizer) || __has_feature(thread_sanitizer) || \
    __has_feature(memory_sanitizer)
#define THREELINK_SANITIZER
#endif
#endif

namespace {

// Read by every allocation of the program: without the call that other models take.
__attribute__((tls_model("initial-exec"))) thread_local std::size_t largest_allocation = SIZE_MAX;

}  // namespace

#ifndef THREELINK_SANITIZER
// As that of the C++ library, whose operator delete and array form go with it.
void* operator new(std::size_t size) {
  if (size > largest_allocation) throw std::bad_alloc();
  while (true) {
    if (void* memory = std::malloc(size > 0 ? size : 1)) return memory;
    const std::new_handler handler = std::get_new_handler();
    if (!handler) throw std::bad_alloc();
    handler();
  }
}

void operator delete(void* memory) noexcept { std::free(memory); }
void operator delete(void* memory, std::size_t) noexcept { std::free(memory); }
#endif

namespace threelink_sim {

AllocationLimit::AllocationLimit(std::size_t largest) : before_(largest_allocation) {
  largest_allocation = std::min(largest_allocation, largest);
}

AllocationLimit::~AllocationLimit() { largest_allocation = before_; }

}  // namespace threelink_sim

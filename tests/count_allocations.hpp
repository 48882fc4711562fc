#pragma once

// Replaces operator new of the test program that includes it, in one file of it: every allocation is counted. The thread
// sanitizer's own operators cannot be replaced: nothing is counted there.

#include <atomic>
#include <cstdlib>
#include <new>

namespace bodesmith {
namespace {
/// Only differences are looked at.
std::atomic<long> allocations{0};
}  // namespace
}  // namespace bodesmith

#if defined(__has_feature)
#if __has_feature(thread_sanitizer)
#define BODESMITH_COUNTS_NO_ALLOCATIONS
#endif
#endif

#ifndef BODESMITH_COUNTS_NO_ALLOCATIONS
void* operator new(std::size_t size, const std::nothrow_t&) noexcept {
  ++bodesmith::allocations;
  return std::malloc(size);
}
void* operator new(std::size_t size) {
  if (void* p = operator new(size, std::nothrow)) return p;
  throw std::bad_alloc();
}
void operator delete(void* p) noexcept {
  std::free(p);
}
void operator delete(void* p, std::size_t) noexcept {
  std::free(p);
}
void operator delete(void* p, const std::nothrow_t&) noexcept {
  std::free(p);
}
#endif

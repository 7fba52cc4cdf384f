// operator new, counted: to show that a warm step allocates nothing.

#include "sim/allocations.h"

#include <atomic>
#include <cstdlib>
#include <new>

namespace {
std::atomic<std::size_t> count{0};
}

namespace obscura::sim {
std::size_t allocations() { return count; }
}  // namespace obscura::sim

// not inlined: the compiler would take malloc and operator delete for a mismatched pair
[[gnu::noinline]] void* operator new(std::size_t size) {
  ++count;
  if (void* place = std::malloc(size ? size : 1)) return place;
  throw std::bad_alloc();
}
[[gnu::noinline]] void* operator new(std::size_t size, const std::nothrow_t&) noexcept {
  ++count;
  return std::malloc(size ? size : 1);
}
[[gnu::noinline]] void operator delete(void* place, const std::nothrow_t&) noexcept { std::free(place); }
[[gnu::noinline]] void operator delete(void* place) noexcept { std::free(place); }
[[gnu::noinline]] void operator delete(void* place, std::size_t) noexcept { std::free(place); }

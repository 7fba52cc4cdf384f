#include "media/opened.h"

#include <dlfcn.h>
#include <sys/mman.h>

#include <cstddef>
#include <cstring>
#include <new>

namespace obscura::media {
namespace {

// Whether memory is what the loader wants. It has no codes, but words, English where setlocale is not called;
// a segment that it cannot map may be forbidden too.
bool lacks_memory(const char* why) {
  if (std::strstr(why, "Cannot allocate memory")) return true;
  if (!std::strstr(why, "failed to map segment")) return false;
  constexpr std::size_t kLibrary = std::size_t(200) << 20;  // LLVM's addresses
  void* some =
      ::mmap(nullptr, kLibrary, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS | MAP_NORESERVE, -1, 0);
  if (some == MAP_FAILED) return true;
  ::munmap(some, kLibrary);
  return false;
}

}  // namespace

void* opened(const char* library) {
  void* handle = dlopen(library, RTLD_NOW | RTLD_LOCAL);
  const char* why = handle ? nullptr : dlerror();
  if (why && lacks_memory(why)) throw std::bad_alloc();
  return handle;
}

}  // namespace obscura::media

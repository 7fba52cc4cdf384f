#include "gl/context.h"

#include <dlfcn.h>
#include <sys/mman.h>

#include <cstdlib>
#include <cstring>
#include <mutex>
#include <new>

#include "gl/backends.h"
#include "gl/error.h"

namespace obscura::gl {
namespace {

// Mesa reads these once, when its first screen is made.
void set_environment(bool native) {
  constexpr int keep = 0;
  // the same bytes on every x86-64: no fused multiply-add, no wider vectors
  if (!native) setenv("GALLIUM_OVERRIDE_CPU_CAPS", "sse2", keep);
  // each renderer rasterises in its own thread
  setenv("LP_NUM_THREADS", "0", keep);
  // EGL: the software driver, never a GPU
  setenv("LIBGL_ALWAYS_SOFTWARE", "1", keep);
}

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

void ready(const ContextOptions& options) {
  static std::once_flag once;
  std::call_once(once, set_environment, options.native);
}

std::unique_ptr<Context> create(const ContextOptions& options) {
  ready(options);

  switch (options.backend) {
    case Backend::osmesa:
      return create_osmesa();
    case Backend::egl:
      return create_egl();
    case Backend::automatic:
      break;
  }
  std::string tried;
  try {
    return create_osmesa();
  } catch (const Error& error) {
    tried = error.what();
  }
  try {
    return create_egl();
  } catch (const Error& error) {
    throw Error("no OpenGL context: " + tried + "; " + error.what());
  }
}

}  // namespace obscura::gl

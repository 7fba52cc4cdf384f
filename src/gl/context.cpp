#include "gl/context.h"

#include <cstdlib>
#include <mutex>

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

}  // namespace

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

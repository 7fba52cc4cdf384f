#pragma once

#include "gl/error.h"
#include "gl/renderer.h"
#include "needs.h"

namespace obscura::gl {

/// Whether this back end is installed.
inline bool opens(Backend backend) {
  try {
    Renderer(16, 16, {.backend = backend});
    return true;
  } catch (const Error&) {
    return false;
  }
}

}  // namespace obscura::gl

/// Of a test that compares them.
#define OBSCURA_NEEDS_BOTH_BACK_ENDS()                                 \
  OBSCURA_NEEDS(gl::opens(Backend::osmesa) && gl::opens(Backend::egl), \
                "libosmesa6, libegl1 and "                             \
                "libegl-mesa0")

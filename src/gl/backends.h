#pragma once

#include <memory>

#include "gl/context.h"

namespace obscura::gl {

/// A context of Mesa's off-screen library, opened at run time. Throws gl::Error.
std::unique_ptr<Context> create_osmesa();

/// A context of EGL without a surface, drawn in software. Throws gl::Error, also where only a GPU answers.
std::unique_ptr<Context> create_egl();

}  // namespace obscura::gl

#pragma once

#include <memory>
#include <string>

namespace obscura::gl {

enum class Backend { automatic, osmesa, egl };

/// An off-screen OpenGL 4.5 core context. Each thread that draws has its own.
class Context {
 public:
  virtual ~Context() = default;
  /// Makes it this thread's current context.
  virtual void make_current() = 0;
  /// The address of a GL function, or null.
  virtual void* function(const char* name) const = 0;
  virtual std::string backend() const = 0;          // "OSMesa", "EGL (surfaceless)"
};

struct ContextOptions {
  Backend backend = Backend::automatic;             // OSMesa where it is, then software EGL; never a GPU
  bool native = false;                              // leave out GALLIUM_OVERRIDE_CPU_CAPS=sse2
};

/// Creates a context and makes it current. Throws gl::Error saying what was tried and which package has it.
std::unique_ptr<Context> create(const ContextOptions& options);

}  // namespace obscura::gl

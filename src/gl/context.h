#pragma once

#include <memory>
#include <string>

namespace obscura::gl {

enum class Backend { automatic, osmesa, egl };

/// An off-screen OpenGL core context, 4.5 where there is one and 3.3 at least. Each thread that draws has its
/// own.
class Context {
 public:
  virtual ~Context() = default;
  /// Makes it this thread's current context. No other thread may have it current, nor this thread another; it
  /// may wait for other threads' contexts.
  virtual void make_current() = 0;
  /// Leaves this thread without a current context, so that another may take it.
  virtual void release() = 0;
  /// The address of a GL function, or null.
  virtual void* function(const char* name) const = 0;
  virtual std::string backend() const = 0;  // "OSMesa", "EGL (surfaceless)"
};

struct ContextOptions {
  Backend backend = Backend::automatic;  // OSMesa where it is, then software EGL; never a GPU
  bool native = false;  // leave out GALLIUM_OVERRIDE_CPU_CAPS=sse2; the process's first context decides
};

/// Sets Mesa's environment variables for the process, except those that the user has set; once. Call it
/// before there are threads: a thread that reads the environment meanwhile may crash.
void ready(const ContextOptions& options);

/// Creates a context and makes it current. Throws gl::Error saying what was tried and which package has it,
/// and std::bad_alloc where memory was wanting. Initialises on the first call.
std::unique_ptr<Context> create(const ContextOptions& options);

}  // namespace obscura::gl

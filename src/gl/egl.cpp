#define EGL_NO_X11
#include <EGL/egl.h>
#include <EGL/eglext.h>
#include <dlfcn.h>

#include <array>
#include <mutex>

#include "gl/backends.h"
#include "gl/error.h"
#include "gl/functions.h"
#include "media/opened.h"

namespace obscura::gl {
namespace {

struct EglLibrary {
  decltype(&::eglGetProcAddress) GetProcAddress = nullptr;
  decltype(&::eglGetPlatformDisplay) GetPlatformDisplay = nullptr;
  decltype(&::eglInitialize) Initialize = nullptr;
  decltype(&::eglBindAPI) BindAPI = nullptr;
  decltype(&::eglChooseConfig) ChooseConfig = nullptr;
  decltype(&::eglCreateContext) CreateContext = nullptr;
  decltype(&::eglDestroyContext) DestroyContext = nullptr;
  decltype(&::eglMakeCurrent) MakeCurrent = nullptr;
  EGLDisplay display = EGL_NO_DISPLAY;
  EGLConfig config = nullptr;
  // held while one of the contexts is current: all have one screen (osmesa.cpp)
  mutable std::mutex drawing;

  // opened and initialised once for the process, never terminated: other threads' contexts live on the same
  // display
  EglLibrary() {
    void* handle = media::opened("libEGL.so.1");
    if (!handle) throw Error("EGL: libEGL.so.1 cannot be opened (packages libegl1 and libgl1-mesa-dri)");
    const auto find = [&](auto& f, const char* name) {
      f = reinterpret_cast<std::decay_t<decltype(f)>>(dlsym(handle, name));
      if (!f) throw Error(std::string("EGL: ") + name + " is missing: EGL 1.5 is needed (package libegl1)");
    };
    find(GetProcAddress, "eglGetProcAddress");
    find(GetPlatformDisplay, "eglGetPlatformDisplay");
    find(Initialize, "eglInitialize");
    find(BindAPI, "eglBindAPI");
    find(ChooseConfig, "eglChooseConfig");
    find(CreateContext, "eglCreateContext");
    find(DestroyContext, "eglDestroyContext");
    find(MakeCurrent, "eglMakeCurrent");

    display = GetPlatformDisplay(EGL_PLATFORM_SURFACELESS_MESA, EGL_DEFAULT_DISPLAY, nullptr);
    if (display == EGL_NO_DISPLAY || !Initialize(display, nullptr, nullptr)) {
      throw Error("EGL: no display without a surface (packages libegl1, libegl-mesa0 and libgl1-mesa-dri)");
    }
    BindAPI(EGL_OPENGL_API);
    const EGLint wanted[] = {EGL_SURFACE_TYPE, 0, EGL_RENDERABLE_TYPE, EGL_OPENGL_BIT, EGL_NONE};
    EGLint count = 0;
    if (!ChooseConfig(display, wanted, &config, 1, &count) || count < 1)
      throw Error("EGL: no configuration for OpenGL");
  }
};

const EglLibrary& egl_library() {
  static const EglLibrary library;
  return library;
}

class Egl final : public Context {
 public:
  Egl() : lib_(egl_library()), turn_(lib_.drawing) {
    lib_.BindAPI(EGL_OPENGL_API);
    for (const auto& [major, minor] : {std::array{4, 5}, std::array{3, 3}}) {
      const EGLint attributes[] = {EGL_CONTEXT_MAJOR_VERSION,
                                   major,
                                   EGL_CONTEXT_MINOR_VERSION,
                                   minor,
                                   EGL_CONTEXT_OPENGL_PROFILE_MASK,
                                   EGL_CONTEXT_OPENGL_CORE_PROFILE_BIT,
                                   EGL_NONE};
      if (context_ == EGL_NO_CONTEXT)
        context_ = lib_.CreateContext(lib_.display, lib_.config, EGL_NO_CONTEXT, attributes);
    }
    if (context_ == EGL_NO_CONTEXT) throw Error("EGL: no core context of OpenGL 3.3 or newer");
    try {
      make_current();
      refuse_gpu();
    } catch (...) {
      close();
      throw;
    }
  }

  ~Egl() override { close(); }
  Egl(const Egl&) = delete;
  Egl& operator=(const Egl&) = delete;

  void make_current() override {
    if (!turn_.owns_lock()) turn_.lock();
    // the API is bound thread by thread
    lib_.BindAPI(EGL_OPENGL_API);
    if (!lib_.MakeCurrent(lib_.display, EGL_NO_SURFACE, EGL_NO_SURFACE, context_)) {
      turn_.unlock();
      throw Error("EGL: the context cannot be made current");
    }
  }
  void release() override {
    if (!turn_.owns_lock()) return;
    lib_.MakeCurrent(lib_.display, EGL_NO_SURFACE, EGL_NO_SURFACE, EGL_NO_CONTEXT);
    turn_.unlock();
  }
  void* function(const char* name) const override {
    return reinterpret_cast<void*>(lib_.GetProcAddress(name));
  }
  std::string backend() const override { return "EGL (surfaceless)"; }

 private:
  void refuse_gpu() const {
    const std::string device = Functions(*this).string(GL_RENDERER);
    for (const char* software : {"llvmpipe", "softpipe", "swrast"}) {
      if (device.find(software) != std::string::npos) return;
    }
    throw Error("EGL: " + device + " is no software renderer (package libgl1-mesa-dri)");
  }
  void close() {
    release();
    const std::scoped_lock alone(lib_.drawing);
    lib_.DestroyContext(lib_.display, context_);
  }

  const EglLibrary& lib_;
  std::unique_lock<std::mutex> turn_;  // while it is current
  EGLContext context_ = EGL_NO_CONTEXT;
};

}  // namespace

std::unique_ptr<Context> create_egl() { return std::make_unique<Egl>(); }

}  // namespace obscura::gl

#include <dlfcn.h>

#include <array>
#include <cerrno>
#include <cstdint>
#include <new>

#include "gl/backends.h"
#include "gl/error.h"
#include "media/opened.h"

namespace obscura::gl {
namespace {

// <GL/osmesa.h> is gone where Mesa is newer than 25.0, so its five functions and nine names are here.
using OSMesaContext = void*;
constexpr int kFormat = 0x22, kRgba = 0x1908, kDepthBits = 0x30, kStencilBits = 0x31, kAccumBits = 0x32;
constexpr int kProfile = 0x33, kCoreProfile = 0x34, kMajor = 0x36, kMinor = 0x37;
constexpr unsigned kUnsignedByte = 0x1401;

struct OsMesaLibrary {
  OSMesaContext (*create)(const int* attributes, OSMesaContext share) = nullptr;
  void (*destroy)(OSMesaContext) = nullptr;
  unsigned char (*make_current)(OSMesaContext, void* buffer, unsigned type, int width, int height) = nullptr;
  void* (*function)(const char* name) = nullptr;

  // opened once and never closed: Mesa's and LLVM's exit handlers stay behind
  OsMesaLibrary() {
    void* handle = nullptr;
    for (const char* name : {"libOSMesa.so.8", "libOSMesa.so"}) {
      if (!handle) handle = media::opened(name);
    }
    if (!handle) throw Error("OSMesa: libOSMesa.so.8 cannot be opened (package libosmesa6)");
    const auto find = [&](auto& f, const char* name) {
      f = reinterpret_cast<std::decay_t<decltype(f)>>(dlsym(handle, name));
      if (!f)
        throw Error(std::string("OSMesa: ") + name +
                    " is missing (package libosmesa6 of Mesa 11.2 or newer)");
    };
    find(create, "OSMesaCreateContextAttribs");
    find(destroy, "OSMesaDestroyContext");
    find(make_current, "OSMesaMakeCurrent");
    find(function, "OSMesaGetProcAddress");
  }
};

const OsMesaLibrary& os_mesa_library() {
  static const OsMesaLibrary library;
  return library;
}

class OsMesa final : public Context {
 public:
  OsMesa() : lib_(os_mesa_library()) {
    for (const auto& [major, minor] : {std::array{4, 5}, std::array{3, 3}}) {
      const int attributes[] = {kFormat,  kRgba,        kDepthBits, 0,     kStencilBits, 0,     kAccumBits, 0,
                                kProfile, kCoreProfile, kMajor,     major, kMinor,       minor, 0};
      errno = 0;
      if (!context_) context_ = lib_.create(attributes, nullptr);
    }
    if (!context_ && errno == ENOMEM) throw std::bad_alloc();
    if (!context_) throw Error("OSMesa: no core context of OpenGL 3.3 or newer");
    try {
      make_current();
    } catch (...) {
      lib_.destroy(context_);
      throw;
    }
  }

  // before its buffer is freed: it is flushed into
  ~OsMesa() override {
    release();
    lib_.destroy(context_);
  }

  OsMesa(const OsMesa&) = delete;
  OsMesa& operator=(const OsMesa&) = delete;

  void make_current() override {
    if (!lib_.make_current(context_, buffer_.data(), kUnsignedByte, kSide, kSide)) {
      throw Error("OSMesa: the context cannot be made current");
    }
  }
  void release() override { lib_.make_current(nullptr, nullptr, 0, 0, 0); }
  void* function(const char* name) const override { return lib_.function(name); }
  std::string backend() const override { return "OSMesa"; }

 private:
  // its own buffer goes unused: pictures are drawn into a framebuffer object
  static constexpr int kSide = 16;
  const OsMesaLibrary& lib_;
  OSMesaContext context_ = nullptr;
  std::array<std::uint8_t, 4 * kSide * kSide> buffer_{};
};

}  // namespace

std::unique_ptr<Context> create_osmesa() { return std::make_unique<OsMesa>(); }

}  // namespace obscura::gl

#include <dlfcn.h>
#include <sys/mman.h>
#include <sys/resource.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <memory>
#include <mutex>
#include <new>
#include <string>
#include <system_error>
#include <thread>
#include <vector>

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

// It draws for one thread at a time. A library has one screen; Mesa 22 looks through the drawing lists of all
// its contexts when it reads a texture, while their threads free them, and every Mesa fills the pixels of one
// of them after another. Threads that draw side by side have a copy of the library each.
class OsMesaLibrary {
 public:
  // opened once and never closed: Mesa's and LLVM's exit handlers stay behind
  explicit OsMesaLibrary(void* handle) {
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

  OSMesaContext (*create)(const int* attributes, OSMesaContext share) = nullptr;
  void (*destroy)(OSMesaContext) = nullptr;
  unsigned char (*make_current)(OSMesaContext, void* buffer, unsigned type, int width, int height) = nullptr;
  void* (*function)(const char* name) = nullptr;
  std::mutex drawing;  // held while one of its contexts is current
  int contexts = 0;
};

/// The process's libraries; contexts are made and destroyed one after another, for copies share Mesa's table
/// of functions.
class OsMesaLibraries {
 public:
  std::mutex making;
  std::mutex table;  // held where functions may be added to it

  /// A library without contexts, else a new copy, else the one with the fewest.
  OsMesaLibrary& borrow() {
    if (all_.empty()) all_.push_back(std::make_unique<OsMesaLibrary>(first_opened()));
    const auto least = [](const auto& a, const auto& b) { return a->contexts < b->contexts; };
    auto free = std::min_element(all_.begin(), all_.end(), least);
    if ((*free)->contexts > 0 && all_.size() < std::max(1u, std::thread::hardware_concurrency())) {
      if (void* copy = copied((*all_.front()).create))
        free = all_.insert(all_.end(), std::make_unique<OsMesaLibrary>(copy));
    }
    ++(*free)->contexts;
    return **free;
  }
  void give_back(OsMesaLibrary& library) { --library.contexts; }

 private:
  static void* first_opened() {
    for (const char* name : {"libOSMesa.so.8", "libOSMesa.so"}) {
      if (void* handle = media::opened(name)) return handle;
    }
    throw Error("OSMesa: libOSMesa.so.8 cannot be opened (package libosmesa6)");
  }

  // The library that has this function once more, from a file in memory: to the loader it is another. The
  // file stays open, so that no other has its name. Null where that cannot be: it counts as a file that is
  // as large as it may be (ulimit -f), and half a library, mapped, ends the program with SIGBUS.
  template <class F>
  static void* copied(F function) {
    Dl_info info{};
    if (!dladdr(reinterpret_cast<void*>(function), &info) || !info.dli_fname) return nullptr;
    std::error_code none;
    const std::uintmax_t size = std::filesystem::file_size(info.dli_fname, none);
    rlimit most{};
    if (none || ::getrlimit(RLIMIT_FSIZE, &most) != 0 || size > most.rlim_cur) return nullptr;
    std::ifstream from(info.dli_fname, std::ios::binary);
    const int file = memfd_create("libOSMesa", MFD_CLOEXEC);
    if (file < 0) return nullptr;
    const std::string name = "/proc/self/fd/" + std::to_string(file);
    void* handle = nullptr;
    if (std::ofstream to(name, std::ios::binary);
        to << from.rdbuf() && to.flush() && std::filesystem::file_size(name, none) == size)
      handle = dlopen(name.c_str(), RTLD_NOW | RTLD_LOCAL);
    if (!handle) ::close(file);
    return handle;
  }

  std::vector<std::unique_ptr<OsMesaLibrary>> all_;
};

// never destroyed: Mesa's threads may outlive static objects
OsMesaLibraries& libraries() {
  static OsMesaLibraries& all = *new OsMesaLibraries;
  return all;
}

class OsMesa final : public Context {
 public:
  OsMesa() {
    {
      const std::scoped_lock alone(libraries().making);
      lib_ = &libraries().borrow();
      turn_ = std::unique_lock(lib_->drawing);
      const std::scoped_lock table(libraries().table);
      for (const auto& [major, minor] : {std::array{4, 5}, std::array{3, 3}}) {
        const int attributes[] = {kFormat, kRgba,      kDepthBits, 0,        kStencilBits,
                                  0,       kAccumBits, 0,          kProfile, kCoreProfile,
                                  kMajor,  major,      kMinor,     minor,    0};
        errno = 0;
        if (!context_) context_ = lib_->create(attributes, nullptr);
      }
    }
    try {
      if (!context_ && errno == ENOMEM) throw std::bad_alloc();
      if (!context_) throw Error("OSMesa: no core context of OpenGL 3.3 or newer");
      make_current();
    } catch (...) {
      close();
      throw;
    }
  }

  ~OsMesa() override {
    release();
    close();
  }

  OsMesa(const OsMesa&) = delete;
  OsMesa& operator=(const OsMesa&) = delete;

  void make_current() override {
    if (!turn_.owns_lock()) turn_.lock();
    if (!lib_->make_current(context_, buffer_.data(), kUnsignedByte, kSide, kSide)) {
      turn_.unlock();
      throw Error("OSMesa: the context cannot be made current");
    }
  }
  void release() override {
    if (!turn_.owns_lock()) return;
    lib_->make_current(nullptr, nullptr, 0, 0, 0);
    turn_.unlock();
  }
  void* function(const char* name) const override {
    const std::scoped_lock table(libraries().table);
    return lib_->function(name);
  }
  std::string backend() const override { return "OSMesa"; }

 private:
  // before its buffer is freed: it is flushed into
  void close() {
    if (turn_.owns_lock()) turn_.unlock();
    const std::scoped_lock alone(libraries().making, lib_->drawing);
    if (context_) lib_->destroy(context_);
    libraries().give_back(*lib_);
  }

  // its own buffer goes unused: pictures are drawn into a framebuffer object
  static constexpr int kSide = 16;
  OsMesaLibrary* lib_ = nullptr;
  std::unique_lock<std::mutex> turn_;  // while it is current
  OSMesaContext context_ = nullptr;
  std::array<std::uint8_t, 4 * kSide * kSide> buffer_{};
};

}  // namespace

std::unique_ptr<Context> create_osmesa() { return std::make_unique<OsMesa>(); }

}  // namespace obscura::gl

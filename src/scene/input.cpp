#include "scene/input.h"

#include <fcntl.h>
#include <poll.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <streambuf>
#include <system_error>

namespace obscura::scene {

namespace {

constexpr int kPatience = 100;  // ms between two questions

bool (*asked_to_stop)() = nullptr;

[[noreturn]] void unreadable() { throw std::system_error(errno, std::generic_category()); }

}  // namespace

void heed(bool (*stop)()) { asked_to_stop = stop; }

void stop_if_asked() {
  if (asked_to_stop && asked_to_stop()) throw Stopped{};
}

class Input::Buffer : public std::streambuf {
 public:
  // open() of a named pipe without a writer would block
  explicit Buffer(const std::string& file)
      : owned_(file != "-"),
        descriptor_(owned_ ? ::open(file.c_str(), O_RDONLY | O_NONBLOCK | O_CLOEXEC) : STDIN_FILENO) {
    if (descriptor_ < 0) unreadable();
  }
  ~Buffer() override {
    if (owned_) ::close(descriptor_);
  }
  Buffer(const Buffer&) = delete;
  Buffer& operator=(const Buffer&) = delete;

 protected:
  int_type underflow() override {
    for (;;) {
      wait();
      const ::ssize_t n = ::read(descriptor_, bytes_.data(), bytes_.size());
      if (n > 0) {
        setg(bytes_.data(), bytes_.data(), bytes_.data() + n);
        return traits_type::to_int_type(bytes_[0]);
      }
      if (n == 0) {
        // the end of a pipe whose writer the same signal ended
        stop_if_asked();
        return traits_type::eof();
      }
      if (errno != EINTR && errno != EAGAIN) unreadable();
    }
  }

 private:
  // until there is something to read, or the end. A signal that comes before poll() does not cut it short: so
  // it is asked again from time to time
  void wait() const {
    for (;;) {
      stop_if_asked();
      struct pollfd one {
        descriptor_, POLLIN, 0
      };
      const int n = ::poll(&one, 1, kPatience);
      if (n > 0) return;
      if (n < 0 && errno != EINTR) unreadable();
    }
  }

  bool owned_;
  int descriptor_;
  std::array<char, 65536> bytes_{};
};

Input::Input(const std::string& file) : std::istream(nullptr), buffer_(std::make_unique<Buffer>(file)) {
  rdbuf(buffer_.get());
  exceptions(std::ios::badbit);
}

Input::~Input() = default;

}  // namespace obscura::scene

#include "media/file.h"

#include <fcntl.h>
#include <poll.h>
#include <sys/stat.h>
#include <unistd.h>

#include <atomic>
#include <cerrno>
#include <cstring>
#include <filesystem>
#include <system_error>
#include <utility>

#include "media/error.h"

namespace obscura::media {

namespace fs = std::filesystem;

namespace {

[[noreturn]] void fail(const std::string& path, const char* what, int code) {
  throw Error(path + ": " + what + ": " + std::generic_category().message(code));
}

// a signal is no failure: asked again
template <class Call>
int again(Call&& call) {
  int result;
  while ((result = call()) < 0 && errno == EINTR) {
  }
  return result;
}

// hidden, in the same directory (rename does not cross file systems), told apart by process and by count
std::string temporary_beside(const fs::path& target) {
  static std::atomic<unsigned> count{0};
  const std::string name = target.filename().string().substr(0, 200);
  const std::string own = std::to_string(getpid()) + '-' + std::to_string(count++);
  return (target.parent_path() / ('.' + name + '.' + own + ".tmp")).string();
}

}  // namespace

void make_folder_of(const std::string& path) {
  const fs::path folder = fs::path(path).parent_path();
  std::error_code error;
  if (!folder.empty()) fs::create_directories(folder, error);
  if (error) throw Error(folder.string() + ": cannot make this folder: " + error.message());
}

void remove_leftovers(const std::string& folder, const std::function<bool(const std::string& name)>& ours) {
  std::error_code error;
  for (const auto& entry : fs::directory_iterator(folder.empty() ? "." : folder, error)) {
    // .NAME.PROCESS-COUNT.tmp
    const std::string name = entry.path().filename().string();
    if (!name.starts_with('.') || !name.ends_with(".tmp")) continue;
    const std::size_t own = name.find_last_of('.', name.size() - 5);
    if (own == 0 || own == std::string::npos || !ours(name.substr(1, own - 1))) continue;
    std::error_code ignored;
    fs::remove(entry.path(), ignored);
  }
}

int write_all(int descriptor, std::span<const std::uint8_t> bytes) noexcept {
  while (!bytes.empty()) {
    const ssize_t n = ::write(descriptor, bytes.data(), bytes.size());
    if (n >= 0) {
      bytes = bytes.subspan(std::size_t(n));
    } else if (errno == EAGAIN) {
      // the other end set the pipe not to block: wait for room
      pollfd room{descriptor, POLLOUT, 0};
      ::poll(&room, 1, -1);
    } else if (errno != EINTR) {
      return errno;
    }
  }
  return 0;
}

File::File(const std::string& path) : path_(path) {
  std::error_code ignored;
  fs::path target = path;
  // a link stays a link: the file that it points at is replaced
  if (fs::is_symlink(target, ignored)) {
    const fs::path real = fs::weakly_canonical(target, ignored);
    if (!ignored) target = real;
  }
  target_ = target.string();

  const fs::file_status status = fs::status(target, ignored);
  if (fs::is_directory(status)) fail(path, "cannot write", EISDIR);
  const bool in_place = fs::exists(status) && !fs::is_regular_file(status);
  temporary_ = in_place ? target_ : temporary_beside(target);
  const int flags = O_RDWR | O_CLOEXEC | (in_place ? 0 : O_CREAT | O_EXCL);
  descriptor_ = again([&] { return ::open(temporary_.c_str(), flags, 0666); });
  if (descriptor_ < 0 && in_place)
    descriptor_ = again([&] { return ::open(temporary_.c_str(), O_WRONLY | O_CLOEXEC); });
  if (descriptor_ < 0) fail(path, "cannot write", errno);
}

File::File(File&& other) noexcept
    : path_(std::move(other.path_)),
      target_(std::move(other.target_)),
      temporary_(std::move(other.temporary_)),
      descriptor_(std::exchange(other.descriptor_, -1)) {
  other.temporary_.clear();
}

File::~File() {
  if (descriptor_ >= 0) ::close(descriptor_);
  if (!temporary_.empty() && temporary_ != target_) ::unlink(temporary_.c_str());
}

void File::write(std::span<const std::uint8_t> bytes) {
  if (const int code = write_all(descriptor_, bytes)) fail(path_, "cannot write", code);
}

void File::place(bool durable, const std::string& instead) {
  // a file that cannot be synced (a pipe, a device) gives EINVAL or EROFS, and has no disk to wait for
  if (durable && again([&] { return ::fsync(descriptor_); }) != 0 && errno != EINVAL && errno != EROFS) {
    fail(path_, "cannot write to disk", errno);
  }
  // a close that a signal met has closed all the same
  if (::close(std::exchange(descriptor_, -1)) != 0 && errno != EINTR) fail(path_, "cannot close", errno);
  if (temporary_ != target_) {
    const std::string& final_name = instead.empty() ? target_ : instead;
    if (::rename(temporary_.c_str(), final_name.c_str()) != 0) {
      fail(instead.empty() ? path_ : instead, "cannot rename into place", errno);
    }
  }
  temporary_.clear();
}

}  // namespace obscura::media

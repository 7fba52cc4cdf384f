// A library that is loaded before libc (LD_PRELOAD) and lets one call of a program fail, or ends or stops the
// program there: the n-th of the calls that change what is under a folder. What is asked for comes by the
// environment:
//
//   FAULTS_UNDER   the folder, an absolute path; calls elsewhere are let through and are not counted
//   FAULTS_CALLS   which are counted, as in "write,fsync"; left out: all. Where a named pipe in the folder is
//                  read: "poll", "after-poll", "read", "after-read", "close"; these get signals and do not
//                  fail
//   FAULTS_NTH     which of them fails, from 1
//   FAULTS_WITH    ENOSPC, EIO, EINTR, or "short": a write of half of what there is; or a signal that the
//   process
//                  gets before the call, which is made if it lives: KILL, STOP, INT, TERM, HUP
//   FAULTS_ON      "from": it and all after it; left out: it alone
//   FAULTS_LOG     a file that gets a line for the call that failed
//
// Written to C's library alone: what it is loaded into may have any C++ library.

#include <dlfcn.h>
#include <fcntl.h>
#include <limits.h>
#include <poll.h>
#include <signal.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <sys/syscall.h>
#include <sys/uio.h>
#include <unistd.h>
#include <atomic>

#include <cerrno>

namespace {

std::atomic<long> calls{0};

bool starts(const char* text, const char* with) { return strncmp(text, with, strlen(with)) == 0; }

// read before there are threads: what sets the environment in one of them moves it under those who read
struct Asked {
  const char *under = getenv("FAULTS_UNDER"), *calls = getenv("FAULTS_CALLS"), *nth = getenv("FAULTS_NTH"),
             *with = getenv("FAULTS_WITH"), *on = getenv("FAULTS_ON"), *log = getenv("FAULTS_LOG");
};

const Asked& asked() {
  static const Asked once;
  return once;
}

[[gnu::constructor]] void ask() { asked(); }

bool is_under(const char* path) { return asked().under && starts(path, asked().under); }

// the path of a call, seen from the folder of the process
bool is_under_from(int at, const char* path) {
  if (path[0] == '/') return is_under(path);
  char whole[2 * PATH_MAX] = "";
  if (at == AT_FDCWD) {
    if (!getcwd(whole, PATH_MAX)) return false;
  } else {
    char link[64];
    snprintf(link, sizeof link, "/proc/self/fd/%d", at);
    const ssize_t n = readlink(link, whole, PATH_MAX - 1);
    if (n < 0) return false;
    whole[n] = 0;
  }
  strcat(whole, "/");
  strncat(whole, path, PATH_MAX - 1);
  return is_under(whole);
}

mode_t mode_of(int descriptor) {
  struct stat facts;
  return syscall(SYS_newfstatat, descriptor, "", &facts, AT_EMPTY_PATH) == 0 ? facts.st_mode : 0;
}

bool has_path_under(int descriptor) {
  char link[64], path[PATH_MAX];
  snprintf(link, sizeof link, "/proc/self/fd/%d", descriptor);
  const ssize_t n = readlink(link, path, sizeof path - 1);
  if (n < 0) return false;
  path[n] = 0;
  return is_under(path);
}

bool is_under(int descriptor) {
  const mode_t mode = mode_of(descriptor);
  return (S_ISREG(mode) || S_ISDIR(mode)) && has_path_under(descriptor);
}

bool is_pipe_under(int descriptor) { return S_ISFIFO(mode_of(descriptor)) && has_path_under(descriptor); }

bool is_counted(const char* call) {
  const char* wanted = asked().calls;
  if (!wanted) return true;
  const size_t length = strlen(call);
  for (const char* at = wanted; (at = strstr(at, call)); at += length)
    if ((at == wanted || at[-1] == ',') && (at[length] == 0 || at[length] == ',')) return true;
  return false;
}

void tell(long n, const char* call) {
  const char* log = asked().log;
  if (!log) return;
  char line[128];
  const int length = snprintf(line, sizeof line, "%ld %s\n", n, call);
  const long file = syscall(SYS_openat, AT_FDCWD, log, O_WRONLY | O_CREAT | O_APPEND, 0666);
  if (file < 0) return;
  syscall(SYS_write, file, line, length);
  syscall(SYS_close, file);
}

// the signal of this name; 0: it is none
int signal_of(const char* name) {
  constexpr struct {
    const char* name;
    int number;
  } all[] = {{"KILL", SIGKILL}, {"STOP", SIGSTOP}, {"INT", SIGINT}, {"TERM", SIGTERM}, {"HUP", SIGHUP}};
  for (const auto& one : all)
    if (strcmp(name, one.name) == 0) return one.number;
  return 0;
}

// Whether this call fails, once it is known to be one that counts. 0: it goes through; -1: a short write.
int fault(const char* call) {
  if (!is_counted(call)) return 0;
  const char *nth = asked().nth, *with = asked().with, *on = asked().on;
  if (!nth || !with) return 0;
  const long n = ++calls, wanted = atol(nth);
  if (n != wanted && !(on && n > wanted)) return 0;
  tell(n, call);
  if (const int signal = signal_of(with)) {
    raise(signal);  // to this thread: it is delivered before the call goes on
    return 0;
  }
  if (strcmp(with, "short") == 0) return -1;
  return strcmp(with, "EIO") == 0 ? EIO : strcmp(with, "EINTR") == 0 ? EINTR : ENOSPC;
}

bool fails(bool ours, const char* call) {
  const int keep = errno;
  const int error = ours ? fault(call) : 0;
  errno = error > 0 ? error : keep;
  return error > 0;
}

// a moment of reading a pipe: signals come here, faults do not
void pass(bool ours, const char* moment) {
  const int keep = errno;
  if (ours) fault(moment);
  errno = keep;
}

template <class F>
F* next(const char* name) {
  return reinterpret_cast<F*>(dlsym(RTLD_NEXT, name));
}

bool writes(int flags) { return (flags & O_ACCMODE) != O_RDONLY || (flags & O_CREAT) != 0; }

}  // namespace

#define NEXT(name) static auto* const real = next<decltype(name)>(#name)

extern "C" {

ssize_t write(int descriptor, const void* bytes, size_t size) {
  NEXT(write);
  const int keep = errno, error = is_under(descriptor) ? fault("write") : 0;
  errno = keep;
  if (error > 0) return errno = error, -1;
  return real(descriptor, bytes, error < 0 ? (size + 1) / 2 : size);
}

ssize_t pwrite64(int descriptor, const void* bytes, size_t size, off64_t at) {
  NEXT(pwrite64);
  const int keep = errno, error = is_under(descriptor) ? fault("write") : 0;
  errno = keep;
  if (error > 0) return errno = error, -1;
  return real(descriptor, bytes, error < 0 ? (size + 1) / 2 : size, at);
}
ssize_t pwrite(int descriptor, const void* bytes, size_t size, off_t at) {
  return pwrite64(descriptor, bytes, size, at);
}

ssize_t writev(int descriptor, const iovec* parts, int count) {
  NEXT(writev);
  const int keep = errno, error = is_under(descriptor) ? fault("write") : 0;
  errno = keep;
  if (error > 0) return errno = error, -1;
  return real(descriptor, parts, error < 0 && count > 1 ? 1 : count);
}

ssize_t read(int descriptor, void* bytes, size_t size) {
  NEXT(read);
  const bool ours = is_pipe_under(descriptor);
  pass(ours, "read");
  const ssize_t n = real(descriptor, bytes, size);
  pass(ours, "after-read");
  return n;
}

int poll(pollfd* all, nfds_t count, int milliseconds) {
  NEXT(poll);
  const bool ours = count == 1 && is_pipe_under(all->fd);
  pass(ours, "poll");
  const int n = real(all, count, milliseconds);
  pass(ours, "after-poll");
  return n;
}

int fsync(int descriptor) {
  NEXT(fsync);
  return fails(is_under(descriptor), "fsync") ? -1 : real(descriptor);
}
int fdatasync(int descriptor) {
  NEXT(fdatasync);
  return fails(is_under(descriptor), "fsync") ? -1 : real(descriptor);
}

// as on Linux: the descriptor is gone, whatever close says
int close(int descriptor) {
  NEXT(close);
  pass(is_pipe_under(descriptor), "close");
  if (!fails(is_under(descriptor), "close")) return real(descriptor);
  const int error = errno;
  real(descriptor);
  errno = error;
  return -1;
}

int ftruncate64(int descriptor, off64_t size) {
  NEXT(ftruncate64);
  return fails(is_under(descriptor), "ftruncate") ? -1 : real(descriptor, size);
}
int ftruncate(int descriptor, off_t size) { return ftruncate64(descriptor, size); }

int rename(const char* from, const char* to) {
  NEXT(rename);
  return fails(is_under_from(AT_FDCWD, to), "rename") ? -1 : real(from, to);
}
int link(const char* from, const char* to) {
  NEXT(link);
  return fails(is_under_from(AT_FDCWD, to), "rename") ? -1 : real(from, to);
}
int symlink(const char* from, const char* to) {
  NEXT(symlink);
  return fails(is_under_from(AT_FDCWD, to), "rename") ? -1 : real(from, to);
}

int mkdir(const char* path, mode_t mode) {
  NEXT(mkdir);
  return fails(is_under_from(AT_FDCWD, path), "mkdir") ? -1 : real(path, mode);
}

int unlink(const char* path) {
  NEXT(unlink);
  return fails(is_under_from(AT_FDCWD, path), "unlink") ? -1 : real(path);
}
int unlinkat(int at, const char* path, int flags) {
  NEXT(unlinkat);
  return fails(is_under_from(at, path), "unlink") ? -1 : real(at, path, flags);
}
int remove(const char* path) {
  NEXT(remove);
  return fails(is_under_from(AT_FDCWD, path), "unlink") ? -1 : real(path);
}
int rmdir(const char* path) {
  NEXT(rmdir);
  return fails(is_under_from(AT_FDCWD, path), "unlink") ? -1 : real(path);
}

int open64(const char* path, int flags, ...) {
  NEXT(open64);
  va_list more;
  va_start(more, flags);
  const mode_t mode = flags & O_CREAT ? mode_t(va_arg(more, int)) : 0;
  va_end(more);
  return fails(writes(flags) && is_under_from(AT_FDCWD, path), "open") ? -1 : real(path, flags, mode);
}
int open(const char* path, int flags, ...) {
  NEXT(open);
  va_list more;
  va_start(more, flags);
  const mode_t mode = flags & O_CREAT ? mode_t(va_arg(more, int)) : 0;
  va_end(more);
  return fails(writes(flags) && is_under_from(AT_FDCWD, path), "open") ? -1 : real(path, flags, mode);
}
int openat(int at, const char* path, int flags, ...) {
  NEXT(openat);
  va_list more;
  va_start(more, flags);
  const mode_t mode = flags & O_CREAT ? mode_t(va_arg(more, int)) : 0;
  va_end(more);
  return fails(writes(flags) && is_under_from(at, path), "open") ? -1 : real(at, path, flags, mode);
}

FILE* fopen64(const char* path, const char* how) {
  NEXT(fopen64);
  return fails(how[0] != 'r' && is_under_from(AT_FDCWD, path), "open") ? nullptr : real(path, how);
}
FILE* fopen(const char* path, const char* how) { return fopen64(path, how); }

}  // extern "C"

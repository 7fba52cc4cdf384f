#include "app/console/memory.h"

#include <sys/mman.h>
#include <sys/resource.h>
#include <unistd.h>

#include <algorithm>
#include <charconv>
#include <csignal>
#include <cstdlib>
#include <exception>
#include <fstream>
#include <limits>
#include <new>

#include <fmt/format.h>

#include "app/console/exit.h"

namespace obscura::app {

namespace {

#if defined(__SANITIZE_ADDRESS__)
constexpr bool kHolds = false;  // the sanitizer's own maps are beyond any limit
#elif defined(__has_feature)
constexpr bool kHolds = !__has_feature(address_sanitizer);
#else
constexpr bool kHolds = true;
#endif

double soft_limit(int which) {
  rlimit limit{};
  if (::getrlimit(__rlimit_resource_t(which), &limit) != 0 || limit.rlim_cur == RLIM_INFINITY)
    return std::numeric_limits<double>::infinity();
  return double(limit.rlim_cur);
}

// the memory of this machine, or of this process's control group
double memory_there() {
  double bytes = double(::sysconf(_SC_PHYS_PAGES)) * double(::sysconf(_SC_PAGESIZE));
  for (const char* file : {"/sys/fs/cgroup/memory.max", "/sys/fs/cgroup/memory/memory.limit_in_bytes"}) {
    double most = 0;
    if (std::ifstream(file) >> most && most > 0) bytes = std::min(bytes, most);
  }
  return bytes;
}

// nothing but what a signal handler may call
[[noreturn]] void end_without_memory() {
  constexpr char kWords[] = "obscura: out of memory\n";
  (void)!::write(STDERR_FILENO, kWords, sizeof kWords - 1);
  ::_exit(kFiles);
}

bool can_map(std::size_t size, int access) {
  void* some = ::mmap(nullptr, size, access, MAP_PRIVATE | MAP_ANONYMOUS | MAP_NORESERVE, -1, 0);
  if (some == MAP_FAILED) return false;
  ::munmap(some, size);
  return true;
}

// a fault that comes while there is no memory to be had comes of that
void judge_fault(int signal) {
  if (!can_map(std::size_t(64) << 20, PROT_READ | PROT_WRITE)) end_without_memory();
  std::signal(signal, SIG_DFL);
  ::raise(signal);
}

// on a thread without a handler
void judge_exception() {
  try {
    if (const auto error = std::current_exception()) std::rethrow_exception(error);
  } catch (const std::bad_alloc&) {
    end_without_memory();
  } catch (...) {
  }
  std::abort();
}

}  // namespace

double most_memory() { return 0.9 * memory_there(); }

double memory_limit() { return std::min({soft_limit(RLIMIT_DATA), soft_limit(RLIMIT_AS), memory_there()}); }

void hold_memory(double bytes) {
  rlimit limit{};
  if (!kHolds || ::getrlimit(RLIMIT_DATA, &limit) != 0) return;
  if (double(limit.rlim_cur) <= bytes) return;
  limit.rlim_cur = rlim_t(bytes);
  ::setrlimit(RLIMIT_DATA, &limit);
}

void require_memory_to_draw(double pixels) {
  // addresses for the libraries themselves and what they compile, and memory for what they keep
  constexpr double kAddresses = 300e6, kKept = 60e6, kPixel = 40;
  if (!(kPixel * pixels < 1e15)) throw std::bad_alloc();
  const bool there = can_map(std::size_t(kAddresses + kPixel * pixels), PROT_NONE) &&
                     can_map(std::size_t(kKept + kPixel * pixels), PROT_READ | PROT_WRITE);
  if (!there) throw std::bad_alloc();
}

std::string out_of_memory() {
  return fmt::format("out of memory: the limit is {}", bytes_text(memory_limit()));
}

void survive_libraries() {
  std::set_terminate(judge_exception);
  if (!kHolds) return;
  // a fault may be one of the stack: its handler has another
  static char stack[1 << 16];
  stack_t other{};
  other.ss_sp = stack, other.ss_size = sizeof stack;
  ::sigaltstack(&other, nullptr);
  struct sigaction action {};
  action.sa_handler = judge_fault;
  action.sa_flags = SA_ONSTACK | SA_NODEFER;
  for (const int signal : {SIGSEGV, SIGBUS, SIGABRT}) ::sigaction(signal, &action, nullptr);
}

double parse_bytes(const std::string& text) {
  double value = 0;
  const auto read = std::from_chars(text.data(), text.data() + text.size(), value);
  std::string unit(read.ptr, text.data() + text.size());
  std::erase(unit, ' ');
  std::transform(unit.begin(), unit.end(), unit.begin(),
                 [](unsigned char c) { return char(std::toupper(c)); });
  const bool binary = unit.size() == 3 && unit[1] == 'I' && unit[2] == 'B';
  const std::size_t power = unit.empty() || unit == "B" ? 0 : std::string("_KMGT").find(unit[0]);
  const bool good = unit.size() <= 1 || (unit.size() == 2 && unit[1] == 'B') || binary;
  if (read.ec != std::errc() || !good || power == std::string::npos || !(value > 0) || value > 1e18)
    throw UsageError(fmt::format("{}: expected a size, as in 500MB, 2GB or 1.5GiB", text));
  for (std::size_t k = 0; k < power; ++k) value *= binary ? 1024 : 1000;
  return value;
}

std::string bytes_text(double bytes) {
  if (bytes < 1e6) return fmt::format("{:.0f} kB", bytes / 1e3);
  if (bytes < 1e9) return fmt::format("{:.1f} MB", bytes / 1e6);
  if (bytes < 1e12) return fmt::format("{:.2f} GB", bytes / 1e9);
  return fmt::format("{:.1f} TB", bytes / 1e12);
}

}  // namespace obscura::app

#include "app/console/waiting.h"

#include <unistd.h>

#include <chrono>
#include <cstdio>
#include <system_error>

#include <fmt/format.h>

#include "scene/complaints.h"

namespace obscura::app {

namespace {

constexpr std::chrono::milliseconds kQuiet(2000), kBetween(500);

// the text for the only Waiting
struct Notices {
  std::mutex mutex;
  std::condition_variable_any ended;
  bool heard = false;  // progress has been reported
  int hushed = 0;
  bool shown = false;
  std::string what;
  double done = 0, of = 0;
  std::string unit;
};

Notices& said() {
  static Notices it;
  return it;
}

// requires the mutex
void clear(Notices& it) {
  if (!it.shown) return;
  it.shown = false;
  std::fputs("\033[K", stderr);
  std::fflush(stderr);
}

}  // namespace

Waiting::Waiting(const std::string& command) : command_(command) {
  if (command.empty() || isatty(STDERR_FILENO) != 1) return;
  try {
    teller_ = std::jthread([this](std::stop_token stop) { tell(stop); });
    const std::lock_guard lock(said().mutex);
    said().heard = true;
  } catch (const std::system_error&) {
    // without a thread nothing is shown
  }
}

Waiting::~Waiting() {
  if (!teller_.joinable()) return;
  teller_.request_stop();
  teller_.join();
  const std::lock_guard lock(said().mutex);
  said().heard = false;
  clear(said());
}

void Waiting::tell(std::stop_token stop) {
  using Clock = std::chrono::steady_clock;
  const Clock::time_point began = Clock::now();
  Notices& it = said();
  std::unique_lock lock(it.mutex);
  const auto over = [&] { return stop.stop_requested(); };
  for (auto wait = kQuiet; !it.ended.wait_for(lock, stop, wait, over) && !over(); wait = kBetween) {
    if (it.hushed > 0) continue;
    std::string line = command_;
    if (!it.what.empty()) line += "  " + it.what;
    if (it.of > 0) line += fmt::format("  {:.4g}/{:.4g} {}", it.done, it.of, it.unit);
    line += fmt::format("  {:.0f} s", std::chrono::duration<double>(Clock::now() - began).count());
    // back at the line's beginning, so that what is printed next stands over it
    std::fputs(("\r" + scene::one_line(line) + "\033[K\r").c_str(), stderr);
    std::fflush(stderr);
    it.shown = true;
  }
}

void doing(const std::string& what, double done, double of, const std::string& unit) {
  Notices& it = said();
  const std::lock_guard lock(it.mutex);
  if (!it.heard) return;
  if (it.what != what) it.what = what;
  if (it.unit != unit) it.unit = unit;
  it.done = done, it.of = of;
}

void clear_waiting() {
  const std::lock_guard lock(said().mutex);
  clear(said());
}

Hushed::Hushed() {
  const std::lock_guard lock(said().mutex);
  ++said().hushed;
  clear(said());
}

Hushed::~Hushed() {
  const std::lock_guard lock(said().mutex);
  --said().hushed;
}

}  // namespace obscura::app

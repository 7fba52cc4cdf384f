#pragma once

#include <condition_variable>
#include <mutex>
#include <string>
#include <thread>

namespace obscura::app {

/// Says on a terminal what a command is doing once it takes longer than two seconds, on one line of standard
/// error that is redrawn and cleared; nothing elsewhere. Commands that show a Progress say no more than that.
class Waiting {
 public:
  /// Waits in the name of `command`, until it is destroyed. At most one at a time.
  explicit Waiting(const std::string& command);
  ~Waiting();
  Waiting(const Waiting&) = delete;
  Waiting& operator=(const Waiting&) = delete;

 private:
  void tell(std::stop_token stop);

  std::string command_;
  std::jthread teller_;
};

/// The current work and its progress: "reading a.toml"; "simulating", 3.2 of 10 "s". Cheap enough to be
/// said at every instant of a run. From every thread.
void doing(const std::string& what, double done = 0, double of = 0, const std::string& unit = "");

/// Clears the line before something else is printed; it comes back half a second later.
void clear_waiting();

/// Silences Waiting while it lives: something else shows the progress.
class Hushed {
 public:
  Hushed();
  ~Hushed();
  Hushed(const Hushed&) = delete;
  Hushed& operator=(const Hushed&) = delete;
};

}  // namespace obscura::app

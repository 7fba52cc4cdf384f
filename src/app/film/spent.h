#pragma once

#include <chrono>
#include <optional>
#include <string>

namespace obscura::app {

/// Work of so many seconds is not thrown away without being asked.
inline constexpr double kWorthKeeping = 60;

/// The time spent on an unfinished output, in a small file beside it, by which to decide whether it may be
/// thrown away. A failure to write it is ignored.
class Spent {
 public:
  /// The time that an earlier process wrote to the file.
  explicit Spent(std::string path);
  ~Spent();
  Spent(const Spent&) = delete;
  Spent& operator=(const Spent&) = delete;

  /// The time of earlier processes, s; none if they did not write it.
  std::optional<double> before() const { return before_; }
  /// Work begins: from now on the time is counted, on top of `before`.
  void begin(double before);
  /// Puts down how long it is by now, once a second.
  void note();
  /// The file goes: the thing is whole, or gone.
  void remove();

 private:
  using Clock = std::chrono::steady_clock;
  void write();

  std::string path_;
  std::optional<double> before_;
  bool counting_ = false;
  Clock::time_point began_, written_;
};

}  // namespace obscura::app

#pragma once

#include <chrono>
#include <cstdint>
#include <optional>
#include <string>

#include "app/console/waiting.h"

namespace obscura::app {

enum class ProgressKind { automatic, plain, json, none };

/// One calm line about how far a film is, on standard error: redrawn in place on a terminal, a line now and
/// then elsewhere, JSON lines for programs.
class Progress {
 public:
  /// `what` is made; `frames` of it; a frame lasts `frame_seconds` of the film. `unit`: the thing that is
  /// counted if it is not frames, as "runs"; `frame_seconds` is then ignored.
  Progress(ProgressKind kind, std::string what, std::int64_t frames, double frame_seconds,
           std::string unit = "frames");
  ~Progress();

  /// So many frames are done.
  void at(std::int64_t done);
  /// Clears the line; prints the summary, unless asked for silence.
  void finish(std::int64_t done, const std::string& summary, bool to_stdout);

  double seconds() const;

 private:
  void print(std::int64_t done, bool last);
  void clear();

  ProgressKind kind_;
  bool terminal_ = false, shown_ = false;
  std::optional<Hushed> hushed_;  // while it shows something
  std::string what_, unit_;
  std::int64_t frames_;
  double frame_seconds_;
  std::chrono::steady_clock::time_point began_, printed_;
  std::int64_t first_ = -1;
  std::chrono::steady_clock::time_point first_at_;
};

}  // namespace obscura::app

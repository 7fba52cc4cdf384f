#pragma once

#include <istream>
#include <memory>
#include <string>

namespace obscura::scene {

/// Thrown where reading a pipe was ended.
struct Stopped {};

/// Sets the function that a waiting read of a pipe calls ten times a second; if it returns true, the wait
/// ends. Call once, before anything is read. None: reads wait for ever.
void heed(bool (*stop)());

/// Throws Stopped where an end has been asked for: before what was read is judged, for a pipe that the same
/// signal has closed is cut short.
void stop_if_asked();

/// A file, a named pipe, or standard input ("-"), as a stream. Its functions throw Stopped where reading
/// a pipe is ended, and std::system_error where it cannot be read.
class Input : public std::istream {
 public:
  /// Throws std::system_error where it cannot be opened.
  explicit Input(const std::string& file);
  ~Input() override;

 private:
  class Buffer;
  std::unique_ptr<Buffer> buffer_;
};

}  // namespace obscura::scene

#pragma once

#include <istream>
#include <memory>
#include <string>

namespace obscura::scene {

/// Thrown where the wait for a pipe was ended.
struct Stopped {};

/// What an idle pipe asks ten times a second: true ends the wait. Set once, before anything is read; none: it
/// waits for ever.
void heed(bool (*stop)());

/// A file, a named pipe, or standard input ("-"), as a stream. Its functions throw Stopped where the wait for
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

#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "app/run/origin.h"
#include "media/image.h"

namespace obscura::app {

/// The pictures of a file or folder in their order: one still, the PNGs of a folder and of those in it, the
/// frames of a movie.
class Frames {
 public:
  enum class Kind { still, folder, movie };

  /// Throws media::Error naming the path where there is nothing of the kind.
  explicit Frames(const std::string& path);
  ~Frames();
  Frames(Frames&&) noexcept;

  Kind kind() const;
  /// For a folder the names of its PNGs as seen from there ("sub/0001.png"), numbers in them by their value;
  /// else empty.
  const std::vector<std::string>& names() const;
  /// For a folder: reads only these, in this order.
  void only(std::vector<std::string> names);

  /// The next picture. False after the last. Throws media::Error.
  bool next(media::Image& image);
  /// For the last picture: its file's name, of a folder as in names(), or "frame 12"; its time (s) if known;
  /// its origin, or that of the whole movie.
  std::string name() const;
  std::optional<double> time() const;
  const std::optional<Origin>& origin() const;
  /// Of a movie, s: to what the times of its frames are rounded; else 0.
  double tick() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

/// A file's bytes, and their hash. Throws media::Error.
std::string file_bytes(const std::string& path);
std::string file_hash(const std::string& path);

}  // namespace obscura::app

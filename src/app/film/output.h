#pragma once

#include <cstdint>
#include <optional>
#include <string>

namespace obscura::app {

/// The destination of a film. The form of the name chooses it: a movie, a sequence of PNGs, one PNG, a pipe.
struct Output {
  enum class Form { movie, frames, still, pipe };
  Form form = Form::movie;
  std::string path;    // of frames: with its pattern, {frame:04} or %04d
  bool plain = false;  // the path has no pattern, whatever stands in it

  /// The file of frame n. Requires: frames or still.
  std::string file(std::int64_t n) const;
  /// The name beside `path` of a film that ended early: room.partial.mp4.
  std::string partial() const;
  /// The folders for finished parts of an unfinished film, and for checkpoints that were asked for:
  /// room.mp4.parts, room.mp4.checkpoints; for frames/{frame:04}.png frames/frame.png.parts.
  std::string parts() const;
  std::string checkpoints() const;
};

/// Requires, for --no-overwrite, that there is no such file yet. Throws media::Error.
void require_fresh(const std::string& file);

/// Reads OUT. None: render_out/<name>.mp4, or .png for a still. A folder's name with its slash takes
/// {frame:04}.png. Throws UsageError: a sequence without a pattern, an ending that is not known, a pattern
/// for one still.
Output output(const std::optional<std::string>& out, const std::string& name, bool still,
              std::int64_t frames);

}  // namespace obscura::app

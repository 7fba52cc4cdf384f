#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "app/shots.h"
#include "media/image.h"
#include "scene/scene.h"

namespace obscura::app {

/// XXH3-128 as 32 hexadecimal digits.
std::string hash(const void* bytes, std::size_t size);
std::string hash(const std::string& text);

/// The hash of a state's words (sim/state.h): equal exactly when the states are.
std::string state_hash(const std::vector<std::uint64_t>& words);

/// What made a picture or a movie: enough to make it again, and to say why another one differs.
struct Origin {
  std::string scene_hash, scene_file, scene_text;
  std::vector<std::string> sets;
  int width = 0, height = 0;
  std::string theme, fps;
  std::string gl_version, gl_renderer;
  bool native = false;
  std::optional<Shot> shot;  // of a still or a frame; of a movie its first frame
  std::string state;         // the hash of the state it shows
  std::int64_t frames = 0;   // of a movie

  /// As the tags of a file: "Software", "Title", and the whole as JSON under "obscura".
  media::Tags tags(const std::string& title) const;
};

}  // namespace obscura::app

#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <nlohmann/json_fwd.hpp>

#include "app/run/checksums.h"
#include "app/run/shots.h"
#include "app/run/table.h"
#include "media/image.h"
#include "scene/scene.h"

namespace obscura::app {

/// XXH3-128 as 32 hexadecimal digits.
std::string hash(const void* bytes, std::size_t size);
std::string hash(const std::string& text);

/// The hash of a state's words (sim/model/state.h): equal exactly when the states are.
std::string state_hash(const std::vector<std::uint64_t>& words);

/// The whole number that a file holds, none where it is no such from `least` to `most`.
std::optional<std::int64_t> whole(const nlohmann::json& json, std::int64_t least, std::int64_t most);

/// How a picture or a movie was made: enough to make it again, and to say why another one differs.
struct Origin {
  std::string version;  // of obscura
  std::string scene_hash, scene_file, scene_text;
  std::vector<std::string> sets;
  int width = 0, height = 0;
  std::string theme, fps;
  std::string camera;  // the one of several that is shown; empty: all there are
  bool transparent = false;
  std::string gl_version, gl_renderer;
  bool native = false;
  std::optional<Shot> shot;         // of a still or a frame; of a movie its first frame
  std::string state;                // the hash of the state it shows
  std::optional<Checksums> states;  // of all that it shows; origins before 0.2 have none
  std::int64_t frames = 0;          // of a movie
  std::string shots;                // of a movie: which frames of the film (Shots::text)
  std::string encoder, preset;      // of a movie
  std::optional<double> crf;
  std::vector<std::string> programs;  // forces that a program computed, by name: none can be computed again
  std::string trajectory;             // the file of another program's run, where that is shown
  std::shared_ptr<const Table> run;   // that run, where it is at hand; not in the file

  /// The program and library that drew it: "obscura 0.2.0, OpenGL 4.5 (Core Profile) Mesa 22.3.6, llvmpipe
  /// (LLVM 15.0.6, 256 bits)".
  std::string drawn_by() const;

  /// "--set ball.mass=2 --set seed=3"; empty where no keys were set.
  std::string set_flags() const;

  /// As the tags of a file: "Software", "Title", and the whole as JSON under "obscura".
  media::Tags tags(const std::string& title) const;
};

/// Why pictures of two origins cannot be of one film, in words: "the size is 640x360 there, and
/// 320x180 here". Empty where nothing does; frame, instant and state may differ.
std::string discord(const Origin& there, const Origin& here);

/// The part of an origin that all pictures of a scene share.
Origin origin_of(const scene::Scene& scene);

/// The origin that a file's tags carry; none where they carry none, or not all of it.
std::optional<Origin> origin_in(const media::Tags& tags);

/// The scene as it was filmed: its text, what was set, its size, theme, frame rate and camera, and another
/// program's run where that is at hand. Throws scene::Error where this obscura does not read it, media::Error
/// where the run is not one of it.
scene::Scene scene_of(const Origin& origin);

/// The shots of it that a movie shows, or the one of a still. Throws UsageError where the scene has no such.
Shots shots_of(const Origin& origin, const scene::Scene& scene);

/// Keeps only the camera of this name. Throws UsageError if there is none.
void choose_camera(const std::string& name, scene::Scene& scene);

}  // namespace obscura::app

#pragma once

#include <optional>
#include <string>
#include <utility>

#include "app/console/progress.h"
#include "app/film/output.h"
#include "app/run/shots.h"
#include "gl/context.h"
#include "media/movie.h"
#include "media/pipe.h"
#include "scene/scene.h"

namespace obscura::app {

/// How a film is made, beyond what its scene says.
struct FilmOptions {
  int workers = 0;  // 0: one a core
  gl::ContextOptions context;
  ProgressKind progress = ProgressKind::automatic;
  media::PipeFormat pipe = media::PipeFormat::y4m;
  bool overwrite = true;
  bool transparent = false;  // PNG with the ground left out

  bool resume = false;                       // go on from what is whole
  bool anew = false;                         // whatever is there
  std::optional<std::pair<int, int>> shard;  // i of n, from 1: only this share, not joined
  std::optional<int> prepare;                // draw nothing: leave what so many shards begin with
  sim::Rational checkpoint_every{0, 1};      // s; 0: none are kept when the film is whole
  std::optional<std::string> from_checkpoint;
};

/// The encoder settings for this scene.
media::MovieSpec movie_spec(const scene::Scene& scene);

/// How many frames of such an output one worker makes at a time.
int take_frames(Output::Form form, const media::MovieSpec& spec);

/// Simulates, draws and writes the shots of a scene. Returns an exit code; throws the errors of the rooms.
int film(const scene::Scene& scene, const Shots& shots, const Output& output, const FilmOptions& options);

}  // namespace obscura::app

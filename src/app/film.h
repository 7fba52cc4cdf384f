#pragma once

#include <string>

#include "app/output.h"
#include "app/progress.h"
#include "app/shots.h"
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
};

/// What libav is asked for by this scene.
media::MovieSpec movie_spec(const scene::Scene& scene);

/// Simulates, draws and writes the shots of a scene. Returns an exit code; throws the errors of the rooms.
int film(const scene::Scene& scene, const Shots& shots, const Output& output, const FilmOptions& options);

}  // namespace obscura::app

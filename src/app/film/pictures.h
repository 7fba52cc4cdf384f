#pragma once

#include <string>
#include <vector>

#include "app/run/origin.h"
#include "app/run/shots.h"
#include "gl/context.h"
#include "media/image.h"
#include "scene/scene.h"

namespace obscura::app {

/// A picture as `render` would write it, and where it comes from.
struct Pictured {
  media::Image image;
  Origin origin;
};

struct PictureOptions {
  gl::ContextOptions context;
  bool transparent = false;
};

/// Simulates and draws the shots of a scene in this thread. Fewer come back when a signal asks for an end.
/// Throws TroubleError where the run cannot go on, and the errors of gl.
std::vector<Pictured> pictures(const scene::Scene& scene, const Shots& shots,
                               const PictureOptions& options = {});

}  // namespace obscura::app

#include "app/film/pictures.h"

#include "app/film/frame_renderer.h"
#include "app/run/ahead.h"
#include "app/run/simulation.h"
#include "app/run/trouble.h"

namespace obscura::app {

std::vector<Pictured> pictures(const scene::Scene& scene, const Shots& shots, const PictureOptions& options) {
  const Ahead ahead = app::ahead(scene);
  Simulation simulation(scene, shots, ahead, {.frames = 1, .hash_each = true});
  FrameRenderer darkroom(scene, ahead, options.context);
  std::vector<Pictured> all;
  while (const auto take = simulation.next()) {
    Pictured one;
    one.origin = origin_of(scene);
    one.origin.native = options.context.native, one.origin.transparent = options.transparent;
    one.origin.gl_version = darkroom.renderer().version();
    one.origin.gl_renderer = darkroom.renderer().device();
    one.origin.shot = take->shots[0], one.origin.state = take->states[0];
    one.origin.states = checksums(take->states[0], take->all_bodies(0));
    one.image = darkroom.print(*take, 0, options.transparent);
    // a file without alpha reads as opaque
    if (!options.transparent)
      for (std::size_t i = 3; i < one.image.pixels.size(); i += 4) one.image.pixels[i] = 255;
    all.push_back(std::move(one));
  }
  if (simulation.trouble()) throw TroubleError(scene.file, *simulation.trouble(), "");
  return all;
}

}  // namespace obscura::app

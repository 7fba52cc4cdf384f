#include "app/pictures.h"

#include "app/simulation.h"
#include "app/trouble.h"
#include "gl/renderer.h"

namespace obscura::app {

std::vector<Pictured> pictures(const scene::Scene& scene, const Shots& shots, const PictureOptions& options) {
  Simulation simulation(scene, shots, {.frames = 1, .hash_each = true});
  gl::Renderer renderer(scene.film.width, scene.film.height, options.context);
  const draw::Depictor artist = depictor(scene);
  std::vector<Pictured> all;
  while (const auto take = simulation.next()) {
    Pictured one;
    one.origin = origin_of(scene);
    one.origin.native = options.context.native, one.origin.transparent = options.transparent;
    one.origin.gl_version = renderer.version(), one.origin.gl_renderer = renderer.device();
    one.origin.shot = take->shots[0], one.origin.state = take->states[0];
    draw::Picture picture = artist.depict(take->moments[0], take->ways);
    picture.transparent = options.transparent;
    renderer.draw(picture, one.image);
    // a file without alpha reads as opaque
    if (!options.transparent)
      for (std::size_t i = 3; i < one.image.pixels.size(); i += 4) one.image.pixels[i] = 255;
    all.push_back(std::move(one));
  }
  if (simulation.trouble()) throw TroubleError(scene.file, *simulation.trouble(), "");
  return all;
}

}  // namespace obscura::app

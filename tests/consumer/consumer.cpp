// Steps a scene, and takes three of its frames as arrays of bytes.

#include <cstdio>
#include <variant>

#include "app/film/pictures.h"
#include "scene/scene.h"

int main(int argc, char** argv) {
  using namespace obscura;
  if (argc != 2) return 2;
  scene::Scene scene = scene::read(argv[1]);

  // where everything is, step by step
  const auto run = scene.run();
  for (int step = 0; step <= 60; step += 20) {
    const auto outcome = run->at(sim::rational(step) / run->rate());
    const auto* now = std::get_if<sim::Snapshot>(&outcome);
    if (!now) return 6;
    for (std::size_t i = 0; i < now->bodies.size(); ++i)
      std::printf("%s at %g s: %.17g %.17g\n", run->scene_info().bodies[i].name.c_str(), now->time,
                  now->bodies[i].position.x(), now->bodies[i].position.y());
  }

  // what it looks like: RGBA, row 0 at the top
  scene.film.width = 160, scene.film.height = 90;
  const app::Shots shots = app::Shots::stills({sim::rational(0), sim::rational(1, 10)}, scene.film.fps);
  for (const app::Pictured& frame : app::pictures(scene, shots))
    std::printf("frame of %dx%d, %zu bytes, state %s\n", frame.image.width, frame.image.height,
                frame.image.pixels.size(), frame.origin.state.c_str());
}

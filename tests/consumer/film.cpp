// A film, frame by frame, and the height of its ball.

#include <obscura/obscura.h>

#include <cstdio>

int main(int argc, char** argv) {
  if (argc != 3) return 2;
  const obscura::Scene scene = obscura::Scene::read(argv[1]);
  obscura::World world(scene);
  obscura::Renderer renderer(scene, {.width = 160, .height = 90, .fps = "30"});
  obscura::Movie movie(argv[2], renderer);

  const int ball = world.body("ball");
  for (int n = 0; n < renderer.frames(); ++n) {
    world.step_to(n / renderer.fps());
    movie.add(renderer.draw(world));
    std::printf("%.2f s: %.3f m high\n", world.time(), world.positions()(ball, 1));
  }
  movie.close();
}

// A force of our own: a spring from every body to the middle of the room, in every stage of the integrator.

#include <obscura/obscura.h>

#include <cstdio>

int main() {
  obscura::Builder room;
  room.set("room.size", {4, 4}).set("room.gravity", {0, 0}).set("room.walls", "none");
  room.add("ball",
           {{"name", "ball"}, {"radius", 0.1}, {"mass", 2}, {"position", {3, 2}}, {"velocity", {0, 1}}});

  const auto spring = [](const obscura::Stage& stage, const obscura::Push& push) {
    for (std::size_t i = 0; i < stage.positions.rows; ++i) {
      push.forces[2 * i] = -8 * (stage.positions(i, 0) - 2);
      push.forces[2 * i + 1] = -8 * (stage.positions(i, 1) - 2);
    }
  };
  const obscura::Scene scene = room.build("middle").with_force("spring", spring);

  // with k/m = 4/s^2 it is back where it began after pi seconds
  obscura::World world(scene);
  world.step_to(3.14159265358979);
  std::printf("%.3f %.3f\n", world.positions()(0, 0), world.positions()(0, 1));
}

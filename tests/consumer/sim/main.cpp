// A world made by hand, of the simulation alone; without velocities it is an error with a name.

#include <cstdio>
#include <variant>

#include "sim/step/run.h"

int main() {
  using namespace obscura::sim;
  World<2> world;
  Body<2> ball;
  ball.name = "ball";
  world.model.bodies = {ball};
  world.state.x = {{0, 1}};
  const auto wrong = run(world)->at({1, 10});
  std::printf("%s %s\n", std::get<Trouble>(wrong).quantity.c_str(), std::get<Trouble>(wrong).what.c_str());
  world.state.v = {{1, 0}};
  const auto found = run(world)->at({1, 10});
  std::printf("%.6f %.6f\n", std::get<Snapshot>(found).bodies[0].position.x(),
              std::get<Snapshot>(found).bodies[0].position.y());
}

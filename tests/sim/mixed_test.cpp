// Bodies that keep the handout's law beside others that rest on forces.

#include <gtest/gtest.h>

#include "sim/rooms.h"

namespace obscura::sim {
namespace {

World<2> tumbling() {
  World<2> world = room();
  add_walls(world, 4, 3);
  add_particle(world, {1, 1}, {2, 0}, 0.5, 0.8, 0.1);
  add_box(world, {0.6, 0.4}, 1, {2.5, 1}, {-1, 0}, 0.4, 2, 0.7);
  return world;
}

TEST(Mixed, WhoKeepsTheHandoutsLawMovesByIt) {
  const State<2> alone = stepped(tumbling(), 1500);
  World<2> world = tumbling();
  world.model.collision = Collision::contact;
  world.model.solver = Solver::direct;  // whose free flight is that of the integrator
  for (Body<2>& body : world.model.bodies) body.handout = true;
  const State<2> state = stepped(world, 1500);
  // reckoned together here and by blocks there: roundings, made larger by a dozen impacts
  for (int i = 0; i < 2; ++i) EXPECT_LT((state.x[i] - alone.x[i]).norm(), 1e-9) << i;
}

TEST(Mixed, TheOthersDoNotNoticeThem) {
  World<2> world = tumbling();
  world.model.collision = Collision::contact;
  World<2> visited = world;
  add_box(visited, {0.6, 0.4}, 1, {2.5, 1.1});
  visited.model.bodies.back().handout = true;
  const State<2> without = stepped(world, 300), with = stepped(visited, 300);
  for (int i = 0; i < 2; ++i) EXPECT_LT((with.x[i] - without.x[i]).norm(), 1e-9) << i;
}

}  // namespace
}  // namespace obscura::sim

// A warm step allocates nothing.

#include <gtest/gtest.h>

#include "sim/allocations.h"
#include "sim/rooms.h"

namespace obscura::sim {
namespace {

TEST(Step, AllocatesNothingOnceWarm) {
  for (const auto integrator :
       {Integrator::rk4, Integrator::midpoint, Integrator::euler, Integrator::semi_implicit}) {
    World<2> world = room();
    world.model.integrator = integrator;
    add_walls(world, 4, 3);
    add_wall(world, {0, 0.5}, {0.2, 1});
    for (int i = 0; i < 300; ++i)
      add_particle(world, {0.1 + 0.012 * i, 2}, {2 - 0.01 * i, 1}, 1, 0.8, i % 2 ? 0 : 0.05);
    for (int i = 0; i < 30; ++i) add_box(world, {0.3, 0.2}, 1, {0.3 + 0.1 * i, 1.5}, {1, 0}, 0.1 * i, 1, 0.3);
    for (int i = 0; i < 50; ++i) add_spring(world, {i, {0, 0}}, {300 + i % 30, {0.15, 0.1}}, 10, 0.3, 0.1);
    world.model.mice.push_back({{{{1, 100}, {1, 1}}, {{3, 1}, {2, 1}}, {{9, 1}, {3, 2}}}, 0.1, 20, 0.1});
    State<2> state = world.state;
    Stepper<2> stepper(world.model);
    stepper.begin(state);
    for (int i = 0; i < 100; ++i) ASSERT_FALSE(stepper.step(state));
    std::size_t touches = 0;
    const std::size_t before = allocations();
    for (int i = 0; i < 1500; ++i) {
      const auto trouble = stepper.step(state);
      if (trouble) break;
      touches += state.touches.size();
    }
    EXPECT_EQ(allocations(), before) << int(integrator);
    EXPECT_EQ(state.step, 1600);
    EXPECT_GT(touches, 1000u) << "it must have met the walls";
  }
}

}  // namespace
}  // namespace obscura::sim

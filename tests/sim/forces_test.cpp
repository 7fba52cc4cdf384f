#include "sim/force/forces.h"
#include "sim/force/force_coupling.h"

#include <gtest/gtest.h>

#include <cmath>
#include <memory>
#include <variant>

#include "sim/allocations.h"
#include "sim/force/formula.h"
#include "sim/step/stepper.h"

namespace obscura::sim {
namespace {

std::shared_ptr<const ForceFormula> formula(const ForceText& text) {
  auto made = force_formula<2>(text, {});
  return std::make_shared<ForceFormula>(std::get<ForceFormula>(made));
}

World<2> charged_dust(int many, Collision collision) {
  World<2> world;
  world.model.collision = collision;
  world.model.scale = 10;
  for (int i = 0; i < many; ++i) {
    world.model.bodies.emplace_back();
    world.state.x.push_back({0.3 * i, std::sin(i)}), world.state.v.push_back({std::cos(i), 0});
  }
  return world;
}

template <class Takes>
Force<2> on(const World<2>& world, const ForceText& text, Takes&& takes) {
  Force<2> force;
  force.formula = formula(text);
  for (int i = 0; i < int(world.model.bodies.size()); ++i) {
    Subject<2> subject;
    subject.body = i, subject.mass = world.model.bodies[std::size_t(i)].mass, subject.copy = i;
    if (takes(i)) force.subjects.push_back(subject);
  }
  return force;
}

const ForceText kSwirl{.potential = "", .components = {"-0.3*vx*speed + i - x", "sin(t)*vx - y"}};

TEST(ForcesOfAModel, AWarmStepAllocatesNothing) {
  for (const Collision collision : {Collision::handout, Collision::contact}) {
    World<2> world = charged_dust(100, collision);
    world.model.solver = Solver::iterative;
    world.model.forces.push_back(on(world, kSwirl, [](int) { return true; }));
    Force<2> pairs = on(world, {.potential = "1/sqrt(r^2 + 1)", .components = {}, .pair = true},
                        [](int i) { return i % 2; });
    pairs.on = Force<2>::On::among;
    world.model.forces.push_back(pairs);
    Force<2> fall = pairs;
    fall.law = Force<2>::Law::gravitation, fall.strength = 0.1, fall.softening = 1;
    world.model.forces.push_back(fall);
    Stepper<2> stepper(world.model);
    stepper.begin(world.state);
    for (int i = 0; i < 30; ++i) ASSERT_FALSE(stepper.step(world.state));
    const std::size_t before = allocations();
    for (int i = 0; i < 30; ++i) ASSERT_FALSE(stepper.step(world.state));
    if (collision == Collision::handout) {
      EXPECT_EQ(allocations(), before);
    }
  }
}

// in blocks, or in one system with others: by the same operations
TEST(ForcesOfAModel, BodiesThatFlyGoAsThoseThatAreTied) {
  World<2> flies = charged_dust(300, Collision::handout);
  flies.model.forces.push_back(on(flies, kSwirl, [](int i) { return i % 3 != 0; }));
  World<2> tied = flies;
  for (int i = 0; i < 300; ++i) {
    Spring<2> none;
    none.a.body = i, none.b.local = {1, 1};
    tied.model.springs.push_back(none);
  }
  Stepper<2> a(flies.model), b(tied.model);
  a.begin(flies.state), b.begin(tied.state);
  for (int i = 0; i < 100; ++i) ASSERT_FALSE(a.step(flies.state) || b.step(tied.state));
  for (std::size_t i = 0; i < 300; ++i) EXPECT_LT((flies.state.x[i] - tied.state.x[i]).norm(), 1e-13) << i;
}

TEST(ForcesOfAModel, TellsWhichBodiesTheyTieTogetherAndKeepAwake) {
  World<2> world = charged_dust(6, Collision::contact);
  world.model.forces.push_back(
      on(world, {.potential = "x^2", .components = {}}, [](int i) { return i < 2; }));
  world.model.forces.push_back(
      on(world, {.potential = "x*sin(t)", .components = {}}, [](int i) { return i == 2; }));
  Force<2> pairs =
      on(world, {.potential = "r", .components = {}, .pair = true}, [](int i) { return i >= 4; });
  pairs.on = Force<2>::On::between;
  world.model.forces.push_back(pairs);
  const auto together = tied_by_forces(world.model);
  ASSERT_EQ(together.size(), 1u);
  EXPECT_EQ(together[0], (std::vector<int>{4, 5}));
  EXPECT_EQ(restless_by_forces(world.model, true), (std::vector<int>{2, 4, 5}));
  EXPECT_EQ(restless_by_forces(world.model, false), (std::vector<int>{0, 1, 2, 4, 5}));
}

}  // namespace
}  // namespace obscura::sim

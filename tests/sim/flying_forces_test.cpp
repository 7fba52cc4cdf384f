// Forces on bodies that fly are evaluated for many bodies at a time: to the bit as for each alone, by two
// lanes and by four.

#include "sim/force/flying_forces.h"

#include <gtest/gtest.h>

#include <cmath>
#include <memory>
#include <variant>
#include <vector>

#include "sim/force/formula.h"
#include "sim/math/lanes.h"
#include "sim/step/stepper.h"

namespace obscura::sim {
namespace {

constexpr int kMany = 203;  // no multiple of a block or of a lane

template <int D>
Force<D> formula(const std::vector<std::string>& components, int from, int step) {
  Force<D> force;
  auto made = force_formula<D>({.potential = "", .components = components}, {});
  force.formula = std::make_shared<ForceFormula>(std::get<ForceFormula>(made));
  for (int i = from; i < kMany; i += step) {
    Subject<D> subject;
    subject.body = i;
    subject.mass = i % 3 == 0 ? 0.5 : 1 + 0.01 * i;
    subject.copy = i;
    force.subjects.push_back(subject);
  }
  return force;
}

// drag on all, a field on every third, and a force that grows with the number on a stretch
template <int D>
World<D> dust() {
  World<D> world;
  world.model.collision = Collision::handout;
  world.model.scale = 100;
  for (int i = 0; i < kMany; ++i) {
    Body<D>& body = world.model.bodies.emplace_back();
    body.mass = i % 3 == 0 ? 0.5 : 1 + 0.01 * i;
    body.drag = i % 5 == 0 ? 0.2 : 0;
    Vec<D> x, v;
    for (int axis = 0; axis < D; ++axis) x[axis] = 0.01 * i + axis, v[axis] = std::sin(1.0 + i + 7 * axis);
    world.state.x.push_back(x), world.state.v.push_back(v);
  }
  std::vector<std::string> drag = {"-0.3*vx*speed", "-0.3*vy*speed"}, field = {"sin(x)*t", "x/(1 + y^2)"},
                           few = {"0.1*i", "-m*y"};
  if (D == 3) drag.push_back("-0.3*vz*speed"), field.push_back("exp(-z*z)"), few.push_back("vx*z");
  world.model.forces.push_back(formula<D>(drag, 0, 1));
  world.model.forces.push_back(formula<D>(field, 1, 3));
  world.model.forces.push_back(formula<D>(few, 150, 1));
  return world;
}

template <int D>
void expect_the_bits_of_each_alone() {
  const World<D> world = dust<D>();
  FlyingForces<D> forces(world.model);
  ASSERT_TRUE(forces.all());
  const auto rows = [](const std::vector<Vec<D>>& all) {
    std::vector<double> made;
    for (int axis = 0; axis < D; ++axis)
      for (const Vec<D>& each : all) made.push_back(each[axis]);
    return made;
  };
  const std::vector<double> x = rows(world.state.x), v = rows(world.state.v);
  std::vector<double> d(x.size()), rates(x.size(), -1);
  for (std::size_t i = 0; i < d.size(); ++i) d[i] = 1e-3 * std::cos(double(i));
  const double power = forces.accelerate(0.7, 0, kMany, x.data(), d.data(), v.data(), rates.data());
  double sum = 0;
  for (int i = 0; i < kMany; ++i) {
    double its[4][D];
    for (int axis = 0; axis < D; ++axis) {
      const std::size_t at = std::size_t(axis * kMany + i);
      its[0][axis] = x[at], its[1][axis] = d[at], its[2][axis] = v[at], its[3][axis] = -1;
    }
    sum += forces.accelerate(0.7, i, 1, its[0], its[1], its[2], its[3]);
    for (int axis = 0; axis < D; ++axis)
      EXPECT_EQ(rates[std::size_t(axis * kMany + i)], its[3][axis]) << i << " " << axis;
  }
  EXPECT_NEAR(power, sum, 1e-12 * std::fabs(sum));
  EXPECT_NE(power, 0);
}

TEST(FlyingForces, OfManyBodiesAreThoseOfEachAlone) {
  const bool wide = lanes::four_lanes;
  for (const bool four : {false, wide}) {
    lanes::four_lanes = four;
    expect_the_bits_of_each_alone<2>();
    expect_the_bits_of_each_alone<3>();
  }
  lanes::four_lanes = wide;
}

// A body's motion does not hang on which others are stepped beside it, nor on the width of the lanes.
template <int D>
void expect_the_motion_of_each_alone() {
  const auto after = [](World<D> world) {
    Stepper<D> stepper(world.model);
    stepper.begin(world.state);
    for (int i = 0; i < 20; ++i) EXPECT_FALSE(stepper.step(world.state));
    return world.state;
  };
  const State<D> all = after(dust<D>());
  const bool wide = lanes::four_lanes;
  lanes::four_lanes = false;
  const State<D> narrow = after(dust<D>());
  lanes::four_lanes = wide;
  for (int i = 0; i < kMany; ++i) EXPECT_EQ(all.x[std::size_t(i)], narrow.x[std::size_t(i)]) << i;
  EXPECT_EQ(all.work, narrow.work);
  for (const int i : {0, 64, 150, 202}) {
    World<D> one = dust<D>();
    for (Force<D>& force : one.model.forces)
      std::erase_if(force.subjects, [&](const Subject<D>& it) { return it.body != i; });
    one.model.bodies = {one.model.bodies[std::size_t(i)]};
    one.state.x = {one.state.x[std::size_t(i)]}, one.state.v = {one.state.v[std::size_t(i)]};
    for (Force<D>& force : one.model.forces)
      for (Subject<D>& it : force.subjects) it.body = 0;
    const State<D> its = after(one);
    EXPECT_EQ(its.x[0], all.x[std::size_t(i)]) << i;
    EXPECT_EQ(its.v[0], all.v[std::size_t(i)]) << i;
  }
}

TEST(FlyingForces, MoveEachBodyAsIfItWereAlone) {
  expect_the_motion_of_each_alone<2>();
  expect_the_motion_of_each_alone<3>();
}

}  // namespace
}  // namespace obscura::sim

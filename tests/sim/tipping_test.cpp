// Bodies that turn about an edge or a corner which friction holds, and what strikes them: by both solvers and
// at every rate.

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "sim/space_rooms.h"
#include "sim/units.h"

namespace obscura::sim {
namespace {

// a body in a room of 8 m with a floor
World<3> on_floor(Solver solver, int rate) {
  World<3> world = space({0, -kG, 0});
  world.model.scale = 8, world.model.rate = {rate, 1};
  world.model.collision = Collision::contact, world.model.solver = solver;
  add_wall(world, {0, 0, 0}, {0, 1, 0});
  return world;
}

// Physical pendulum about the edge, upside down:  a'' = m g r sin a / (I + m r^2), by fine steps of Runge and
// Kutta. The spin after `time` s.
double spin_after(double angle, double per_second_squared, double time) {
  const int steps = 20000;
  const double h = time / steps;
  double a = angle, w = 0;
  const auto rate = [&](double at) { return per_second_squared * std::sin(at); };
  for (int i = 0; i < steps; ++i) {
    const double k1 = rate(a), k2 = rate(a + 0.5 * h * w), k3 = rate(a + 0.5 * h * w + 0.25 * h * h * k1);
    const double k4 = rate(a + h * w + 0.5 * h * h * k2);
    a += h * w + h * h / 6 * (k1 + k2 + k3), w += h / 6 * (k1 + 2 * k2 + 2 * k3 + k4);
  }
  return w;
}

// A domino on its edge, 10 degrees beyond upright, a little above the floor: it lands with hardly any slip,
// and sticks. Friction along the slip of that instant for a whole step would throw it about.
TEST(Tipping, ADominoTurnsAboutItsEdge) {
  constexpr double kWide = 0.05, kHigh = 0.5, kMass = 1, kTime = 0.4;
  const double lean = 10 * std::numbers::pi / 180;
  for (const Solver solver : {Solver::direct, Solver::iterative}) {
    for (const int rate : {240, 600, 2400}) {
      for (const double above : {0.0, 2e-9, 1e-8}) {
        for (const double mu : {0.5, 2.0}) {
          World<3> world = on_floor(solver, rate);
          const Vec3 corner(0.5 * kWide, -0.5 * kHigh, 0);
          const Orientation<3> turn = exponential(Vec3(0, 0, -lean));
          const Vec3 arm = rotation<3>(turn) * corner;
          add_solid(world, brick({kWide, kHigh, 0.2}), kMass, {0, above - arm.y(), 0}, Vec3::Zero(), turn,
                    Vec3::Zero(), 0.5);
          world.model.bodies[0].friction = mu;
          const double before = energy(world, world.state);
          const State<3> now = stepped(world, int(std::lround(kTime * rate)));
          const double inertia = world.model.bodies[0].inertia[2] + kMass * corner.squaredNorm();
          const double begun = std::atan2(-arm.x(), -arm.y());
          const double expected = -spin_after(begun, kMass * kG * corner.norm() / inertia, kTime);
          SCOPED_TRACE(testing::Message() << (solver == Solver::direct ? "direct, " : "iterative, ") << rate
                                          << "/s, " << above << " m above, mu " << mu);
          // the iterative solver's angle is of first order in the step where it lands
          EXPECT_NEAR(now.spin[0].z(), expected, solver == Solver::direct ? 2e-3 : 8e-3);
          const double of_scheme = solver == Solver::direct ? 1e-9 : 1e-6;
          EXPECT_NEAR(energy(world, now), before, of_scheme * kMass * kG * kHigh + 2 * kMass * kG * above);
          EXPECT_NEAR(now.x[0].z(), 0, 1e-9);
        }
      }
    }
  }
}

// What springs do to the spin of a body in a step in which it is struck is not lost: angular momentum stays.
TEST(Tipping, SpringsTurnABodyInTheStepInWhichItIsStruck) {
  for (const int rate : {240, 600, 2400}) {
    World<3> world = space(Vec3::Zero());
    world.model.scale = 4, world.model.rate = {rate, 1};
    world.model.collision = Collision::contact, world.model.solver = Solver::iterative;
    add_solid(world, brick({0.6, 0.2, 0.3}), 2, Vec3::Zero(), Vec3::Zero(), no_rotation<3>(),
              Vec3(0.3, 0.9, 0.2), 0.5);
    add_solid(world, brick({0.2, 0.2, 0.2}), 1, {0.2, 0.8, 0.05}, {0, -8, 0.3}, no_rotation<3>(),
              Vec3::Zero(), 0.5);
    add_solid(world, brick({0.3, 0.3, 0.3}), 1.5, {-1.2, 0.4, 0.3}, Vec3::Zero(), no_rotation<3>(),
              Vec3::Zero(), 0.5);
    Spring<3> spring;
    spring.a = {0, Vec3(-0.3, 0.1, 0.15)}, spring.b = {2, Vec3(0.15, 0, 0)};
    spring.rest_length = 0.3, spring.stiffness = 40;
    world.model.springs.push_back(spring);
    const auto angular_momentum = [&](const State<3>& state) {
      Vec3 sum = Vec3::Zero();
      for (int i = 0; i < 3; ++i) {
        const Body<3>& body = world.model.bodies[std::size_t(i)];
        sum += body.mass * state.x[std::size_t(i)].cross(state.v[std::size_t(i)]) +
               inertia_times<3>(body.inertia, rotation<3>(state.turn[std::size_t(i)]),
                                state.spin[std::size_t(i)]);
      }
      return sum;
    };
    const Vec3 before = angular_momentum(world.state);
    const State<3> now = stepped(world, rate);
    ASSERT_GT((now.v[1] - world.state.v[1]).norm(), 1) << "it was struck";
    EXPECT_LT((angular_momentum(now) - before).norm(), 1e-4 * before.norm()) << rate;
  }
}

// A point has no thickness to be seen by: one that comes to a body at rest bounces off it all the same.
TEST(Tipping, APointBouncesOffABodyAtRest) {
  for (const Solver solver : {Solver::direct, Solver::iterative}) {
    for (const int rate : {60, 600, 4800}) {
      World<2> world = room({0, -kG});
      world.model.scale = 4, world.model.rate = {rate, 1};
      world.model.collision = Collision::contact, world.model.solver = solver;
      add_wall(world, {0, 0}, {0, 1});
      add_particle(world, {0.05, 1}, {0, 0}, 1, 0.5);
      add_box(world, {0.4, 0.4}, 1e9, {0, 0.2}, {0, 0}, 0, 0, 0.5);
      const double fall = std::sqrt(2 * 0.6 / kG), up = 0.5 * kG * fall, after = 0.05;
      const int steps = int(std::ceil((fall + after) * rate));
      const State<2> now = stepped(world, steps);
      const double since = double(steps) / rate - fall;
      // the iterative solver ends the step where something fast meets another
      const double late = solver == Solver::direct ? 1e-9 : 1.0 / rate;
      EXPECT_NEAR(now.v[0].y(), up - kG * since, 1.5 * kG * late) << rate;
      EXPECT_NEAR(now.x[0].y(), 0.4 + up * since - 0.5 * kG * since * since, up * late + 1e-6) << rate;
    }
  }
}

}  // namespace
}  // namespace obscura::sim

// Chains in the room: what the Stepper makes of them, told by their links' bodies.

#include "sim/multibody/chains.h"

#include <gtest/gtest.h>

#include <cmath>

#include "sim/allocations.h"
#include "sim/energy/energy.h"
#include "sim/reference.h"
#include "sim/space_rooms.h"
#include "sim/units.h"

namespace obscura::sim {
namespace {

// n links end to end from the origin, rods or points at their ends, hanging where q is zero
World<2> hung(int n, double length, double mass, bool rods) {
  World<2> world = room();
  std::vector<Link<2>> links;
  std::vector<int> bodies;
  for (int i = 0; i < n; ++i) {
    bodies.push_back(rods ? add_box(world, {0.1 * length, length}, mass, {0, 0})
                          : add_particle(world, {0, 0}, {0, 0}, mass));
    Body<2>& body = world.model.bodies.back();
    if (rods) body.inertia[0] = mass * length * length / 12;
    Link<2> link = link_of(body);
    link.parent = i - 1;
    link.joint.on_link.place = {0, rods ? 0.5 * length : length};
    if (i > 0 && rods) link.joint.on_parent.place = {0, -0.5 * length};
    links.push_back(link);
  }
  for (Body<2>& body : world.model.bodies) body.group = 1;
  world.model.ignore = {{1, 1}};
  articulate(world, links, bodies);
  world.model.scale = n * length;
  return world;
}

double total_energy(const World<2>& world, const State<2>& state) {
  return energies(world.model, state, {}, 0).total();
}

// A double pendulum against its table at the steps for which a plain RK4 in absolute angles is measured.
// Relative angles are linear in those, so the scheme is the same and its error too: twice that, and rounding.
void expect_table(const std::string& name, bool rods, double first, double second, Collision collision) {
  for (const int rate : {240, 1000, 4000}) {
    World<2> world = hung(2, 1, 1, rods);
    world.model.collision = collision;
    world.model.rate = {rate, 1};
    world.state.chain_states[0].q = {first, second - first};
    const auto allowed = rk4_errors(name, rate);
    State<2> state = world.state;
    Stepper<2> stepper(world.model);
    stepper.begin(state);
    for (const auto& row : table(name + ".csv")) {
      while (state.step < std::lround(row[0] * rate)) ASSERT_FALSE(stepper.step(state));
      const auto& [q, v] = state.chain_states[0];
      const double got[4] = {q[0], q[0] + q[1], v[0], v[0] + v[1]};
      double worst = 0;
      for (int k = 0; k < 4; ++k) worst = std::max(worst, std::abs(got[k] - row[1 + k]));
      EXPECT_LE(worst, 2 * allowed.at(row[0]) + 1e-13) << name << " 1/" << rate << " at " << row[0];
      const Vec2 elbow(std::sin(got[0]), -std::cos(got[0])), arm(std::sin(got[1]), -std::cos(got[1]));
      const Vec2 want = elbow + (rods ? 0.5 : 1) * arm;
      EXPECT_LE((state.x[1] - want).norm(), 1e-15 * 8) << "joints do not drift";
      if (rods) {
        EXPECT_EQ(state.turn[1][0], got[1]);
      }
    }
  }
}

TEST(Articulated, DoublePendulumsArePlainRungeKutta) {
  for (const auto collision : {Collision::handout, Collision::contact}) {
    expect_table("double_pendulum_point_regular", false, 30 * kDegree, 45 * kDegree, collision);
    expect_table("double_pendulum_point_large", false, 90 * kDegree, 90 * kDegree, collision);
    expect_table("double_pendulum_rods", true, 90 * kDegree, 90 * kDegree, collision);
  }
}

// The largest change of energy in a minute of twelve rods, over what the swing has to give.
double energy_error(double amplitude, int rate) {
  World<2> world = hung(12, 0.15, 0.1, true);
  world.model.rate = {rate, 1};
  State<2> state = world.state;
  Stepper<2> stepper(world.model);
  stepper.begin(state);
  const double hanging = total_energy(world, state);
  state.chain_states[0].q[0] = amplitude;
  stepper.begin(state);
  const double start = total_energy(world, state);
  double worst = 0;
  while (state.step < 60 * rate) {
    EXPECT_FALSE(stepper.step(state));
    if (state.step % rate == 0) worst = std::max(worst, std::abs(total_energy(world, state) - start));
  }
  return worst / (start - hanging);
}

TEST(Articulated, TwelveLinksKeepTheirEnergyForAMinute) {
  // Runge-Kutta takes energy away with the fifth power of the step, and nothing else does: 3.3e-8 of it
  const double coarse = energy_error(0.3, 300), fine = energy_error(0.3, 600);
  EXPECT_LE(fine, 5e-8);
  EXPECT_NEAR(coarse / fine, 32, 3);
}

// A trunk and two arms of two parts each, in flight, every joint turning.
World<2> flat_figure() {
  World<2> world = room();
  std::vector<Link<2>> links;
  std::vector<int> bodies;
  const auto part = [&](int parent, Vec2 size, double mass, Vec2 on_parent, Vec2 on_link) {
    bodies.push_back(add_box(world, size, mass, {0, 0}));
    Link<2> link = link_of(world.model.bodies.back());
    link.parent = parent;
    link.joint.freedom = parent < 0 ? JointType::free : JointType::revolute;
    link.joint.on_parent.place = on_parent, link.joint.on_link.place = on_link;
    links.push_back(link);
  };
  part(-1, {0.3, 0.6}, 35, {0, 0}, {0, 0});
  part(0, {0.3, 0.08}, 2, {0.15, 0.28}, {-0.15, 0});
  part(1, {0.28, 0.08}, 1.5, {0.15, 0}, {-0.14, 0});
  part(0, {0.3, 0.08}, 2, {-0.15, 0.28}, {0.15, 0});
  part(3, {0.28, 0.08}, 1.5, {-0.15, 0}, {0.14, 0});
  articulate(world, links, bodies);
  world.state.chain_states[0].q = {0.3, 1, 1.5, 0.2, -0.4, 0.5, 0.1};
  world.state.chain_states[0].v = {2, 3, 4, 1.5, -2, 1, 2.5};
  return world;
}

struct Kept {
  double momentum = 0, angular = 0, energy = 0;  // errors, relative
};

// What is lost where only springs act, after so long.
template <int D>
Kept kept(World<D> world, int rate, double seconds) {
  world.model.gravity.setZero(), world.model.rate = {rate, 1};
  Stepper<D> stepper(world.model);
  State<D> state = world.state;
  stepper.begin(state);
  const auto p = momentum(world.model, state);
  const auto l = angular_momentum(world.model, state);
  const double e = energies(world.model, state, {}, 0).total();
  EXPECT_GT(l.norm(), 1) << "it must turn";
  for (int i = 0; i < std::lround(seconds * rate); ++i) EXPECT_FALSE(stepper.step(state));
  return {(momentum(world.model, state) - p).norm() / p.norm(),
          (angular_momentum(world.model, state) - l).norm() / l.norm(),
          std::abs(energies(world.model, state, {}, 0).total() - e) / e};
}

// All that is lost is Runge-Kutta's: of fourth order at least, so a fourteenth at most where the step halves,
// down to rounding.
template <int D>
void expect_kept(const World<D>& world, int rate, double seconds, double error) {
  const Kept coarse = kept(world, rate, seconds), fine = kept(world, 2 * rate, seconds);
  constexpr double kRounding = 1e-12;
  EXPECT_LE(coarse.momentum, error);
  EXPECT_LE(coarse.angular, error);
  EXPECT_LE(coarse.energy, error);
  EXPECT_LE(fine.momentum, coarse.momentum / 14 + kRounding);
  EXPECT_LE(fine.angular, coarse.angular / 14 + kRounding);
  EXPECT_LE(fine.energy, coarse.energy / 14 + kRounding);
}

TEST(Articulated, AFigureThatFliesKeepsItsMomenta) { expect_kept(flat_figure(), 1000, 3, 1e-8); }

TEST(Articulated, AFigureThatFliesInSpaceKeepsItsMomenta) {
  World<3> world = space();
  std::vector<Link<3>> links;
  std::vector<int> bodies;
  for (int i = 0; i < 4; ++i) {
    bodies.push_back(add_solid(world, brick({0.3, 0.5, 0.2}), 3, {0, 0, 0}));
    Link<3> link = link_of(world.model.bodies.back());
    link.parent = i - 1;
    link.joint.freedom = i == 0 ? JointType::free : i == 1 ? JointType::revolute : JointType::ball;
    if (i > 0) link.joint.on_parent.place = {0, -0.25, 0}, link.joint.on_link.place = {0, 0.25, 0};
    links.push_back(link);
  }
  articulate(world, links, bodies);
  double at = 0.3;
  for (double& v : world.state.chain_states[0].v) v = 2 * std::sin(at), at += 1.7;
  expect_kept(world, 1000, 3, 1e-8);
}

TEST(Articulated, ASpringBetweenLinksIsInternal) {
  World<2> world = flat_figure();
  add_spring(world, {2, {0.14, 0}}, {4, {-0.14, 0}}, 30, 0.2);
  expect_kept(world, 1000, 1, 1e-6);
  World<2> loose = world;
  loose.model.springs.clear(), world.model.gravity.setZero(), loose.model.gravity.setZero();
  EXPECT_GT((stepped(world, 1000).x[2] - stepped(loose, 1000).x[2]).norm(), 0.1) << "it must pull";
}

// Links of rods with a hand on the last.
World<2> pulled(Collision collision) {
  World<2> world = hung(4, 0.5, 0.2, true);
  world.model.collision = collision;
  world.model.rate = {600, 1};
  std::vector<Link<2>> links;
  for (int i = 0; i < 4; ++i) {
    links.push_back((*world.model.chains[0].tree)[i]);
    links.back().joint.damping = 0.05;
  }
  const std::vector<int> bodies = world.model.chains[0].bodies;
  world.model.chains.clear(), world.state.chain_states.clear();
  articulate(world, links, bodies);
  world.model.mice.push_back(
      {{{{1, 10}, {0.1, -2}}, {{1003, 1000}, {1, -1.5}}, {{2, 1}, {1, -1.5}}, {{11, 1}, {1, -1.5}}},
       0,
       400,
       4});
  return world;
}

TEST(Articulated, AHandHoldsALink) {
  for (const auto collision : {Collision::handout, Collision::contact}) {
    const World<2> world = pulled(collision);
    const State<2> state = stepped(world, 6000);
    ASSERT_EQ(state.grips[0].body, 3);
    EXPECT_EQ(state.grips[0].local, Vec2(0.025, -0.25));
    const Vec2 held = place(state, End<2>{3, state.grips[0].local});
    // at rest the spring bears no more than the weight of all, 0.8 kg
    EXPECT_LE((held - Vec2(1, -1.5)).norm(), 0.8 * 9.81 / 400);
    EXPECT_GT((held - Vec2(1, -1.5)).norm(), 0.1 * 9.81 / 400);
  }
}

TEST(Articulated, EveryFrameRateSeesOneTrajectory) {
  for (const auto collision : {Collision::handout, Collision::contact}) {
    std::vector<std::uint64_t> first;
    for (const Rational fps : {Rational{24, 1}, {60, 1}, {30000, 1001}}) {
      const auto all = run(pulled(collision));
      for (std::int64_t frame = 0; rational(frame) / fps < Rational{2, 1}; ++frame)
        shown(*all, rational(frame) / fps);
      shown(*all, {2, 1});
      if (first.empty()) first = all->words();
      EXPECT_EQ(all->words(), first) << text(fps);
    }
    World<2> other = pulled(collision);
    other.state.chain_states[0].v[3] = 1e-9;
    const auto all = run(other);
    shown(*all, {2, 1});
    EXPECT_NE(all->words(), first) << "the joints must be told";
  }
}

TEST(Articulated, APartialStepIsPartOfTheWay) {
  World<2> world = hung(3, 0.5, 1, true);
  world.model.rate = {100, 1};
  world.state.chain_states[0].q = {1, 0.5, -0.5};
  const auto coarse = run(world);
  world.model.rate = {1000, 1};
  const auto fine = run(world);
  const Snapshot a = shown(*coarse, {1003, 1000}), b = shown(*fine, {1003, 1000});
  // Runge-Kutta's error at 1/100 s
  for (int i = 0; i < 3; ++i) EXPECT_LE((a.bodies[i].position - b.bodies[i].position).norm(), 1e-5);
  EXPECT_GT((a.bodies[2].position - shown(*fine, {101, 100}).bodies[2].position).norm(), 1e-3);
}

TEST(Articulated, ALinkStandsAsItsFramesSay) {
  World<2> world = room();
  const int body = add_box(world, {1, 0.5}, 1, {0, 0});
  Link<2> link = link_of(world.model.bodies[body]);
  link.joint.on_parent = {rotation<2>(Orientation<2>(2.9)), {1, 2}};
  link.joint.on_link = {rotation<2>(Orientation<2>(-0.7)), {0.5, 0}};
  articulate(world, {link}, {body});
  world.state.chain_states[0].q = {4 * std::acos(-1.0)};
  const State<2> state = stepped(world, 0);
  EXPECT_NEAR(state.turn[0][0], 2.9 + 0.7 + 4 * std::acos(-1.0), 1e-14) << "rounds count";
  EXPECT_LE((place(state, End<2>{body, {0.5, 0}}) - Vec2(1, 2)).norm(), 1e-14);
}

TEST(Articulated, AllocatesNothingOnceWarm) {
  World<2> world = pulled(Collision::handout);
  State<2> state = world.state;
  Stepper<2> stepper(world.model);
  stepper.begin(state);
  for (int i = 0; i < 200; ++i) ASSERT_FALSE(stepper.step(state));
  const std::size_t before = allocations();
  for (int i = 0; i < 1000; ++i) stepper.step(state);
  EXPECT_EQ(allocations(), before);
  EXPECT_EQ(state.grips[0].body, 3);
}

}  // namespace
}  // namespace obscura::sim

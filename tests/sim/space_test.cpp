#include <gtest/gtest.h>

#include <cmath>

#include "reference.h"
#include "sim/energy/energy.h"
#include "sim/step/snapshots.h"
#include "space_rooms.h"

namespace obscura::sim {
namespace {

// the tennis racket of the tables: principal moments 1, 2, 3
World<3> racket(bool tied) {
  World<3> world = space(Vec3::Zero());
  add_solid(world, brick({1, 1, 1}), 1, Vec3::Zero());
  world.model.bodies[0].inertia = {1, 2, 3};
  world.state.spin[0] = {0.01, 5, 0.02};
  // a spring that pulls nothing makes it one of those that springs hold
  if (tied) world.model.springs.push_back({{0, Vec3::Zero()}, {-1, {0, 1, 0}}, 1, 0, 0});
  return world;
}

Vec3 own_spin(const State<3>& state, int k) {
  return from_room<3>(rotation<3>(state.turn[k]), state.spin[k]);
}

TEST(FreeTop, KeepsToTheDzhanibekovTable) {
  for (const bool tied : {false, true}) {
    const World<3> world = racket(tied);
    State<3> state = world.state;
    Stepper<3> stepper(world.model);
    stepper.begin(state);
    double worst = 0;
    for (const std::vector<double>& row : table("dzhanibekov_free_top.csv")) {
      while (state.step < std::int64_t(std::llround(row[0] * 1000))) ASSERT_FALSE(stepper.step(state));
      const Vec3 w = own_spin(state, 0);
      Eigen::Vector4d q(row[5], row[6], row[7], row[4]);
      if (q.dot(state.turn[0]) < 0) q = -q;
      worst = std::max({worst, (w - Vec3(row[1], row[2], row[3])).cwiseAbs().maxCoeff(),
                        (q - state.turn[0]).cwiseAbs().maxCoeff()});
    }
    RecordProperty(tied ? "tied" : "free", std::to_string(worst * 1e12) + "e-12");
    // the order's own error at 1 ms: 1.4e-10, at 20 s
    EXPECT_LE(worst, 1e-9) << tied;
    EXPECT_GE(worst, 1e-13) << "no table was read";
  }
}

TEST(FreeTop, KeepsItsMomentumAndEnergyOverAMinute) {
  const World<3> world = racket(false);
  const double energy = kinetic(world.model, world.state, 0);
  const Vec3 L = angular_momentum(world.model, world.state);
  const State<3> state = stepped(world, 60000);
  const Vec3 now = angular_momentum(world.model, state);
  RecordProperty("energy", std::to_string((kinetic(world.model, state, 0) / energy - 1) * 1e12) + "e-12");
  RecordProperty("momentum", std::to_string((now - L).norm() / L.norm() * 1e12) + "e-12");
  // h^4 a step, and as many steps: 1e-12 of each
  EXPECT_NEAR(now.norm() / L.norm(), 1, 1e-11);
  EXPECT_LE((now - L).norm() / L.norm(), 1e-9);
  EXPECT_NEAR(kinetic(world.model, state, 0) / energy, 1, 1e-11);
  EXPECT_NEAR(state.turn[0].norm(), 1, 1e-15);
}

TEST(FreeTop, KeepsItsMomentumAndEnergyWhereAStepTurnsItFar) {
  // 2.9 rad a step: one Runge-Kutta step of that doubles the energy within three
  for (const bool tied : {false, true}) {
    World<3> world = racket(tied);
    world.state.spin[0] *= 1000 * 2.9 / 5;
    const double energy = kinetic(world.model, world.state, 0);
    const Vec3 L = angular_momentum(world.model, world.state);
    const State<3> state = stepped(world, 1000);
    // in pieces of 0.1 rad, 29 a step: 1e-5/120 of each is the order's own, and most of it cancels
    EXPECT_NEAR(kinetic(world.model, state, 0) / energy, 1, 1e-4) << tied;
    EXPECT_LE((angular_momentum(world.model, state) - L).norm() / L.norm(), 1e-2) << tied;
  }
}

TEST(FreeTop, ThatTurnsTooFarInAStepIsTold) {
  World<3> world = racket(false);
  world.model.scale = 1000;  // so that it is not its corners' speed
  const auto after = [&](double turn) -> std::optional<Trouble> {
    world.state.spin[0] = Vec3(0.01, 1, 0.02) * turn * 1000;
    Stepper<3> stepper(world.model);
    State<3> state = world.state;
    stepper.begin(state);
    return stepper.step(state);
  };
  EXPECT_FALSE(after(99));
  const auto trouble = after(101);
  ASSERT_TRUE(trouble);
  EXPECT_EQ(trouble->quantity, "spin");
  EXPECT_NE(trouble->likely.find("raise physics.rate"), std::string::npos);
}

TEST(FreeTop, OfASymmetricTopPrecessesAsEulerSays) {
  // I1 = I2: in the body w turns about the axis by (I3 - I1)/I1 w3
  World<3> world = space(Vec3::Zero());
  add_solid(world, brick({1, 1, 1}), 1, Vec3::Zero());
  world.model.bodies[0].inertia = {2, 3, 2};
  world.state.spin[0] = {0.5, 4, 0};
  const State<3> state = stepped(world, 3000);
  const double angle = (3.0 - 2.0) / 2.0 * 4 * 3;
  const Vec3 w = own_spin(state, 0);
  EXPECT_NEAR(w[0], 0.5 * std::cos(angle), 1e-10);
  EXPECT_NEAR(w[1], 4, 1e-13);
  EXPECT_NEAR(std::fabs(w[2]), 0.5 * std::fabs(std::sin(angle)), 1e-10);
  // and about L the body precesses with L / I1: its axis comes back after one turn
  const Vec3 L = angular_momentum(world.model, world.state);
  const double period = 2 * std::numbers::pi * 2 / L.norm();
  world.model.rate = {1000000000000, std::int64_t(std::llround(period * 1e9))};
  const State<3> once = stepped(world, 1000);
  EXPECT_LE((rotation<3>(once.turn[0]).col(1) - Vec3::UnitY()).norm(), 1e-9);  // as the period is rounded
}

TEST(FlightInSpace, IsTheParabola) {
  World<3> world = space({0, -9.8125, 0});
  world.model.rate = {64, 1};
  add_particle(world, {0, 1, 2}, {3, 4, -1});
  add_solid(world, brick({1, 2, 3}), 2, {0, 1, 2}, {3, 4, -1}, no_rotation<3>(), {1, 2, 3});
  for (const double t : {0.5, 1.0, 2.0}) {
    const auto want = closed_form({"projectile_dyadic", "t=" + std::string(t == 0.5 ? "0.5"
                                                                           : t == 1 ? "1 "
                                                                                    : "2 ")});
    const State<3> now = stepped(world, int(64 * t));
    for (const int body : {0, 1}) {
      EXPECT_EQ(now.x[body], Vec3(want[0], want[1], 2 - t));
      EXPECT_EQ(now.v[body], Vec3(want[2], want[3], -1));
    }
  }
}

// a world of the plane, and the same in space: z = 0, spin about z
World<3> in_space(const World<2>& plane, double depth) {
  World<3> out;
  out.model.rate = plane.model.rate, out.model.integrator = plane.model.integrator;
  out.model.gravity = to_3d<2>(plane.model.gravity), out.model.scale = plane.model.scale;
  for (std::size_t i = 0; i < plane.model.bodies.size(); ++i) {
    const Body<2>& it = plane.model.bodies[i];
    if (it.turns()) {
      const Vec2 half = form<Box<2>>(it.shape)->half;
      const Shape<3> box = brick({2 * half[0], 2 * half[1], depth});
      const int k = turning(plane.state, int(i));
      add_solid(out, box, it.mass, to_3d<2>(plane.state.x[i]), to_3d<2>(plane.state.v[i]),
                exponential({0, 0, plane.state.turn[k][0]}), {0, 0, plane.state.spin[k][0]}, it.elasticity);
    } else {
      add_particle(out, to_3d<2>(plane.state.x[i]), to_3d<2>(plane.state.v[i]), it.mass, it.elasticity,
                   *round_radius(it.shape));
    }
    out.model.bodies.back().drag = it.drag;
  }
  for (const Wall<2>& wall : plane.model.walls)
    out.model.walls.push_back({to_3d<2>(wall.point), to_3d<2>(wall.normal), wall.elasticity, {}});
  for (const Spring<2>& s : plane.model.springs) {
    out.model.springs.push_back({{s.a.body, to_3d<2>(s.a.local)},
                                 {s.b.body, to_3d<2>(s.b.local)},
                                 s.rest_length,
                                 s.stiffness,
                                 s.damping});
  }
  for (const Mouse<2>& m : plane.model.mice) {
    Mouse<3> mouse{{}, m.rest_length, m.stiffness, m.damping};
    for (const Knot<2>& knot : m.path) mouse.path.push_back({knot.time, to_3d<2>(knot.place)});
    out.model.mice.push_back(mouse);
  }
  return out;
}

double apart(const State<2>& plane, const State<3>& space) {
  double most = 0;
  for (std::size_t i = 0; i < plane.x.size(); ++i) {
    most = std::max(most, (to_3d<2>(plane.x[i]) - space.x[i]).norm());
    most = std::max(most, (to_3d<2>(plane.v[i]) - space.v[i]).norm());
  }
  for (std::size_t k = 0; k < plane.turn.size(); ++k) {
    const Eigen::Matrix3d want = rotation<3>(exponential({0, 0, plane.turn[k][0]}));
    most = std::max(most, (want - rotation<3>(space.turn[k])).norm());
    most = std::max(most, (Vec3(0, 0, plane.spin[k][0]) - space.spin[k]).norm());
  }
  return most;
}

TEST(PlanarMotionInSpace, IsThePlanesOwn) {
  // a box on a spring at its corner, one on the hand, a particle in drag, balls and boxes at the walls
  World<2> plane = room();
  add_particle(plane, {1, 1}, {1, 2}, 1, 0.9, 0.1);
  add_particle(plane, {2, 1}, {-1, 1}, 2, 0.7);
  plane.model.bodies[1].drag = 0.3;
  add_box(plane, {1, 0.5}, 2, {0.5, 1.2}, {0, 0}, 0.3, 0.5, 0.8);
  add_box(plane, {0.4, 0.4}, 1, {3, 2}, {1, 0}, 0.1, 5, 0.6);
  add_walls(plane, 4, 3);
  add_spring(plane, {2, {0.5, 0.25}}, {-1, {0.8, 2.5}}, 30, 0.2, 0.1);
  add_spring(plane, {2, {-0.5, 0.25}}, {0, {0, 0}}, 10, 0.2);
  plane.model.mice.push_back({{{{0, 1}, {2, 1.2}}, {{1, 1}, {2.5, 1.5}}, {{3, 2}, {2, 2}}}, 0.1, 20, 0.2});
  for (const Integrator which :
       {Integrator::rk4, Integrator::midpoint, Integrator::euler, Integrator::semi_implicit}) {
    plane.model.integrator = which;
    const World<3> space = in_space(plane, 0.7);
    for (const int steps : {100, 700, 2000}) {
      const double off = apart(stepped(plane, steps), stepped(space, steps));
      // impacts of a tumbling box multiply rounding some ten times each
      EXPECT_LE(off, 1e-9) << int(which) << " after " << steps;
    }
  }
}

// a free top of which a corner hangs on a spring, under gravity and drag: nothing is planar
World<3> hanging_top(int rate, Integrator which) {
  World<3> world = space();
  world.model.rate = {rate, 1}, world.model.integrator = which;
  add_solid(world, brick({1, 0.6, 0.3}), 2, {0, 0, 0}, {0.3, 0.1, 0.5}, exponential({0.3, -0.5, 0.2}),
            {1, 4, 2});
  add_solid(world, capsule(0.3, 0.3), 1, {1, 0, 0.5}, {0, 0, 0}, exponential({1, 0, 0.2}), {5, 1, -2});
  world.model.springs.push_back({{0, {0.5, 0.3, 0.15}}, {-1, {0, 1, 0}}, 0.5, 40, 0.1});
  world.model.springs.push_back({{0, {-0.5, 0.3, 0.15}}, {1, {0, 0.3, 0}}, 0.5, 30, 0.1});
  return world;
}

TEST(SpringsInSpace, ConvergeWithTheOrderOfTheScheme) {
  const State<3> exact = stepped(hanging_top(16000, Integrator::rk4), 16000);
  const struct {
    Integrator which;
    double order;
  } schemes[] = {{Integrator::rk4, 4},
                 {Integrator::midpoint, 2},
                 {Integrator::euler, 1},
                 {Integrator::semi_implicit, 1}};
  for (const auto& [which, order] : schemes) {
    const auto off = [&, which = which](int rate) {
      const State<3> now = stepped(hanging_top(rate, which), rate);
      return (now.x[0] - exact.x[0]).norm() + (now.spin[1] - exact.spin[1]).norm() +
             (rotation<3>(now.turn[0]) - rotation<3>(exact.turn[0])).norm();
    };
    const int rate = order == 1 ? 2000 : 1000;
    const double measured = std::log2(off(rate) / off(2 * rate));
    EXPECT_NEAR(measured, order, 0.3) << int(which);
  }
}

TEST(SpringsInSpace, KeepEnergyAndMomentum) {
  World<3> world = hanging_top(1000, Integrator::rk4);
  world.model.springs[0].damping = world.model.springs[1].damping = 0;
  const std::vector<Path<3>> none;
  const double before = energies(world.model, world.state, none, 0).total();
  const State<3> after = stepped(world, 5000);
  EXPECT_NEAR(energies(world.model, after, none, 5).total(), before, 1e-7);
  // untied from the room and weightless: all of it
  world.model.springs.erase(world.model.springs.begin());
  world.model.gravity.setZero();
  const State<3> adrift = stepped(world, 5000);
  EXPECT_LE((momentum(world.model, adrift) - momentum(world.model, world.state)).norm(), 1e-12);
  // RK4's error of the turn, h^4
  EXPECT_LE((angular_momentum(world.model, adrift) - angular_momentum(world.model, world.state)).norm(),
            1e-7);
}

TEST(SpringsInSpace, TurnWithTheWholeScene) {
  World<3> world = hanging_top(1000, Integrator::rk4), other = world;
  const Orientation<3> by = exponential({0.7, -1.1, 0.4});
  const Eigen::Matrix3d turn = rotation<3>(by);
  other.model.gravity = turn * world.model.gravity;
  other.model.springs[0].b.local = turn * world.model.springs[0].b.local;
  for (int i = 0; i < 2; ++i) {
    other.state.x[i] = turn * world.state.x[i], other.state.v[i] = turn * world.state.v[i];
    other.state.turn[i] = product(by, world.state.turn[i]), other.state.spin[i] = turn * world.state.spin[i];
  }
  const State<3> a = stepped(world, 1000), b = stepped(other, 1000);
  for (int i = 0; i < 2; ++i) {
    EXPECT_LE((turn * a.x[i] - b.x[i]).norm(), 1e-12);
    EXPECT_LE((turn * a.spin[i] - b.spin[i]).norm(), 1e-11);
  }
}

// handout §2.4: a ball from height h rises again to e^2 h; in a corner of three walls it turns back
TEST(WallsInSpace, ReturnABallAsTheHandoutSays) {
  World<3> world = space(Vec3::Zero());
  world.model.scale = 4;
  for (int axis = 0; axis < 3; ++axis) add_wall(world, Vec3::Zero(), Vec3::Unit(axis));
  add_particle(world, {1, 1, 1}, {-2, -2, -2}, 1, 0.5, 0.25);
  const State<3> now = stepped(world, 1000);
  // there after 0.375 s, back with half the speed for 0.625 s; it is put on the wall within a step
  EXPECT_LE((now.v[0] - Vec3(1, 1, 1)).norm(), 1e-14);
  EXPECT_LE((now.x[0] - Vec3::Constant(0.25 + 0.625)).norm(), 4e-3);
}

// §3.5 with the tensor: J = -(1 + e) v / (1/m + (r x n) . I^-1 (r x n))
TEST(WallsInSpace, GiveACornerItsImpulse) {
  World<3> world = space(Vec3::Zero());
  world.model.rate = {100000000, 1}, world.model.scale = 4;
  add_wall(world, Vec3::Zero(), Vec3::UnitY());
  const Orientation<3> turn = exponential({0.5, 0.3, -0.4});
  add_solid(world, brick({1, 0.5, 0.8}), 2, {0, 0, 0}, {1, -3, 0.5}, turn, {2, -1, 0.5}, 0.6);
  const Eigen::Matrix3d axes = rotation<3>(turn);
  Vec3 r = Vec3::Zero();
  for (int i = 0; i < 8; ++i) {
    const Vec3 arm = axes * form<Box<3>>(world.model.bodies[0].shape)->corner(i);
    if (arm[1] < r[1]) r = arm;
  }
  world.state.x[0][1] = -r[1] + 1e-9;
  const Body<3>& body = world.model.bodies[0];
  const Vec3 w = world.state.spin[0], v = world.state.v[0] + w.cross(r), rn = r.cross(Vec3::UnitY());
  const Vec3 answer = axes * (axes.transpose() * rn).cwiseQuotient(body.inertia);
  const double J = -1.6 * v[1] / (1 / body.mass + rn.dot(answer));
  const State<3> now = stepped(world, 1);
  ASSERT_EQ(now.touches.size(), 1u);
  EXPECT_NEAR(now.touches[0].impulse[1], J, 1e-6 * J);  // a step of 1e-8 s turns it by as much
  EXPECT_LE((now.spin[0] - (w + J * answer)).norm(), 1e-6);
  EXPECT_LE((now.v[0] - (world.state.v[0] + J / body.mass * Vec3::UnitY())).norm(), 1e-6);
}

TEST(WallsInSpace, GiveNoSpinToWhatLandsFlat) {
  const Shape<3> shapes[] = {brick({1, 0.5, 0.8}), as_hull(brick({1, 0.5, 0.8}))};
  for (const Shape<3>& shape : shapes) {
    World<3> world = space();
    world.model.scale = 4;
    add_wall(world, Vec3::Zero(), Vec3::UnitY());
    add_solid(world, shape, 2, {0, 1, 0}, {0.3, 0, 0.1}, no_rotation<3>(), Vec3::Zero(), 0.5);
    const State<3> now = stepped(world, 3000);
    EXPECT_LE(now.spin[0].norm(), 1e-13);
    EXPECT_LE((now.turn[0] - no_rotation<3>()).norm(), 1e-14);  // the rounding of four corners
    EXPECT_NEAR(now.x[0][1], 0.25, 1e-4);
  }
  // lying on its side
  World<3> world = space();
  world.model.scale = 4;
  add_wall(world, Vec3::Zero(), Vec3::UnitY());
  add_solid(world, capsule(0.5, 0.1), 2, {0, 1, 0}, {0.3, 0, 0.1}, exponential({0, 0, std::numbers::pi / 2}),
            Vec3::Zero(), 0.5);
  const State<3> now = stepped(world, 3000);
  EXPECT_LE(now.spin[0].norm(), 1e-12);
  EXPECT_NEAR(now.x[0][1], 0.1, 1e-4);
}

TEST(WallsInSpace, MeetAHullOfABoxAsTheBox) {
  const auto after = [](const Shape<3>& shape) {
    World<3> world = space();
    world.model.scale = 4;
    for (int axis = 0; axis < 3; ++axis) {
      add_wall(world, Vec3::Constant(-2), Vec3::Unit(axis));
      add_wall(world, Vec3::Constant(2), -Vec3::Unit(axis));
    }
    add_solid(world, shape, 2, {0, 0, 0}, {1, 2, 1.5}, exponential({1, 2, 3}), {3, 1, 2}, 0.9);
    return stepped(world, 2000);
  };
  const State<3> box = after(brick({1, 0.5, 0.8})), hull = after(as_hull(brick({1, 0.5, 0.8})));
  EXPECT_LE((box.x[0] - hull.x[0]).norm(), 1e-9);
  EXPECT_LE((box.spin[0] - hull.spin[0]).norm(), 1e-9);
}

TEST(WallsInSpace, KeepEnergyOfWhatIsElastic) {
  World<3> world = space(Vec3::Zero());
  world.model.scale = 4;
  for (int axis = 0; axis < 3; ++axis) {
    add_wall(world, Vec3::Constant(-2), Vec3::Unit(axis));
    add_wall(world, Vec3::Constant(2), -Vec3::Unit(axis));
  }
  add_solid(world, brick({1, 0.5, 0.8}), 2, {0, 0, 0}, {3, 2, 1.5}, exponential({1, 2, 3}), {3, 1, 2});
  add_solid(world, capsule(0.5, 0.1), 2, {1, 0, 0}, {2, 2, 4}, exponential({1, 2, 3}), {3, 1, 2});
  double before = 0, after = 0;
  const State<3> now = stepped(world, 10000);
  for (int body : {0, 1}) {
    before += kinetic(world.model, world.state, body), after += kinetic(world.model, now, body);
    EXPECT_LE(now.x[body].cwiseAbs().maxCoeff(), 2);
  }
  EXPECT_NEAR(after / before, 1, 1e-10);
  EXPECT_NE(now.ledger.impacts, 0);
}

// the paper's linear motion: what has no inertia stands upright, and meets the ground with its corners
TEST(WithoutRotation, ABoxBouncesAsAParticleDoes) {
  World<3> world = space();
  world.model.scale = 4;
  add_wall(world, Vec3::Zero(), Vec3::UnitY());
  add_particle(world, {0, 1.25, 0}, {1, 0, 0.5}, 1, 0.8, 0.25);
  add_particle(world, {0, 1.25, 0}, {1, 0, 0.5}, 1, 0.8);
  world.model.bodies[1].shape = brick({1, 0.5, 0.8});
  const State<3> now = stepped(world, 2000);
  EXPECT_LE((now.x[0] - now.x[1]).norm(), 1e-12);
  EXPECT_LE((now.v[0] - now.v[1]).norm(), 1e-12);
}

TEST(HandInSpace, TakesTheClosestCorner) {
  World<3> world = space(Vec3::Zero());
  add_particle(world, {5, 0, 0});
  add_solid(world, brick({1, 1, 1}), 1, {0, 0, 0});
  add_solid(world, capsule(1, 0.1), 1, {0, 0, 3});
  world.model.mice.push_back({{{{0, 1}, {0.9, 0.8, 0.7}}, {{2, 1}, {1, 1, 1}}}, 0, 10, 0});
  Stepper<3> stepper(world.model);
  State<3> state = world.state;
  stepper.begin(state);
  EXPECT_EQ(state.grips[0].body, 1);
  EXPECT_EQ(state.grips[0].local, Vec3::Constant(0.5));
  EXPECT_FALSE(stepper.step(state));
  // pulled by k along the spring
  const Vec3 force = 10 * (Vec3(0.9, 0.8, 0.7) - Vec3::Constant(0.5));
  EXPECT_LE((state.v[1] * 1000 - force).norm(), 0.01);
}

TEST(RunInSpace, GivesTheSameStateAtEveryFrameRateAndCutInTwo) {
  const World<3> world = hanging_top(1000, Integrator::rk4);
  const auto by = [&](int fps) {
    auto it = run(world);
    for (int frame = 0; frame <= fps; ++frame) shown(*it, {frame, fps});
    return it->words();
  };
  const auto want = by(10);
  EXPECT_EQ(by(24), want);
  EXPECT_EQ(by(60), want);
  auto it = run(world);
  const Snapshot now = shown(*it, {1, 1});
  EXPECT_EQ(it->scene_info().dimension, 3);
  const State<3> half = stepped(world, 500);
  const State<3> whole = stepped(World<3>{world.model, half}, 500);
  EXPECT_EQ(words(whole), want);
  EXPECT_EQ(now.bodies[0].position, whole.x[0]);
  EXPECT_EQ(Vec3(now.bodies[0].orientation * Vec3::UnitX()), Vec3(now.bodies[0].orientation * Vec3::UnitX()));
  EXPECT_LE((now.bodies[0].orientation.toRotationMatrix() - rotation<3>(whole.turn[0])).norm(), 1e-15);
  EXPECT_EQ(now.bodies[1].spin, whole.spin[1]);
  EXPECT_LE((now.angular_momentum - angular_momentum(world.model, whole)).norm(), 1e-15);
}

}  // namespace
}  // namespace obscura::sim

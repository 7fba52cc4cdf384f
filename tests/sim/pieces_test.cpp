#include "sim/step/bonded_bodies.h"

#include <gtest/gtest.h>

#include <cmath>

#include "sim/energy/energy.h"
#include "space_rooms.h"

namespace obscura::sim {
namespace {

// cubes of a bonded block around the origin, edge 0.5; all neighbours bonded
World<3> block(int nx, int ny, int nz, double strength) {
  World<3> world = space(Vec3::Zero());
  world.model.scale = 4;
  const auto index = [&](int i, int j, int k) { return (i * ny + j) * nz + k; };
  for (int i = 0; i < nx; ++i) {
    for (int j = 0; j < ny; ++j) {
      for (int k = 0; k < nz; ++k) {
        const Vec3 place = 0.5 * (Vec3(i, j, k) - 0.5 * Vec3(nx - 1, ny - 1, nz - 1));
        add_solid(world, brick({0.5, 0.5, 0.5}), 1 + 0.1 * index(i, j, k), place);
        if (i) world.model.bonds.push_back({index(i - 1, j, k), index(i, j, k), strength});
        if (j) world.model.bonds.push_back({index(i, j - 1, k), index(i, j, k), strength});
        if (k) world.model.bonds.push_back({index(i, j, k - 1), index(i, j, k), strength});
      }
    }
  }
  return world;
}

// all turn and fly as one
void set_moving(World<3>& world, Vec3 v, Vec3 w) {
  Vec3 center = Vec3::Zero();
  double mass = 0;
  for (std::size_t i = 0; i < world.state.x.size(); ++i)
    center += world.model.bodies[i].mass * world.state.x[i], mass += world.model.bodies[i].mass;
  center /= mass;
  for (std::size_t i = 0; i < world.state.x.size(); ++i) {
    world.state.v[i] = v + w.cross(world.state.x[i] - center);
    world.state.spin[i] = w;
  }
}

TEST(Bonds, MakeTheirPartsOneRigidBody) {
  World<3> world = block(2, 3, 1, 1e300);
  set_moving(world, {1, 2, 0.5}, {1, 5, 2});
  world.model.gravity = {0, -9.81, 0};
  // a spring at a part's corner
  world.model.springs.push_back({{3, {0.25, 0.25, 0.25}}, {-1, {0, 3, 0}}, 1, 40, 0.1});

  // the same by hand: a compound in its principal frame
  Vec3 center = Vec3::Zero();
  double mass = 0;
  for (int i = 0; i < 6; ++i)
    center += world.model.bodies[i].mass * world.state.x[i], mass += world.model.bodies[i].mass;
  center /= mass;
  Eigen::Matrix3d tensor = Eigen::Matrix3d::Zero();
  for (int i = 0; i < 6; ++i) {
    const Vec3 d = world.state.x[i] - center;
    const double m = world.model.bodies[i].mass;
    tensor += Eigen::Matrix3d(world.model.bodies[i].inertia.asDiagonal());
    tensor += m * (d.squaredNorm() * Eigen::Matrix3d::Identity() - d * d.transpose());
  }
  const Orientation<3> axes = principal_axes(tensor);
  World<3> one = space();
  one.model.scale = 4;
  add_solid(one, brick({1, 1, 1}), mass, center, {1, 2, 0.5}, axes, {1, 5, 2});
  one.model.bodies[0].inertia = tensor.diagonal();
  const Eigen::Matrix3d turn = rotation<3>(axes);
  one.model.springs = world.model.springs;
  one.model.springs[0].a = {0, turn.transpose() * (world.state.x[3] + Vec3::Constant(0.25) - center)};

  const State<3> parts = stepped(world, 1500), single = stepped(one, 1500);
  const Eigen::Matrix3d now = rotation<3>(single.turn[0]);
  for (int i = 0; i < 6; ++i) {
    const Vec3 arm = now * (turn.transpose() * (world.state.x[i] - center));
    EXPECT_LE((parts.x[i] - single.x[0] - arm).norm(), 1e-11) << i;
    EXPECT_LE((parts.v[i] - single.v[0] - single.spin[0].cross(arm)).norm(), 1e-10) << i;
    EXPECT_LE((rotation<3>(parts.turn[i]) - now * turn.transpose()).norm(), 1e-11) << i;
  }
}

// m1 and m2 on a line turn about their centre: the bond bears m1 r1 w^2
TEST(Bonds, BearWhatKeepsThemTurning) {
  for (const double over : {0.999, 1.001}) {
    World<3> world = space(Vec3::Zero());
    add_particle(world, {-2, 0, 0}, {0, 0, 0}, 3), add_particle(world, {1, 0, 0}, {0, 0, 0}, 6);
    const double w = 4, load = 3 * 2 * w * w;
    world.state.v[0] = {0, -2 * w, 0}, world.state.v[1] = {0, w, 0};
    world.model.bonds.push_back({0, 1, load / over});
    const State<3> now = stepped(world, 100);
    EXPECT_EQ(int(now.intact[0]), over < 1 ? 1 : 0);
    const double apart = (now.x[0] - now.x[1]).norm();
    if (over < 1) {
      EXPECT_NEAR(apart, 3, 1e-12);
    } else {
      // it broke after the first step; then both go straight on
      EXPECT_NEAR(apart, std::hypot(3, 3 * w * 0.099), 1e-9);
    }
  }
}

TEST(Bonds, ThatBreakLoseNothing) {
  World<3> world = block(2, 2, 3, 20);
  set_moving(world, {1, 2, 0.5}, {1, 5, 2});
  // it spins apart: who breaks when is the load's affair
  Stepper<3> stepper(world.model);
  State<3> state = world.state;
  stepper.begin(state);
  const Vec3 p = momentum(world.model, state), L = angular_momentum(world.model, state);
  const double energy = kinetic(world.model, state);
  std::size_t bodies = state.bonded[0].x.size();
  EXPECT_EQ(bodies, 1u);
  bool broke = false;
  for (int i = 0; i < 500; ++i) {
    ASSERT_FALSE(stepper.step(state));
    broke = broke || state.bonded[0].x.size() > bodies;
    bodies = state.bonded[0].x.size();
    ASSERT_LE((momentum(world.model, state) - p).norm(), 1e-11 * p.norm()) << i;
    ASSERT_LE((angular_momentum(world.model, state) - L).norm(), 1e-9 * L.norm()) << i;
    ASSERT_NEAR(kinetic(world.model, state), energy, 1e-9 * energy) << i;
  }
  EXPECT_TRUE(broke);
  EXPECT_GT(bodies, 1u);
}

// two particles in line with a blast: what one is pushed more goes through the bond
TEST(Bonds, BearWhatABlastPushesOnePartMore) {
  const double f1 = 10.0 / 4, f2 = 10.0 / 9, m1 = 1, m2 = 3;
  const double load = std::fabs(m2 * f1 - m1 * f2) / (m1 + m2);
  for (const double over : {0.99, 1.01}) {
    World<3> world = space(Vec3::Zero());
    world.model.scale = 4, world.model.rate = {10000, 1};
    add_particle(world, {2, 0, 0}, Vec3::Zero(), m1), add_particle(world, {3, 0, 0}, Vec3::Zero(), m2);
    Explosion<3> explosion;
    explosion.strength = 10;
    world.model.explosions.push_back(explosion);
    world.model.bonds.push_back({0, 1, load / over});
    EXPECT_EQ(int(stepped(world, 10).intact[0]), over < 1 ? 1 : 0) << over;
    const State<3> now = stepped(world, 10000);
    if (over < 1) {
      EXPECT_NEAR(now.x[1][0] - now.x[0][0], 1, 1e-12);
    }
  }
}

// a ball with another on top lands: of the impulse P the upper one takes its share through the bond
TEST(Bonds, BearTheirShareOfABlow) {
  const double v = 3, m1 = 1, m2 = 3, e = 0.5;
  const double through = (1 + e) * v * m2;  // P = (m1 + m2)(1 + e) v, of which m2 / (m1 + m2)
  for (const Collision collision : {Collision::handout, Collision::contact}) {
    for (const double over : {0.99, 1.01}) {
      World<2> world = room({0, 0});
      world.model.collision = collision;
      world.model.scale = 4;
      add_wall(world, {0, 0}, {0, 1});
      add_particle(world, {0, 0.5}, {0, -v}, m1, e, 0.1), add_particle(world, {0, 0.75}, {0, -v}, m2, e, 0.1);
      world.model.bonds.push_back({0, 1, through / 0.002 / over, 0.002});
      const State<2> now = stepped(world, 300);
      EXPECT_EQ(int(now.intact[0]), over < 1 ? 1 : 0) << int(collision) << " " << over;
      EXPECT_NEAR(now.v[1][1], e * v, 1e-9);
      EXPECT_NEAR(now.v[0][1], e * v, 1e-9);
    }
  }
}

// a beam of cubes out of the wall: the first bond bears its weight, and its torque over half the spacing
TEST(Bonds, HoldABeamInTheRoomUntilItIsTooLong) {
  const int n = 4;
  const double m = 1, a = 0.5, l = a / 2;
  for (const double over : {0.99, 1.01}) {
    World<2> world = room();
    world.model.scale = 4;
    for (int i = 0; i < n; ++i) {
      add_box(world, {a, a}, m, {a * i, 2});
      if (i) world.model.bonds.push_back({i - 1, i, 1e300});
    }
    world.model.bodies[0].fixed = true;
    // of the bond between the first two, a/2 from the first: three cubes at a/2, 3a/2, 5a/2
    const double torque = m * 9.81 * a * (0.5 + 1.5 + 2.5), force = 3 * m * 9.81;
    world.model.bonds[0].strength = std::hypot(force, torque / l) / over;
    const State<2> now = stepped(world, 100);
    EXPECT_EQ(int(now.intact[0]), over < 1 ? 1 : 0) << over;
    EXPECT_EQ(now.x[0], Vec2(0, 2));
    if (over < 1) {
      EXPECT_EQ(now.x[3], Vec2(1.5, 2));
    } else {
      // the rest falls as one
      EXPECT_NEAR(now.v[3][1], -9.81 * 0.099, 1e-9);
      EXPECT_NEAR(now.v[1][1], now.v[3][1], 1e-12);
    }
  }
}

// a bridge of three cubes between two bonds to the room: what is symmetric breaks symmetrically, and neither
// bond bears less than half the weight of the middle
TEST(Bonds, InALoopShareTheLoad) {
  const auto intact = [](double strength) {
    World<2> world = room();
    world.model.scale = 4;
    for (int i = 0; i < 3; ++i) add_box(world, {0.5, 0.5}, 5, {0.5 * (i - 1), 2});
    world.model.bonds = {{0, -1, 1e300}, {2, -1, 1e300}, {0, 1, strength}, {2, 1, strength}};
    const State<2> now = stepped(world, 1);
    EXPECT_EQ(now.intact[2], now.intact[3]) << strength;
    EXPECT_EQ(int(now.intact[0]), 1);
    return now.intact[2] != 0;
  };
  const double half = 5 * 9.81 / 2;
  EXPECT_FALSE(intact(0.999 * half));
  // at most as beams would: with the torque of half the weight over the half spacing
  EXPECT_TRUE(intact(1.001 * half * std::sqrt(2.0)));
}

TEST(Bonds, BreakAtTheSameStepAtEveryFrameRateAndCutInTwo) {
  World<3> world = block(2, 2, 2, 60);
  world.model.gravity = {0, -9.81, 0};
  add_wall(world, {0, -1, 0}, Vec3::UnitY());
  for (Body<3>& body : world.model.bodies) body.elasticity = 0.3;
  set_moving(world, {0.5, 0, 0.2}, {1, 0.5, 2});
  Explosion<3> explosion;
  explosion.strength = 30, explosion.center = {0.3, -1.2, 0.1}, explosion.start = {1, 2},
  explosion.duration = {1, 4};
  for (const auto scheme : {Explosion<3>::Scheme::smooth, Explosion<3>::Scheme::paper}) {
    explosion.scheme = scheme;
    world.model.explosions = {explosion};
    const auto by = [&](int fps) {
      auto it = run(world);
      for (int frame = 0; frame <= fps; ++frame) shown(*it, {frame, fps});
      return it->words();
    };
    const auto want = by(24);
    EXPECT_EQ(by(25), want);
    for (const int first : {300, 510, 700})
      EXPECT_EQ(words(stepped(World<3>{world.model, stepped(world, first)}, 1000 - first)), want) << first;
    const State<3> end = stepped(world, 1000);
    EXPECT_GT(end.bonded[0].x.size(), 1u);
    for (const Vec3& x : end.x) EXPECT_TRUE(x.allFinite());
  }
}

TEST(Bonds, LetAPileOfThePlaneRestAsOne) {
  for (const Solver solver : {Solver::direct, Solver::iterative}) {
    World<2> world = room();
    world.model.collision = Collision::contact, world.model.solver = solver;
    world.model.rate = {600, 1}, world.model.scale = 4;
    add_wall(world, {0, 0}, {0, 1});
    for (int i = 0; i < 4; ++i) {
      add_box(world, {0.5, 0.5}, 1, {0.5 * (i % 2), 0.3 + 0.5 * (i / 2)}, {0, 0}, 0, 0, 0);
      world.model.bodies[i].friction = 0.5;
    }
    world.model.bonds = {{0, 1, 1e6}, {0, 2, 1e6}, {1, 3, 1e6}, {2, 3, 1e6}};
    const State<2> now = stepped(world, 1200);
    for (int i = 0; i < 4; ++i) {
      EXPECT_LE((now.x[i] - Vec2(0.5 * (i % 2), 0.25 + 0.5 * (i / 2))).norm(), 1e-5) << int(solver) << i;
      EXPECT_LE(now.v[i].norm(), 1e-6) << int(solver);
      EXPECT_EQ(int(now.intact[i]), 1);
    }
    EXPECT_FALSE(now.contacts.empty());
    for (const Contact<2>& contact : now.contacts) EXPECT_LT(contact.key.a, 2) << "the lower ones stand";
  }
}

}  // namespace
}  // namespace obscura::sim

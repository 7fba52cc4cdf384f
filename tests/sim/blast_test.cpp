#include "sim/force/explosion.h"

#include <gtest/gtest.h>

#include <cmath>
#include <sstream>

#include "chain_cases.h"
#include "reference.h"
#include "sim/energy/energy.h"
#include "space_rooms.h"

namespace obscura::sim {
namespace {

template <int D>
Explosion<D> explosion(double strength, Vec<D> center = Vec<D>::Zero()) {
  Explosion<D> it;
  it.strength = strength, it.center = center;
  return it;
}

TEST(Explosion, KeepsToTheTables) {
  const struct {
    const char* table;
    Vec3 gravity, from;
    double mass;
  } cases[] = {{"explosion_radial_free.csv", {0, 0, 0}, {1, 0, 0}, 1},
               {"explosion_oblique_gravity.csv", {0, -9.81, 0}, {1, 0.5, -2}, 2}};
  for (const auto& it : cases) {
    World<3> world = space(it.gravity);
    world.model.scale = 4;
    world.model.explosions.push_back(explosion<3>(10));
    add_particle(world, it.from, Vec3::Zero(), it.mass);
    Stepper<3> stepper(world.model);
    State<3> state = world.state;
    stepper.begin(state);
    int read = 0;
    for (const std::vector<double>& row : table(it.table)) {
      while (state.step < std::llround(row[0] * 1000)) ASSERT_FALSE(stepper.step(state));
      // RK4 at 1 ms: 1e-4 of its error at 10 ms, 1.3e-8 at r0 = 1
      EXPECT_LE((state.x[0] - Vec3(row[1], row[2], row[3])).norm(), 1e-11) << row[0];
      EXPECT_LE((state.v[0] - Vec3(row[4], row[5], row[6])).norm(), 1e-11) << row[0];
      ++read;
    }
    EXPECT_GE(read, 5);
  }
}

// which scheme runs shows in the tenth digit
TEST(Explosion, IsIntegratedByTheSchemeThatIsAskedFor) {
  auto file = open_reference("explosion_radial_r0_sweep.csv");
  std::string line;
  std::getline(file, line);
  int read = 0;
  while (std::getline(file, line)) {
    std::istringstream cells(line);
    std::string r0, scheme, r, v;
    std::getline(cells, r0, ','), std::getline(cells, scheme, ','), std::getline(cells, r, ','),
        std::getline(cells, v, ',');
    World<3> world = space(Vec3::Zero());
    world.model.rate = {scheme == "continuous" ? 4000 : 100, 1};
    if (scheme == "symplectic_10ms") world.model.integrator = Integrator::semi_implicit;
    if (scheme == "euler_10ms") world.model.integrator = Integrator::euler;
    world.model.explosions.push_back(explosion<3>(10));
    if (scheme == "zoh_10ms") {
      // the force is held: at any rate the same, exactly
      world.model.rate = {300, 1};
      world.model.explosions[0].scheme = Explosion<3>::Scheme::paper;
    }
    add_particle(world, {0, 0, std::stod(r0)});
    const State<3> now = stepped(world, int(value(world.model.rate)));
    EXPECT_NEAR(now.x[0][2], std::stod(r), 2e-13 * 100) << line;
    EXPECT_NEAR(now.v[0][2], std::stod(v), 2e-13 * 100) << line;
    ++read;
  }
  EXPECT_EQ(read, 25);
}

TEST(Explosion, GivesWhatIsFarStrengthOverDistanceSquaredOverMassTimesASecond) {
  World<3> world = space(Vec3::Zero());
  world.model.scale = 1000;
  world.model.rate = {100, 1};
  world.model.explosions.push_back(explosion<3>(10));
  const Vec3 at = 1000 * Vec3(2, -1, 2) / 3;
  add_particle(world, at, Vec3::Zero(), 2);
  add_solid(world, brick({1, 0.5, 0.8}), 2, at);
  const State<3> now = stepped(world, 200);
  const double want = 10 / 1e6 / 2;
  EXPECT_NEAR(now.v[0].norm() / want, 1, 1e-7);  // moved by 2.5e-6 m of 1000
  EXPECT_LE((now.v[0].normalized() - at.normalized()).norm(), 1e-12);
  // eight points, each within 1 m of 1000
  EXPECT_NEAR(now.v[1].norm() / want, 8, 1e-4);
}

TEST(Explosion, LastsAHundredIntervalsAndNoMore) {
  for (const auto scheme : {Explosion<3>::Scheme::smooth, Explosion<3>::Scheme::paper}) {
    World<3> world = space(Vec3::Zero());
    world.model.scale = 1e6;
    // steps that fall on no interval
    world.model.rate = {317, 1};
    world.model.explosions.push_back(explosion<3>(1e12));
    world.model.explosions[0].scheme = scheme;
    world.model.explosions[0].start = {1, 3};
    add_particle(world, {1e6, 0, 0});
    const auto edge = edges(world.model);
    EXPECT_EQ(edge.size(), scheme == Explosion<3>::Scheme::paper ? 101u : 2u);
    const State<3> now = stepped(world, 317 * 2);
    EXPECT_NEAR(now.v[0][0], 1, 2e-6);  // a newton for a second; 0.5 m further is 1e-6 less
    EXPECT_FALSE(blasting(now));
  }
}

TEST(Explosion, IsTheSameOverOctantsAxesAndPoles) {
  std::vector<Vec3> places;
  for (int i = 0; i < 8; ++i) places.push_back(Vec3(i & 1 ? 1 : -1, i & 2 ? 1 : -1, i & 4 ? 1 : -1));
  for (int axis = 0; axis < 3; ++axis) {
    places.push_back(std::sqrt(3.0) * Vec3::Unit(axis)), places.push_back(-std::sqrt(3.0) * Vec3::Unit(axis));
  }
  World<3> world = space(Vec3::Zero());
  world.model.explosions.push_back(explosion<3>(10));
  for (const Vec3& place : places) add_particle(world, place);
  const State<3> now = stepped(world, 1500);
  for (std::size_t i = 0; i < places.size(); ++i) {
    EXPECT_NEAR(now.v[i].norm(), now.v[0].norm(), 1e-13) << i;
    EXPECT_LE((now.v[i].normalized() - places[i].normalized()).norm(), 1e-14) << i;
  }
  EXPECT_LE(momentum(world.model, now).norm(), 1e-12);
}

TEST(Explosion, AtItsCentreHasNoDirection) {
  EXPECT_EQ(blast<3>(explosion<3>(10, {1, 2, 3}), {1, 2, 3}), Vec3::Zero());
  Explosion<3> soft = explosion<3>(10);
  soft.softening = 0.5;
  // the most it can push is 2 S / (3 sqrt 3 eps^2), where r = eps / sqrt 2
  const double most = 2 * 10 / (3 * std::sqrt(3.0) * 0.25);
  EXPECT_NEAR(blast<3>(soft, {0.5 / std::sqrt(2.0), 0, 0})[0], most, 1e-13);
  EXPECT_LT(blast<3>(soft, {0.3, 0, 0})[0], most);
}

// a scatter of boxes, capsules and points
World<3> scatter() {
  Dice dice(12);
  World<3> world = space();
  world.model.scale = 4;
  world.model.explosions.push_back(explosion<3>(30, {0.1, -0.2, 0.3}));
  world.model.explosions[0].duration = {1, 2};
  for (int i = 0; i < 4; ++i) add_particle(world, dice.vector<3>(3), dice.vector<3>(1));
  for (int i = 0; i < 4; ++i) {
    const Shape<3> shape = i % 2 ? brick({0.5, 0.3, 0.4}) : capsule(0.3, 0.1);
    const Vec3 place = dice.vector<3>(1).normalized() * dice.between(1, 3);
    add_solid(world, shape, dice.between(1, 2), place, dice.vector<3>(1), exponential(dice.vector<3>(2)),
              dice.vector<3>(3));
  }
  return world;
}

TEST(Explosion, TurnsWithTheWholeScene) {
  World<3> world = scatter(), other = world;
  const Orientation<3> by = exponential({0.7, -1.1, 0.4});
  const Eigen::Matrix3d turn = rotation<3>(by);
  other.model.gravity = turn * world.model.gravity;
  other.model.explosions[0].center = turn * world.model.explosions[0].center;
  for (std::size_t i = 0; i < world.state.x.size(); ++i)
    other.state.x[i] = turn * world.state.x[i], other.state.v[i] = turn * world.state.v[i];
  for (std::size_t k = 0; k < world.state.turn.size(); ++k) {
    other.state.turn[k] = product(by, world.state.turn[k]);
    other.state.spin[k] = turn * world.state.spin[k];
  }
  const State<3> a = stepped(world, 1000), b = stepped(other, 1000);
  for (std::size_t i = 0; i < a.x.size(); ++i) {
    // of 20 m and as many metres a second
    EXPECT_LE((turn * a.x[i] - b.x[i]).norm() / a.x[i].norm(), 1e-12);
    EXPECT_LE((turn * a.v[i] - b.v[i]).norm() / a.v[i].norm(), 1e-12);
  }
  for (std::size_t k = 0; k < a.spin.size(); ++k)
    EXPECT_LE((turn * a.spin[k] - b.spin[k]).norm() / a.spin[k].norm(), 1e-11);
}

TEST(Explosion, EndsWithTheSameBitsAtEveryFrameRate) {
  for (const auto scheme : {Explosion<3>::Scheme::smooth, Explosion<3>::Scheme::paper}) {
    World<3> world = scatter();
    world.model.explosions[0].scheme = scheme;
    world.model.explosions[0].start = {1, 7};
    world.model.rate = {601, 1};
    const auto by = [&](int fps) {
      auto it = run(world);
      for (int frame = 0; frame <= 2 * fps; ++frame) shown(*it, {frame, fps});
      return it->words();
    };
    const auto want = by(24);
    for (const int fps : {25, 30, 60}) EXPECT_EQ(by(fps), want);
    // and cut in two where it is under way
    EXPECT_EQ(words(stepped(World<3>{world.model, stepped(world, 200)}, 1002)), want);
  }
}

TEST(Explosion, BlowsABodyAwayAsItsPoints) {
  // force and torque on a box by hand
  World<3> world = space(Vec3::Zero());
  world.model.rate = {1000000, 1};
  const Explosion<3> it = explosion<3>(10, {-0.9, 0.2, 0.1});
  world.model.explosions.push_back(it);
  const Orientation<3> turn = exponential({0.4, 0.2, -0.6});
  add_solid(world, brick({1, 0.5, 0.8}), 2, {0, 0, 0}, Vec3::Zero(), turn);
  Vec3 force = Vec3::Zero(), torque = Vec3::Zero();
  const Eigen::Matrix3d axes = rotation<3>(turn);
  for (int i = 0; i < 8; ++i) {
    const Vec3 r = axes * form<Box<3>>(world.model.bodies[0].shape)->corner(i), from = r - it.center;
    const Vec3 f = 10 * from / std::pow(from.norm(), 3);
    force += f, torque += r.cross(f);
  }
  const State<3> now = stepped(world, 1);
  EXPECT_LE((now.v[0] * 1e6 - force / 2).norm(), 1e-9 * force.norm());
  const Vec3 spun = axes * (axes.transpose() * torque).cwiseQuotient(world.model.bodies[0].inertia);
  EXPECT_GT(spun.norm(), 1);
  EXPECT_LE((now.spin[0] * 1e6 - spun).norm(), 1e-8 * spun.norm());
}

TEST(Explosion, OfThePlaneIsThatOfSpace) {
  World<2> plane = room();
  World<3> world = space();
  for (World<2>* it : {&plane}) it->model.explosions.push_back(explosion<2>(10, {0.2, 0.1}));
  world.model.explosions.push_back(explosion<3>(10, {0.2, 0.1, 0}));
  add_particle(plane, {1, 0.5}, {0, 1}), add_particle(world, {1, 0.5, 0}, {0, 1, 0});
  const State<2> a = stepped(plane, 1500);
  const State<3> b = stepped(world, 1500);
  EXPECT_LE((a.x[0] - b.x[0].head<2>()).norm(), 1e-13);
  EXPECT_LE((a.v[0] - b.v[0].head<2>()).norm(), 1e-13);
  // and a box turns
  World<2> boxed = room({0, 0});
  boxed.model.explosions.push_back(explosion<2>(10, {0, -0.1}));
  add_box(boxed, {0.5, 0.5}, 1, {1, 0});
  const State<2> c = stepped(boxed, 1000);
  EXPECT_GT(std::fabs(c.spin[0][0]), 0.1);
}

TEST(Explosion, ActsUponWhatRestsAndWakesIt) {
  for (const auto solver : {Solver::direct, Solver::iterative}) {
    World<2> world = room();
    world.model.collision = Collision::contact, world.model.solver = solver;
    world.model.rate = {600, 1};
    add_wall(world, {0, 0}, {0, 1});
    add_box(world, {0.5, 0.5}, 1, {1, 0.25}, {0, 0}, 0, 0, 0);
    world.model.bodies[0].friction = 0.2;
    world.model.explosions.push_back(explosion<2>(20, {-1, 0.25}));
    world.model.explosions[0].start = {2, 1};
    State<2> state = world.state;
    Stepper<2> stepper(world.model);
    stepper.begin(state);
    while (state.step < 1200) ASSERT_FALSE(stepper.step(state));
    EXPECT_LE((state.x[0] - Vec2(1, 0.25)).norm(), 1e-6);
    while (state.step < 1800) ASSERT_FALSE(stepper.step(state));
    EXPECT_GT(state.v[0][0], 1) << int(solver);
    const Vec2 v = state.v[0];
    while (state.step < 1860) ASSERT_FALSE(stepper.step(state));
    // then friction alone
    if (std::fabs(state.x[0][1] - 0.25) < 1e-6) {
      EXPECT_NEAR(state.v[0][0], v[0] - 0.2 * 9.81 * 0.1, 1e-6) << int(solver);
    }
  }
}

// the paper's friction: v = v0 exp(-c t / m), on the ground and nowhere else
TEST(GroundDrag, BrakesWhatStandsOnTheGround) {
  for (const auto collision : {Collision::handout, Collision::contact}) {
    World<2> world = room();
    world.model.collision = collision;
    add_wall(world, {0, 0}, {0, 1});
    add_wall(world, {-1, 0}, {1, 0});
    world.model.scale = 4;
    add_particle(world, {0, 0.25}, {3, 0}, 2, 0, 0.25);
    add_particle(world, {0, 2.5}, {3, 3}, 2, 0, 0.25);
    for (Body<2>& body : world.model.bodies) body.ground_drag = 0.8;
    const State<2> now = stepped(world, 500);
    EXPECT_NEAR(now.v[0][0], 3 * std::exp(-0.8 * 0.5 / 2), 1e-9) << int(collision);
    EXPECT_NEAR(now.v[1][0], 3, 1e-15) << int(collision);
  }
  World<3> world = space();
  add_wall(world, Vec3::Zero(), Vec3::UnitY());
  world.model.scale = 4;
  add_particle(world, {0, 0, 0}, {1, 0, 2}, 2, 0.5);
  add_solid(world, brick({1, 0.5, 0.8}), 2, {5, 0.25, 0}, {1, 0, 2}, no_rotation<3>(), Vec3::Zero(), 0.5);
  for (Body<3>& body : world.model.bodies) body.ground_drag = 0.8;
  const State<3> now = stepped(world, 500);
  for (const int body : {0, 1}) {
    const double left = std::exp(-0.8 * 0.5 / 2);
    EXPECT_NEAR(now.v[body][0], left, 1e-9);
    EXPECT_NEAR(now.v[body][2], 2 * left, 1e-9);
  }
}

}  // namespace
}  // namespace obscura::sim

// One loop: time, frames, words, ways.

#include "sim/step/run.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "sim/jointed.h"
#include "sim/rooms.h"
#include "sim/touching.h"

namespace obscura::sim {
namespace {

// something of everything
World<2> busy() {
  World<2> world = room();
  world.model.rate = {600, 1};
  add_walls(world, 4, 3);
  for (int i = 0; i < 12; ++i)
    add_particle(world, {0.3 + 0.3 * i, 2}, {2.0 - 0.3 * i, 0.2 * i}, 1, 0.9, 0.05);
  add_box(world, {0.4, 0.2}, 1, {1, 1}, {1, 0}, 0.3, 2, 0.7);
  add_box(world, {0.3, 0.3}, 1, {3, 1}, {-1, 0}, 0.3, 2, 0.5);
  add_spring(world, {0, {0, 0}}, {1, {0, 0}}, 40, 0.3, 0.1);
  add_spring(world, {13, {0.15, 0.15}}, {-1, {3, 2.5}}, 30, 0.3, 0);
  // presses and releases off every grid
  world.model.mice.push_back(
      {{{{10007, 10000}, {1, 2}}, {{17, 7}, {2, 1}}, {{31, 9}, {3, 2}}}, 0.1, 40, 0.2});
  world.model.mice.push_back({{{{3, 2}, {3, 1}}, {{22, 5}, {1, 1}}}, 0.1, 20, 0});
  return world;
}

TEST(Run, ComesToTheSameWordsAtEveryFrameRate) {
  const auto world = busy();
  std::vector<std::uint64_t> first;
  for (const Rational fps : {Rational{24, 1}, {25, 1}, {30, 1}, {50, 1}, {60, 1}, {30000, 1001}}) {
    const auto all = run(world);
    for (std::int64_t frame = 0;; ++frame) {
      const Rational t = rational(frame) / fps;
      if (!(t < Rational{5, 1})) break;
      shown(*all, t);
    }
    shown(*all, {5, 1});
    const auto words = all->words();
    if (first.empty()) first = words;
    EXPECT_EQ(words, first) << text(fps);
  }
  EXPECT_GT(first.size(), 60u);
}

TEST(Run, ShowsFramesBetweenSteps) {
  // a projectile is exact at any time
  World<2> world = room();
  world.model.rate = {600, 1};
  add_particle(world, {0, 1}, {3, 4});
  const auto all = run(world);
  for (int frame = 0; frame < 30; ++frame) {
    const Rational t = rational(frame * 1001, 30000);
    const auto now = shown(*all, t);
    const double s = value(t);
    EXPECT_EQ(now.time, s);
    EXPECT_EQ(now.step, floor(t * Rational{600, 1}));
    EXPECT_LT((now.bodies[0].position - Vec3(3 * s, 1 + 4 * s - 9.81 * s * s / 2, 0)).norm(), 1e-12);
  }
}

TEST(Run, ShowsAFrameAfterCollisions) {
  World<2> world = room({0, 0});
  world.model.rate = {10, 1};
  add_wall(world, {0, 0}, {0, 1});
  add_particle(world, {0, 0.1}, {0, -2});
  const auto now = shown(*run(world), {3, 40});  // three quarters of a step: it would be at -0.05
  EXPECT_NEAR(now.bodies[0].position.y(), 0, 1e-16);
  EXPECT_EQ(now.bodies[0].velocity.y(), 2);
}

TEST(Run, TakesNoStepForAFrameOnTheGrid) {
  const auto all = run(busy());
  const auto now = shown(*all, {1, 1});
  EXPECT_EQ(now.step, 600);
  const auto words = all->words();
  EXPECT_EQ(words, sim::words(stepped(busy(), 600)));
  shown(*all, {1, 1});
  EXPECT_EQ(all->words(), words) << "asked twice";
}

TEST(Run, AtARateOfAnyRational) {
  World<2> world = room();
  world.model.rate = {30000, 1001};
  add_particle(world, {0, 0});
  const auto now = shown(*run(world), {1001, 1000});
  EXPECT_EQ(now.step, 30);
  EXPECT_NEAR(now.bodies[0].velocity.y(), -9.81 * 1.001, 1e-13);
}

TEST(Words, SayEveryBitOnce) {
  World<2> world = busy();
  State<2> a = world.state, b = a;
  EXPECT_EQ(words(a), words(b));
  b.x[3][1] = std::nextafter(b.x[3][1], 9);
  EXPECT_NE(words(a), words(b));
  b = a, b.v[2][0] = std::nextafter(b.v[2][0], 9);
  EXPECT_NE(words(a), words(b));
  b = a, b.turn[1][0] += 1;
  EXPECT_NE(words(a), words(b));
  b = a, b.spin[1][0] += 1;
  EXPECT_NE(words(a), words(b));
  b = a, b.step = 1;
  EXPECT_NE(words(a), words(b));
  b = a, b.beyond = 0.1;
  EXPECT_NE(words(a), words(b));
  b = a, b.grips.push_back({1, {0, 0}});
  EXPECT_NE(words(a), words(b));
  b = a, b.touches.push_back({});
  EXPECT_NE(words(a), words(b));
  b = a, b.ledger.impacts = -1;
  EXPECT_NE(words(a), words(b));
  b = a, b.ledger.displacement = -1;
  EXPECT_NE(words(a), words(b));
}

TEST(Words, TakeMinusZeroForZero) {
  World<2> world = room();
  add_particle(world, {0, 0});
  State<2> a = world.state, b = a;
  b.x[0][0] = -0.0;
  EXPECT_EQ(words(a), words(b));
}

TEST(Track, IsTheSameForEveryFrameRate) {
  std::vector<Track> tracks;
  for (const Rational fps : {Rational{7, 1}, {60, 1}, {30000, 1001}}) {
    const auto all = run(busy());
    all->track({0, 12});
    Track sum{{0, 12}, {{}, {}}};
    for (std::int64_t frame = 0; rational(frame) / fps < Rational{3, 1}; ++frame) {
      shown(*all, rational(frame) / fps);
      const auto piece = all->take_track();
      for (int i = 0; i < 2; ++i)
        sum.points[i].insert(sum.points[i].end(), piece.points[i].begin(), piece.points[i].end());
    }
    shown(*all, {3, 1});
    const auto piece = all->take_track();
    for (int i = 0; i < 2; ++i)
      sum.points[i].insert(sum.points[i].end(), piece.points[i].begin(), piece.points[i].end());
    tracks.push_back(sum);
  }
  for (const Track& track : tracks) {
    ASSERT_EQ(track.points.size(), 2u);
    for (int i = 0; i < 2; ++i) {
      ASSERT_EQ(track.points[i].size(), tracks[0].points[i].size());
      EXPECT_GE(track.points[i].size(), 361u);  // 120 a second, both ends
      for (std::size_t k = 0; k < track.points[i].size(); ++k) {
        EXPECT_EQ(track.points[i][k].place, tracks[0].points[i][k].place);
        EXPECT_EQ(track.points[i][k].time, tracks[0].points[i][k].time);
        EXPECT_TRUE(k == 0 || track.points[i][k - 1].time < track.points[i][k].time);
      }
    }
  }
}

TEST(Track, KeepsTheCuspOfABounce) {
  World<2> world = room();
  world.model.rate = {600, 1};
  add_wall(world, {0, 0}, {0, 1});
  add_particle(world, {0, 1}, {1, 0}, 1, 0.9);
  const auto all = run(world);
  all->track({0});
  shown(*all, {1, 1});
  double lowest = 1;
  const auto track = all->take_track();
  for (const auto& point : track.points[0]) lowest = std::min(lowest, point.place.y());
  EXPECT_NEAR(lowest, 0, 1e-15);
}

// by both solvers, before any step: a box on the floor, and a weight on a rod
TEST(Snapshot, KnowsTheForcesAtTheStart) {
  for (const Solver solver : {Solver::direct, Solver::iterative}) {
    World<2> world = touching_room();
    world.model.solver = solver;
    add_wall(world, {0, -1}, {0, 1});
    add_particle(world, {3, 0});
    add_box(world, {0.2, 0.2}, 2, {0, -0.9});
    world.model.joints = {rod({0, {0, 0}}, {-1, {3, 1}}, 1)};
    const auto all = run(world);
    const Snapshot now = shown(*all, {0, 1});
    double pushes = 0;
    for (const Snapshot::Contact& contact : now.contacts) pushes += contact.force.y();
    EXPECT_NEAR(pushes, 2 * 9.81, 1e-6) << int(solver);
    EXPECT_NEAR(now.joints[0].force.y(), 9.81, 1e-6) << int(solver);
    // and nothing has moved
    EXPECT_EQ(now.bodies[1].position, Vec3(0, -0.9, 0));
    const auto before = all->words();
    EXPECT_EQ(before, run(world)->words());
    shown(*all, {1, 60});
    EXPECT_EQ(all->words(), words(stepped(world, 10)));
  }
}

TEST(Snapshot, ShowsWhereSpringsEnd) {
  World<2> world = room({0, 0});
  add_box(world, {1, 0.5}, 1, {2, 1}, {0, 0}, std::acos(-1) / 2);
  add_spring(world, {0, {0.5, 0.25}}, {-1, {3, 3}}, 0, 1);
  const auto all = run(world);
  const auto now = shown(*all, {0, 1});
  EXPECT_LT((now.springs[0].a - Vec3(1.75, 1.5, 0)).norm(), 1e-15);
  EXPECT_EQ(now.springs[0].b, Vec3(3, 3, 0));
  EXPECT_EQ(all->scene_info().springs[0].a, 0);
  EXPECT_EQ(all->scene_info().springs[0].b, -1);
  EXPECT_EQ(all->scene_info().bodies[0].half, Vec3(0.5, 0.25, 0));
}

TEST(Snapshot, CountsEnergyAndMomentum) {
  World<2> world = room({0, -10});
  add_particle(world, {1, 2}, {3, 0}, 2);
  add_box(world, {3, 3}, 4, {1, 0}, {0, 1}, 0, 2);  // I = 4 * 18 / 12 = 6
  add_spring(world, {0, {0, 0}}, {-1, {1, 5}}, 10, 1);
  const auto now = shown(*run(world), {0, 1});
  EXPECT_NEAR(now.energies.kinetic, 9 + 2 + 12, 1e-14);
  EXPECT_NEAR(now.energies.gravity, 2 * 10 * 2, 1e-14);
  EXPECT_NEAR(now.energies.springs, 0.5 * 10 * 4, 1e-14);
  EXPECT_EQ(now.momentum, Vec3(6, 4, 0));
  EXPECT_NEAR(now.angular_momentum.z(), -2 * 2 * 3 + 4 * 1 * 1 + 6 * 2, 1e-14);
}

}  // namespace
}  // namespace obscura::sim

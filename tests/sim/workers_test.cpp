// Threads that share a loop, and steps that they share: the same bits, however many there are.

#include "sim/math/workers.h"

#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <atomic>
#include <cmath>
#include <numeric>
#include <stdexcept>
#include <thread>
#include <vector>

#include "sim/rooms.h"
#include "sim/solids.h"
#include "sim/space_rooms.h"
#include "sim/step/stepper.h"

namespace obscura::sim {
namespace {

// how often a loop has come to each number
std::vector<int> visits(Workers& workers, int count, int piece) {
  std::vector<int> all(std::size_t(count), 0);
  workers.each(count, piece, [&](int begin, int end) {
    for (int i = begin; i < end; ++i) ++all[std::size_t(i)];
  });
  return all;
}

TEST(Workers, ComeToEachNumberOnce) {
  for (const int threads : {1, 2, 3, 8}) {
    Workers workers(threads);
    EXPECT_EQ(workers.threads(), threads);
    for (const int count : {0, 1, 7, 64, 1000, 4097}) {
      for (const int piece : {1, 3, 64}) {
        for (int again = 0; again < 20; ++again)
          EXPECT_EQ(visits(workers, count, piece), std::vector<int>(std::size_t(count), 1)) << threads;
      }
    }
  }
}

TEST(Workers, BeginPiecesAtMultiplesOfTheirLength) {
  Workers workers(3);
  std::vector<int> ends(1000, 0);
  workers.each(1000, 16, [&](int begin, int end) { ends[std::size_t(begin)] = end; });
  for (int i = 0; i < 1000; ++i) EXPECT_EQ(ends[std::size_t(i)], i % 16 != 0 ? 0 : std::min(i + 16, 1000));
}

TEST(Workers, ThrowWhatTheFirstPieceThrew) {
  Workers workers(4);
  for (int again = 0; again < 50; ++again) {
    try {
      workers.each(100, 1, [](int begin, int) {
        if (begin >= 40) throw std::runtime_error(std::to_string(begin));
      });
      ADD_FAILURE();
    } catch (const std::runtime_error& error) {
      EXPECT_STREQ(error.what(), "40");
    }
    EXPECT_EQ(visits(workers, 50, 1), std::vector<int>(50, 1)) << "and are fit for the next loop";
  }
}

// a loop within a loop, and loops of several callers at once
TEST(Workers, DoOneLoopAtATime) {
  Workers workers(2);
  std::atomic<int> sum = 0;
  const auto call = [&] {
    for (int again = 0; again < 100; ++again) {
      workers.each(8, 1, [&](int begin, int end) {
        for (int i = begin; i < end; ++i)
          workers.each(10, 1, [&](int first, int last) { sum += last - first; });
      });
    }
  };
  std::vector<std::jthread> callers;
  for (int i = 0; i < 3; ++i) callers.emplace_back(call);
  callers.clear();
  EXPECT_EQ(sum, 3 * 100 * 8 * 10);
}

TEST(Workers, AreNotMissedInAForkedProcess) {
  Workers workers(3);
  visits(workers, 100, 1);
  const pid_t child = fork();
  if (child == 0) _exit(visits(workers, 100, 1) == std::vector<int>(100, 1) ? 0 : 1);
  int status = -1;
  waitpid(child, &status, 0);
  EXPECT_EQ(status, 0);
}

// balls, boxes, something driven, a belt and joints, of several masses and elasticities
template <int D>
World<D> mixed_heap() {
  World<D> world;
  world.model.rate = {60, 1}, world.model.collision = Collision::contact;
  world.model.solver = Solver::iterative, world.model.scale = 4;
  const int side = D == 3 ? 7 : 20, layer = D == 3 ? side * side : side, count = D == 3 ? 350 : 600;
  const double half = 0.2 * side + 0.1;
  for (int axis = 0; axis < D; ++axis) {
    for (const int sign : {-1, 1}) {
      if (axis == 1 && sign == 1) continue;
      Vec<D> n = Vec<D>::Zero(), at = Vec<D>::Zero();
      n[axis] = -sign, at[axis] = axis == 1 ? 0 : sign * half;
      world.model.walls.push_back({at, n, {}, {}});
    }
  }
  for (int i = 0; i < count; ++i) {
    Body<D> body;
    if (i % 3 == 0)
      body.shape = Ball<D>{0.12};
    else
      body.shape = Box<D>{Vec<D>::Constant(0.11)};
    body.mass = i % 7 == 0 ? 20 : 1, body.elasticity = i % 5 == 0 ? 0.8 : 0, body.friction = 0.4;
    body.inertia = solid_inertia(body.shape, body.mass);
    if (i == 2) body.belt[0] = 0.5;
    Vec<D> x = Vec<D>::Zero(), v = Vec<D>::Zero();
    x[0] = -half + 0.3 + 0.4 * (i % side) + 0.01 * (i % 3), x[1] = 0.25 + 0.4 * (i / layer);
    if constexpr (D == 3) x[2] = -half + 0.3 + 0.4 * (i / side % side) + 0.01 * (i % 5);
    v[0] = 0.3 * std::sin(1.7 * i), v[1] = -0.5;
    world.model.bodies.push_back(body);
    world.state.x.push_back(x), world.state.v.push_back(v);
    if constexpr (D == 3)
      world.state.turn.push_back(exponential(Vec3(std::sin(i), std::cos(2.0 * i), 0.1 * i)));
    else
      world.state.turn.push_back(Orientation<2>(0.3 * i));
    world.state.spin.push_back(AngularVec<D>::Zero());
  }
  return world;
}

template <int D>
std::vector<std::uint64_t> words_after(const World<D>& from, int threads, int steps) {
  World<D> world = from;
  if (threads > 0) world.model.workers = std::make_shared<Workers>(threads);
  Stepper<D> stepper(world.model);
  stepper.begin(world.state);
  for (int i = 0; i < steps; ++i)
    if (const auto trouble = stepper.step(world.state)) {
      ADD_FAILURE() << trouble->body << ' ' << trouble->quantity << ' ' << trouble->what;
      break;
    }
  return words(world.state);
}

template <int D>
void expect_the_same_bits(int steps) {
  const World<D> world = mixed_heap<D>();
  const auto alone = words_after(world, 0, steps);
  for (const int threads : {1, 2, 3, 4, 8, 16})
    EXPECT_EQ(words_after(world, threads, steps), alone) << threads << " threads";
}

TEST(Workers, ShareStepsInThePlaneWithTheSameBits) { expect_the_same_bits<2>(30); }
TEST(Workers, ShareStepsInSpaceWithTheSameBits) { expect_the_same_bits<3>(20); }

}  // namespace
}  // namespace obscura::sim

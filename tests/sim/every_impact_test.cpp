// Every impact counts: bodies that have nothing to do with one another bounce as each of them alone, by both
// solvers, in the plane and in space, at every rate, and however many fall into one step.

#include <gtest/gtest.h>

#include <cmath>
#include <optional>
#include <string>
#include <tuple>

#include "sim/rooms.h"
#include "sim/units.h"

namespace obscura::sim {
namespace {

// A ball that falls from rest through `fall` (m) onto a floor of elasticity e, after t (s):
//   t_1 = sqrt(2 fall / g),   v_k = e^k g t_1   its speed after bounce k,   2 v_k / g   its flight until the
//   next
struct Bouncing {
  double height, speed;  // m above the floor; m/s, upwards
  int bounces;
};
Bouncing bouncing(double fall, double e, double t) {
  const double first = std::sqrt(2 * fall / kG);
  if (t < first) return {fall - 0.5 * kG * t * t, -kG * t, 0};
  double left = t - first, v = e * kG * first;
  int bounces = 1;
  for (; left >= 2 * v / kG; ++bounces) left -= 2 * v / kG, v *= e;
  return {v * left - 0.5 * kG * left * left, v - kG * left, bounces};
}

// Place along an axis between two walls at 0 and `width` that send back all they get: a straight line,
// folded.
double folded(double x, double width) {
  x = std::fmod(x, 2 * width);
  if (x < 0) x += 2 * width;
  return x > width ? 2 * width - x : x;
}

template <int D>
World<D> walled(double width, double gravity, Solver solver, int rate) {
  World<D> world;
  world.model.gravity = -gravity * Vec<D>::Unit(1);
  world.model.rate = {rate, 1};
  world.model.collision = Collision::contact;
  world.model.solver = solver;
  world.model.scale = width;
  for (int axis = 0; axis < D; ++axis) {
    add_wall<D>(world, Vec<D>::Zero(), Vec<D>::Unit(axis));
    add_wall<D>(world, width * Vec<D>::Unit(axis), -Vec<D>::Unit(axis));
  }
  return world;
}

// a number between 0 and 1 for each i, as unlike its neighbours' as can be
double scattered(int i, int which = 0) {
  const double x = (i + 1) * (which == 0   ? 0.6180339887498949
                              : which == 1 ? 0.7548776662466927
                                           : 0.5698402909980532);
  return x - std::floor(x);
}

template <int D>
double motion(const World<D>& world, const State<D>& state) {
  double sum = 0;
  for (std::size_t i = 0; i < state.v.size(); ++i)
    sum += 0.5 * world.model.bodies[i].mass * state.v[i].squaredNorm();
  return sum;
}

// `many` particles beside one another, dropped a tenth of a metre with 3 mm of jitter
template <int D>
void expect_rain(Solver solver, int many, int rate, double radius) {
  constexpr double kE = 0.8, kFall = 0.1;
  const int steps = rate / 5;
  // contacts close to 1e-10 of the room's size: so late is a bounce, at some m/s
  const double wide = 0.5 * (many + 1), off = 1e-8 * wide;
  World<D> world = walled<D>(wide, kG, solver, rate);
  for (int i = 0; i < many; ++i) {
    Vec<D> at = Vec<D>::Constant(0.5 * wide);
    at[0] = 0.5 * (i + 1), at[1] = kFall + 0.003 * scattered(i) + radius;
    add_particle<D>(world, at, Vec<D>::Zero(), 1, kE, radius);
  }
  const State<D> now = stepped(world, steps);
  for (int i = 0; i < many; ++i) {
    const Bouncing want = bouncing(world.state.x[i][1] - radius, kE, double(steps) / rate);
    ASSERT_EQ(want.bounces, 1);
    ASSERT_NEAR(now.x[i][1] - radius, want.height, off) << "body " << i;
    ASSERT_NEAR(now.v[i][1], want.speed, off) << "body " << i;
  }
}

template <int D>
void expect_rain(int many, int rate) {
  const std::string what = std::to_string(D) + "D, " + std::to_string(many) + " at " + std::to_string(rate);
  {
    SCOPED_TRACE("direct, points, " + what);
    expect_rain<D>(Solver::direct, many, rate, 0);
  }
  {
    SCOPED_TRACE("iterative, points, " + what);
    expect_rain<D>(Solver::iterative, many, rate, 0);
  }
  if (many <= 100) {
    SCOPED_TRACE("direct, balls, " + what);
    expect_rain<D>(Solver::direct, many, rate, 0.1);
  }
  {
    SCOPED_TRACE("iterative, balls, " + what);
    expect_rain<D>(Solver::iterative, many, rate, 0.1);
  }
}

class EveryImpact : public testing::TestWithParam<std::tuple<int, int>> {};

TEST_P(EveryImpact, OfARainBouncesAsAlone) {
  const auto [many, rate] = GetParam();
  expect_rain<2>(many, rate);
  expect_rain<3>(many, rate);
}

INSTANTIATE_TEST_SUITE_P(Rain, EveryImpact,
                         testing::Combine(testing::Values(1, 20, 100, 1000), testing::Values(60, 600, 6000)));

// e = 1, no gravity, all arrive within 0.3 ms: all come back as fast as they came
template <int D>
void expect_volley(Solver solver, int rate) {
  World<D> world = walled<D>(10, 0, solver, rate);
  for (int i = 0; i < 30; ++i) {
    Vec<D> at = Vec<D>::Constant(5), v = Vec<D>::Zero();
    at[0] = 0.3 * (i + 1), at[1] = 0.1 + 0.0003 * scattered(i), v[1] = -1;
    add_particle<D>(world, at, v);
  }
  const int steps = rate / 5;
  const State<D> now = stepped(world, steps);
  for (int i = 0; i < 30; ++i) {
    EXPECT_NEAR(now.v[i][1], 1, 1e-12) << i;
    EXPECT_NEAR(now.x[i][1], double(steps) / rate - world.state.x[i][1], 1e-8) << i;
  }
}

TEST(EveryImpact, OfAVolleyOnAWallComesBack) {
  for (const int rate : {60, 600, 6000}) {
    for (const Solver solver : {Solver::direct, Solver::iterative}) {
      SCOPED_TRACE(std::to_string(rate) + (solver == Solver::direct ? " direct" : " iterative"));
      expect_volley<2>(solver, rate);
      expect_volley<3>(solver, rate);
    }
  }
}

// points between walls that send all back: straight lines, folded
template <int D>
void expect_gas(Solver solver, int many, double speed, double width, int rate, int steps, double off) {
  World<D> world = walled<D>(width, 0, solver, rate);
  for (int i = 0; i < many; ++i) {
    Vec<D> at, v;
    for (int axis = 0; axis < D; ++axis) {
      at[axis] = width * (0.01 + 0.98 * scattered(i, axis));
      v[axis] = scattered(7 * i + 3, (axis + 1) % 3) - 0.5;
    }
    add_particle<D>(world, at, Vec<D>(speed / v.norm() * v));
  }
  const State<D> now = stepped(world, steps);
  EXPECT_NEAR(motion(world, now) / motion(world, world.state), 1, 1e-12);
  const double t = double(steps) / rate;
  for (int i = 0; i < many; ++i) {
    for (int axis = 0; axis < D; ++axis) {
      ASSERT_NEAR(now.x[i][axis], folded(world.state.x[i][axis] + t * world.state.v[i][axis], width),
                  off * width)
          << "point " << i << " axis " << axis;
    }
  }
}

TEST(EveryImpact, OfAGasOfPointsKeepsItsEnergy) {
  for (const Solver solver : {Solver::direct, Solver::iterative}) {
    for (const double speed : {8.0, 15.0, 60.0}) {
      SCOPED_TRACE(std::to_string(speed) + (solver == Solver::direct ? " direct" : " iterative"));
      expect_gas<2>(solver, 400, speed, 2, 600, 120, 1e-6);
      expect_gas<3>(solver, 400, speed, 2, 600, 120, 1e-6);
      expect_gas<2>(solver, 400, speed, 2, 60, 12, 1e-6);
    }
  }
}

// Balls of e = 1 that meet one another and walls, several times in a step where it is long: what energy is
// left after 2 s. `across`: how many along each axis.
template <int D>
void expect_elastic(const int (&across)[D], double radius, double width, double speed, int rate, double off) {
  SCOPED_TRACE(std::to_string(D) + "D, " + std::to_string(speed) + " m/s at " + std::to_string(rate));
  World<D> world = walled<D>(width, 0, Solver::iterative, rate);
  int all = 1;
  for (const int n : across) all *= n;
  for (int i = 0; i < all; ++i) {
    Vec<D> at, v;
    for (int axis = 0, rest = i; axis < D; rest /= across[axis++]) {
      const double cell = width / across[axis], room = cell - 2 * radius;
      at[axis] = cell * (rest % across[axis] + 0.5) + 0.9 * room * (scattered(i, axis) - 0.5);
      v[axis] = scattered(7 * i + 3, (axis + 1) % 3) - 0.5;
    }
    add_particle<D>(world, at, Vec<D>(speed / v.norm() * v), 1, 1, radius);
  }
  EXPECT_NEAR(motion(world, stepped(world, 2 * rate)) / motion(world, world.state), 1, off);
}

TEST(EveryImpact, OfAGasOfBallsKeepsItsEnergy) {
  for (const int rate : {60, 120, 240, 600, 6000}) {
    for (const double speed : {5.0, 40.0}) {
      expect_elastic<2>({10, 10}, 0.2, 10, speed, rate, 1e-9);
      if (rate < 6000) expect_elastic<3>({5, 4, 5}, 0.2, 6, speed, rate, 1e-6);
    }
    expect_elastic<2>({5, 4}, 0.05, 1, 40, rate, 1e-9);
    expect_elastic<3>({3, 3, 3}, 0.05, 1, 40, rate, 1e-6);
  }
}

// A row of equal balls of e = 1 that touch hands the blow on, pair after pair, though it is n impacts in one
// instant; to the left of the origin their gaps round to both signs.
template <int D>
void expect_cradle(int balls, int rate) {
  SCOPED_TRACE(std::to_string(D) + "D, " + std::to_string(balls) + " at " + std::to_string(rate));
  World<D> world = walled<D>(400, 0, Solver::iterative, rate);
  world.model.impacts = Impacts::sequential;
  for (Wall<D>& wall : world.model.walls) wall.point -= 200 * Vec<D>::Ones();
  const auto at = [](double x) { return Vec<D>(x * Vec<D>::Unit(0)); };
  add_particle<D>(world, at(-81), at(2), 1, 1, 0.2);
  for (int i = 0; i < balls; ++i) add_particle<D>(world, at(0.4 * i - 80), at(0), 1, 1, 0.2);
  const State<D> now = stepped(world, rate / 2);
  EXPECT_NEAR(now.v.back()[0], 2, 1e-12);
  for (int i = 0; i < balls; ++i) EXPECT_NEAR(now.v[std::size_t(i)].norm(), 0, 1e-12) << i;
}

TEST(EveryImpact, OfACradleOfHundredsHandsTheBlowOn) {
  for (const int rate : {60, 600}) {
    for (const int balls : {5, 300}) {
      expect_cradle<2>(balls, rate);
      expect_cradle<3>(balls, rate);
    }
  }
}

// A heavy ball drives a light one against a wall, time and again, all in a few steps: with masses M and m
// each impact of theirs turns (sqrt(M) V, sqrt(m) v) by twice atan(sqrt(m / M)). Counted as Galperin counts
// the digits of pi (2003).
template <int D>
void expect_digits_of_pi(double ratio, int rate) {
  SCOPED_TRACE(std::to_string(D) + "D, " + std::to_string(ratio) + " at " + std::to_string(rate));
  World<D> world = walled<D>(20, 0, Solver::iterative, rate);
  const auto at = [](double x) { return Vec<D>(10 * Vec<D>::Ones() + (x - 10) * Vec<D>::Unit(0)); };
  add_particle<D>(world, at(1), at(0) - at(0), 1, 1, 0.2);
  add_particle<D>(world, at(3), at(-2) - at(0), ratio, 1, 0.2);
  double V = -2, v = 0;
  for (;;) {
    if (v > V) {
      const double all = ratio + 1, before = V;
      V = ((ratio - 1) * V + 2 * v) / all, v = ((1 - ratio) * v + 2 * ratio * before) / all;
    } else if (v < 0) {
      v = -v;
    } else {
      break;
    }
  }
  const State<D> now = stepped(world, 3 * rate);
  EXPECT_NEAR(now.v[1][0], V, 1e-7);
  EXPECT_NEAR(std::fabs(now.v[0][0]), v, 1e-7 * std::sqrt(ratio));  // it may meet the wall once more
}

TEST(EveryImpact, OfTwoThatCountTheDigitsOfPi) {
  for (const int rate : {60, 600}) {
    for (const double ratio : {1e2, 1e4, 1e6}) {
      expect_digits_of_pi<2>(ratio, rate);
      expect_digits_of_pi<3>(ratio, rate);
    }
  }
}

// Impacts that would not end are told: a ball of 10^12 times the mass meets another 3,141,592 times.
TEST(EveryImpact, ThatDoNotEndAreTold) {
  World<2> world = walled<2>(20, 0, Solver::iterative, 60);
  add_particle<2>(world, {1, 10}, {0, 0}, 1, 1, 0.2),
      add_particle<2>(world, {1.45, 10}, {-2, 0}, 1e12, 1, 0.2);
  State<2> state = world.state;
  Stepper<2> stepper(world.model);
  stepper.begin(state);
  std::optional<Trouble> trouble;
  for (int i = 0; i < 60 && !trouble; ++i) trouble = stepper.step(state);
  ASSERT_TRUE(trouble);
  EXPECT_EQ(trouble->quantity, "number of impacts");
  EXPECT_NE(trouble->likely.find("raise physics.rate"), std::string::npos);
}

// many times through the room in a step
TEST(EveryImpact, OfABulletKeepsItsSpeed) {
  for (const Solver solver : {Solver::direct, Solver::iterative}) {
    for (const double speed : {1e3, 1e4, 1e5}) {
      SCOPED_TRACE(std::to_string(speed) + (solver == Solver::direct ? " direct" : " iterative"));
      expect_gas<2>(solver, 1, speed, 2, 600, 60, 1e-4);
      expect_gas<3>(solver, 1, speed, 2, 600, 60, 1e-4);
    }
  }
}

}  // namespace
}  // namespace obscura::sim

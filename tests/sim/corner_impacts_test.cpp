// Boxes that fall on a corner, with friction: by both solvers, against a closed form.
//
// A box at angle q with spin w meets the floor with the corner at (x, y) from its centre. The speeds of the
// corner are v_n = v_y + w x, v_t = v_x - w y; impulses p change them by
//   K_nn = 1/m + x^2/I,  K_tt = 1/m + y^2/I,  K_nt = -x y / I
// Newton says v_n + K_nn p_n + K_nt p_t = -e v_n, and Coulomb that p_t stops the corner, or is mu p_n.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>
#include <random>

#include "sim/first_impact.h"
#include "sim/solve/iterate/plane_pair_impact.h"
#include "sim/touching.h"

namespace obscura::sim {
namespace {

struct Drop {
  double width = 1, height = 0.5, mass = 2, e = 0.5, mu = 0.5;
  double y = 2, angle = 0.5, spin = 0;
  Vec2 v = {0, -3};

  double inertia() const { return mass * (width * width + height * height) / 12; }
};

struct Landing {
  double time = 0;  // s
  Vec2 v = {0, 0};
  double spin = 0;
  bool slides = false, gains = false;  // energy, by Newton's law
};

// the lowest corner, from the centre
Vec2 lowest(const Drop& drop, double angle) {
  const double c = std::cos(angle), s = std::sin(angle);
  Vec2 best(0, 1e300);
  for (const double i : {-0.5, 0.5}) {
    for (const double j : {-0.5, 0.5}) {
      const Vec2 corner(c * i * drop.width - s * j * drop.height, s * i * drop.width + c * j * drop.height);
      if (corner.y() < best.y()) best = corner;
    }
  }
  return best;
}

// how high the lowest corner is
double height(const Drop& drop, double y, double vy, double angle, double spin, double t) {
  return y + vy * t + lowest(drop, angle + spin * t).y();
}

// when that is zero for the first time: closely stepped, then halved
double first_touch(const Drop& drop) {
  const auto at = [&](double t) { return height(drop, drop.y, drop.v.y(), drop.angle, drop.spin, t); };
  const double step = 1e-4;
  double t = 0;
  while (at(t + step) > 0) t += step;
  double low = t, high = t + step;
  for (int i = 0; i < 60; ++i) {
    const double mid = 0.5 * (low + high);
    (at(mid) > 0 ? low : high) = mid;
  }
  return 0.5 * (low + high);
}

Landing landing_by_newton(const Drop& drop) {
  Landing out;
  out.time = first_touch(drop);
  const double m = drop.mass, I = drop.inertia(), w = drop.spin;
  const Vec2 r = lowest(drop, drop.angle + w * out.time);
  const double vn = drop.v.y() + w * r.x(), vt = drop.v.x() - w * r.y();
  const double knn = 1 / m + r.x() * r.x() / I, ktt = 1 / m + r.y() * r.y() / I, knt = -r.x() * r.y() / I;

  // p_n(p_t) by Newton; the corner stops at one p_t, and Coulomb allows an interval of them
  const auto normal = [&](double pt) { return (-(1 + drop.e) * vn - knt * pt) / knn; };
  double least = -1e300, most = 1e300;
  if (knn - drop.mu * knt > 0) least = -drop.mu * -(1 + drop.e) * vn / (knn - drop.mu * knt);
  if (knn + drop.mu * knt > 0) most = drop.mu * -(1 + drop.e) * vn / (knn + drop.mu * knt);
  const double stop = -(vt + knt * normal(0)) / (ktt - knt * knt / knn);
  const double pt = std::clamp(stop, least, most), pn = normal(pt);
  out.slides = pt != stop;
  out.v = drop.v + Vec2(pt, pn) / m;
  out.spin = w + (r.x() * pn - r.y() * pt) / I;
  const double before = m * drop.v.squaredNorm() + I * w * w,
               after = m * out.v.squaredNorm() + I * out.spin * out.spin;
  out.gains = after > before * (1 + 1e-12);
  return out;
}

Landing landing_of(const Drop& drop) { return without_gain(drop, landing_by_newton); }

// whether nothing touches the floor in the time after a landing
bool free_after(const Drop& drop, const Landing& landing, double time) {
  const double y = drop.y + drop.v.y() * landing.time, angle = drop.angle + drop.spin * landing.time;
  for (int i = 1; i <= 100; ++i) {
    if (height(drop, y, landing.v.y(), angle, landing.spin, time * i / 100) <= 0) return false;
  }
  return true;
}

Drop mirrored(Drop drop) {
  drop.angle = -drop.angle, drop.spin = -drop.spin, drop.v.x() = -drop.v.x();
  return drop;
}

// over angles, speeds, e, mu, spins
Drop drop(int seed) {
  Chance chance(std::uint64_t(seed) * 7919 + 11);
  const double es[] = {0.2, 0.5, 0.8, 1}, mus[] = {0, 0.1, 0.3, 0.6, 1.2};
  Drop it;
  it.width = chance.between(0.3, 1.2), it.height = chance.between(0.3, 1.2), it.mass = chance.between(0.2, 5);
  it.e = es[seed % 4], it.mu = mus[seed / 4 % 5];
  it.angle = chance.between(-3, 3), it.spin = seed % 3 == 0 ? 0 : chance.between(-10, 10);
  it.v = {chance.between(-3, 3), -chance.between(0.5, 6)};
  it.y = -lowest(it, it.angle).y() + chance.between(0.02, 0.1) * -it.v.y();
  return it;
}

World<2> room_of(const std::vector<Drop>& drops, Solver solver, int rate) {
  World<2> world = touching_room(Collision::contact, {0, 0});
  world.model.solver = solver, world.model.rate = {rate, 1};
  add_wall(world, {0, 0}, {0, 1});
  for (std::size_t i = 0; i < drops.size(); ++i) {
    const Drop& it = drops[i];
    const int body = add_box(world, {it.width, it.height}, it.mass, {3.0 * double(i), it.y}, it.v, it.angle,
                             it.spin, it.e);
    world.model.bodies[body].friction = it.mu;
  }
  return world;
}

// A small ball beside each box, so near that it might meet it in a step, flying as the box does until that
// lands, and on the side from which the box goes then: so it never does.
void add_neighbours(World<2>& world, const std::vector<Drop>& drops, int rate) {
  for (std::size_t i = 0; i < drops.size(); ++i) {
    const Drop& it = drops[i];
    const double radius = 0.01, side = landing_of(it).v.x() > it.v.x() ? -1 : 1;
    const double apart = std::hypot(it.width, it.height) / 2 + radius + 0.5 * it.v.norm() / rate;
    add_ball(world, radius, it.mass, world.state.x[i] + Vec2(side * apart, 0), it.v, 0, it.e);
  }
}

struct Compared {
  int all = 0, slid = 0, stuck = 0;
};

// each box in the step after its landing, against the closed form, within `bound` of its speed before
Compared compare(const std::vector<Drop>& drops, Solver solver, int rate, double bound, bool near = false) {
  World<2> world = room_of(drops, solver, rate);
  if (near) add_neighbours(world, drops, rate);
  State<2> state = world.state;
  Stepper<2> stepper(world.model);
  stepper.begin(state);
  std::vector<Landing> want;
  for (const Drop& it : drops) want.push_back(landing_of(it));
  double last = 0;
  for (const Landing& it : want) last = std::max(last, it.time);
  Compared count;
  std::vector<char> done(drops.size(), 0);
  const double h = 1.0 / rate;
  while (double(state.step) * h < last + h) {
    EXPECT_FALSE(stepper.step(state));
    const double now = double(state.step) * h;
    for (std::size_t i = 0; i < drops.size(); ++i) {
      if (done[i] || now < want[i].time) continue;
      done[i] = 1;
      if (!free_after(drops[i], want[i], std::max(1e-3, 1.5 * h))) continue;
      const double reach = std::hypot(drops[i].width, drops[i].height) / 2;
      const double size = drops[i].v.norm() + std::abs(drops[i].spin) * reach;
      EXPECT_NEAR((state.v[i] - want[i].v).norm(), 0, bound * size)
          << "box " << i << " of " << drops.size() << " at " << rate;
      EXPECT_NEAR(state.spin[i][0] * reach, want[i].spin * reach, bound * size)
          << "box " << i << " of " << drops.size() << " at " << rate;
      ++count.all, ++(want[i].slides ? count.slid : count.stuck);
    }
  }
  return count;
}

// The exact solver, which moves what meets nothing but walls beside the iterative one too, finds an impact's
// time by places to 1e-9 of the room; the iterative one to 1e-9 of a step of 1/240 s at most. What a box of
// 10 rad/s turns meanwhile is less than these.
constexpr double kExactBound = 1e-8, kIterativeBound = 1e-9;

TEST(CornerImpacts, ABoxLeavesTheFloorAsTheClosedFormSaysByBothSolvers) {
  for (const Solver solver : {Solver::direct, Solver::iterative}) {
    Compared sum;
    for (const int rate : {60, 600, 6000}) {
      for (int seed = 0; seed < 240; ++seed) {
        const Drop it = drop(seed);
        for (const Drop& one : {it, mirrored(it)}) {
          const Compared count = compare({one}, solver, rate, kExactBound);
          sum.all += count.all, sum.slid += count.slid, sum.stuck += count.stuck;
        }
      }
    }
    EXPECT_GT(sum.slid, 300);
    EXPECT_GT(sum.stuck, 300);
  }
}

// The example of every engine: a square at 20 degrees that falls at 3 m/s and neither e nor mu is said.
TEST(CornerImpacts, ASquareAtTwentyDegreesIsTheSameAtEveryRateByBothSolvers) {
  Drop it;
  it.width = it.height = 1, it.mass = 1, it.e = 0.8, it.mu = 0.5, it.y = 1;
  it.angle = 20 * std::numbers::pi / 180;
  for (const Solver solver : {Solver::direct, Solver::iterative}) {
    for (const int rate : {60, 600, 6000}) EXPECT_EQ(compare({it}, solver, rate, 1e-12).all, 1) << rate;
  }
}

TEST(CornerImpacts, HowManyOthersThereAreDoesNotMatter) {
  for (const int rate : {60, 600, 6000}) {
    for (const int many : {20, 100, 1000}) {
      std::vector<Drop> drops;
      for (int i = 0; i < many; ++i) drops.push_back(drop(i));
      EXPECT_GT(compare(drops, Solver::iterative, rate, kExactBound).all, many / 2) << rate;
    }
  }
}

TEST(CornerImpacts, WhatIsNearButNotMetDoesNotMatter) {
  for (const int rate : {60, 600, 6000}) {
    for (const int many : {1, 20, 100, 1000}) {
      std::vector<Drop> drops;
      for (int i = 0; i < many; ++i) drops.push_back(drop(i + 1));
      EXPECT_GE(compare(drops, Solver::iterative, rate, kIterativeBound, true).all, many / 2) << rate;
    }
  }
}

// Flat onto the floor with friction: both corners meet at once. v_n' = -e v_n in both, so it does not turn;
// friction stops it along the floor or is mu p_n.
TEST(CornerImpacts, ABoxThatLandsFlatDoesNotTurnAndIsRubbed) {
  for (const Solver solver : {Solver::direct, Solver::iterative}) {
    for (const double e : {0.2, 0.5, 1.0}) {
      for (const double mu : {0.0, 0.1, 0.3}) {
        for (const int rate : {60, 600}) {
          Drop it;
          it.e = e, it.mu = mu, it.y = 0.25 + 0.1 + 1e-3, it.angle = 0, it.v = {5, -2};
          const State<2> now = stepped(room_of({it}, solver, rate), rate / 10);
          // K is not diagonal: friction at the floor would turn the box, the corners' impulses turn it back
          EXPECT_NEAR(now.v[0].y(), 2 * e, 1e-9) << e << " " << mu;
          EXPECT_NEAR(now.v[0].x(), 5 - mu * (1 + e) * 2, 1e-9) << e << " " << mu;
          EXPECT_NEAR(now.spin[0][0], 0, 1e-9) << e << " " << mu;
        }
      }
    }
  }
}

// two of any shapes that fly at each other, far off from anything else
World<2> meeting(int seed, Collision collision, int rate) {
  Chance chance(std::uint64_t(seed) * 977 + 5);
  World<2> world = touching_room(collision, {0, 0});
  if (collision == Collision::contact) world.model.solver = Solver::iterative;
  world.model.rate = {rate, 1};
  const double e = seed % 3 == 0 ? 1 : chance.between(0.2, 1);
  for (int side = 0; side < 2; ++side) {
    const Vec2 x(side ? 1.0 : 0, chance.between(-0.2, 0.2)),
        v(side ? chance.between(-3, 0) : chance.between(1, 3), chance.between(-0.2, 0.2));
    const double mass = chance.between(0.2, 5), angle = chance.between(-3, 3), spin = chance.between(-4, 4);
    switch ((seed / (side ? 3 : 1)) % 3) {
      case 0:
        add_ball(world, chance.between(0.1, 0.4), mass, x, v, spin, e);
        break;
      case 1:
        add_box(world, {chance.between(0.2, 0.6), chance.between(0.2, 0.6)}, mass, x, v, angle, spin, e);
        break;
      default:
        add_polygon(world, odd_polygon(chance, 3 + seed % 4, chance.between(0.2, 0.4)), mass, x, v, angle,
                    spin, e);
    }
  }
  rub(world, seed % 4 == 0 ? 0 : chance.between(0.05, 1));
  return world;
}

// Against the exact solver, and every impact keeps momentum and angular momentum to rounding.
TEST(CornerImpacts, TwoBodiesPartAsTheExactSolverSays) {
  int met = 0;
  for (int seed = 0; seed < 300; ++seed) {
    const auto [want, impacts] = first_impact(meeting(seed, Collision::event, 600), 1.0 / 15);
    if (impacts != 1 || want.time > 0.9) continue;  // none, or two near each other
    for (const int rate : {60, 600, 6000}) {
      const World<2> world = meeting(seed, Collision::contact, rate);
      const auto [got, all] = first_impact(world, 1.0 / 30);
      EXPECT_GE(got.time, 0) << seed << " at " << rate;
      if (got.time < 0) continue;
      ++met;
      EXPECT_EQ(all, 1) << seed << " at " << rate;
      const Eigen::Vector3d before = momenta(world, world.state), after = momenta(world, got.state);
      EXPECT_NEAR((after - before).norm(), 0, 1e-12 * before.norm() + 1e-12) << seed << " at " << rate;
      for (int i = 0; i < 2; ++i) {
        EXPECT_NEAR((got.state.v[i] - want.state.v[i]).norm(), 0, 1e-7) << seed << " at " << rate;
        EXPECT_NEAR(got.state.spin[i][0], want.state.spin[i][0], 1e-6) << seed << " at " << rate;
      }
    }
  }
  EXPECT_GT(met, 80);
}

// A box that lands all but level on both corners, which hold: the normals are exact, and what their heights
// leave of the slip is no more than these differ. Taking turns would not end: one corner's friction is almost
// the other's.
TEST(CornerImpacts, OfABoxThatLandsLevelStopItsFace) {
  std::mt19937 bits(5);
  std::uniform_real_distribution<double> any(-1, 1);
  for (int n = 0; n < 1000; ++n) {
    const double m = 2, half = 0.3, high = 0.25, inertia = m * (4 * half * half + 4 * high * high) / 12;
    plane::PairImpact it;
    it.closed[0] = it.closed[1] = true, it.mu = 0.8;
    // rows (x, y, moment) of each corner's normal and tangent, of one a little lower
    const double lower = 1e-4 * any(bits);
    const double rows[4][3] = {{0, 1, -half}, {1, 0, high}, {0, 1, half}, {1, 0, high + lower}};
    const double speed[3] = {0.3 * any(bits), -1 + 0.3 * any(bits), 0.5 * any(bits)};
    for (int i = 0; i < 4; ++i) {
      for (int k = 0; k < 3; ++k) it.v[i] += rows[i][k] * speed[k];
      for (int k = 0; k < 4; ++k)
        it.K[i][k] =
            (rows[i][0] * rows[k][0] + rows[i][1] * rows[k][1]) / m + rows[i][2] * rows[k][2] / inertia;
    }
    double p[4], w[4];
    plane::solve(it, p);
    for (int i = 0; i < 4; ++i) {
      w[i] = it.v[i];
      for (int k = 0; k < 4; ++k) w[i] += it.K[i][k] * p[k];
    }
    for (const int touch : {0, 1}) {
      EXPECT_GE(p[2 * touch], 0) << n;
      EXPECT_LE(std::abs(p[2 * touch + 1]), it.mu * p[2 * touch] * (1 + 1e-12)) << n;
    }
    EXPECT_NEAR(p[0] > 0 ? w[0] : std::min(w[0], 0.0), 0, 1e-12) << n;
    EXPECT_NEAR(p[2] > 0 ? w[2] : std::min(w[2], 0.0), 0, 1e-12) << n;
    EXPECT_NEAR(w[1], 0, 1e-12) << n;
    EXPECT_NEAR(w[3], 0, 1e-3) << n;
  }
}

}  // namespace
}  // namespace obscura::sim

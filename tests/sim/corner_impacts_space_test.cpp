// Cubes that fall on a corner in space, with friction: by both solvers, against a closed form.
//
// A cube has one moment of inertia I, so it turns about an axis that stays: R(t) = exp(w t) R(0). Impulses p
// on the corner at r from the centre change its velocity by K p, K = (1/m + r.r/I) 1 - r r'/I. Newton says
// what the normal component becomes, and Coulomb that p stops the corner or that p_t = -mu p_n d, with d the
// direction in which it slides then: the angle of d is found by halving.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "sim/first_impact.h"
#include "sim/space_rooms.h"
#include "sim/touching.h"

namespace obscura::sim {
namespace {

const Vec3 kUp(0, 1, 0);

Shape<3> round(double radius) { return Ball<3>{radius}; }

struct Fall {
  double side = 0.5, mass = 2, e = 0.5, mu = 0.5, y = 2;
  Orientation<3> turn = no_rotation<3>();
  Vec3 v = {0, -3, 0}, spin = Vec3::Zero();

  double inertia() const { return mass * side * side / 6; }
};

struct Landed {
  double time = 0;
  Vec3 v = Vec3::Zero(), spin = Vec3::Zero();
  bool slides = false, gains = false;
};

Vec3 lowest(const Fall& fall, double t) {
  const Rotation<3> now = rotation<3>(turned<3>(fall.turn, Vec3(fall.spin * t)));
  Vec3 best(0, 1e300, 0);
  for (int corner = 0; corner < 8; ++corner) {
    const Vec3 at =
        now * (fall.side / 2 * Vec3(corner & 1 ? 1 : -1, corner & 2 ? 1 : -1, corner & 4 ? 1 : -1));
    if (at.y() < best.y()) best = at;
  }
  return best;
}

double first_touch(const Fall& fall) {
  const auto at = [&](double t) { return fall.y + fall.v.y() * t + lowest(fall, t).y(); };
  double t = 0;
  while (at(t + 1e-4) > 0) t += 1e-4;
  double low = t, high = t + 1e-4;
  for (int i = 0; i < 60; ++i) {
    const double mid = 0.5 * (low + high);
    (at(mid) > 0 ? low : high) = mid;
  }
  return 0.5 * (low + high);
}

Landed landing_by_newton(const Fall& fall) {
  Landed out;
  out.time = first_touch(fall);
  const double m = fall.mass, I = fall.inertia();
  const Vec3 r = lowest(fall, out.time), v = fall.v + fall.spin.cross(r);
  const Eigen::Matrix3d K = (1 / m + r.dot(r) / I) * Eigen::Matrix3d::Identity() - r * r.transpose() / I;
  const double bounced = -fall.e * v.y();

  // that stops the corner along the floor
  Vec3 p = K.inverse() * (bounced * kUp - v);
  out.slides = Vec3(p.x(), 0, p.z()).norm() > fall.mu * p.y();
  if (out.slides) {
    const auto pushed = [&](double angle) -> Vec3 {
      const Vec3 way = kUp - fall.mu * Vec3(std::cos(angle), 0, std::sin(angle));
      return (bounced - v.y()) / kUp.dot(K * way) * way;
    };
    // how far the slip turns from the direction it is taken to have, and how much of it is along that
    const auto turns = [&](double angle) {
      const Vec3 slip = v + K * pushed(angle);
      return std::pair(slip.z() * std::cos(angle) - slip.x() * std::sin(angle),
                       slip.x() * std::cos(angle) + slip.z() * std::sin(angle));
    };
    const int parts = 720;
    double best = -1;
    for (int i = 0; i < parts; ++i) {
      double low = 2 * std::numbers::pi * i / parts, high = 2 * std::numbers::pi * (i + 1) / parts;
      if (turns(low).first * turns(high).first > 0) continue;
      for (int n = 0; n < 60; ++n) {
        const double mid = 0.5 * (low + high);
        (turns(mid).first * turns(low).first > 0 ? low : high) = mid;
      }
      if (turns(low).second > best && pushed(low).y() >= 0) best = turns(low).second, p = pushed(low);
    }
  }
  out.v = fall.v + p / m, out.spin = fall.spin + r.cross(p) / I;
  const double before = m * fall.v.squaredNorm() + I * fall.spin.squaredNorm(),
               after = m * out.v.squaredNorm() + I * out.spin.squaredNorm();
  out.gains = after > before * (1 + 1e-12);
  return out;
}

Landed landing_of(const Fall& fall) { return without_gain(fall, landing_by_newton); }

bool free_after(const Fall& fall, const Landed& landed, double time) {
  Fall then = fall;
  then.y += fall.v.y() * landed.time, then.turn = turned<3>(fall.turn, Vec3(fall.spin * landed.time));
  then.v = landed.v, then.spin = landed.spin;
  for (int i = 1; i <= 100; ++i) {
    const double t = time * i / 100;
    if (then.y + then.v.y() * t + lowest(then, t).y() <= 0) return false;
  }
  return true;
}

Fall fall(int seed) {
  Chance chance(std::uint64_t(seed) * 6571 + 3);
  const double es[] = {0.2, 0.5, 0.8, 1}, mus[] = {0, 0.1, 0.3, 0.6, 1.2};
  const auto vec = [&](double size) -> Vec3 {
    return {chance.between(-size, size), chance.between(-size, size), chance.between(-size, size)};
  };
  Fall it;
  it.side = chance.between(0.3, 1), it.mass = chance.between(0.2, 5);
  it.e = es[seed % 4], it.mu = mus[seed / 4 % 5];
  it.turn = exponential(vec(2));
  it.spin = seed % 3 == 0 ? Vec3(Vec3::Zero()) : vec(6);
  it.v = vec(3);
  it.v.y() = -chance.between(0.5, 6);
  it.y = -lowest(it, 0).y() + chance.between(0.02, 0.1) * -it.v.y();
  return it;
}

// turned about the vertical and mirrored, the same must come of it
Fall mirrored(const Fall& it) {
  Fall out = it;
  // x -> -x: of a turn and a spin the parts along y and z change their sign
  out.v.x() = -it.v.x();
  out.spin = {it.spin.x(), -it.spin.y(), -it.spin.z()};
  out.turn = {it.turn[0], -it.turn[1], -it.turn[2], it.turn[3]};
  return out;
}

World<3> room_of(const std::vector<Fall>& falls, Solver solver, int rate) {
  World<3> world = space({0, 0, 0});
  world.model.collision = Collision::contact, world.model.solver = solver, world.model.rate = {rate, 1};
  world.model.scale = 4;
  add_wall(world, {0, 0, 0}, kUp);
  for (std::size_t i = 0; i < falls.size(); ++i) {
    const Fall& it = falls[i];
    const int body =
        add_solid(world, brick({it.side, it.side, it.side}), it.mass,
                  {3.0 * double(i % 32), it.y, 3.0 * double(i / 32)}, it.v, it.turn, it.spin, it.e);
    world.model.bodies[body].friction = it.mu;
  }
  return world;
}

struct Compared {
  int all = 0, slid = 0, stuck = 0;
};

Compared compare(const std::vector<Fall>& falls, Solver solver, int rate, double bound) {
  const World<3> world = room_of(falls, solver, rate);
  State<3> state = world.state;
  Stepper<3> stepper(world.model);
  stepper.begin(state);
  std::vector<Landed> want;
  double last = 0;
  for (const Fall& it : falls) want.push_back(landing_of(it)), last = std::max(last, want.back().time);
  Compared count;
  std::vector<char> done(falls.size(), 0);
  const double h = 1.0 / rate;
  while (double(state.step) * h < last + h) {
    EXPECT_FALSE(stepper.step(state));
    const double now = double(state.step) * h;
    for (std::size_t i = 0; i < falls.size(); ++i) {
      if (done[i] || now < want[i].time) continue;
      done[i] = 1;
      if (!free_after(falls[i], want[i], std::max(1e-3, 1.5 * h))) continue;
      const double size = falls[i].v.norm() + falls[i].spin.norm() * falls[i].side;
      EXPECT_NEAR((state.v[i] - want[i].v).norm(), 0, bound * size)
          << "cube " << i << " of " << falls.size() << " at " << rate;
      EXPECT_NEAR((state.spin[i] - want[i].spin).norm() * falls[i].side, 0, bound * size)
          << "cube " << i << " of " << falls.size() << " at " << rate;
      ++count.all, ++(want[i].slides ? count.slid : count.stuck);
    }
  }
  return count;
}

// The exact solver, which moves what meets nothing but walls, finds places to 1e-9 of the room: where a
// corner comes slowly, a cube of 10 rad/s turns by 1e-7 meanwhile.
constexpr double kBound = 2e-7;

TEST(CornerImpactsInSpace, ACubeLeavesTheFloorAsTheClosedFormSaysByBothSolvers) {
  for (const Solver solver : {Solver::direct, Solver::iterative}) {
    Compared sum;
    for (const int rate : {60, 600, 6000}) {
      for (int seed = 0; seed < 120; ++seed) {
        const Fall it = fall(seed);
        for (const Fall& one : {it, mirrored(it)}) {
          const Compared count = compare({one}, solver, rate, kBound);
          sum.all += count.all, sum.slid += count.slid, sum.stuck += count.stuck;
        }
      }
    }
    EXPECT_GT(sum.slid, 100);
    EXPECT_GT(sum.stuck, 100);
  }
}

TEST(CornerImpactsInSpace, HowManyOthersThereAreDoesNotMatter) {
  for (const int rate : {60, 600, 6000}) {
    for (const int many : {20, 100, 1000}) {
      if (rate == 6000 && many == 1000) continue;  // long
      std::vector<Fall> falls;
      for (int i = 0; i < many; ++i) falls.push_back(fall(i));
      EXPECT_GT(compare(falls, Solver::iterative, rate, kBound).all, many / 3) << rate;
    }
  }
}

TEST(CornerImpactsInSpace, ACubeThatLandsFlatDoesNotTurnAndIsRubbed) {
  for (const Solver solver : {Solver::direct, Solver::iterative}) {
    for (const double e : {0.2, 0.5, 1.0}) {
      for (const double mu : {0.0, 0.1, 0.3}) {
        for (const int rate : {60, 600}) {
          Fall it;
          it.e = e, it.mu = mu, it.y = 0.25 + 0.1 + 1e-3, it.v = {4, -2, 3};
          const State<3> now = stepped(room_of({it}, solver, rate), rate / 10);
          const Vec3 slowed = (5 - mu * (1 + e) * 2) / 5 * Vec3(4, 0, 3);
          EXPECT_NEAR((now.v[0] - slowed - 2 * e * kUp).norm(), 0, 1e-9) << e << " " << mu;
          EXPECT_NEAR(now.spin[0].norm(), 0, 1e-9) << e << " " << mu;
        }
      }
    }
  }
}

// a ball flung past another's middle: both turn, and momentum and angular momentum stay to rounding
TEST(CornerImpactsInSpace, AnOffCentreRoughImpactKeepsAngularMomentum) {
  for (const int rate : {60, 600, 6000}) {
    for (const bool cubes : {false, true}) {
      World<3> world = space({0, 0, 0});
      world.model.collision = Collision::contact, world.model.solver = Solver::iterative;
      world.model.rate = {rate, 1}, world.model.scale = 4;
      const Shape<3> shape = cubes ? brick({0.3, 0.3, 0.3}) : round(0.2);
      add_solid(world, shape, 2, {0, 0, 0}, {0, 0, 0}, exponential(Vec3(0.3, 0.5, -0.2)), {1, 2, -3}, 0.7);
      add_solid(world, shape, 1, {-1, 0.15, 0.05}, {5, 0, 0}, exponential(Vec3(1, -0.5, 0.2)), {-2, 1, 1},
                0.7);
      for (Body<3>& body : world.model.bodies) body.friction = 0.6;
      const auto angular = [&](const State<3>& state) {
        Vec3 sum = Vec3::Zero();
        for (int i = 0; i < 2; ++i) {
          const Body<3>& body = world.model.bodies[i];
          sum += body.mass * state.x[i].cross(state.v[i]) +
                 inertia_times<3>(body.inertia, rotation<3>(state.turn[i]), state.spin[i]);
        }
        return sum;
      };
      const State<3> now = stepped(world, rate / 4);
      EXPECT_GT((now.v[0]).norm(), 0.5) << "they must have met";
      EXPECT_NEAR((angular(now) - angular(world.state)).norm(), 0, 1e-11) << rate << " " << cubes;
      EXPECT_NEAR((2 * now.v[0] + now.v[1] - Vec3(5, 0, 0)).norm(), 0, 1e-12) << rate << " " << cubes;
    }
  }
}

// two balls or cubes, whose spin stays in flight, that fly at each other
World<3> meeting(int seed, Collision collision, int rate) {
  Chance chance(std::uint64_t(seed) * 977 + 5);
  World<3> world = space({0, 0, 0});
  world.model.collision = collision, world.model.scale = 4, world.model.rate = {rate, 1};
  if (collision == Collision::contact) world.model.solver = Solver::iterative;
  const auto vec = [&](double size) -> Vec3 {
    return {chance.between(-size, size), chance.between(-size, size), chance.between(-size, size)};
  };
  const double e = seed % 3 == 0 ? 1 : chance.between(0.2, 1),
               mu = seed % 4 == 0 ? 0 : chance.between(0.05, 1);
  for (int side = 0; side < 2; ++side) {
    Vec3 x = vec(0.2), v = vec(0.2);
    x.x() = side ? 1.0 : 0, v.x() = side ? chance.between(-3, 0) : chance.between(1, 3);
    const double size = chance.between(0.2, 0.5);
    const bool ball = (seed / (side ? 3 : 1)) % 3 == 0;
    const int body = add_solid(world, ball ? round(size / 2) : brick({size, size, size}),
                               chance.between(0.2, 5), x, v, exponential(vec(2)), vec(4), e);
    world.model.bodies[body].friction = mu;
  }
  return world;
}

TEST(CornerImpactsInSpace, TwoBodiesPartAsTheExactSolverSays) {
  int met = 0;
  for (int seed = 0; seed < 300; ++seed) {
    const auto [want, impacts] = first_impact(meeting(seed, Collision::event, 600), 1.0 / 15);
    if (impacts != 1 || want.time > 0.9) continue;  // none, or two near each other
    for (const int rate : {60, 600, 6000}) {
      const auto [got, all] = first_impact(meeting(seed, Collision::contact, rate), 1.0 / 30);
      EXPECT_GE(got.time, 0) << seed << " at " << rate;
      if (got.time < 0) continue;
      ++met;
      EXPECT_EQ(all, 1) << seed << " at " << rate;
      for (int i = 0; i < 2; ++i) {
        EXPECT_NEAR((got.state.v[i] - want.state.v[i]).norm(), 0, 1e-7) << seed << " at " << rate;
        EXPECT_NEAR((got.state.spin[i] - want.state.spin[i]).norm(), 0, 1e-6) << seed << " at " << rate;
      }
    }
  }
  EXPECT_GT(met, 80);
}

}  // namespace
}  // namespace obscura::sim

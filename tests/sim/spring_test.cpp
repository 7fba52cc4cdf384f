// Springs against closed forms and tables, handout §2.2.

#include "sim/force/spring.h"

#include <gtest/gtest.h>

#include <cmath>

#include "sim/reference.h"
#include "sim/rooms.h"

namespace obscura::sim {
namespace {

// m = 1, k = 100, x0 = 1 at rest, hung on the origin without a rest length: x'' = -100 x - c x'
World<2> oscillator(Rational rate, double c = 0) {
  World<2> world = room({0, 0});
  world.model.rate = rate;
  add_particle(world, {1, 0});
  add_spring(world, {0, {0, 0}}, {-1, {0, 0}}, 100, 0, c);
  return world;
}

TEST(Oscillator, IsWhatRungeKuttaMakesOfItStepByStep) {
  struct Case {
    int rate, steps;
    const char* key;
  };
  for (const auto& [rate, steps, key] :
       {Case{50, 50, "h=0.02 N=50 "}, Case{100, 100, "h=0.01 N=100 "}, Case{100, 1000, "h=0.01 N=1000 "},
        Case{200, 200, "h=0.005 N=200 "}, Case{400, 400, "h=0.0025 N=400 "},
        Case{800, 800, "h=0.00125 N=800 "}}) {
    const auto want = closed_form({"oscillator_rk4_discrete", key});
    const auto now = shown(*run(oscillator({rate, 1})), rational(steps, rate));
    // a thousand steps of rounding at 1 (x) and 10 (v)
    EXPECT_NEAR(now.bodies[0].position.x(), want[0], 1e-13) << key;
    EXPECT_NEAR(now.bodies[0].velocity.x(), want[1], 1e-12) << key;
    EXPECT_NEAR(now.energies.total() / 50, want[2], 1e-13) << key;
    EXPECT_NEAR(now.bodies[0].position.x() - std::cos(10.0 * steps / rate), want[3], 1e-12) << key;
  }
}

TEST(Oscillator, SwingsAsItMust) {
  const auto swing = run(oscillator({16000, 1}));
  for (const auto& [t, key] : {std::pair{Rational{1, 10}, "at t=0.1,"},
                               {Rational{1, 1}, "at t=1,"},
                               {Rational{10, 1}, "at t=10,"}}) {
    const auto want = closed_form({"oscillator_exact", key});
    const auto at = shown(*swing, t).bodies[0];
    // RK4: t w (w h)^4 / 120 = 1.3e-13 at t = 10, and rounding
    EXPECT_NEAR(at.position.x(), want[0], 1e-12);
    EXPECT_NEAR(at.velocity.x(), want[1], 1e-11);
  }
}

TEST(Oscillator, IsDampedAsItMust) {
  struct Case {
    const char* name;
    double c;
  };
  for (const auto& [name, c] :
       {Case{"damped_spring_under", 2}, Case{"damped_spring_critical", 20}, Case{"damped_spring_over", 50}}) {
    const auto swing = run(oscillator({16000, 1}, c));
    for (const auto& [t, key] : {std::pair{Rational{1, 10}, "at t=0.1,"},
                                 {Rational{1, 2}, "at t=0.5,"},
                                 {Rational{1, 1}, "at t=1,"},
                                 {Rational{2, 1}, "at t=2,"}}) {
      const auto want = closed_form({name, key});
      const auto at = shown(*swing, t).bodies[0];
      // the fastest mode decays with 48/s: RK4 errs (48/16000)^5/120 a step of it, 6e-12 in all
      EXPECT_NEAR(at.position.x(), want[0], 2e-12) << name << key;
      EXPECT_NEAR(at.velocity.x(), want[1], 1e-10) << name << key;
    }
  }
}

TEST(HangingSpring, ComesToRestAtItsStaticExtension) {
  World<2> world = room();
  add_particle(world, {0, -1});
  add_spring(world, {0, {0, 0}}, {-1, {0, 0}}, 40, 1, 12);
  const auto at = shown(*run(world), {10, 1}).bodies[0];
  EXPECT_NEAR(at.position.y(), -1 - closed_form({"hanging_spring"})[0], 1e-13);
  EXPECT_NEAR(at.velocity.y(), 0, 1e-13);  // exp(-60) of the swing is 1e-26: rounding is left
}

TEST(HangingSpring, StaysAtItsStaticExtension) {
  World<2> world = room();
  add_particle(world, {0, -1 - 9.81 / 40});
  add_spring(world, {0, {0, 0}}, {-1, {0, 0}}, 40, 1);
  EXPECT_NEAR(shown(*run(world), {10, 1}).bodies[0].position.y(), -1.24525, 1e-14);
}

enum class Case { pendulum, damped, box };

World<2> cross_velocity(Case which, int rate) {
  World<2> world = room();
  world.model.rate = {rate, 1};
  if (which == Case::box) {
    add_box(world, {1, 0.5}, 2, {0, 0});
    add_spring(world, {0, {0.5, 0.25}}, {-1, {0.8, 1.5}}, 30, 0.2);
  } else {
    add_particle(world, {1.1, -0.3});
    add_spring(world, {0, {0, 0}}, {-1, {0, 0}}, 40, 1, which == Case::damped ? 0.8 : 0);
  }
  return world;
}

// largest error of a row of a table
double error(const Snapshot::Body& at, const std::vector<double>& row) {
  std::vector<double> got = {at.position.x(), at.position.y()};
  if (row.size() == 7) got.push_back(at.angle);
  got.push_back(at.velocity.x()), got.push_back(at.velocity.y());
  if (row.size() == 7) got.push_back(at.spin.z());
  double most = 0;
  for (std::size_t i = 0; i < got.size(); ++i) most = std::max(most, std::fabs(got[i] - row[i + 1]));
  return most;
}

// no worse than `times` a plain double-precision RK4 at the same step, and rounding where that one is lucky
void expect_table(Case which, const char* name, const char* errors, double times) {
  for (const int rate : {240, 1000, 4000, 16000}) {
    const auto reachable = rk4_errors(errors, rate);
    const auto motion = run(cross_velocity(which, rate));
    for (const auto& row : table(name)) {
      const auto found = reachable.find(row[0]);
      if (found == reachable.end()) continue;
      const auto at = shown(*motion, *from_double(row[0])).bodies[0];
      EXPECT_LT(error(at, row), times * found->second + 3e-13) << name << " 1/" << rate << " at " << row[0];
    }
  }
}

TEST(ElasticPendulum, FollowsItsTable) {
  expect_table(Case::pendulum, "elastic_pendulum.csv", "elastic_pendulum", 2);
}

TEST(ElasticPendulum, FollowsItsTableWithADashpot) {
  // errors are listed for the undamped one only; the dashpot adds terms of the same size
  expect_table(Case::damped, "elastic_pendulum_damped.csv", "elastic_pendulum", 3);
}

TEST(BoxOnACornerSpring, FollowsItsTable) {
  expect_table(Case::box, "box_on_corner_spring_2d.csv", "box_on_corner_spring_2d", 2);
}

// the same scheme written out for the six numbers of this box alone
TEST(BoxOnACornerSpring, StepsAsTheSchemeByHand) {
  const double h = 1.0 / 1000, m = 2, inertia = m * (1 + 0.25) / 12, k = 30, rest = 0.2;
  using Six = Eigen::Matrix<double, 6, 1>;
  const auto f = [&](const Six& y) {
    const double c = std::cos(y[2]), s = std::sin(y[2]);
    const double rx = c * 0.5 - s * 0.25, ry = s * 0.5 + c * 0.25;
    const double dx = y[0] + rx - 0.8, dy = y[1] + ry - 1.5, l = std::sqrt(dx * dx + dy * dy);
    const double fx = -k * (l - rest) * dx / l, fy = -k * (l - rest) * dy / l;
    Six rate;
    rate << y[3], y[4], y[5], fx / m, fy / m - 9.81, (rx * fy - ry * fx) / inertia;
    return rate;
  };
  Six y = Six::Zero();
  for (int i = 0; i < 1000; ++i) {
    const Six k1 = f(y), k2 = f(y + h / 2 * k1), k3 = f(y + h / 2 * k2), k4 = f(y + h * k3);
    y += h * (k1 + 2 * k2 + 2 * k3 + k4) / 6;
  }
  const auto at = shown(*run(cross_velocity(Case::box, 1000)), {1, 1}).bodies[0];
  // the same scheme: rounding only
  EXPECT_NEAR(at.position.x(), y[0], 1e-12);
  EXPECT_NEAR(at.position.y(), y[1], 1e-12);
  EXPECT_NEAR(at.angle, y[2], 1e-12);
  EXPECT_NEAR(at.spin.z(), y[5], 1e-11);
}

TEST(Spring, PushesWhenShorterThanItsRest) {
  const SpringLaw s{1, 10, 0};
  EXPECT_GT((pull<2>(s, {0.5, 0}, {0, 0}, {0, 0}, {0, 0}).x()), 0);
  EXPECT_LT((pull<2>(s, {1.5, 0}, {0, 0}, {0, 0}, {0, 0}).x()), 0);
  // handout: f = -k (l - l_rest) d
  EXPECT_EQ((pull<2>(s, {0, 3}, {0, 0}, {0, 0}, {0, 0})), Vec2(0, -20));
}

TEST(Spring, DampsAlongItsAxisOnly) {
  const SpringLaw s{1, 0, 2};
  EXPECT_EQ((pull<2>(s, {1, 0}, {3, 5}, {0, 0}, {1, 1})), Vec2(-4, 0));
}

TEST(Spring, OfNoLengthPushesAlongX) {
  const SpringLaw s{1, 10, 0};
  EXPECT_EQ((pull<2>(s, {2, 2}, {0, 0}, {2, 2}, {0, 0})), Vec2(10, 0));
  World<2> world = room({0, 0});
  add_particle(world, {2, 2});
  add_spring(world, {0, {0, 0}}, {-1, {2, 2}}, 10, 1);
  const auto now = shown(*run(world), {1, 1});
  EXPECT_TRUE(std::isfinite(now.bodies[0].position.x()));
  EXPECT_NEAR(now.energies.total(), 5, 1e-9);  // k l_rest^2 / 2 was stored
}

TEST(Spring, BetweenTwoPointsOfOneBodyMovesNothing) {
  World<2> world = room({0, 0});
  add_box(world, {1, 0.5}, 2, {0, 0});
  add_spring(world, {0, {0.5, 0.25}}, {0, {-0.5, 0.25}}, 30, 0.2);
  const auto at = shown(*run(world), {1, 1}).bodies[0];
  EXPECT_EQ(at.position, Vec3::Zero());
  EXPECT_NEAR(at.angle, 0, 1e-15);
}

TEST(Spring, HoldsOnToAFixedBody) {
  // the corner of a fixed, turned box is a place in the room like any other
  World<2> by_place = room(), by_body = room();
  add_particle(by_place, {1, 1}), add_particle(by_body, {1, 1});
  const double angle = 0.3;
  const int box = add_box(by_body, {1, 0.5}, 2, {0, 2}, {0, 0}, angle);
  by_body.model.bodies[box].fixed = true;
  const Vec2 local(0.5, 0.25), corner = Vec2(0, 2) + rotation<2>(Orientation<2>(angle)) * local;
  add_spring(by_body, {0, {0, 0}}, {box, local}, 30, 0.2);
  add_spring(by_place, {0, {0, 0}}, {-1, corner}, 30, 0.2);
  EXPECT_EQ(stepped(by_body, 1000).x[0], stepped(by_place, 1000).x[0]);
}

}  // namespace
}  // namespace obscura::sim

// Joints by sweeps: against tables, closed forms, and the direct solver.

#include "sim/solve/iterate/joint_solver.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "allocations.h"
#include "sim/jointed.h"
#include "sim/reference.h"
#include "sim/solve/iterate/plane.h"
#include "sim/touching.h"

namespace obscura::sim {
namespace {

World<2> swept_room(Vec2 gravity = {0, -9.81}) {
  World<2> world = touching_room(Collision::contact, gravity);
  world.model.solver = Solver::iterative;
  return world;
}

// how far the second bob is from the table's at t = 2 s
double pendulum_error(int rate) {
  World<2> world = swept_room();
  world.model.rate = {rate, 1};
  const double degree = std::acos(-1) / 180;
  const Vec2 p = hanging(30 * degree), q = p + hanging(45 * degree);
  add_particle(world, p), add_particle(world, q);
  world.model.joints.push_back(rod({0, {0, 0}}, {-1, {0, 0}}, 1));
  world.model.joints.push_back(rod({1, {0, 0}}, {0, {0, 0}}, 1));
  const State<2> now = stepped(world, 2 * rate);
  const auto want = row_at("double_pendulum_point_regular.csv", 2);
  EXPECT_NEAR(now.x[0].norm(), 1, 1e-13) << "joints do not drift";
  EXPECT_NEAR((now.x[1] - now.x[0]).norm(), 1, 1e-13);
  return (now.x[1] - hanging(want[1]) - hanging(want[2])).norm();
}

// as Runge and Kutta's scheme: half the step, a sixteenth of the error, to what the next order adds
TEST(IterativeJoints, ADoublePendulumIsOfFourthOrder) {
  const double coarse = pendulum_error(300), middle = pendulum_error(600), fine = pendulum_error(1200);
  EXPECT_NEAR(coarse / middle, 16, 0.1);
  EXPECT_NEAR(middle / fine, 16, 0.05);
  EXPECT_LT(middle, 1e-9);
}

// Four rods swing chaotically: what one run errs by in a minute is a matter of its bits (of starts that
// differ by 1e-7 rad/s 1.8e-6 to 7e-6 of the energy). The median of five starts, in a quarter of it, is not:
// 2e-7 to 3.2e-7.
TEST(IterativeJoints, PinnedRodsKeepTheEnergy) {
  std::vector<double> errors;
  for (int start = 0; start < 5; ++start) {
    World<2> world = swept_room();
    const double right = std::acos(-1) / 2;
    for (int i = 0; i < 4; ++i) {
      add_box(world, {0.02, 1}, 1, (i + 0.5) * hanging(right), {0, 0}, right);
      world.model.joints.push_back(pin({i, {0, 0.5}}, {i - 1, i == 0 ? Vec2(0, 0) : Vec2(0, -0.5)}));
    }
    world.state.spin[3][0] = 1e-3 * start;
    world.model.ignore.emplace_back(0, 0);
    const double begun = energy(world, world.state), size = 4 * 9.81 * 4;
    const State<2> now = stepped(world, 9000);
    errors.push_back(std::fabs(energy(world, now) - begun) / size);
    for (int i = 1; i < 4; ++i) {
      const Vec2 end = now.x[i] - 0.5 * hanging(now.turn[i][0]);
      EXPECT_NEAR((end - now.x[i - 1] - 0.5 * hanging(now.turn[i - 1][0])).norm(), 0, 1e-12);
    }
  }
  std::sort(errors.begin(), errors.end());
  EXPECT_LT(errors[2], 5e-7);
  EXPECT_LT(errors[4], 3e-6);
}

// on a taut rope, with gravity and without: as on a rod
TEST(IterativeJoints, ATautRopeSwingsAsARod) {
  for (const Vec2& gravity : {Vec2(0, -9.81), Vec2(0, 0)}) {
    const auto error = [&](JointKind kind, int rate) {
      World<2> world = touching_room(Collision::contact, gravity);
      world.model.solver = Solver::iterative, world.model.rate = {rate, 1};
      add_particle(world, {0, -1}, {8, 0});
      world.model.joints = {rod({0, {0, 0}}, {-1, {0, 0}}, 1)};
      world.model.joints[0].kind = kind;
      const double begun = energy(world, world.state);
      const State<2> now = stepped(world, rate);
      EXPECT_NEAR(now.x[0].norm(), 1, 1e-12) << rate;
      return std::fabs(energy(world, now) - begun);
    };
    // 32 J in motion, at 8 rad/s; what contacts may not give costs a rope a little that a rod keeps
    const double coarse = error(JointKind::rope, 300), fine = error(JointKind::rope, 600);
    EXPECT_LT(fine, 1e-7) << gravity;
    EXPECT_GT(coarse / fine, 12) << gravity;
    EXPECT_NEAR(fine, error(JointKind::rod, 600), 1e-7) << gravity;
  }
}

// A diver folded up in the air: motors go on pressing arm, hip and knee against their limits, which no longer
// move, so nothing gives energy. Where joints were put back after the limits these were off by the square of
// that, open or closed to the next step, and 3 J a second came from striking them in each.
TEST(IterativeJoints, MotorsThatPressLimitsGiveNothing) {
  World<2> world = swept_room({0, 0});
  world.model.rate = {240, 1}, world.model.scale = 5.625;
  const double degree = std::acos(-1) / 180, spin = 150 * degree;
  const auto v = [&](double height) { return Vec2(spin * (1.1171 - height), 0); };
  add_box(world, {0.13, 0.48}, 8, {0, 0.26}, v(0.26), 0, spin);
  add_box(world, {0.16, 0.48}, 16, {0, 0.74}, v(0.74), 0, spin);
  add_box(world, {0.26, 0.6}, 30, {0, 1.28}, v(1.28), 0, spin);
  add_ball(world, 0.13, 5, {0, 1.72}, v(1.72), spin);
  add_box(world, {0.1, 0.62}, 7, {0, 1.83}, v(1.83), 0, spin);
  world.model.ignore.emplace_back(0, 0);
  const auto joint = [&](int a, int b, double height) {
    return pin({a, Vec2(0, height) - world.state.x[a]}, {b, Vec2(0, height) - world.state.x[b]});
  };
  const auto limited = [&](int a, int b, double height, double lower, double upper, double fast,
                           double most) {
    Joint<2> it = joint(a, b, height);
    it.lower = lower * degree, it.upper = upper * degree;
    it.motor = Joint<2>::Motor{fast * degree, most};
    world.model.joints.push_back(it);
  };
  Joint<2> neck = joint(3, 2, 1.59);
  neck.kind = JointKind::weld;
  world.model.joints.push_back(neck);
  limited(4, 2, 1.52, -150, 0, -600, 60), limited(1, 2, 0.98, 0, 125, 500, 200),
      limited(0, 1, 0.5, -135, 0, -540, 80);
  State<2> state = stepped(world, 120);
  for (const int body : {0, 1, 4})
    EXPECT_NEAR(state.spin[body][0], state.spin[2][0], 1e-6) << "all is folded";
  const double folded = energy(world, state);
  world.state = state;
  EXPECT_NEAR(energy(world, stepped(world, 120)), folded, 1e-3) << "J";
}

// a weld's two are one body: momenta to rounding
TEST(IterativeJoints, AWeldMakesOneBodyOfTwo) {
  World<2> world = swept_room({0, 0});
  add_box(world, {1, 0.5}, 2, {0, 0}, {1, 0}, 0, 0);
  add_box(world, {1, 0.5}, 2, {1, 0}, {1, 0.6}, 0, 0);
  Joint<2> weld = pin({0, {0.5, 0}}, {1, {-0.5, 0}});
  weld.kind = JointKind::weld;
  world.model.joints.push_back(weld);
  const Eigen::Vector3d begun = momenta(world, world.state);
  const State<2> now = stepped(world, 600);
  const double inertia = 2 * (2 * 1.25 / 12 + 2 * 0.25), w = 2 * 0.6 * 0.5 / inertia;
  EXPECT_NEAR((momenta(world, now) - begun).norm(), 0, 1e-11);
  // the step that joins them moves them by the mean of both velocities
  EXPECT_NEAR(now.spin[0][0], w, 1e-5);
  EXPECT_NEAR(now.turn[0][0], now.turn[1][0], 1e-13);
}

// I w' = -tau, whatever the pin's own forces
TEST(IterativeJoints, DryFrictionStopsAPinAtItsTime) {
  World<2> world = swept_room({0, 0});
  add_box(world, {1, 0.5}, 2, {0.5, 0}, {0, 1}, 0, 2);
  Joint<2> hinge = pin({0, {-0.5, 0}}, {-1, {0, 0}});
  hinge.friction = 0.7;
  world.model.joints.push_back(hinge);
  const double inertia = world.model.bodies[0].inertia[0] + 2 * 0.25;
  const double stops = 2 * inertia / 0.7;
  EXPECT_NEAR(stepped(world, 600).spin[0][0], 2 - 0.7 / inertia, 1e-5);
  EXPECT_NEAR(stepped(world, int(600 * stops) + 2).spin[0][0], 0, 1e-12);
}

// T = 3 m g cos; first the step's mean, half a step late: 3 m g w h / 2
TEST(IterativeJoints, ASwingReportsItsTensionAndBreaksByIt) {
  World<2> world = swept_room();
  add_particle(world, {1, 0}, {0, 0}, 2);
  world.model.joints.push_back(rod({0, {0, 0}}, {-1, {0, 0}}, 1));
  State<2> state = world.state;
  Stepper<2> stepper(world.model);
  stepper.begin(state);
  for (int i = 0; i < 300; ++i) {
    ASSERT_FALSE(stepper.step(state));
    const double tension = -3 * 2 * 9.81 * state.x[0].y();
    ASSERT_NEAR((state.joint_forces[0] + tension * state.x[0]).norm(), 0, 3 * 2 * 9.81 * 4.5 / 1200) << i;
  }
  world.model.joints[0].breaks = 1.5 * 2 * 9.81;
  state = world.state;
  Stepper<2> again(world.model);
  again.begin(state);
  for (int i = 0; i < 600 && !state.broken[0]; ++i) ASSERT_FALSE(again.step(state));
  ASSERT_TRUE(state.broken[0]);
  EXPECT_NEAR(state.x[0].y(), -0.5, 0.02);
  ASSERT_FALSE(again.step(state));
  EXPECT_EQ(state.joint_forces[0], Vec2(0, 0));
}

// planks along an arc between two posts, each a box pinned at its ends
World<2> bridge(int planks, double wide, double friction = 0) {
  World<2> world = swept_room();
  world.model.scale = wide;
  const double l = wide / planks;
  Vec2 at(0, 0);
  for (int i = 0; i < planks; ++i) {
    const double angle = -0.4 * (1 - (2.0 * i + 1) / planks);
    const Vec2 along(std::cos(angle), std::sin(angle));
    const int body = add_box(world, {l, 0.1}, 10 * l, at + 0.5 * l * along, {0, 0}, angle, 0, 0);
    at += l * along;
    world.model.bodies[body].friction = 0.6;
    const Vec2 left(-l / 2, 0), right(l / 2, 0);
    world.model.joints.push_back(i == 0 ? pin({0, left}, {-1, {0, 0}}) : pin({i, left}, {i - 1, right}));
    world.model.joints.back().friction = friction;
  }
  world.model.joints.push_back(pin({planks - 1, {l / 2, 0}}, {-1, at}));
  return world;
}

// two solvers, one hanging bridge of five planks with a crate that slides: half a second apart by the orders
// of their steps, h v of the slide and of dry friction
TEST(IterativeJoints, AgreesWithTheDirectOneOnABridgeWithACrate) {
  World<2> world = bridge(5, 5, 0.1);
  const int crate = add_box(world, {0.6, 0.6}, 2, {2.4, 0}, {0, 0}, 0, 0, 0);
  world.model.bodies[crate].friction = 0.6;
  const State<2> swept = stepped(world, 300);
  world.model.solver = Solver::direct;
  const State<2> direct = stepped(world, 300);
  for (int i = 0; i <= crate; ++i) {
    EXPECT_NEAR((swept.x[i] - direct.x[i]).norm(), 0, 2e-4) << i;
    EXPECT_NEAR(swept.turn[i][0], direct.turn[i][0], 5e-4) << i;
  }
  for (std::size_t i = 0; i < direct.joint_forces.size(); ++i)
    EXPECT_NEAR((swept.joint_forces[i] - direct.joint_forces[i]).norm(), 0,
                0.02 * direct.joint_forces[i].norm())
        << i;
}

// each pin carries what its end of the bridge weighs; nothing drifts
TEST(IterativeJoints, ABridgeOfSixtyPlanksHangsTogether) {
  World<2> world = bridge(60, 12, 0.5);
  for (int i = 0; i < 3; ++i) {
    const int crate = add_box(world, {0.8, 0.8}, 6, {3.0 + 3 * i, 0.6}, {0, 0}, 0, 0, 0);
    world.model.bodies[crate].friction = 0.6;
  }
  const State<2> now = stepped(world, 1800);
  double apart = 0;
  for (const Joint<2>& joint : world.model.joints) {
    const auto place = [&](const End<2>& end) -> Vec2 {
      return end.body < 0 ? end.local : Vec2(now.x[end.body] + rotation<2>(now.turn[end.body]) * end.local);
    };
    apart = std::max(apart, (place(joint.a) - place(joint.b)).norm());
  }
  EXPECT_LT(apart, 1e-9);
  for (int i = 0; i < 3; ++i) {
    EXPECT_GT(now.x[60 + i].y(), -3) << "the crates stay on it";
    EXPECT_LT(std::fabs(now.x[60 + i].x() - 6), 6);
  }
  EXPECT_LT(deepest(now), 1e-3);
}

// ten figures of nine limbs dropped on each other: joints stay whole, limits hold, nobody leaves the room
TEST(IterativeJoints, TenFiguresInAHeapHangTogether) {
  World<2> world = swept_room();
  add_walls(world, 4, 20);
  for (int figure = 0; figure < 10; ++figure) {
    const Vec2 at(1.2 + 0.3 * (figure % 6), 1 + 1.6 * figure);
    const auto limb = [&](Vec2 size, Vec2 from) {
      const int i = add_box(world, size, 20 * size[0] * size[1] * 10, at + from, {0, 0}, 0, 0, 0);
      world.model.bodies[i].friction = 0.5;
      return i;
    };
    const int trunk = limb({0.2, 0.5}, {0, 0});
    const auto hang = [&](int a, Vec2 on_a, int b, Vec2 on_b, double lower, double upper) {
      Joint<2> joint = pin({a, on_a}, {b, on_b});
      joint.lower = lower, joint.upper = upper, joint.friction = 0.1;
      world.model.joints.push_back(joint);
    };
    hang(limb({0.18, 0.2}, {0, 0.36}), {0, -0.1}, trunk, {0, 0.26}, -0.5, 0.5);
    for (const double side : {-1.0, 1.0}) {
      const int arm = limb({0.3, 0.08}, {side * 0.26, 0.2}), hand = limb({0.3, 0.08}, {side * 0.56, 0.2});
      hang(arm, {-side * 0.15, 0}, trunk, {side * 0.11, 0.2}, -1.5, 1.5);
      hang(hand, {-side * 0.15, 0}, arm, {side * 0.15, 0}, -1.5, 1.5);
      const int thigh = limb({0.09, 0.36}, {side * 0.06, -0.44}),
                shin = limb({0.09, 0.36}, {side * 0.06, -0.8});
      hang(thigh, {0, 0.18}, trunk, {side * 0.06, -0.26}, -1, 1);
      hang(shin, {0, 0.18}, thigh, {0, -0.18}, -1.5, 1.5);
    }
  }
  // limbs of one figure pass each other
  for (int i = 0; i < int(world.model.bodies.size()); ++i) world.model.bodies[i].group = i / 10;
  for (int i = 0; i < 10; ++i) world.model.ignore.emplace_back(i, i);
  const State<2> now = stepped(world, 2400);
  for (const Joint<2>& joint : world.model.joints) {
    const auto place = [&](const End<2>& end) -> Vec2 {
      return now.x[end.body] + rotation<2>(now.turn[end.body]) * end.local;
    };
    EXPECT_LT((place(joint.a) - place(joint.b)).norm(), 1e-9);
    const double angle = now.turn[joint.a.body][0] - now.turn[joint.b.body][0];
    EXPECT_GT(angle, joint.lower - 1e-3);
    EXPECT_LT(angle, joint.upper + 1e-3);
  }
  for (const Vec2& x : now.x) EXPECT_TRUE(x[0] > 0 && x[0] < 4 && x[1] > 0 && x[1] < 20) << x.transpose();
  // an eighth of the thinnest limb: a heap that still settles, a few sweeps a step
  EXPECT_LT(deepest(now), 1e-2);
}

// what hangs still is at rest, by proof, and keeps its forces
TEST(IterativeJoints, AHangingChainFreezes) {
  World<2> world = swept_room();
  for (int i = 0; i < 8; ++i) {
    add_box(world, {0.1, 0.5}, 1, {0, -0.25 - 0.5 * i}, {0, 0}, 0, 0, 0);
    world.model.joints.push_back(pin({i, {0, 0.25}}, {i - 1, i == 0 ? Vec2(0, 0) : Vec2(0, -0.25)}));
  }
  const State<2> now = stepped(world, 600);
  for (int i = 0; i < 8; ++i) {
    EXPECT_TRUE(now.frozen[i]) << i;
    EXPECT_NEAR(now.joint_forces[i].y(), (8 - i) * 9.81, 1e-6) << i;
  }
}

TEST(IterativeJoints, WarmStepAllocatesNothing) {
  World<2> world = bridge(20, 10, 0.2);
  world.model.joints[3].upper = 0.1, world.model.joints[5].lower = -0.1;
  const int crate = add_box(world, {0.8, 0.8}, 6, {5, 0.6}, {0, 0}, 0, 0, 0);
  world.model.bodies[crate].friction = 0.6;
  State<2> state = world.state;
  Stepper<2> stepper(world.model);
  stepper.begin(state);
  for (int i = 0; i < 900; ++i) ASSERT_FALSE(stepper.step(state));
  const std::size_t before = allocations();
  for (int i = 0; i < 300; ++i) ASSERT_FALSE(stepper.step(state));
  EXPECT_EQ(allocations(), before);
}

}  // namespace
}  // namespace obscura::sim

// The table of joints, and the rows of those of the plane by finite differences; those of space are in
// row_space_test.cpp.

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <array>
#include <cmath>
#include <memory>
#include <vector>

#include "sim/constraint/joints/joint.h"
#include "sim/dice.h"

namespace obscura::sim {
namespace {

template <int D>
void expect_equations(JointKind kind, int rows, bool coordinate) {
  const JointEquations<D>& its = equations<D>(kind);
  EXPECT_EQ(its.rows, rows) << int(kind);
  EXPECT_EQ(its.coordinate != nullptr, coordinate) << int(kind);
  EXPECT_EQ(its.one_sided, kind == JointKind::rope || kind == JointKind::pulley) << int(kind);
}

TEST(Joints, OfTheTableHaveTheirRowsAndFreeCoordinate) {
  expect_equations<2>(JointKind::pin, 2, true), expect_equations<3>(JointKind::pin, 3, false);
  expect_equations<2>(JointKind::weld, 3, false), expect_equations<3>(JointKind::weld, 6, false);
  expect_equations<2>(JointKind::slider, 2, true), expect_equations<3>(JointKind::slider, 5, true);
  expect_equations<2>(JointKind::rod, 1, false), expect_equations<3>(JointKind::rod, 1, false);
  expect_equations<2>(JointKind::rope, 1, false), expect_equations<3>(JointKind::rope, 1, false);
  expect_equations<2>(JointKind::hinge, 2, true), expect_equations<3>(JointKind::hinge, 5, true);
  expect_equations<2>(JointKind::pulley, 1, false), expect_equations<3>(JointKind::pulley, 1, false);
  expect_equations<2>(JointKind::gear, 1, false), expect_equations<3>(JointKind::gear, 1, false);
  expect_equations<3>(JointKind::screw, 5, true);
  expect_equations<2>(JointKind::wire, 1, true), expect_equations<3>(JointKind::wire, 2, true);
}

// a body of the plane at an angle, moving
struct Placed {
  Vec<2> x, v;
  double angle, spin;

  explicit Placed(Dice& dice)
      : x(dice.vector<2>(2)), v(dice.vector<2>(2)), angle(dice.between(-3, 3)), spin(dice.between(-2, 2)) {}
  Placed after(double h) const {
    Placed then = *this;
    then.x += h * v, then.angle += h * spin;
    return then;
  }
  BodyMotion<2> motion() const {
    BodyMotion<2> at;
    at.x = x, at.v = v, at.w[0] = spin;
    at.room_from_body = Eigen::Rotation2Dd(angle).toRotationMatrix();
    return at;
  }
};

struct Written {
  std::vector<Row<2>> rows;
  std::vector<double> C;
  std::vector<BodyMotion<2>> bodies;
};

// what it holds, then its free coordinate
Written written(const Joint<2>& joint, const std::array<Placed, 3>& placed) {
  Written all;
  for (const Placed& each : placed) all.bodies.push_back(each.motion());
  const AngularVec<2> turn =
      joint.turn_between([&](int body) { return AngularVec<2>(placed[std::size_t(body)].angle); });
  Row<2> J[kMostHeld<2> + 1];
  double C[kMostHeld<2> + 1];
  int n = rows(joint, all.bodies[0], all.bodies[1], turn, J, C, all.bodies);
  n += free_row(joint, all.bodies[0], all.bodies[1], turn, J[n], C[n]);
  all.rows.assign(J, J + n), all.C.assign(C, C + n);
  return all;
}

// gives a mechanism what else it holds: a rope over a third body and the room, on two wheels; a pin and a
// slider
void complete(Joint<2>& joint, Dice& dice) {
  if (joint.kind == JointKind::pulley) {
    joint.over = {{2, dice.vector<2>(1)}, {-1, Vec<2>(-7, 5)}};
    joint.on_a = {0.4, dice.vector<2>(1).normalized()}, joint.on_b = {-0.3, dice.vector<2>(1).normalized()};
    joint.turns = {{0, 0.4}, {1, 0.3}};
  }
  if (joint.kind == JointKind::gear) {
    Joint<2> pin, slider;
    pin.a = {0, dice.vector<2>(1)}, pin.b = {1, dice.vector<2>(1)};
    slider.kind = JointKind::slider, slider.axis = dice.vector<2>(1).normalized();
    slider.a = {2, dice.vector<2>(1)}, slider.b = {0, dice.vector<2>(1)};
    joint.geared = std::make_shared<const std::array<Joint<2>, 2>>(std::array<Joint<2>, 2>{pin, slider});
    joint.ratio = dice.between(-3, 3), joint.turns = {{0, 1}, {1, -1}};
    joint.over = {slider.a, slider.b};
  }
}

// puts a point of a onto a wire of b, three quarters of a circle
void thread(Joint<2>& joint, const Placed& a, const Placed& b, Dice& dice) {
  CurvePath<2> path({1, 0});
  path.arc({0, 1}, {-1, 0}), path.arc({0, -1});
  joint.curve = std::make_shared<const Curve<2>>(path.pieces(), false);
  const double angle = dice.between(0.2, 4.5);
  const BodyMotion<2> at = b.motion();
  const Vec<2> place = at.x + at.arm(Vec<2>(std::cos(angle), std::sin(angle)));
  joint.a.local = a.motion().room_from_body.transpose() * (place - a.x);
}

// d C / dt = J v and d (J v) / dt = J' v for bodies that nothing accelerates; differences are right to h^2 of
// third derivatives, which are of order 10 and for short rods more
TEST(Joints, OfThePlaneChangeByTheirRows) {
  Dice dice(1);
  const double h = 1e-5;
  for (int k = 0; k < kJointKinds; ++k) {
    const JointKind kind = JointKind(k);
    for (int n = 0; n < 100; ++n) {
      Joint<2> joint;
      joint.kind = kind, joint.length = 1;
      joint.a = {0, dice.vector<2>(1)}, joint.b = {1, dice.vector<2>(1)};
      joint.axis = dice.vector<2>(1).normalized(), joint.turn[0] = dice.between(-2, 2);
      std::array<Placed, 3> at{Placed(dice), Placed(dice), Placed(dice)};
      at[2].x += Vec<2>(6, 6);
      complete(joint, dice);
      if (kind == JointKind::wire) thread(joint, at[0], at[1], dice);
      const auto after = [&](double t) {
        return std::array<Placed, 3>{at[0].after(t), at[1].after(t), at[2].after(t)};
      };
      const Written now = written(joint, at), later = written(joint, after(h)),
                    before = written(joint, after(-h));
      ASSERT_EQ(now.rows.size(), std::size_t(equations<2>(kind).rows + has_free_row(joint)));
      for (std::size_t i = 0; i < now.rows.size(); ++i) {
        const double rate = speed(now.rows[i], now.bodies);
        EXPECT_NEAR((later.C[i] - before.C[i]) / (2 * h), rate, 1e-7 * (1 + std::abs(rate)))
            << int(kind) << ' ' << i;
        const double change =
            (speed(later.rows[i], later.bodies) - speed(before.rows[i], before.bodies)) / (2 * h);
        EXPECT_NEAR(change, now.rows[i].velocity_product, 1e-7 * (1 + std::abs(change) + rate * rate))
            << int(kind) << ' ' << i;
      }
    }
  }
}

}  // namespace
}  // namespace obscura::sim

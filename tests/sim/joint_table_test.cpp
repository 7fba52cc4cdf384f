// The table of joints, and the rows of those of the plane by finite differences; those of space are in
// row_space_test.cpp.

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
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
  EXPECT_EQ(its.one_sided, kind == JointKind::rope) << int(kind);
}

TEST(Joints, OfTheTableHaveTheirRowsAndFreeCoordinate) {
  expect_equations<2>(JointKind::pin, 2, true), expect_equations<3>(JointKind::pin, 3, false);
  expect_equations<2>(JointKind::weld, 3, false), expect_equations<3>(JointKind::weld, 6, false);
  expect_equations<2>(JointKind::slider, 2, true), expect_equations<3>(JointKind::slider, 5, true);
  expect_equations<2>(JointKind::rod, 1, false), expect_equations<3>(JointKind::rod, 1, false);
  expect_equations<2>(JointKind::rope, 1, false), expect_equations<3>(JointKind::rope, 1, false);
  expect_equations<2>(JointKind::hinge, 2, true), expect_equations<3>(JointKind::hinge, 5, true);
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
Written written(const Joint<2>& joint, const Placed& a, const Placed& b) {
  Written all;
  all.bodies = {a.motion(), b.motion()};
  const AngularVec<2> turn(a.angle - b.angle);
  Row<2> J[kMostHeld<2> + 1];
  double C[kMostHeld<2> + 1];
  int n = rows(joint, all.bodies[0], all.bodies[1], turn, J, C);
  n += free_row(joint, all.bodies[0], all.bodies[1], turn, J[n], C[n]);
  all.rows.assign(J, J + n), all.C.assign(C, C + n);
  return all;
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
      const Placed a(dice), b(dice);
      const Written now = written(joint, a, b), later = written(joint, a.after(h), b.after(h)),
                    before = written(joint, a.after(-h), b.after(-h));
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

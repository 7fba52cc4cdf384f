// Rows of joints in space: how they change, and what they hold, by finite differences.

#include "sim/constraint/joints/joint.h"

#include <gtest/gtest.h>

#include <array>
#include <memory>
#include <vector>

#include "sim/solids.h"

namespace obscura::sim {
namespace {

Joint<3> joint_of(JointKind kind, SpaceDice& dice) {
  Joint<3> joint;
  joint.kind = kind;
  joint.a = {0, dice.vec(1)}, joint.b = {1, dice.vec(1)};
  joint.axis = dice.vec(1).normalized();
  joint.turn = dice.vec(1.5);
  return joint;
}

// a as the joint wants it, where b is
BodyMotion<3> seated_on(const Joint<3>& joint, const BodyMotion<3>& b, const Vec<3>& along, double angle) {
  BodyMotion<3> a;
  const Vec<3> axis = joint.axis;
  a.room_from_body =
      b.room_from_body * matrix(exponential(Vec<3>(angle * axis))) * matrix(exponential(joint.turn));
  a.x = b.x + b.arm(joint.b.local + along) - a.arm(joint.a.local);
  return a;
}

struct Held {
  int rows;
  Row<3> row[kMostHeld<3>];
  double off[kMostHeld<3>];
};

Held held(const Joint<3>& joint, const BodyMotion<3>& a, const BodyMotion<3>& b) {
  Held all;
  all.rows = rows(joint, a, b, Vec<3>::Zero().eval(), all.row, all.off, std::vector<BodyMotion<3>>{a, b});
  return all;
}

TEST(SpaceRows, OfAJointAreAsManyAsItHolds) {
  SpaceDice dice(1);
  for (const auto& [kind, count] :
       {std::pair{JointKind::pin, 3}, std::pair{JointKind::hinge, 5}, std::pair{JointKind::weld, 6},
        std::pair{JointKind::slider, 5}, std::pair{JointKind::rod, 1}, std::pair{JointKind::rope, 1},
        std::pair{JointKind::pulley, 1}, std::pair{JointKind::screw, 5}}) {
    EXPECT_EQ(held(joint_of(kind, dice), dice.place(1), dice.place(1)).rows, count);
  }
}

// J v and its rate at any pose, for spins that stay
TEST(SpaceRows, OfAJointChangeByTheirDrift) {
  SpaceDice dice(2);
  const double h = 1e-5;
  for (int k = 0; k < kJointKinds; ++k) {
    const JointKind kind = JointKind(k);
    if (kind == JointKind::wire) continue;  // holds on its wire alone: tests/scene/tracks_test.cpp
    for (int n = 0; n < 200; ++n) {
      Joint<3> joint = joint_of(kind, dice);
      if (kind == JointKind::pulley) joint.over = {{-1, Vec<3>(6, 7, 5)}, {1, dice.vec(1)}};
      if (kind == JointKind::gear) {
        // a rack and its pinion; every other time two wheels
        const JointKind second = n % 2 ? JointKind::hinge : JointKind::slider;
        std::array<Joint<3>, 2> both{joint_of(JointKind::hinge, dice), joint_of(second, dice)};
        both[1].axis = both[0].axis;
        joint.geared = std::make_shared<const std::array<Joint<3>, 2>>(both);
        joint.ratio = n % 4 < 2 ? 1.7 : -1.7, joint.length = -1, joint.lower = 0;
      }
      if (kind == JointKind::screw) joint.ratio = 0.3;
      const BodyMotion<3> a = dice.place(2), b = dice.place(2);
      const std::vector<BodyMotion<3>> now = {a, b}, later = {moved(a, h), moved(b, h)},
                                       before = {moved(a, -h), moved(b, -h)};
      const Held at = held(joint, a, b), after = held(joint, later[0], later[1]),
                 earlier = held(joint, before[0], before[1]);
      for (int i = 0; i < at.rows; ++i) {
        const double rate = (speed(after.row[i], later) - speed(earlier.row[i], before)) / (2 * h);
        // h^2 of third derivatives of order 10, of short rods as many times more as the rate
        EXPECT_NEAR(rate, at.row[i].velocity_product, 1e-7 * (1 + std::abs(rate))) << int(kind) << " " << i;
        // those of turns, and angles about an axis, are exact where the joint is seated alone
        const bool turns = kind == JointKind::weld ? i >= 3
                           : kind == JointKind::screw
                               ? i == 4
                               : kind == JointKind::gear || (kind == JointKind::slider && i >= 2);
        if (turns) continue;
        EXPECT_NEAR((after.off[i] - earlier.off[i]) / (2 * h), speed(at.row[i], now), 1e-7)
            << int(kind) << " " << i;
      }
      Row<3> free, free_after, free_before;
      double way = 0;
      if (!free_row(joint, a, b, Vec<3>::Zero().eval(), free, way)) continue;
      free_row(joint, later[0], later[1], Vec<3>::Zero().eval(), free_after, way);
      free_row(joint, before[0], before[1], Vec<3>::Zero().eval(), free_before, way);
      EXPECT_NEAR((speed(free_after, later) - speed(free_before, before)) / (2 * h), free.velocity_product,
                  1e-7);
    }
  }
}

TEST(SpaceRows, AreNotOffWhereTheJointIsSeatedAndLeaveItsOneFreedom) {
  SpaceDice dice(3);
  const double h = 1e-5;
  for (const JointKind kind : {JointKind::pin, JointKind::hinge, JointKind::weld, JointKind::slider}) {
    for (int n = 0; n < 100; ++n) {
      const Joint<3> joint = joint_of(kind, dice);
      const bool turns = kind == JointKind::hinge || kind == JointKind::pin,
                 slides = kind == JointKind::slider;
      const double angle = turns ? dice.between(-3, 3) : 0, along = slides ? dice.between(-1, 1) : 0;
      BodyMotion<3> b = dice.place(2), a = seated_on(joint, b, along * joint.axis, angle);
      const Held at = held(joint, a, b);
      for (int i = 0; i < at.rows; ++i) EXPECT_NEAR(at.off[i], 0, 1e-14) << int(kind) << " " << i;
      Row<3> free;
      double way = 0;
      ASSERT_EQ(free_row(joint, a, b, Vec<3>::Zero().eval(), free, way), kind == JointKind::hinge || slides);

      // a little off: turns are told too
      a.w = dice.vec(1), a.v = dice.vec(1);
      const BodyMotion<3> off_a = moved(a, h), off_b = moved(b, h);
      const Held off = held(joint, off_a, off_b);
      const std::vector<BodyMotion<3>> both = {a, b};
      for (int i = 0; i < at.rows; ++i) EXPECT_NEAR(off.off[i] / h, speed(at.row[i], both), 1e-4);
      if (kind != JointKind::hinge && !slides) continue;
      EXPECT_NEAR(way, slides ? along : angle, 1e-13);
      double further = 0;
      Row<3> unused;
      free_row(joint, off_a, off_b, Vec<3>::Zero().eval(), unused, further);
      EXPECT_NEAR((further - way) / h, speed(free, both), 1e-4);
    }
  }
}

}  // namespace
}  // namespace obscura::sim

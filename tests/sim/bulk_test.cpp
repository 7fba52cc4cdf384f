#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "chain_cases.h"
#include "space_rooms.h"

namespace obscura::sim {
namespace {

// handout §3.1 in space: m (y^2 + z^2) / 12
TEST(BulkInSpace, OfABoxBallAndCapsuleIsTheClosedForm) {
  const Vec3 box = solid_inertia(brick({1, 2, 3}), 6);
  EXPECT_NEAR(box[0], 6.5, 1e-15);
  EXPECT_NEAR(box[1], 5.0, 1e-15);
  EXPECT_NEAR(box[2], 2.5, 1e-15);
  const Shape<3> ball = Ball<3>{0.5};
  EXPECT_NEAR(solid_inertia(ball, 2)[1], 0.2, 1e-16);
  EXPECT_EQ(inertia(ball, 2), Vec3::Zero());

  // a capsule: pieces by hand, cylinder m_c, ball m_b = 4/3 r, per pi r^2
  const double a = 0.7, r = 0.2, mc = 2 * a, mb = 4 * r / 3, mass = 3;
  const double along = mc * r * r / 2 + 2 * mb * r * r / 5;
  const double across = mc * (r * r / 4 + a * a / 3) + mb * (2 * r * r / 5 + a * a + 3 * a * r / 4);
  const Vec3 moments = solid_inertia(capsule(a, r), mass);
  EXPECT_NEAR(moments[1], mass * along / (mc + mb), 1e-15);
  EXPECT_NEAR(moments[0], mass * across / (mc + mb), 1e-15);
  EXPECT_EQ(moments[0], moments[2]);
}

// a capsule's ends as stacked discs, numerically: a second way to the same numbers
TEST(BulkInSpace, OfACapsuleIsThatOfItsDiscs) {
  const double a = 0.7, r = 0.2;
  double volume = 0, across = 0, along = 0;
  const int n = 200000;
  const double h = 2 * (a + r) / n;
  for (int i = 0; i < n; ++i) {
    const double y = -a - r + (i + 0.5) * h, beyond = std::max(0.0, std::fabs(y) - a);
    const double r2 = r * r - beyond * beyond, slice = std::numbers::pi * r2 * h;
    volume += slice, along += slice * r2 / 2, across += slice * (r2 / 4 + y * y);
  }
  const MassProperties<3> got = mass_properties(capsule(a, r));
  // midpoint rule: h^2 = 8e-11 of the whole
  EXPECT_NEAR(got.content, volume, 1e-9);
  EXPECT_NEAR(got.second[0], across, 1e-9);
  EXPECT_NEAR(got.second[1], along, 1e-9);
}

TEST(BulkInSpace, OfATetrahedronIsTheClosedForm) {
  // the corner of a cube: V = 1/6, centroid 1/4, int x^2 = 1/60, int x y = 1/120
  const Shape<3> hull =
      Hull{{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}}, {{0, 2, 1}, {0, 1, 3}, {0, 3, 2}, {1, 2, 3}}};
  const MassProperties<3> got = mass_properties(hull);
  EXPECT_NEAR(got.content, 1.0 / 6, 1e-16);
  EXPECT_LE((got.center - Vec3::Constant(0.25)).norm(), 1e-16);
  // about the centroid C = 1/160 on, -1/480 off the diagonal: of 1 1 1 1/480, across it 1/120
  Vec3 moments = got.second;
  std::sort(moments.data(), moments.data() + 3);
  EXPECT_NEAR(moments[0], 1.0 / 480 + 1.0 / 120, 1e-16);
  EXPECT_NEAR(moments[1], 1.0 / 480 + 1.0 / 120, 1e-16);
  EXPECT_NEAR(moments[2], 2.0 / 120, 1e-16);
}

TEST(BulkInSpace, SeatedShapesHaveTheirAxesAndStandWhereTheyStood) {
  Dice dice(5);
  for (int trial = 0; trial < 200; ++trial) {
    // a box anywhere, as a hull: its seat is its centre and its own axes
    Box<3> box{Vec3(dice.between(0.2, 1), dice.between(1.1, 2), dice.between(2.2, 3)) / 2};
    box.center = dice.vector<3>(4);
    box.turn = exponential(dice.vector<3>(2));
    const Shape<3> hull = as_hull(box);
    const MassProperties<3> got = mass_properties(hull);
    EXPECT_NEAR(got.content, 8 * box.half.prod(), 1e-13);
    EXPECT_LE((got.center - box.center).norm(), 1e-13);
    Vec3 want = solid_inertia<3>(box, 1), moments = got.second / got.content;
    std::sort(want.data(), want.data() + 3), std::sort(moments.data(), moments.data() + 3);
    EXPECT_LE((want - moments).norm(), 1e-12);

    const Shape<3> seat = seated(hull, got);
    const MassProperties<3> again = mass_properties(seat);
    EXPECT_LE(again.center.norm(), 1e-14);
    EXPECT_LE((again.second - got.second).norm(), 1e-12);
    // tilted by no more than the rounding of the moments over their differences
    EXPECT_LE((again.axes - no_rotation<3>()).norm(), 1e-12);
    const Eigen::Matrix3d axes = rotation<3>(got.axes);
    for (int i = 0; i < 8; ++i)
      EXPECT_LE((got.center + axes * form<Hull>(seat)->vertices[i] - form<Hull>(hull)->vertices[i]).norm(),
                1e-14);

    // the same as a compound of two halves, one a box and one a hull
    Box<3> one{{box.half[0], box.half[1] / 2, box.half[2]}, Vec3::Zero(), box.turn}, two = one;
    const Vec3 off = rotation<3>(box.turn) * Vec3(0, box.half[1] / 2, 0);
    one.center = box.center + off, two.center = box.center - off;
    const Shape<3> whole = Compound<3>{{one, as_hull(two)}};
    const MassProperties<3> halves = mass_properties(whole);
    EXPECT_LE((halves.center - got.center).norm(), 1e-13);
    Vec3 both = halves.second / halves.content;
    std::sort(both.data(), both.data() + 3);
    EXPECT_LE((both - want).norm(), 1e-12);
    const MassProperties<3> sat = mass_properties(seated(whole, halves));
    EXPECT_LE(sat.center.norm(), 1e-13);
    EXPECT_LE((sat.axes - no_rotation<3>()).norm(), 1e-11);
    EXPECT_NEAR(bounding_radius(seated(whole, halves)), box.half.norm(), 1e-13);
  }
}

TEST(BulkInSpace, AShapeWhoseAxesAreItsFramesKeepsThem) {
  const Shape<3> whole = Compound<3>{{Capsule{0.5, 0.1}, Box<3>{{0.3, 0.1, 0.15}, {0, 0.6, 0}}}};
  EXPECT_EQ(mass_properties(whole).axes, no_rotation<3>());
}

TEST(BoundsInSpace, HoldEveryTipAndTouchOne) {
  Dice dice(6);
  for (int trial = 0; trial < 200; ++trial) {
    BodyMotion<3> at;
    at.x = dice.vector<3>(5);
    at.room_from_body = rotation<3>(exponential(dice.vector<3>(2)));
    Capsule rod{0.5, 0.1};
    Box<3> box{{0.5, 0.15, 0.25}};
    rod.center = dice.vector<3>(1), box.center = dice.vector<3>(1);
    rod.turn = exponential(dice.vector<3>(2)), box.turn = exponential(dice.vector<3>(2));
    const Shape<3> whole = Compound<3>{{rod, box, as_hull(brick({0.2, 1, 0.2}))}};
    const Bounds<3> around = bounds(whole, at);
    Vec3 lower = Vec3::Constant(1e9), upper = -lower;
    double most = 0;
    for (const SupportVertex<3>& tip : support_vertices(whole)) {
      const Vec3 place = at.x + at.arm(tip.at);
      lower = lower.cwiseMin(place - Vec3::Constant(tip.radius));
      upper = upper.cwiseMax(place + Vec3::Constant(tip.radius));
      most = std::max(most, tip.at.norm() + tip.radius);
    }
    EXPECT_LE((around.lower - lower).norm(), 1e-14);
    EXPECT_LE((around.upper - upper).norm(), 1e-14);
    EXPECT_NEAR(bounding_radius(whole), most, 1e-15);
  }
}

}  // namespace
}  // namespace obscura::sim

// What shapes weigh, and how far they reach.

#include "sim/shape/shape.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <vector>

#include "sim/shapes.h"

namespace obscura::sim {
namespace {

TEST(MassProperties, OfAPolygonIsThatOfTheBoxItDraws) {
  const Shape<2> box = Box<2>{{0.35, 0.2}, {3, -5}};
  const MassProperties<2> one = mass_properties(box), two = mass_properties(as_polygon(box));
  EXPECT_NEAR(two.content, one.content, 1e-15);
  EXPECT_NEAR((two.center - one.center).norm(), 0, 2e-15);  // a rounding of 5
  EXPECT_NEAR(two.second[0], one.second[0], 1e-15);
}

TEST(MassProperties, OfARegularPolygonIsTheClosedForm) {
  // side s, n corners: A = n s^2 cot(pi/n) / 4, K / A = R^2 (1 + 2 cos^2(pi/n)) / 6
  for (const int n : {3, 5, 12}) {
    std::vector<Vec<2>> around;
    for (int i = 0; i < n; ++i) {
      const double angle = 2 * std::numbers::pi * i / n;
      around.push_back(2 * Vec<2>(std::cos(angle), std::sin(angle)) + Vec<2>(0.3, 0.1));
    }
    const MassProperties<2> whole = mass_properties(polygon_shape(around));
    const double c = std::cos(std::numbers::pi / n), s = std::sin(std::numbers::pi / n);
    EXPECT_NEAR(whole.content, n * 4 * s * c, 1e-14);
    EXPECT_NEAR(whole.center[0], 0.3, 1e-15);
    EXPECT_NEAR(whole.second[0] / whole.content, 4 * (1 + 2 * c * c) / 6, 1e-14);
    EXPECT_EQ(inertia(polygon_shape(around), 3), AngularVec<2>(3 * whole.second / whole.content));
  }
}

TEST(MassProperties, OfPartsIsThatOfTheWholeTheyMake) {
  const Shape<2> left = Box<2>{{0.15, 0.5}, {-0.35, 2}}, right = Box<2>{{0.35, 0.5}, {0.15, 2}};
  const Shape<2> both = compound_shape({left, as_polygon(right)}), whole = box_shape(1, 1);
  EXPECT_NEAR(mass_properties(both).content, 1, 1e-15);
  EXPECT_NEAR((mass_properties(both).center - Vec<2>(0, 2)).norm(), 0, 1e-15);
  EXPECT_NEAR(inertia(both, 6)[0], inertia(whole, 6)[0], 1e-15);
  EXPECT_NEAR(inertia(both, 6)[0], 1, 1e-15);
}

TEST(Inertia, OfABallIsNoneUntilItRolls) {
  EXPECT_EQ(inertia(ball_shape(0.5), 8), AngularVec<2>::Zero());
  EXPECT_EQ(solid_inertia(ball_shape(0.5), 8)[0], 1);
  EXPECT_EQ(solid_inertia(ball_shape(0), 8), AngularVec<2>::Zero());
  EXPECT_NEAR(solid_inertia(compound_shape({ball_shape(0.5)}), 8)[0], 1, 1e-15);
}

// twelve corners: the apothem, r cos(pi / 12)
TEST(HalfThickness, IsTheLeastOfAShape) {
  EXPECT_EQ(half_thickness(ball_shape(0)), 0);
  EXPECT_EQ(half_thickness(ball_shape(0.3)), 0.3);
  EXPECT_EQ(half_thickness(box_shape(0.4, 3)), 0.2);
  std::vector<Vec<2>> corners;
  for (int i = 0; i < 12; ++i) {
    const double angle = i * std::numbers::pi / 6;
    corners.emplace_back(2 * std::cos(angle), 2 * std::sin(angle));
  }
  const Shape<2> twelve = polygon_shape(corners);
  EXPECT_NEAR(half_thickness(twelve), 2 * std::cos(std::numbers::pi / 12), 1e-15);
  EXPECT_NEAR(half_thickness(as_polygon(box_shape(0.4, 3))), 0.2, 1e-16);
  EXPECT_EQ(half_thickness(compound_shape({twelve, ball_shape(0.3)})), 0.3);
}

TEST(Bounds, HoldTheShapeTightly) {
  ShapeDice dice(6);
  for (int n = 0; n < 200; ++n) {
    const Shape<2> box = box_shape(dice.between(0.2, 1), dice.between(0.2, 1));
    const Ball<2> ball{0.3, {0.6, 0.1}};
    const Shape<2> polygon = dice.polygon(1), all = compound_shape({box, ball, polygon});
    const BodyMotion<2> at = dice.body_motion(3);
    const Bounds<2> a = bounds(box, at), b = bounds(as_polygon(box), at), c = bounds(all, at);
    EXPECT_NEAR((a.lower - b.lower).norm() + (a.upper - b.upper).norm(), 0, 4e-15);
    const Vec<2> center = at.x + at.arm(ball.center), r = Vec<2>::Constant(0.3);
    EXPECT_EQ(c.lower, a.lower.cwiseMin(bounds(polygon, at).lower).cwiseMin(center - r));
    EXPECT_EQ(c.upper, a.upper.cwiseMax(bounds(polygon, at).upper).cwiseMax(center + r));
    EXPECT_LE((c.upper - at.x).maxCoeff(), bounding_radius(all) + 1e-15);
    EXPECT_GE(bounding_radius(all), ball.center.norm() + 0.3);
    EXPECT_EQ(bounding_radius(box), form<Box<2>>(box)->half.norm());
  }
}

}  // namespace
}  // namespace obscura::sim

// Gaps against brute force, and stacks that keep their features.

#include "sim/collide/narrow_phase.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "sim/gaps.h"
#include "sim/shapes.h"

namespace obscura::sim {
namespace {

using Kind = ContactCandidate<2>::Kind;

// a polygon's corners in the room, in long double
using Place = Eigen::Matrix<long double, 2, 1>;

std::vector<Place> placed(const Shape<2>& shape, const BodyMotion<2>& at) {
  std::vector<Vec<2>> local = {Vec<2>::Zero()};
  if (const Box<2>* box = form<Box<2>>(shape)) local = box->outline().vertices;
  if (const Polygon* polygon = form<Polygon>(shape)) local = polygon->vertices;
  std::vector<Place> out;
  for (const Vec<2>& p : local) {
    out.push_back(at.x.cast<long double>() + at.room_from_body.cast<long double>() * p.cast<long double>());
  }
  return out;
}

long double cross(const Place& a, const Place& b) { return a[0] * b[1] - a[1] * b[0]; }

// Distance of the segments and corners; where the sets overlap, minus the distance from the origin to the
// hull of all differences, found among the lines through any two of them: no separating axes.
long double brute_force(const std::vector<Place>& a, const std::vector<Place>& b) {
  std::vector<Place> differences;
  for (const Place& p : a) {
    for (const Place& q : b) differences.push_back(p - q);
  }
  long double nearest = 1e300L, depth = 1e300L;
  bool inside = differences.size() > 2;
  for (std::size_t i = 0; i < differences.size(); ++i) {
    nearest = std::min(nearest, differences[i].norm());
    for (std::size_t k = 0; k < differences.size(); ++k) {
      const Place along = differences[k] - differences[i];
      if (along.norm() < 1e-15L) continue;
      const long double s = -differences[i].dot(along) / along.squaredNorm();
      if (s > 0 && s < 1) nearest = std::min(nearest, (differences[i] + s * along).norm());
      // an edge of the hull, if all lie to its left
      const bool edge = std::all_of(differences.begin(), differences.end(), [&](const Place& p) {
        return cross(along, p - differences[i]) >= -1e-15L * along.norm();
      });
      if (!edge) continue;
      const long double left = cross(along, -differences[i]) / along.norm();
      if (left < 0) inside = false;
      depth = std::min(depth, left);
    }
  }
  return inside ? -depth : nearest;
}

TEST(Separation, IsTheDistanceOrDepthOfTheDifferencesHull) {
  ShapeDice dice(1);
  int overlapping = 0;
  for (int n = 0; n < 3000; ++n) {
    const Shape<2> a = dice.simple(1), b = dice.simple(0.8);
    const BodyMotion<2> at_a = dice.body_motion(1.2), at_b = dice.body_motion(1.2);
    const double want =
        double(brute_force(placed(a, at_a), placed(b, at_b))) - core(a).radius - core(b).radius;
    overlapping += want < 0;
    // coordinates of order 1, a dozen roundings
    EXPECT_NEAR(separation(a, at_a, b, at_b), want, 1e-14) << n;
    EXPECT_NEAR(separation(b, at_b, a, at_a), want, 1e-14) << n;
  }
  EXPECT_GT(overlapping, 500);
  EXPECT_LT(overlapping, 2500);
}

TEST(Gaps, AreNoneBeyondTheMarginAndAsNearAsTheSeparationWithin) {
  ShapeDice dice(2);
  for (int n = 0; n < 5000; ++n) {
    const Shape<2> a = dice.simple(1), b = dice.simple(0.8);
    const BodyMotion<2> at_a = dice.body_motion(1.2), at_b = dice.body_motion(1.2);
    const double apart = separation(a, at_a, b, at_b), margin = dice.between(-0.3, 0.5);
    const auto all = found(a, at_a, b, at_b, margin);
    const bool points = is_point(a) && is_point(b);
    ASSERT_EQ(all.empty(), points || apart >= margin) << n << " " << apart << " " << margin;
    ASSERT_LE(all.size(), 2u);
    if (all.empty()) continue;
    EXPECT_NEAR(least(all), apart, 1e-13) << n;
    for (const ContactCandidate<2>& gap : all) {
      EXPECT_LT(gap.value, margin);
      EXPECT_NEAR(evaluate(gap, at_a, at_b).value, gap.value, 1e-14);
    }
  }
}

// two gaps of swapped bodies are the same touch
TEST(Gaps, AreTheSameFromEitherSide) {
  ShapeDice dice(3);
  for (int n = 0; n < 5000; ++n) {
    const Shape<2> a = dice.simple(1), b = dice.simple(0.8);
    const BodyMotion<2> at_a = dice.body_motion(1.2), at_b = dice.body_motion(1.2);
    const auto one = found(a, at_a, b, at_b, 0.2), two = found(b, at_b, a, at_a, 0.2);
    ASSERT_EQ(one.size(), two.size()) << n;
    for (const ContactCandidate<2>& gap : one) {
      const EvaluatedContact<2> now = evaluate(gap, at_a, at_b);
      EXPECT_TRUE(std::any_of(two.begin(), two.end(), [&](const ContactCandidate<2>& other) {
        const EvaluatedContact<2> there = evaluate(other, at_b, at_a);
        return std::abs(there.value - now.value) < 1e-13 && (there.point - now.point).norm() < 1e-12 &&
               (there.normal + now.normal).norm() < 1e-12;
      })) << n;
    }
  }
}

TEST(Gaps, ChangeAtTheNormalVelocityOfTheirPoint) {
  ShapeDice dice(4);
  int seen = 0;
  for (int n = 0; n < 3000; ++n) {
    const Shape<2> a = dice.simple(1), b = dice.simple(0.8);
    const Vec<2> xa(dice.between(-1, 1), dice.between(-1, 1)), xb(dice.between(-1, 1), dice.between(-1, 1));
    const double ta = dice.between(-4, 4), tb = dice.between(-4, 4);
    BodyMotion<2> at_a = standing(xa, ta), at_b = standing(xb, tb);
    at_a.v = {dice.between(-1, 1), dice.between(-1, 1)};
    at_b.v = {dice.between(-1, 1), dice.between(-1, 1)};
    at_a.w[0] = dice.between(-1, 1);
    at_b.w[0] = dice.between(-1, 1);
    for (const ContactCandidate<2>& gap : found(a, at_a, b, at_b, 0.5)) {
      const EvaluatedContact<2> now = evaluate(gap, at_a, at_b);
      if (gap.kind == Kind::corners && now.value + gap.radius_a + gap.radius_b < 0.1) continue;
      const double rate =
          now.normal.dot(at_a.velocity(now.point - at_a.x) - at_b.velocity(now.point - at_b.x));
      const auto later = [&](double h) {
        return evaluate(gap, standing(xa + h * at_a.v, ta + h * at_a.w[0]),
                        standing(xb + h * at_b.v, tb + h * at_b.w[0]))
            .value;
      };
      // central difference: h^2 g''' / 6 with g''' up to 1e3 where corners are 0.1 m apart
      EXPECT_NEAR((later(1e-5) - later(-1e-5)) / 2e-5, rate, 2e-8) << n;
      ++seen;
    }
  }
  EXPECT_GT(seen, 2000);
}

TEST(Gaps, OfAStackAreTwoAndKeepTheirFeatures) {
  const Shape<2> box = box_shape(0.2, 0.1), wide = box_shape(1, 0.1);
  struct Case {
    const Shape<2>&upper, &lower;
    double offset;
  };
  for (const auto& [upper, lower, offset] :
       {Case{box, box, 0}, Case{box, box, 0.03}, Case{box, box, -0.1}, Case{box, wide, 0.2},
        Case{wide, box, 0.1}, Case{box, wide, 0.4}, Case{wide, box, -0.4}}) {
    for (const bool swapped : {false, true}) {
      std::vector<int> features;
      for (const double tilt : {0.0, 1e-9, -1e-9, 1e-6, -1e-6}) {
        for (const double shift : {0.0, 1e-9, -1e-9}) {
          for (const double height : {0.0, 1e-9, -1e-9, 1e-5}) {
            const BodyMotion<2> below = standing({0.3, 0.7}),
                                above = standing({0.3 + offset + shift, 0.8 + height}, tilt);
            const auto all =
                swapped ? found(lower, below, upper, above, 0.01) : found(upper, above, lower, below, 0.01);
            ASSERT_EQ(all.size(), 2u) << offset << " " << tilt << " " << shift << " " << height;
            if (features.empty()) features = {all[0].key.feature, all[1].key.feature};
            EXPECT_EQ(all[0].key.feature, features[0])
                << offset << " " << tilt << " " << shift << " " << height;
            EXPECT_EQ(all[1].key.feature, features[1])
                << offset << " " << tilt << " " << shift << " " << height;
            // the ends of what they share
            const double half = std::min(
                {(form<Box<2>>(upper)->half[0] + form<Box<2>>(lower)->half[0] - std::abs(offset)) / 2,
                 form<Box<2>>(upper)->half[0], form<Box<2>>(lower)->half[0]});
            for (const ContactCandidate<2>& gap : all) {
              const EvaluatedContact<2> now =
                  swapped ? evaluate(gap, below, above) : evaluate(gap, above, below);
              EXPECT_NEAR(now.normal[1], swapped ? -1 : 1, 1e-11);
              EXPECT_NEAR(now.value, height, 5.1e-7);
              EXPECT_NEAR(now.point[1], 0.75, 2e-5);
            }
            const double x0 = evaluate(all[0], swapped ? below : above, swapped ? above : below).point[0];
            const double x1 = evaluate(all[1], swapped ? below : above, swapped ? above : below).point[0];
            EXPECT_NEAR(std::abs(x1 - x0), 2 * half, 3e-6);
          }
        }
      }
    }
  }
}

TEST(Gaps, OfATurnedStackAreThoseOfTheUpright) {
  const Shape<2> box = box_shape(0.2, 0.1);
  const auto upright = found(box, standing({0, 0.1}), box, standing({0, 0}), 0.01);
  for (const double angle : {0.3, 1.0, 2.0, -3.0}) {
    const BodyMotion<2> below = standing({5, 7}, angle);
    const auto turned = found(box, standing(below.x + below.arm({0, 0.1}), angle), box, below, 0.01);
    ASSERT_EQ(turned.size(), 2u);
    for (int i : {0, 1}) {
      EXPECT_EQ(turned[i].key, upright[i].key);
      EXPECT_NEAR(turned[i].value, 0, 5e-15);  // places of order 10
    }
  }
}

TEST(Gaps, ACornerOnAFaceIsOne) {
  const Shape<2> box = box_shape(1, 1);
  const double half = std::sqrt(0.5);
  for (const double tilt : {0.0, 1e-9, -1e-9, 0.3}) {
    const auto all =
        found(box, standing({0.1, 0.5 + half}, std::numbers::pi / 4 + tilt), box, standing({0, 0}), 0.05);
    ASSERT_EQ(all.size(), 1u);
    EXPECT_EQ(all[0].kind, Kind::corner_of_a);
    EXPECT_EQ(all[0].key.feature,
              found(box, standing({0.1, 0.5 + half}, std::numbers::pi / 4), box, standing({0, 0}), 0.05)[0]
                  .key.feature);
  }
}

TEST(Gaps, OfCornersApartPointFromOneToTheOther) {
  const Shape<2> box = box_shape(1, 1);
  const auto all = found(box, standing({1.03, 1.04}), box, standing({0, 0}), 0.1);
  ASSERT_EQ(all.size(), 1u);
  EXPECT_EQ(all[0].kind, Kind::corners);
  const EvaluatedContact<2> now = evaluate(all[0], standing({1.03, 1.04}), standing({0, 0}));
  EXPECT_NEAR(now.value, 0.05, 1e-15);
  EXPECT_NEAR(now.normal[0], 0.6, 1e-13);
  EXPECT_NEAR(now.point[1], 0.52, 1e-15);
  // at one place, sharp ones that are askew touch with a face
  const double half = std::sqrt(0.5);
  const auto askew =
      found(box, standing({0.5 + half, 0.5}, std::numbers::pi / 4), box, standing({0, 0}), 0.1);
  ASSERT_EQ(askew.size(), 1u);
  EXPECT_NE(askew[0].kind, Kind::corners);
}

// a box that slides from one onto the next, a hair lower or higher, and bricks across a crossing of joints
TEST(Gaps, OfParallelFacesInLineAreNone) {
  const Shape<2> box = box_shape(1, 1);
  for (const double level : {0.0, 1e-9, -1e-9, 1e-7, -1e-7}) {
    for (const double before : {0.05, 1e-3, 1e-9, 0.0, -1e-9}) {
      EXPECT_TRUE(found(box, standing({-1 - before, 1 + level}), box, standing({0, 0}), 0.1).empty());
      EXPECT_TRUE(found(box, standing({1 + level, 1 + before}), box, standing({0, 0}), 0.1).empty());
    }
    EXPECT_EQ(found(box, standing({-0.999, 1 + level}), box, standing({0, 0}), 0.1).size(), 2u);
  }
}

TEST(Gaps, OfBallsRunAlongTheirCentres) {
  const auto one = found(ball_shape(0.3), standing({1, 0}), ball_shape(0.2), standing({0.6, 0.3}));
  ASSERT_EQ(one.size(), 1u);
  EXPECT_NEAR(one[0].value, 0, 1e-15);
  const EvaluatedContact<2> now = evaluate(one[0], standing({1, 0}), standing({0.6, 0.3}));
  EXPECT_NEAR(now.normal[0], 0.8, 1e-15);
  EXPECT_NEAR(now.point[0], 0.6 + 0.16, 1e-15);
  // in one place: along x
  const auto same = found(ball_shape(0.3), standing({1, 0}), ball_shape(0.2), standing({1, 0}));
  EXPECT_EQ(evaluate(same[0], standing({1, 0}), standing({1, 0})).normal, Vec<2>(1, 0));
  EXPECT_EQ(same[0].value, -0.5);
  EXPECT_TRUE(found(ball_shape(0), standing({1, 0}), ball_shape(0), standing({1, 0})).empty());
}

TEST(Gaps, ABallDeepInABoxLeavesByTheNearestFace) {
  const auto all = found(ball_shape(0.1), standing({0.3, 0.1}), box_shape(1, 1), standing({0, 0}));
  ASSERT_EQ(all.size(), 1u);
  const EvaluatedContact<2> now = evaluate(all[0], standing({0.3, 0.1}), standing({0, 0}));
  EXPECT_EQ(now.normal, Vec<2>(1, 0));
  EXPECT_NEAR(now.value, -0.3, 1e-15);
}

TEST(Gaps, ABoxIsAPolygonToAllOthers) {
  ShapeDice dice(5);
  for (int n = 0; n < 1000; ++n) {
    const Shape<2> box = box_shape(dice.between(0.2, 1), dice.between(0.2, 1)), other = dice.simple(0.7);
    const BodyMotion<2> at = dice.body_motion(0.8), there = dice.body_motion(0.8);
    const auto one = found(box, at, other, there, 0.3), two = found(as_polygon(box), at, other, there, 0.3);
    ASSERT_EQ(one.size(), two.size());
    for (std::size_t i = 0; i < one.size(); ++i) {
      EXPECT_EQ(one[i].key, two[i].key);
      EXPECT_NEAR(one[i].value, two[i].value, 1e-14);
    }
  }
}

TEST(Gaps, OfACompoundAreThoseOfItsParts) {
  const Shape<2> left = Box<2>{{0.1, 0.1}, {-0.5, 0}}, right = Ball<2>{0.1, {0.5, 0}};
  const Shape<2> dumbbell = compound_shape({left, right});
  const Shape<2> floor = box_shape(4, 0.2);
  const auto all = found(dumbbell, standing({0, 0.2}), floor, standing({0, 0}), 1e-3);
  ASSERT_EQ(all.size(), 3u);
  for (const ContactCandidate<2>& gap : all) EXPECT_NEAR(gap.value, 0, 1e-15);
  EXPECT_NE(all[0].key.feature, all[2].key.feature);
  EXPECT_NE(all[1].key.feature, all[2].key.feature);
  EXPECT_NEAR(separation(dumbbell, standing({0, 0.3}), floor, standing({0, 0})), 0.1, 1e-15);
}

TEST(Gaps, ToAWallAreOfEveryCorner) {
  Wall<2> wall;
  wall.point = {0, -1};
  std::vector<ContactCandidate<2>> out;
  collide(3, box_shape(1, 1), standing({0, 0}, std::numbers::pi / 4), 2, wall, 0.3, out);
  ASSERT_EQ(out.size(), 1u);
  EXPECT_EQ(out[0].key.b, -3);
  EXPECT_NEAR(out[0].value, 1 - std::sqrt(0.5), 1e-15);
  out.clear();
  collide(3, box_shape(1, 1), standing({0, -0.5}), 2, wall, 0.3, out);
  ASSERT_EQ(out.size(), 2u);
  const EvaluatedContact<2> now = evaluate(out[0], standing({0.2, -0.4}), BodyMotion<2>{});
  EXPECT_NEAR(now.value, 0.1, 1e-15);
  EXPECT_NEAR(now.point[1], -0.95, 1e-15);
  out.clear();
  collide(3, ball_shape(0.5), standing({0, -0.5}), 2, wall, 0.3, out);
  ASSERT_EQ(out.size(), 1u);
  EXPECT_NEAR(out[0].value, 0, 1e-15);
}

}  // namespace
}  // namespace obscura::sim

// Gaps of space against brute force, and against the plane's.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "sim/constraint/row.h"
#include "sim/gaps.h"
#include "sim/solids.h"

namespace obscura::sim {
namespace {

using Kind = ContactCandidate<3>::Kind;

// a core's corners in the room, in long double
using Place = Eigen::Matrix<long double, 3, 1>;

std::vector<Place> corners(const Shape<3>& shape, const BodyMotion<3>& at) {
  std::vector<Vec<3>> local = {Vec<3>::Zero()};
  if (const Hull* hull = form<Hull>(shape)) local = hull->vertices;
  if (const Capsule* rod = form<Capsule>(shape)) local = {{0, -rod->half, 0}, {0, rod->half, 0}};
  if (const Box<3>* box = form<Box<3>>(shape)) {
    local.clear();
    for (int i = 0; i < 8; ++i) local.push_back(box->corner(i));
  }
  std::vector<Place> out;
  for (const Vec<3>& p : local) {
    out.push_back(at.x.cast<long double>() + at.room_from_body.cast<long double>() * p.cast<long double>());
  }
  return out;
}

// distance from the origin to a triangle, its sides included
long double to_triangle(const Place& a, const Place& b, const Place& c) {
  const auto to_segment = [](const Place& p, const Place& q) {
    const Place d = q - p;
    const long double s = std::clamp(-p.dot(d) / d.squaredNorm(), 0.0L, 1.0L);
    return (p + s * d).norm();
  };
  const Place n = (b - a).cross(c - a);
  const bool inside =
      n.dot((b - a).cross(-a)) >= 0 && n.dot((c - b).cross(-b)) >= 0 && n.dot((a - c).cross(-c)) >= 0;
  const long double rim = std::min({to_segment(a, b), to_segment(b, c), to_segment(c, a)});
  return inside ? std::min(rim, std::abs(n.dot(a)) / n.norm()) : rim;
}

// Of the hull of all differences, among the planes through any three of them: the distance of the origin, or
// minus its depth. No separating axes, no edges.
long double brute_force(const std::vector<Place>& a, const std::vector<Place>& b) {
  std::vector<Place> differences;
  for (const Place& p : a) {
    for (const Place& q : b) differences.push_back(p - q);
  }
  long double nearest = 1e300L, depth = 1e300L;
  bool inside = false, outside = false;
  const std::size_t n = differences.size();
  for (std::size_t i = 0; i < n; ++i) {
    nearest = std::min(nearest, differences[i].norm());
    for (std::size_t j = i + 1; j < n; ++j) {
      const Place along = differences[j] - differences[i];
      const long double s = std::clamp(-differences[i].dot(along) / along.squaredNorm(), 0.0L, 1.0L);
      nearest = std::min(nearest, (differences[i] + s * along).norm());
      for (std::size_t k = j + 1; k < n; ++k) {
        Place normal = along.cross(differences[k] - differences[i]);
        const long double size = normal.norm();
        if (size < 1e-12L) continue;
        normal /= size;
        long double low = 0, high = 0;
        for (const Place& p : differences) {
          const long double d = normal.dot(p - differences[i]);
          low = std::min(low, d), high = std::max(high, d);
          if (low < -1e-15L && high > 1e-15L) break;
        }
        if (low < -1e-15L && high > 1e-15L) continue;
        const long double out = normal.dot(differences[i]) * (high > 1e-15L ? -1 : 1);
        const bool flat = low >= -1e-15L && high <= 1e-15L;
        (flat || out < 0 ? outside : inside) = true;
        depth = std::min(depth, out);
        nearest = std::min(nearest, to_triangle(differences[i], differences[j], differences[k]));
      }
    }
  }
  return inside && !outside ? -depth : nearest;
}

TEST(SpaceSeparation, IsTheDistanceOrDepthOfTheDifferencesHull) {
  SpaceDice dice(1);
  int overlapping = 0;
  for (int n = 0; n < 400; ++n) {
    const Shape<3> a = dice.solid(1), b = dice.solid(0.8);
    const BodyMotion<3> at_a = dice.place(1), at_b = dice.place(1);
    const double want =
        double(brute_force(corners(a, at_a), corners(b, at_b))) - core(a).radius - core(b).radius;
    overlapping += want < 0;
    // coordinates of order 1, some dozens of roundings, normals of short edges
    EXPECT_NEAR(separation(a, at_a, b, at_b), want, 1e-13) << n;
    EXPECT_NEAR(separation(b, at_b, a, at_a), want, 1e-13) << n;
  }
  EXPECT_GT(overlapping, 60);
  EXPECT_LT(overlapping, 340);
}

TEST(SpaceGaps, AreNoneBeyondTheMarginAndAsNearAsTheSeparationWithin) {
  SpaceDice dice(2);
  int kinds[6] = {};
  for (int n = 0; n < 20000; ++n) {
    const Shape<3> a = dice.solid(1), b = dice.solid(0.8);
    const BodyMotion<3> at_a = dice.place(1), at_b = dice.place(1);
    const double apart = separation(a, at_a, b, at_b), margin = dice.between(-0.3, 0.5);
    const auto all = found(a, at_a, b, at_b, margin);
    const bool points = is_point(a) && is_point(b);
    ASSERT_EQ(all.empty(), points || apart >= margin) << n << " " << apart << " " << margin;
    if (all.empty()) continue;
    // places within 1e-6 of each other are one
    EXPECT_NEAR(least(all), apart, 1e-12) << n << " " << a.index() << " " << b.index();
    for (const ContactCandidate<3>& gap : all) {
      ++kinds[int(gap.kind)];
      EXPECT_LT(gap.value, margin);
      EXPECT_NEAR(evaluate(gap, at_a, at_b).value, gap.value, 1e-13) << n << " " << int(gap.kind);
    }
  }
  for (const int seen : kinds) EXPECT_GT(seen, 100);
}

// A push at a place that neither body reaches is none of theirs, nor is the speed that it has there.
TEST(SpaceGaps, OfBodiesApartLieOnThem) {
  SpaceDice dice(21);
  int edges = 0;
  for (int n = 0; n < 20000; ++n) {
    const Shape<3> a = brick({0.6, 0.8, 1}), b = brick({0.7, 0.5, 0.9});
    const BodyMotion<3> at_a = dice.place(1), at_b = dice.place(1);
    if (separation(a, at_a, b, at_b) <= 0) continue;
    for (const ContactCandidate<3>& gap : found(a, at_a, b, at_b, 0.3)) {
      if (gap.kind != Kind::edges) continue;
      ++edges;
      const EvaluatedContact<3> now = evaluate(gap, at_a, at_b);
      const Vec<3> half = 0.5 * now.value * now.normal;
      EXPECT_LT((now.point + half - at_a.x).norm(), bounding_radius(a) * (1 + 1e-9)) << n;
      EXPECT_LT((now.point - half - at_b.x).norm(), bounding_radius(b) * (1 + 1e-9)) << n;
    }
  }
  EXPECT_GT(edges, 500);
}

// so that the solver need not look again at pairs that cannot have come near
TEST(SpaceGaps, AreNoneWhileTheBodiesMoveLessThanTheirClearance) {
  SpaceDice dice(12);
  int apart = 0, edges = 0;
  for (int n = 0; n < 40000; ++n) {
    const bool boxes = n % 2 == 0;
    const Shape<3> a = boxes ? brick({0.6, 0.8, 1}) : dice.solid(1),
                   b = boxes ? brick({0.7, 0.5, 0.9}) : dice.solid(0.8);
    const BodyMotion<3> at_a = dice.place(1), at_b = dice.place(1);
    const double margin = dice.between(0.01, 0.1), radii = bounding_radius(a) + bounding_radius(b);
    std::vector<ContactCandidate<3>> out;
    Clearance clearance;
    collide(0, a, at_a, 1, b, at_b, margin, Gaps::all, out, clearance);
    if (!out.empty() || clearance.apart < margin) continue;
    ++apart, edges += clearance.per_turn > 1;
    // as far as its words go, in any direction: half of it by moving, half by turning
    const double spare = clearance.apart - margin, distance = (at_a.x - at_b.x).norm() + spare;
    BodyMotion<3> then_a = at_a, then_b = at_b;
    then_a.x += 0.25 * spare * dice.vec(1).normalized(), then_b.x += 0.25 * spare * dice.vec(1).normalized();
    const double turn = 0.25 * std::min(spare / (distance + radii), 1.0) / clearance.per_turn;
    for (BodyMotion<3>* at : {&then_a, &then_b}) {
      at->room_from_body = matrix(exponential(Vec<3>(turn * dice.vec(1).normalized()))) * at->room_from_body;
    }
    EXPECT_TRUE(found(a, then_a, b, then_b, margin).empty()) << n << " " << clearance.per_turn;
  }
  EXPECT_GT(apart, 5000);
  EXPECT_GT(edges, 200);
}

TEST(SpaceSeparation, AlongAnyDirectionIsNoMoreAndAlongTheNormalOfTheNearestGapIsAll) {
  SpaceDice dice(13);
  int inside = 0;
  for (int n = 0; n < 4000; ++n) {
    const Shape<3> a = dice.solid(1), b = dice.solid(0.8);
    const BodyMotion<3> at_a = dice.place(0.5), at_b = dice.place(0.5);
    const double apart = separation(a, at_a, b, at_b);
    EXPECT_LE(separation_along(dice.vec(1).normalized(), a, at_a, b, at_b), apart + 1e-12) << n;
    const auto all = found(a, at_a, b, at_b, 0);
    if (all.empty() || core(a).radius + core(b).radius > 0) continue;
    ++inside;
    double most = -1e300;
    for (const auto& gap : all)
      most = std::max(most, separation_along(evaluate(gap, at_a, at_b).normal, a, at_a, b, at_b));
    EXPECT_NEAR(most, apart, 1e-12) << n << " " << a.index() << " " << b.index();
  }
  EXPECT_GT(inside, 500);
}

TEST(SpaceGaps, AreTheSameFromEitherSideAndInATurnedRoom) {
  SpaceDice dice(3);
  const Rotation<3> turn = matrix(exponential(Vec<3>(0.3, -1.1, 0.7)));
  for (int n = 0; n < 10000; ++n) {
    const Shape<3> a = dice.solid(1), b = dice.solid(0.8);
    const BodyMotion<3> at_a = dice.place(1), at_b = dice.place(1);
    const auto one = found(a, at_a, b, at_b, 0.2), two = found(b, at_b, a, at_a, 0.2);
    BodyMotion<3> turned_a = at_a, turned_b = at_b;
    for (BodyMotion<3>* at : {&turned_a, &turned_b}) {
      at->x = turn * at->x, at->room_from_body = turn * at->room_from_body;
    }
    const auto three = found(a, turned_a, b, turned_b, 0.2);
    ASSERT_EQ(one.size(), two.size()) << n << " " << a.index() << " " << b.index();
    ASSERT_EQ(one.size(), three.size()) << n;
    for (std::size_t i = 0; i < one.size(); ++i) {
      const EvaluatedContact<3> now = evaluate(one[i], at_a, at_b);
      EXPECT_TRUE(std::any_of(two.begin(), two.end(),
                              [&](const ContactCandidate<3>& other) {
                                const EvaluatedContact<3> there = evaluate(other, at_b, at_a);
                                return std::abs(there.value - now.value) < 1e-12 &&
                                       (there.point - now.point).norm() < 1e-10 &&
                                       (there.normal + now.normal).norm() < 1e-10;
                              }))
          << n << " " << a.index() << " " << b.index();
      EXPECT_EQ(three[i].key, one[i].key);
      const EvaluatedContact<3> there = evaluate(three[i], turned_a, turned_b);
      EXPECT_NEAR(there.value, now.value, 1e-12);
      EXPECT_LT((there.point - turn * now.point).norm(), 1e-10);
    }
  }
}

TEST(SpaceGaps, ChangeAtTheNormalVelocityOfTheirPoint) {
  SpaceDice dice(4);
  int seen[6] = {};
  for (int n = 0; n < 6000; ++n) {
    const Shape<3> a = dice.solid(1), b = dice.solid(0.8);
    const BodyMotion<3> at_a = dice.place(1), at_b = dice.place(1);
    for (const ContactCandidate<3>& gap : found(a, at_a, b, at_b, 0.5)) {
      const EvaluatedContact<3> now = evaluate(gap, at_a, at_b);
      // places close together and edges nearly parallel turn fast
      const bool points =
          gap.kind != Kind::corner_of_a && gap.kind != Kind::corner_of_b && gap.kind != Kind::edges;
      if (points && now.value + gap.radius_a + gap.radius_b < 0.1) continue;
      if (gap.kind == Kind::edges && at_a.arm(gap.edge_a).cross(at_b.arm(gap.edge_b)).norm() < 0.3) continue;
      const double rate =
          now.normal.dot(at_a.velocity(now.point - at_a.x) - at_b.velocity(now.point - at_b.x));
      const double h = 1e-5;
      const double later = evaluate(gap, moved(at_a, h), moved(at_b, h)).value,
                   before = evaluate(gap, moved(at_a, -h), moved(at_b, -h)).value;
      // central difference: h^2 g''' / 6 with g''' up to 1e4
      EXPECT_NEAR((later - before) / (2 * h), rate, 1e-7) << n << " " << int(gap.kind);

      // and so do rows: J v, and how it changes
      Row<3> now_rows[3], later_rows[3], before_rows[3];
      const EvaluatedContact<3> width = rows(gap, at_a, at_b, now_rows);
      EXPECT_NEAR(width.value, now.value, 1e-13);
      EXPECT_LT((width.normal - now.normal).norm(), 1e-12);
      const std::vector<BodyMotion<3>> both = {at_a, at_b}, after = {moved(at_a, h), moved(at_b, h)},
                                       earlier = {moved(at_a, -h), moved(at_b, -h)};
      EXPECT_NEAR(speed(now_rows[0], both), rate, 1e-12);
      rows(gap, after[0], after[1], later_rows), rows(gap, earlier[0], earlier[1], before_rows);
      const double faster = (speed(later_rows[0], after) - speed(before_rows[0], earlier)) / (2 * h);
      EXPECT_NEAR(faster, now_rows[0].velocity_product, 1e-5) << n << " " << int(gap.kind);
      ++seen[int(gap.kind)];
    }
  }
  for (const int of_kind : seen) EXPECT_GT(of_kind, 50);
}

// Flat bodies given a depth touch as in the plane, at both ends of it. Where two corners are near each other
// and each lies before a face of the other, the plane keeps both of these, and space the nearer one.
TEST(SpaceGaps, OfExtrudedShapesAreThoseOfThePlane) {
  SpaceDice dice(5);
  int seen = 0;
  for (int n = 0; n < 5000; ++n) {
    const Shape<2> flat_a = dice.simple(1), flat_b = dice.simple(0.8);
    const BodyMotion<2> at_a = dice.body_motion(1.2), at_b = dice.body_motion(1.2);
    const double depth_a = dice.between(3, 4), depth_b = n % 3 ? dice.between(3, 4) : depth_a;
    const Shape<3> a = extruded(flat_a, depth_a), b = extruded(flat_b, depth_b);
    std::vector<ContactCandidate<2>> flat;
    collide(0, flat_a, at_a, 1, flat_b, at_b, 0.2, flat);
    const auto deep = found(a, extruded(at_a), b, extruded(at_b), 0.2);
    const bool round = round_radius(a) || round_radius(b);
    const auto in_plane = [&](std::size_t k) { return evaluate(flat[k], at_a, at_b); };
    const bool corners = flat.size() == 2 && (in_plane(0).normal - in_plane(1).normal).norm() > 1e-6;
    if (corners && deep.size() == 2) {
      const double nearer = std::min(in_plane(0).value, in_plane(1).value);
      EXPECT_NEAR(evaluate(deep[0], extruded(at_a), extruded(at_b)).value, nearer, 1e-12) << n;
      EXPECT_GT(nearer, 0) << n;
    } else {
      ASSERT_EQ(deep.size(), flat.size() * (round ? 1 : 2)) << n << " " << a.index() << " " << b.index();
    }
    for (const ContactCandidate<3>& gap : deep) {
      const EvaluatedContact<3> now = evaluate(gap, extruded(at_a), extruded(at_b));
      EXPECT_NEAR(std::abs(now.point[2]), round ? 0 : std::min(depth_a, depth_b) / 2, 1e-12);
      EXPECT_TRUE(std::any_of(flat.begin(), flat.end(),
                              [&](const ContactCandidate<2>& other) {
                                const EvaluatedContact<2> there = evaluate(other, at_a, at_b);
                                return std::abs(there.value - now.value) < 1e-12 &&
                                       (there.point - now.point.head<2>()).norm() < 1e-11 &&
                                       (there.normal - now.normal.head<2>()).norm() < 1e-11;
                              }))
          << n << " " << int(gap.kind);
      ++seen;
    }
  }
  EXPECT_GT(seen, 1000);
}

TEST(SpaceGaps, OfAStackAreFourAndKeepTheirFeatures) {
  const Shape<3> box = brick({0.2, 0.1, 0.3}), wide = brick({1, 0.1, 1});
  struct Case {
    const Shape<3>&upper, &lower;
    Vec<3> offset;
  };
  for (const auto& [upper, lower, offset] :
       {Case{box, box, {0, 0, 0}}, Case{box, box, {0.03, 0, 0}}, Case{box, box, {0.03, 0, -0.1}},
        Case{box, wide, {0.2, 0, 0.1}}, Case{wide, box, {0.1, 0, 0}}, Case{box, wide, {0.4, 0, 0.35}},
        Case{wide, box, {-0.5, 0, 0}}}) {
    for (const bool swapped : {false, true}) {
      std::vector<int> features;
      for (const Vec<3>& tilt : {Vec<3>(0, 0, 0), Vec<3>(1e-9, 0, 0), Vec<3>(-1e-9, 0, 1e-9),
                                 Vec<3>(0, 1e-9, 0), Vec<3>(0, -1e-8, 0), Vec<3>(1e-7, 1e-8, -1e-7)}) {
        for (const double shift : {0.0, 1e-9, -1e-9}) {
          for (const double height : {0.0, 1e-9, -1e-9, 1e-5}) {
            const BodyMotion<3> below = placed({0.3, 0.7, 0.1}),
                                above = placed(below.x + offset + Vec<3>(shift, 0.1 + height, -shift), tilt);
            const auto all =
                swapped ? found(lower, below, upper, above, 0.01) : found(upper, above, lower, below, 0.01);
            ASSERT_EQ(all.size(), 4u) << offset.transpose() << " " << tilt.transpose() << " " << shift;
            Vec<3> low = Vec<3>::Constant(1e9), high = -low;
            for (std::size_t i = 0; i < all.size(); ++i) {
              if (features.size() < 4) features.push_back(all[i].key.feature);
              EXPECT_EQ(all[i].key.feature, features[i])
                  << offset.transpose() << " " << tilt.transpose() << " " << shift << " " << height;
              const EvaluatedContact<3> now =
                  swapped ? evaluate(all[i], below, above) : evaluate(all[i], above, below);
              EXPECT_NEAR(now.normal[1], swapped ? -1 : 1, 1e-11);
              EXPECT_NEAR(now.value, height, 1e-7);
              EXPECT_NEAR(now.point[1], 0.75, 2e-5);
              low = low.cwiseMin(now.point), high = high.cwiseMax(now.point);
            }
            // the corners of what they share
            for (const int axis : {0, 2}) {
              const double half =
                  std::min({(form<Box<3>>(upper)->half[axis] + form<Box<3>>(lower)->half[axis] -
                             std::abs(offset[axis])) /
                                2,
                            form<Box<3>>(upper)->half[axis], form<Box<3>>(lower)->half[axis]});
              EXPECT_NEAR(high[axis] - low[axis], 2 * half, 3e-6);
            }
          }
        }
      }
    }
  }
}

TEST(SpaceGaps, OfCrossedBeamsAreTheirEdgesCrossings) {
  const Shape<3> beam = brick({2, 0.2, 0.4});
  for (const double angle : {0.6, 1.0, std::numbers::pi / 2}) {
    for (const bool swapped : {false, true}) {
      const BodyMotion<3> below = placed({0, 0, 0}), above = placed({0.1, 0.2, 0.05}, {0, angle, 0});
      const auto all =
          swapped ? found(beam, below, beam, above, 0.01) : found(beam, above, beam, below, 0.01);
      ASSERT_EQ(all.size(), 4u);
      for (const ContactCandidate<3>& gap : all) {
        EXPECT_EQ(gap.kind, Kind::edges);
        EXPECT_NEAR(gap.value, 0, 1e-15);
      }
    }
  }
  // turned about the middle, a square on a square: eight
  const auto octagon = found(brick({1, 1, 1}), placed({0, 1, 0}, {0, std::numbers::pi / 4, 0}),
                             brick({1, 1, 1}), placed({0, 0, 0}), 0.01);
  EXPECT_EQ(octagon.size(), 8u);
}

TEST(SpaceGaps, OfParallelFacesInLineAreNone) {
  const Shape<3> box = brick({1, 1, 1});
  for (const double level : {0.0, 1e-9, -1e-9, 1e-7, -1e-7}) {
    for (const double before : {0.05, 1e-3, 1e-9, 0.0, -1e-9}) {
      for (const double aside : {0.0, 0.2, 1.0}) {
        EXPECT_TRUE(found(box, placed({-1 - before, 1 + level, aside}), box, placed({0, 0, 0}), 0.1).empty())
            << level << " " << before << " " << aside;
      }
    }
    EXPECT_EQ(found(box, placed({-0.999, 1 + level, 0}), box, placed({0, 0, 0}), 0.1).size(), 4u);
  }
}

TEST(SpaceGaps, OfCapsulesSideBySideAreTheEndsOfWhatTheyShare) {
  const Shape<3> one = capsule(0.5, 0.1), other = capsule(0.3, 0.2);
  const auto all = found(one, placed({0, 0, 0}), other, placed({0.3, 0.5, 0}), 0.01);
  ASSERT_EQ(all.size(), 2u);
  for (const ContactCandidate<3>& gap : all) {
    const EvaluatedContact<3> now = evaluate(gap, placed({0, 0, 0}), placed({0.3, 0.5, 0}));
    EXPECT_NEAR(now.value, 0, 1e-15);
    EXPECT_NEAR(now.normal[0], -1, 1e-15);
    EXPECT_NEAR(now.point[0], 0.1, 1e-15);
    EXPECT_TRUE(std::abs(now.point[1] - 0.5) < 1e-15 || std::abs(now.point[1] - 0.2) < 1e-15);
  }
  // lying on a table
  const auto flat = found(one, placed({0, 0.6, 0}, {0, 0, std::numbers::pi / 2}), brick({4, 1, 4}),
                          placed({0, 0, 0}), 0.01);
  ASSERT_EQ(flat.size(), 2u);
  EXPECT_NEAR(flat[0].value, 0, 1e-15);
}

TEST(SpaceGaps, ABoxIsAHullToAllOthers) {
  SpaceDice dice(6);
  for (int n = 0; n < 2000; ++n) {
    const Shape<3> box = brick({dice.between(0.2, 1), dice.between(0.2, 1), dice.between(0.2, 1)}),
                   other = dice.solid(0.7);
    const BodyMotion<3> at = dice.place(0.7), there = dice.place(0.7);
    const auto one = found(box, at, other, there, 0.3), two = found(as_hull(box), at, other, there, 0.3);
    ASSERT_EQ(one.size(), two.size()) << n;
    for (const ContactCandidate<3>& gap : one) {
      const EvaluatedContact<3> now = evaluate(gap, at, there);
      EXPECT_TRUE(std::any_of(two.begin(), two.end(), [&](const ContactCandidate<3>& same) {
        const EvaluatedContact<3> here = evaluate(same, at, there);
        return std::abs(here.value - now.value) < 1e-12 && (here.point - now.point).norm() < 1e-10;
      })) << n;
    }
  }
}

TEST(SpaceGaps, OfACompoundAreThoseOfItsTurnedParts) {
  const Orientation<3> quarter = exponential(Vec<3>(0, 0, std::numbers::pi / 2));
  const Shape<3> left = Box<3>{{0.1, 0.2, 0.1}, {-0.5, 0, 0}, quarter}, right = Ball<3>{0.1, {0.5, 0, 0}},
                 bar = Capsule{0.2, 0.1, Vec<3>::Zero(), quarter};
  const Shape<3> all_three = compound_shape<3>({left, right, bar});
  const Shape<3> floor = brick({4, 0.2, 4});
  const auto all = found(all_three, placed({0, 0.2, 0}), floor, placed({0, 0, 0}), 1e-3);
  ASSERT_EQ(all.size(), 7u);
  for (std::size_t i = 0; i < all.size(); ++i) {
    EXPECT_NEAR(all[i].value, 0, 1e-15);
    for (std::size_t k = 0; k < i; ++k) EXPECT_NE(all[i].key.feature, all[k].key.feature);
  }
  std::vector<ContactCandidate<3>> wall;
  collide(0, all_three, placed({0, 0.2, 0}), 0, Wall<3>{{0, 0.1, 0}, {0, 1, 0}, {}, {}}, 1e-3, wall);
  EXPECT_EQ(wall.size(), 7u);
}

// found by fuzzing states: no face is the nearest to what is turned by no number
TEST(SpaceGaps, WhatStandsNowhereTouchesNothing) {
  BodyMotion<3> nowhere = placed({0, 0, 0});
  nowhere.room_from_body.setConstant(std::nan(""));
  const Shape<3> box = brick({0.2, 0.2, 0.2});
  EXPECT_TRUE(found(box, nowhere, box, placed({0, 0.1, 0}), 1).empty());
  EXPECT_TRUE(found(box, placed({0, 0.1, 0}), box, nowhere, 1).empty());
  EXPECT_TRUE(found(ball_shape<3>(0.1), placed({0, 0.1, 0}), box, nowhere, 1).empty());
}

}  // namespace
}  // namespace obscura::sim

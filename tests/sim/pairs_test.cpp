// Pairs against all pairs.

#include "sim/collide/broad_phase.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <limits>

#include "sim/allocations.h"
#include "sim/collide/may_touch.h"
#include "sim/shapes.h"

namespace obscura::sim {
namespace {

using Found = std::vector<std::pair<int, int>>;

Found all_pairs(const std::vector<Bounds<2>>& bounds, const std::vector<char>& still) {
  Found out;
  for (int a = 0; a < int(bounds.size()); ++a) {
    for (int b = a + 1; b < int(bounds.size()); ++b) {
      if (bounds[a].meets(bounds[b]) && !(still[a] && still[b])) out.emplace_back(a, b);
    }
  }
  return out;
}

struct RandomBodies {
  std::vector<Bounds<2>> bounds;
  std::vector<char> still;
};

// bodies of like size, some of them floors, towers, points, and one far away
RandomBodies body_counts(ShapeDice& dice, int n, double room) {
  RandomBodies all;
  for (int i = 0; i < n; ++i) {
    const Vec<2> x(dice.between(-room, room), dice.between(-room, room));
    Vec<2> half(dice.between(0.1, 1), dice.between(0.1, 1));
    const int odd = dice.below(40);
    if (odd == 0) half[0] *= 50;
    if (odd == 1) half[1] *= 2000;
    if (odd == 2) half = Vec<2>::Zero();
    all.bounds.push_back({x - half, x + half});
    all.still.push_back(dice.below(4) == 0);
  }
  all.bounds[0].lower = {1e20, -3e200};
  all.bounds[0].upper = {1e21, 2};
  return all;
}

TEST(BroadPhase, FindsAllPairsAndNoOther) {
  ShapeDice dice(1);
  for (int n = 0; n < 60; ++n) {
    const RandomBodies all = body_counts(dice, 1 + dice.below(300), dice.between(1, 60));
    BroadPhase<2> phase;
    EXPECT_EQ(phase.find(all.bounds, all.still), all_pairs(all.bounds, all.still)) << n;
  }
}

TEST(BroadPhase, FindsTheSameWhateverCameBefore) {
  ShapeDice dice(2);
  BroadPhase<2> phase;
  RandomBodies all = body_counts(dice, 400, 10);
  for (int n = 0; n < 60; ++n) {
    // drift, now and then a jump
    const double far = n % 10 == 9 ? 20 : 0.1;
    for (Bounds<2>& one : all.bounds) {
      const Vec<2> by(dice.between(-far, far), dice.between(-far, far));
      one.lower += by;
      one.upper += by;
    }
    EXPECT_EQ(phase.find(all.bounds, all.still), all_pairs(all.bounds, all.still)) << n;
  }
}

TEST(BroadPhase, TellsNoPairOfPointsNorOfStillBodies) {
  ShapeDice dice(3);
  BroadPhase<2> phase;
  for (int n = 0; n < 60; ++n) {
    const RandomBodies all = body_counts(dice, 1 + dice.below(300), dice.between(1, 20));
    std::vector<char> points;
    for (std::size_t i = 0; i < all.bounds.size(); ++i) points.push_back(dice.below(3) == 0);
    Found right = all_pairs(all.bounds, all.still);
    std::erase_if(right, [&](const auto& pair) { return points[pair.first] && points[pair.second]; });
    EXPECT_EQ(phase.find(all.bounds, all.still, {}, points), right) << n;
  }
}

// how many pairs are compared of n boxes at one place, all but ten of them points, or still
std::int64_t compared_at_one_place(int n, bool points) {
  std::vector<Bounds<2>> bounds(n, {{0, 0}, {1, 1}});
  std::vector<char> odd(n, 1), none(n, 0);
  for (int i = 0; i < 10; ++i) odd[i] = 0;
  BroadPhase<2> phase;
  const auto& pairs = points ? phase.find(bounds, none, {}, odd) : phase.find(bounds, odd);
  EXPECT_EQ(int(pairs.size()), 10 * (n - 10) + 45);
  return phase.compared();
}

TEST(BroadPhase, IsLinearInPointsAndStillBodiesAtOnePlace) {
  for (const bool points : {true, false}) {
    const std::int64_t some = compared_at_one_place(1000, points),
                       twice = compared_at_one_place(2000, points);
    EXPECT_LE(some, 20'000) << points;
    EXPECT_LE(twice, 5 * some / 2) << points;
  }
}

TEST(BroadPhase, TellsTouchingBoundsAndNeverNaN) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const std::vector<Bounds<2>> bounds = {
      {{0, 0}, {1, 1}}, {{1, 1}, {2, 2}}, {{nan, nan}, {nan, nan}}, {{2.5, 0}, {3, 1}}};
  const std::vector<char> moving(4, 0), still(4, 1);
  BroadPhase<2> phase;
  EXPECT_EQ(phase.find(bounds, moving), (Found{{0, 1}}));
  EXPECT_TRUE(phase.find(bounds, still).empty());
  EXPECT_TRUE(phase.find(bounds, moving, [](int, int) { return false; }).empty());
}

TEST(BroadPhase, AllocatesNothingOnceWarm) {
  ShapeDice dice(3);
  RandomBodies all = body_counts(dice, 500, 10);
  BroadPhase<2> phase;
  for (int n = 0; n < 3; ++n) phase.find(all.bounds, all.still);
  const auto before = allocations();
  phase.find(all.bounds, all.still);
  EXPECT_EQ(allocations(), before);
}

TEST(MayTouch, IsNotOfGroupsThatIgnoreEachOtherNorOfAJoint) {
  Model<2> model;
  for (const int group : {7, -2, 7, 5}) {
    model.bodies.emplace_back();
    model.bodies.back().group = group;
    model.bodies.back().shape = ball_shape(1);
  }
  model.ignore = {{-2, 7}, {5, 5}, {99, 7}};
  Joint<2> joint;
  joint.a.body = 3;
  joint.b.body = 2;
  model.joints = {joint};
  const MayTouch<2> may(model);
  EXPECT_FALSE(may(0, 1));
  EXPECT_FALSE(may(1, 2));
  EXPECT_TRUE(may(0, 2));
  EXPECT_TRUE(may(1, 3));
  EXPECT_TRUE(may(0, 3));
  EXPECT_FALSE(may(2, 3));
  model.joints[0].touching = true;
  EXPECT_TRUE(MayTouch<2>(model)(2, 3));
}

TEST(MayTouch, IsNotOfTwoFixedNorOfTwoPointsNorOfTheHandouts) {
  Model<2> model;
  for (int i = 0; i < 7; ++i) {
    model.bodies.emplace_back();
    model.bodies.back().shape = ball_shape(i == 2 || i == 3 ? 0 : 1);
    model.bodies.back().fixed = i < 2;
    model.bodies.back().handout = i == 6;
  }
  const MayTouch<2> may(model);
  EXPECT_FALSE(may(0, 1)) << "both fixed";
  EXPECT_FALSE(may(2, 3)) << "both points";
  EXPECT_TRUE(may(0, 2) && may(1, 4) && may(3, 4) && may(4, 5));
  for (int i = 0; i < 6; ++i) EXPECT_FALSE(may(i, 6) || may(6, i)) << "one keeps the handout's law";
}

}  // namespace
}  // namespace obscura::sim

// Boxes that meet four at a time: against one pair after another.

#include "sim/solve/iterate/plane_box_pairs.h"

#include <gtest/gtest.h>

#include <cmath>

#include "rooms.h"
#include "sim/math/trig.h"

namespace obscura::sim {
namespace {

// 4000 random pairs, near enough to touch or overlap: the same features by the same gap. Both turn corners in
// another order, so that they may choose another corner where two are as near, to rounding (1e-12 of boxes
// of size 1)
TEST(IterativeBoxes, MeetAsOnePairAfterAnother) {
  World<2> world = room();
  std::vector<plane::Pose> poses;
  constexpr int kBoxes = 200;
  for (int i = 0; i < kBoxes; ++i) {
    const double angle = i % 10 == 0 ? 0 : 0.73 * i;
    const Vec2 at(0.9 * std::sin(2.1 * i), 0.9 * std::sin(3.7 * i));
    add_box(world, {0.3 + 0.1 * (i % 7), 1 - 0.1 * (i % 5)}, 1, at, {0, 0}, angle, 0, 0);
    const SinCos sc = sin_cos(angle);
    poses.push_back({at[0], at[1], sc.cos, sc.sin});
  }
  poses.emplace_back();
  const plane::CoreShapes cores(world.model);
  const std::vector<plane::HalfSides> halves = plane::halves(cores);
  int apart = 0, corners = 0;
  for (int i = 0; i < 1000; ++i) {
    plane::BoxManifold four{};
    for (int lane = 0; lane < plane::kLanes; ++lane)
      four.a[lane] = (7 * i + 31 * lane) % kBoxes, four.b[lane] = (13 * i + 57 * lane + 1) % kBoxes;
    plane::collide_boxes(&four, 1, poses.data(), halves.data(), cores.passing);
    for (int lane = 0; lane < plane::kLanes; ++lane) {
      const int p = four.a[lane], q = four.b[lane];
      if (p == q) continue;
      const plane::CoreShape &a = cores.all[p], &b = cores.all[q];
      plane::Feature features[2];
      const double gap = find_features(cores, a, poses[p], b, poses[q], features);
      EXPECT_NEAR(four.gap[lane], gap, 1e-12) << p << " " << q;
      apart += gap > 0;
      double want[2], got[2];
      for (int k = 0; k < 2; ++k) {
        const auto off = [&](const plane::Feature& f) {
          return f.kind == plane::Feature::none ? 1e3
                                                : evaluate_feature(cores, a, poses[p], b, poses[q], f).gap;
        };
        const plane::Feature found = plane::Feature::of(four.words[k][lane]);
        corners += found.kind == plane::Feature::corners;
        want[k] = off(features[k]), got[k] = off(found);
      }
      if (want[1] < want[0]) std::swap(want[0], want[1]);
      if (got[1] < got[0]) std::swap(got[0], got[1]);
      EXPECT_NEAR(got[0], want[0], 1e-12) << p << " " << q;
      EXPECT_NEAR(got[1], want[1], 1e-12) << p << " " << q;
      EXPECT_LE(four.words[0][lane], four.words[1][lane]);
    }
  }
  // all cases were among them
  EXPECT_GT(apart, 200);
  EXPECT_GT(corners, 20);
}

}  // namespace
}  // namespace obscura::sim

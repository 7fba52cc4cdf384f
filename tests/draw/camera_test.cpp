#include "draw/space/camera.h"

#include <gtest/gtest.h>

#include "draw/made.h"

namespace obscura::draw {
namespace {

using Ease = CameraKey::Ease;

constexpr Ease kEases[] = {Ease::linear, Ease::in, Ease::out, Ease::in_out};

TEST(Camera, EasesRiseFromNoughtToOne) {
  for (Ease ease : kEases) {
    EXPECT_EQ(eased(ease, 0), 0);
    EXPECT_EQ(eased(ease, 1), 1);
    double before = 0;
    for (int i = 1; i <= 1000; ++i) {
      const double now = eased(ease, i / 1000.0);
      EXPECT_GE(now, before);
      before = now;
    }
  }
  EXPECT_EQ(eased(Ease::hold, 0.999), 0);
}

TEST(Camera, InAndOutStartAndEndAtRest) {
  // 10 u^3 at the start and, by symmetry, at the end
  EXPECT_LT(eased(Ease::in_out, 0.01), 1.1e-5);
  EXPECT_NEAR(eased(Ease::in_out, 0.3) + eased(Ease::in_out, 0.7), 1, 1e-12);
}

Made filmed() {
  Made made = room(8, 4.5);
  made.camera.keys = {{0, {}, {}, {}, Ease::linear},
                      {2, sim::Vec3(6, 1, 0), 3.0, {}, Ease::in_out},
                      {3, sim::Vec3(2, 3, 0), 3.0, {}, Ease::out},
                      {5, sim::Vec3(4, 2, 0), 12.0, {}, Ease::hold}};
  return made;
}

TEST(Camera, KeysAreHitExactly) {
  const Made made = filmed();
  const Illustrator depictor = made.depictor();
  const double page = 1920;
  const Point middle = depictor.view(0).page({4, 2.25, 0});
  for (const CameraKey& key : made.camera.keys) {
    if (!key.center) continue;
    const View view = depictor.view(key.time);
    EXPECT_NEAR((view.page(*key.center) - middle).norm(), 0, 1e-9) << key.time;
    EXPECT_NEAR(page / view.scale, *key.width, 1e-12) << key.time;
  }
  // the first key says nothing: it fits the room, as without keys; the caption's place is the same
  EXPECT_NEAR(depictor.view(0).scale, room(8, 4.5).depictor().view(0).scale, 1e-9);
}

TEST(Camera, ZoomKeepsOnePlaceOfTheWorldStill) {
  Made made = room(8, 4.5);
  made.camera.keys = {{0, sim::Vec3(4, 2, 0), 8.0, {}, Ease::linear},
                      {1, sim::Vec3(6, 1, 0), 2.0, {}, Ease::linear}};
  const Illustrator depictor = made.depictor();
  // 4 + 2 s = 6 + s (2 - 8) / ... : the centre of the similarity between the two rectangles
  const sim::Vec3 fixed(4 + 2 / (1 - 2.0 / 8), 2 - 1 / (1 - 2.0 / 8), 0);
  const Point there = depictor.view(0).page(fixed);
  double before = 0;
  for (int i = 0; i <= 20; ++i) {
    const View view = depictor.view(i / 20.0);
    EXPECT_NEAR((view.page(fixed) - there).norm(), 0, 1e-8) << i;
    EXPECT_GT(view.scale, before);
    before = view.scale;
  }
}

TEST(Camera, HoldsUntilItsTimeAndAfterTheLastKey) {
  const Illustrator depictor = filmed().depictor();
  EXPECT_EQ(depictor.view(4.999).scale, depictor.view(3).scale);
  EXPECT_NEAR(1920 / depictor.view(5).scale, 12, 1e-12);
  EXPECT_EQ(depictor.view(50).scale, depictor.view(5).scale);
  EXPECT_EQ(depictor.view(-1).scale, depictor.view(0).scale);
}

TEST(Camera, PanIsMonotone) {
  const Illustrator depictor = filmed().depictor();
  double before = 1e9;
  for (int i = 0; i <= 50; ++i) {
    const View view = depictor.view(2 + i / 50.0);
    const double center = (depictor.view(0).page({4, 2.25, 0}).x() - view.origin.x()) / view.scale;
    EXPECT_LE(center, before + 1e-12);
    before = center;
  }
}

TEST(Camera, StillListIsSharedWhileItStandsAndNewWhileItMoves) {
  Made made = filmed();
  const Illustrator depictor = made.depictor();
  auto still = [&](double t) {
    made.now.time = t;
    return depictor.depict(made.now, {}).still;
  };
  EXPECT_EQ(still(3.2), still(4.8)) << "held";
  EXPECT_NE(still(0.8), still(1.2));
  EXPECT_EQ(still(6), still(7));

  made.camera.keys.clear();
  const Illustrator fixed = made.depictor();
  made.now.time = 0;
  const auto first = fixed.depict(made.now, {}).still;
  made.now.time = 9;
  EXPECT_EQ(fixed.depict(made.now, {}).still, first);
}

TEST(Camera, WorldIsClippedBelowTheCaptionWhereItMoves) {
  Made made = filmed();
  made.now.time = 2;
  made.body(sim::ShapeKind::ball, {6, 1, 0}, 5);
  const Picture picture = made.picture();
  ASSERT_FALSE(picture.moving.batches.empty());
  for (const List* list : {picture.still.get(), &picture.moving}) {
    for (const Batch& batch : list->batches) {
      if (batch.kind == Kind::text) continue;
      // the rule between strip and world is the strip's
      if (batch.clip < 0 && list == picture.still.get() && batch.kind == Kind::stroke) continue;
      ASSERT_GE(batch.clip, 0);
      for (const Text& text : picture.still->texts) EXPECT_GT(list->clips[batch.clip].y, text.at.y());
    }
  }
}

}  // namespace
}  // namespace obscura::draw

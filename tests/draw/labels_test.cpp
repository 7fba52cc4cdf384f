// Labels: the words of bodies, beside them and upright.

#include <gtest/gtest.h>

#include <cmath>

#include "draw/made.h"
#include "draw/page/layout.h"
#include "draw/space/camera.h"

namespace obscura::draw {
namespace {

using sim::ShapeKind;

// the text of a list that says these words
const Text* said(const List& list, const std::string& words) {
  for (const Text& text : list.texts)
    if (text.spans[0].text == words) return &text;
  return nullptr;
}

TEST(Labels, StandOverTheHighestCornerHoweverTheBodyIsTurned) {
  Made made = room(8, 4.5);
  const int it = made.body(ShapeKind::box, {3, 2, 0}, 0.5);
  made.look.bodies[it].label = "crate";
  for (double angle : {0.0, 0.4, 0.785398}) {
    made.now.bodies[it].angle = angle;
    const Picture picture = made.picture();
    const Text* text = said(picture.moving, "crate");
    ASSERT_TRUE(text);
    const View view = made.depictor().view(0);
    const double high = 0.5 * (std::abs(std::sin(angle)) + std::abs(std::cos(angle)));
    const double over = view.page({3, 2 + high, 0}).y() - text->at.y();
    EXPECT_GT(over, 5);
    EXPECT_LT(over, 25);
    EXPECT_NEAR(text->at.x(), view.page({3, 2, 0}).x(), 1e-9);
  }
}

TEST(Labels, StayInTheWindow) {
  Made made = room(8, 4.5);
  made.wall({0, 0, 0}, {0, 1, 0});
  const int it = made.body(ShapeKind::ball, {0.02, 4.49, 0}, 0.01);
  made.look.bodies[it].label = "a ball with many words";
  CameraKey key;
  key.center = sim::Vec3(1, 4, 0), key.width = 1.97;
  made.camera.keys = {key};
  const Picture picture = made.picture();
  const Text* text = said(picture.moving, "a ball with many words");
  ASSERT_TRUE(text);
  const View view = made.depictor().view(0);
  const double half = width_of("a ball with many words", Face::medium, text->spans[0].size) / 2;
  EXPECT_GE(text->at.x() - half, view.window.x);
  EXPECT_GE(text->at.y() - text->spans[0].size, view.window.y);
}

TEST(Labels, InSpaceStandOverTheBodyForEachCamera) {
  Made made;
  made.cast.dimension = 3, made.cast.scale = 2;
  made.wall({0, 0, 0}, {0, 1, 0});
  made.extent = {{-2, 0, -2}, {2, 2, 2}};
  const int it = made.body(ShapeKind::ball, {0.5, 0.6, -0.3}, 0.2);
  made.look.bodies[it].label = "ball";
  const Illustrator depictor(made.cast, made.look, {side(), slant()}, made.extent, 16.0 / 9);
  const Picture picture = depictor.depict(made.now, {});
  std::vector<Text> found;
  for (const Text& text : picture.moving.texts)
    if (text.spans[0].text == "ball") found.push_back(text);
  ASSERT_EQ(found.size(), 2u);
  for (int panel = 0; panel < 2; ++panel) {
    const CameraProjection lens = depictor.lens(made.now, panel);
    const Point center = lens.page(made.now.bodies[it].position);
    EXPECT_NEAR(found[std::size_t(panel)].at.x(), center.x(), 1e-9);
    const double over =
        center.y() - 0.2 * lens.scale_at(made.now.bodies[it].position) - found[std::size_t(panel)].at.y();
    EXPECT_GT(over, 5);
    EXPECT_LT(over, 25);
  }
}

}  // namespace
}  // namespace obscura::draw

// Light in space: what looks away from it has tones too.

#include "draw/space/light.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "draw/picture/theme.h"

namespace obscura::draw {
namespace {

/// Two upright faces of a box that both look away from the light: 1.15:1 at least, 1.3:1 on the average, in
/// the light and in the shadow, for the colours that bodies take in turn, on paper and on the screen.
TEST(Light, FacesThatLookAwayFromItDiffer) {
  const Light sun = light({-0.6, 1, 0.42});
  double sum = 0;
  int looked = 0;
  for (const Theme theme : {Theme::paper, Theme::screen})
    for (int color = 0; color < 6; ++color)
      for (int k = 0; k < 72; ++k) {
        const double a = k * std::numbers::pi / 36;
        const sim::Vec3 n(std::cos(a), 0, std::sin(a)), m(-std::sin(a), 0, std::cos(a));
        if (n.dot(sun.toward) > 0 || m.dot(sun.toward) > 0) continue;
        const Shaded first = shade(turn(color), theme, sun, n), second = shade(turn(color), theme, sun, m);
        EXPECT_GT(contrast(first.lit, second.lit), 1.15) << color;
        EXPECT_GT(contrast(first.shaded, second.shaded), 1.15) << color;
        sum += contrast(first.lit, second.lit), ++looked;
      }
  ASSERT_GT(looked, 100);
  EXPECT_GT(sum / looked, 1.3);
}

/// What faces the light is brighter than anything else, and nothing is black.
TEST(Light, TheSunIsStronger) {
  const Light sun = light({-0.6, 1, 0.42});
  const Color own = *color("orange");
  const double bright = luminance(shade(own, Theme::paper, sun, sun.toward).lit);
  for (int k = 0; k < 24; ++k) {
    const double a = k * std::numbers::pi / 12;
    const Shaded side = shade(own, Theme::paper, sun, {std::cos(a), 0, std::sin(a)});
    EXPECT_GT(bright, luminance(side.lit));
    EXPECT_GT(luminance(side.shaded), 0.1);
  }
}

/// The side of a cone that looks away from the light is round, where it would have one tone.
TEST(Light, WhatIsRoundIsBrighterWhereItFacesTheEye) {
  const Light sun = light({-0.6, 1, 0.42});
  const sim::Vec3 eye(0, 0, 1), middle = sim::Vec3(0, -0.6, 0.8).normalized();
  for (int k = 0; k < 6; ++k) {
    for (const Theme theme : {Theme::paper, Theme::screen}) {
      const Shaded faces = shade_round(turn(k), theme, sun, middle, eye);
      for (const double side : {-0.95, 0.95}) {
        const sim::Vec3 rim = sim::Vec3(side, -0.3, 0.1).normalized();
        EXPECT_GT(contrast(faces.lit, shade_round(turn(k), theme, sun, rim, eye).lit), 1.3) << side;
      }
    }
  }
}

/// Edges are darker than what they bound, and lighter where they lie between faces on the dark.
TEST(Light, EdgesDifferFromTheirFaces) {
  for (int k = 0; k < 6; ++k) {
    const Color own = turn(k);
    for (const Theme theme : {Theme::paper, Theme::screen})
      EXPECT_LT(luminance(edge(own, theme)), luminance(own));
    EXPECT_LT(luminance(crease(own, Theme::paper)), luminance(own));
    EXPECT_GT(luminance(crease(own, Theme::screen)), luminance(own));
  }
}

/// A shadow on a face that looks up, a little away from the light: a third darker on the screen, where that
/// on the ground is dark, too, and a fifth on paper.
TEST(Light, AShadowOnABodyIsAsDeepAsTheThemeAsks) {
  const Light sun = light({-0.6, 1, 0.42});
  const sim::Vec3 normal = sim::Vec3(0.25, 0.9, -0.35).normalized();
  double screen = 0, paper = 0;
  for (int color = 0; color < 6; ++color) {
    const auto darker = [&](Theme theme) {
      const Shaded face = shade(turn(color), theme, sun, normal);
      const auto sum = [](Color c) { return c.r + c.g + c.b; };
      return 1 - double(sum(face.shaded)) / sum(face.lit);
    };
    screen += darker(Theme::screen) / 6, paper += darker(Theme::paper) / 6;
  }
  EXPECT_NEAR(screen, 0.33, 0.03);
  EXPECT_NEAR(paper, 0.2, 0.05);
}

}  // namespace
}  // namespace obscura::draw

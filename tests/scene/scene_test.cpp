#include "scene/scene.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "scene/keys.h"

namespace obscura::scene {
namespace {

// the README's first scene
constexpr const char* kTenLines = R"(title    = "A bouncing box"
duration = 20
[room]
size = [4, 3]
[[box]]
size       = [0.6, 0.4]
position   = [1, 2]
velocity   = [1.5, 0]
angle      = 20
elasticity = 0.8
[look]
trails = 1.0
)";

TEST(Scene, TenLinesAreAScene) {
  const Scene scene = parse(kTenLines, "a.toml");
  EXPECT_EQ(scene.look.title, "A bouncing box");
  EXPECT_EQ(scene.duration, (sim::Rational{20, 1}));
  ASSERT_EQ(scene.plane().model.bodies.size(), 1u);
  const sim::Body<2>& box = scene.plane().model.bodies[0];
  EXPECT_EQ(box.name, "box[0]");
  EXPECT_DOUBLE_EQ(box.mass, 0.24);
  EXPECT_DOUBLE_EQ(box.inertia[0], 0.24 * (0.36 + 0.16) / 12);
  EXPECT_DOUBLE_EQ(box.elasticity, 0.8);
  EXPECT_EQ(scene.plane().state.x[0], (sim::Vec<2>{1, 2}));
  EXPECT_EQ(scene.plane().state.v[0], (sim::Vec<2>{1.5, 0}));
  EXPECT_DOUBLE_EQ(scene.plane().state.turn[0][0], 20 * 3.14159265358979323846 / 180);
  EXPECT_EQ(scene.look.bodies[0].trail, 1.0);
  EXPECT_EQ(scene.plane().model.walls.size(), 4u);
  EXPECT_EQ(scene.plane().model.scale, 3);
}

TEST(Scene, TheNewOneIsAScene) { EXPECT_NO_THROW(parse(new_scene("my-room"), "my-room.toml")); }

}  // namespace
}  // namespace obscura::scene

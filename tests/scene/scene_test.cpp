#include "scene/scene.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>
#include <sstream>

#include "scene/keys.h"
#include "where.h"

namespace obscura::scene {
namespace {

// the blocks of TOML that a page of ours has
std::vector<std::string> shown_on(const std::string& page) {
  std::ostringstream all;
  all << std::ifstream(std::string(OBSCURA_SOURCE_DIR) + "/" + page).rdbuf();
  const std::string text = all.str(), begin = "\n```toml\n", end = "\n```\n";
  std::vector<std::string> blocks;
  for (std::size_t at = 0; (at = text.find(begin, at)) != text.npos;) {
    at += begin.size();
    blocks.push_back(text.substr(at, text.find(end, at) + 1 - at));
  }
  return blocks;
}

TEST(Scene, WhatThePagesShowAreScenes) {
  const std::vector<std::string> front = shown_on("README.md"), golden = shown_on("docs/golden.md");
  ASSERT_GE(front.size(), 2u);
  ASSERT_GE(golden.size(), 2u);
  for (const std::string& text : front) EXPECT_NO_THROW(parse(text, "README.md")) << text;
  for (const std::string& text : golden) EXPECT_NO_THROW(parse(text, "golden.md")) << text;
  // the others on its page are parts of scenes
  EXPECT_NO_THROW(parse(shown_on("docs/scene.md").at(0), "scene.md"));
}

TEST(Scene, TheReadmesFirstIsWhatItSays) {
  const Scene scene = parse(shown_on("README.md").at(0), "a.toml");
  EXPECT_EQ(scene.look.title, "A bouncing box");
  EXPECT_EQ(scene.duration, (sim::Rational{6, 1}));
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

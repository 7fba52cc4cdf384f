#include "scene/keys.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <sstream>

#include "scene/document.h"
#include "scene/scene.h"
#include "scene/table.h"
#include "where.h"

namespace obscura::scene {
namespace {

namespace fs = std::filesystem;

const fs::path kDocs = fs::path(OBSCURA_SOURCE_DIR) / "docs";

std::string text_of(const fs::path& file) {
  std::ostringstream all;
  all << std::ifstream(file).rdbuf();
  return all.str();
}

// UPDATE_DOCS=1 writes the page anew, and the test passes
void same_as(const fs::path& file, const std::string& made) {
  if (std::getenv("UPDATE_DOCS")) std::ofstream(file) << made;
  EXPECT_TRUE(text_of(file) == made)
      << file
      << " is not what the program writes today; UPDATE_DOCS=1 scene_tests, or obscura docs, writes it";
}

TEST(Keys, TheSchemaInDocsIsTheProgramsOwn) { same_as(kDocs / "scene.schema.json", json_schema()); }
TEST(Keys, ThePageInDocsIsTheProgramsOwn) { same_as(kDocs / "scene.md", keys_page()); }

TEST(Keys, TheSchemaIsJson) {
  const auto schema = nlohmann::json::parse(json_schema());
  EXPECT_EQ(schema["properties"]["box"]["items"]["properties"]["elasticity"]["default"], 0.8);
}

// each example of the table is a value of its own key: put into a scene, nobody complains of its type or
// range
TEST(Keys, EveryExampleIsOne) {
  for (const Key& each : keys()) {
    if (each.form == Form::table || each.form == Form::tables || each.form == Form::cameras) continue;
    ASSERT_FALSE(each.example.empty()) << each.path;
    ASSERT_FALSE(each.doc.empty()) << each.path;
    EXPECT_TRUE(each.required || !each.fallback.empty() || !each.absent.empty()) << each.path;
    const std::string owner(each.owner());
    const Key* its = key(owner);
    std::string scene;
    if (owner.empty()) {
      scene = each.path + " = " + each.example;
    } else if (owner.find('.') == std::string::npos) {
      scene = (its->form == Form::tables ? "[[" + owner + "]]\n" : "[" + owner + "]\n") +
              std::string(each.last()) + " = " + each.example;
    } else {
      continue;
    }
    try {
      parse(scene, "a.toml");
    } catch (const Error& error) {
      for (const Complaint& complaint : error.complaints) {
        EXPECT_THAT(complaint.message, testing::Not(testing::HasSubstr("expected " + expected(each))))
            << scene;
        EXPECT_THAT(complaint.message, testing::Not(testing::HasSubstr("unknown"))) << scene;
      }
    }
  }
}

TEST(Keys, WhatAPathNamesHasItsUnit) {
  EXPECT_EQ(unit_of("room.gravity.y"), key("room.gravity")->unit);
  EXPECT_EQ(unit_of("crate.velocity.x"), "m/s");
  EXPECT_EQ(unit_of("crate.mass"), "kg");
  EXPECT_EQ(unit_of("s.stiffness"), "N/m");
  EXPECT_EQ(unit_of("door.spring.stiffness"), "") << "of a hinge another than of a slider";
  EXPECT_EQ(unit_of("ball[3].position.y"), "m");
  for (const char* none : {"k", "x", "", "crate.warmth", "crate.friction"})
    EXPECT_EQ(unit_of(none), "") << none;
}

}  // namespace
}  // namespace obscura::scene

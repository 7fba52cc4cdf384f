// Text, files and builders say one thing: the same hash for every key, and the same bits of every shipped
// scene.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <functional>
#include <iterator>
#include <type_traits>

#include "obscura/obscura.h"
#include "scene/canonical.h"
#include "scene/document.h"
#include "scene/table.h"
#include "where.h"

namespace obscura {
namespace {

namespace fs = std::filesystem;
using testing::ElementsAre;
using testing::HasSubstr;

const fs::path kTop = OBSCURA_SOURCE_DIR;

std::string text_of(const fs::path& file) {
  std::ifstream in(file);
  return {std::istreambuf_iterator<char>(in), {}};
}

Value value_of(const scene::Node& node) {
  if (const auto* x = std::get_if<std::int64_t>(&node.value)) return *x;
  if (const auto* x = std::get_if<double>(&node.value)) return *x;
  if (const auto* x = std::get_if<bool>(&node.value)) return *x;
  if (node.is_text()) return node.text();
  if (node.is_list()) {
    Value::List list;
    for (const scene::Node& each : node.list()) list.push_back(value_of(each));
    return list;
  }
  Table table;
  for (const scene::Entry& each : node.table()) table.emplace_back(each.key, value_of(each.node));
  return table;
}

// the builder's keys of a text of TOML
Table table_of(const std::string& toml) { return std::get<Table>(value_of(scene::document(toml, "")).is); }

TEST(Builder, EveryKeyOfTheLanguageSaysTheSameAsInAFile) {
  int built = 0;
  for (const scene::Key& key : scene::keys()) {
    // of a table the example is its lines
    const bool lines = key.form == scene::Form::numbers || key.form == scene::Form::table;
    if (key.example.empty() || lines || key.form == scene::Form::tables) continue;
    // the key within its tables, as TOML writes them on one line
    std::string toml = std::string(key.last()) + " = " + key.example;
    for (std::string owner(key.owner()); !owner.empty();) {
      const scene::Key* its = scene::key(owner);
      ASSERT_TRUE(its) << key.path;
      const bool listed = its->form == scene::Form::tables;
      toml = std::string(its->last()) + " = " + (listed ? "[{ " : "{ ") + toml + (listed ? " }]" : " }");
      owner = std::string(its->owner());
    }
    Builder builder(table_of(toml));
    EXPECT_EQ(scene::canonical({builder.text(), {}}), scene::canonical({"# a comment\n" + toml + "\n", {}}))
        << toml;
    // what is a scene by itself has one hash and one state
    try {
      const Scene there = Scene::parse(toml);
      const Scene here = builder.build();
      EXPECT_EQ(here.hash(), there.hash()) << toml;
      EXPECT_EQ(World(here).hash(), World(there).hash()) << toml;
      ++built;
    } catch (const SceneError&) {
    }
  }
  EXPECT_GT(built, 100);
}

TEST(Builder, EveryShippedSceneIsTheSameToTheBit) {
  int seen = 0;
  for (const auto& entry : fs::directory_iterator(kTop / "scenes")) {
    if (entry.path().extension() != ".toml") continue;
    const std::string text = text_of(entry.path());
    const Scene there = Scene::parse(text, entry.path().string());
    const Scene here = Builder(table_of(text)).build(entry.path().string());
    EXPECT_EQ(here.hash(), there.hash()) << entry.path();
    EXPECT_EQ(Builder(there.keys()).build().hash(), there.hash()) << entry.path();
    World a(there), b(here);
    a.step(5), b.step(5);
    EXPECT_EQ(a.hash(), b.hash()) << entry.path();
    ++seen;
  }
  EXPECT_GT(seen, 20);
}

TEST(Builder, AHashDoesNotAskForLayoutButForValues) {
  const std::string text =
      "duration = 2\n[room]\nsize = [4, 2.25]\n[[ball]]\nradius = 0.5\nposition = [2.0, 1]\n";
  const Scene scene = Scene::parse(text);
  EXPECT_EQ(
      Scene::parse(
          "# twice\nball = [{ position = [2, 1.0], radius = 0.5 }]\nroom.size = [4, 2.25]\nduration = 2.0\n")
          .hash(),
      scene.hash());
  EXPECT_EQ(Scene::parse("duration = 3\n" + text.substr(13), "a.toml", {"duration=2"}).hash(), scene.hash());
  EXPECT_EQ(scene.with("duration", 3).with("duration", 2).hash(), scene.hash());
  EXPECT_NE(scene.with("duration", 3).hash(), scene.hash());
  EXPECT_NE(scene.with("ball[0].radius", 0.25).hash(), scene.hash());
}

TEST(Builder, AnUnknownKeyIsRefusedWhereItIsGiven) {
  Builder builder;
  try {
    builder.set("room.siez", {4, 2});
    FAIL();
  } catch (const SceneError& error) {
    ASSERT_EQ(error.faults.size(), 1u);
    EXPECT_EQ(error.faults[0].key, "room.siez");
    EXPECT_THAT(error.faults[0].message, HasSubstr("did you mean 'size'?"));
  }
  EXPECT_THROW(builder.add("bal", {{"radius", 1}}), SceneError);
  EXPECT_THROW(builder.add("ball", {{"radios", 1}}), SceneError);
  EXPECT_THROW(builder.add("ball", {{"copies", Table{{"coutn", 3}}}}), SceneError);
  EXPECT_TRUE(builder.keys().empty() || builder.text().empty());
}

TEST(Builder, AKeyThatIsGivenTwiceIsRefusedByItsName) {
  // its message named a line of a text that does not exist
  for (const auto& twice :
       std::vector<std::function<void()>>{[] {
                                            Builder(Table{{"room", Table{{"drag", 1}, {"drag", 2}}}});
                                          },
                                          [] {
                                            Builder().add("room", {{"drag", 1}, {"drag", 2}});
                                          }})
    try {
      twice();
      FAIL();
    } catch (const SceneError& error) {
      EXPECT_EQ(error.faults[0].key, "room.drag");
      EXPECT_EQ(error.faults[0].message, "'drag' is given twice");
    }
}

TEST(Builder, AWrongValueIsAFaultOfItsKey) {
  Builder builder;
  builder.set("room.size", {4, 2.25});
  builder.add("ball", {{"radius", 0.2}, {"position", {1, 1}}});
  builder.add("ball", {{"radius", -0.2}, {"position", {2, 1}}});
  try {
    builder.build("two");
    FAIL();
  } catch (const SceneError& error) {
    ASSERT_EQ(error.faults.size(), 1u);
    EXPECT_EQ(error.faults[0].key, "ball[1].radius");
    EXPECT_THAT(error.what(), testing::StartsWith("two: ball[1].radius: "));
  }
}

TEST(Builder, AFaultNamesOtherPlacesByTheirKeys) {
  Builder builder;
  builder.set("room.size", {4, 2.25});
  builder.add("ball", {{"name", "ball"}, {"radius", 0.2}, {"position", {1, 1}}});
  builder.add("ball", {{"radius", 0.2}, {"position", {9, 1}}});
  try {
    builder.build("two");
    FAIL();
  } catch (const SceneError& error) {
    EXPECT_THAT(error.what(), testing::HasSubstr("ball[0].name"));
    EXPECT_THAT(error.what(), testing::HasSubstr("room.size"));
    EXPECT_THAT(error.what(), testing::Not(testing::ContainsRegex("two:[0-9]")));
  }
}

TEST(Builder, APointerIsNoTruth) {
  static_assert(!std::is_constructible_v<Value, const int*> &&
                !std::is_constructible_v<Value, const char8_t*>);
  static_assert(std::is_constructible_v<Value, char*> && std::is_constructible_v<Value, const char(&)[2]>);
  EXPECT_EQ(Value("a"), Value(std::string("a")));
}

TEST(Scene, WithTakesAKeyAlone) {
  const Scene scene = Scene::parse("[room]\nsize = [4, 2.25]\n");
  EXPECT_EQ(scene.with("title", "x").with("title", "y").hash(), scene.with("title", "y").hash());
  // it was read as the title 3="x"
  EXPECT_THROW(scene.with("title=3", "x"), UsageError);
}

TEST(Builder, TextComesThroughWhateverStandsInIt) {
  const std::string title = "quote \" back \\ tab \t umlaut \xc3\xa4";
  Builder builder;
  builder.set("title", title).set("room.size", {4, 2.25});
  const auto keys = table_of(builder.text());
  EXPECT_EQ(std::get<std::string>(keys[0].second.is), title);
}

TEST(Scene, AFaultOfATextHasItsLineAndColumn) {
  try {
    Scene::parse("[room]\nsize = [4, 2.25]\n[[ball]]\nradius = -1\n", "a.toml");
    FAIL();
  } catch (const SceneError& error) {
    EXPECT_EQ(error.faults[0].file, "a.toml");
    EXPECT_EQ(error.faults[0].line, 4);
    EXPECT_EQ(error.faults[0].column, 10);
    EXPECT_TRUE(error.faults[0].key.empty());
  }
  EXPECT_THROW(Scene::read("/none.toml"), SceneError);
}

}  // namespace
}  // namespace obscura

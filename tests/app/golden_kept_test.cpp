// obscura golden: references that cannot be read, hashes instead of pictures, and other engines' runs.

#include <fstream>

#include <gmock/gmock.h>

#include "program.h"

namespace obscura::app {
namespace {

using testing::HasSubstr;
using testing::Not;

const char* const kKeptScene = R"(duration = 2
[room]
size = [4, 2.25]
[[ball]]
name = "ball"
radius = 0.2
position = [1, 1]
velocity = [1, 1]
color = "green"
[golden]
at = [0, 0.5]
size = [160, 90]
)";

class GoldenKept : public Program {
 protected:
  void SetUp() override {
    Program::SetUp();
    scene(kKeptScene);
  }
  Outcome golden(const std::string& arguments = "") const {
    return obscura("golden scene.toml " + arguments);
  }
  void change(const std::string& from, const std::string& to) const {
    std::string text = kKeptScene;
    text.replace(text.find(from), from.size(), to);
    scene(text);
  }
};

TEST_F(GoldenKept, AReferenceThatCannotBeReadFailsItsMomentAloneAndIsReplaced) {
  ASSERT_EQ(golden("--update").exit, 0);
  std::ofstream(path("golden/scene-0.png"), std::ios::trunc)
      << "version https://git-lfs.github.com/spec/v1\noid sha256:4d7a2\nsize 12345\n";
  const std::string whole = contents(path("golden/scene-0.5.png"));
  Outcome run = golden("--junit out.xml");
  EXPECT_EQ(run.exit, 4);
  EXPECT_THAT(run.out, HasSubstr("2 moments, 1 same, 1 unreadable"));
  EXPECT_THAT(run.out,
              HasSubstr("t = 0 s: golden/scene-0.png: not a readable PNG: it is a pointer of git-LFS"));
  EXPECT_THAT(run.out, HasSubstr("`git lfs pull`"));
  EXPECT_THAT(run.out, HasSubstr("render_out/golden/scene-0.png is what there is now; --update takes it"));
  EXPECT_THAT(contents(path("out.xml")), HasSubstr("failures=\"1\" errors=\"0\""));
  std::ofstream(path("golden/scene-0.5.png"), std::ios::trunc) << whole.substr(0, whole.size() / 2);
  EXPECT_THAT(golden().out, HasSubstr("2 moments, 2 unreadable"));
  EXPECT_EQ(golden("--update").exit, 0);
  EXPECT_EQ(golden().exit, 0);
}

TEST_F(GoldenKept, AnUnreadableReferenceOfNoMomentFailsNothing) {
  ASSERT_EQ(golden("--update").exit, 0);
  scene("cut", "golden/scene-7.png");
  scene("of another scene", "golden/scene-tall-7.png");
  const Outcome run = golden();
  EXPECT_EQ(run.exit, 0) << run.out;
  EXPECT_THAT(run.out, HasSubstr("golden/scene-7.png: not a readable PNG"));
  EXPECT_THAT(run.out, HasSubstr("it is no moment of the scene any more"));
  EXPECT_THAT(run.out, Not(HasSubstr("scene-tall")));
}

// What git keeps of two moments is a few hundred bytes, and tells the same.
TEST_F(GoldenKept, OfASceneThatKeepsHashesPicturesStayOutsideGit) {
  change("at = [0, 0.5]", "keep = \"hash\"\nat = [0, 0.5]");
  Outcome run = golden();
  EXPECT_EQ(run.exit, 1);
  EXPECT_THAT(run.out, HasSubstr("golden/scene.json: there is no such reference"));
  ASSERT_EQ(golden("--update").exit, 0);
  EXPECT_LT(contents(path("golden/scene.json")).size(), 200u);
  EXPECT_EQ(contents(path("golden/pictures/.gitignore")), "*\n");
  EXPECT_TRUE(std::filesystem::exists(path("golden/pictures/scene-0.5.png")));
  EXPECT_FALSE(std::filesystem::exists(path("golden/scene-0.5.png")));
  run = golden();
  EXPECT_EQ(run.exit, 0) << run.out;
  EXPECT_THAT(run.out, HasSubstr("2 moments, 2 same"));
  // the same bytes for the same scene
  const std::string first = contents(path("golden/scene.json"));
  std::filesystem::remove_all(path("golden"));
  ASSERT_EQ(golden("--update").exit, 0);
  EXPECT_EQ(contents(path("golden/scene.json")), first);
}

TEST_F(GoldenKept, ByAHashADifferenceIsSeenAndWithThePictureAtHandMeasured) {
  const auto purple = [&] {
    std::string text = kKeptScene;
    text.replace(text.find("\"green\""), 7, "\"purple\"");
    text.replace(text.find("at = [0"), 0, "keep = \"hash\"\n");
    scene(text);
  };
  change("at = [0, 0.5]", "keep = \"hash\"\nat = [0, 0.5]");
  ASSERT_EQ(golden("--update").exit, 0);
  purple();
  Outcome run = golden();
  EXPECT_EQ(run.exit, 1);
  EXPECT_THAT(run.out, HasSubstr("ball.color is \"green\" and \"purple\""));
  EXPECT_TRUE(std::filesystem::exists(path("render_out/golden/scene-0.difference.png")));
  // a fresh clone has no pictures
  std::filesystem::remove_all(path("golden/pictures"));
  run = golden();
  EXPECT_EQ(run.exit, 1);
  EXPECT_THAT(
      run.out,
      HasSubstr("the picture is another one; by how much is not known: that of the reference is not at "
                "golden/pictures/scene-0.png, outside git"));
  EXPECT_THAT(run.out, HasSubstr("the scene's text is another one than the reference's"));
  // a moment that is the same leaves its picture there for the next difference
  change("at = [0, 0.5]", "keep = \"hash\"\nat = [0, 0.5]");
  ASSERT_EQ(golden().exit, 0);
  purple();
  EXPECT_THAT(golden().out, HasSubstr("pixels differ by up to"));
  // a picture that is not the one of the hash is none
  ASSERT_EQ(obscura("render scene.toml --at 0 --size 160x90 -o golden/pictures/scene-0.png").exit, 0);
  EXPECT_THAT(golden().out, HasSubstr("by how much is not known"));
  EXPECT_EQ(golden("--update").exit, 0);
  EXPECT_EQ(golden().exit, 0);
}

TEST_F(GoldenKept, OfHashesOnlyTheMomentThatIsNamedIsTaken) {
  change("at = [0, 0.5]", "keep = \"hash\"\nat = [0, 0.5]");
  ASSERT_EQ(golden("--update").exit, 0);
  std::string text = kKeptScene;
  text.replace(text.find("\"green\""), 7, "\"purple\"");
  text.replace(text.find("at = [0"), 0, "keep = \"hash\"\n");
  scene(text);
  ASSERT_EQ(golden("--update --only scene@0.5").exit, 0);
  const Outcome run = golden();
  EXPECT_EQ(run.exit, 1);
  EXPECT_THAT(run.out, HasSubstr("1 differs, 1 same"));
}

TEST_F(GoldenKept, ByAHashAStateThatDoesNotShowFailsAllTheSame) {
  change("at = [0, 0.5]", "keep = \"hash\"\nat = [0, 0.5]");
  ASSERT_EQ(golden("--update").exit, 0);
  std::filesystem::remove_all(path("golden/pictures"));
  std::string text = kKeptScene;
  text.replace(text.find("[1, 1]\ncolor"), 6, "[1.0000000000000002, 1]");
  text.replace(text.find("at = [0"), 0, "keep = \"hash\"\n");
  scene(text);
  const Outcome run = golden();
  EXPECT_EQ(run.exit, 1);
  EXPECT_THAT(run.out, HasSubstr("the state is another one, though the picture is the same"));
}

// A key that was set is the cause, and a picture made with it is none of the record's.
TEST_F(GoldenKept, ByAHashAKeyThatWasSetIsNamedAndLeavesNoPicture) {
  change("at = [0, 0.5]", "keep = \"hash\"\nat = [0, 0.5]");
  ASSERT_EQ(golden("--update").exit, 0);
  std::filesystem::remove_all(path("golden/pictures"));
  const Outcome run = golden("--set 'room.gravity=[0,-1]'");
  EXPECT_EQ(run.exit, 1);
  EXPECT_THAT(run.out, HasSubstr("other scene: that of the reference with --set room.gravity=[0,-1]"));
  EXPECT_THAT(run.out, Not(HasSubstr("of the same scene")));
  EXPECT_THAT(run.out, HasSubstr("t = 0 s: state and picture are the same with --set room.gravity=[0,-1]"));
  EXPECT_FALSE(std::filesystem::exists(path("golden/pictures")));
  ASSERT_EQ(golden().exit, 0);
  EXPECT_TRUE(std::filesystem::exists(path("golden/pictures/scene-0.png")));
}

// The verdict does not need the pictures of it.
TEST_F(GoldenKept, WhereItsPicturesCannotBeWrittenTheDifferenceIsTold) {
  ASSERT_EQ(golden("--update").exit, 0);
  change("\"green\"", "\"purple\"");
  scene("no folder", "render_out");
  const Outcome run = golden();
  EXPECT_EQ(run.exit, 4);
  EXPECT_THAT(run.out, HasSubstr("pixels differ by up to"));
  EXPECT_THAT(run.out, HasSubstr("ball.color is \"green\" and \"purple\""));
  EXPECT_THAT(run.out, HasSubstr("render_out/golden"));
  EXPECT_THAT(run.out, HasSubstr("1 scene, 2 moments, 2 differs"));
}

TEST_F(GoldenKept, ARecordThatCannotBeReadSaysSoAndIsReplaced) {
  change("at = [0, 0.5]", "keep = \"hash\"\nat = [0, 0.5]");
  ASSERT_EQ(golden("--update").exit, 0);
  const std::string whole = contents(path("golden/scene.json"));
  for (const std::string& damaged :
       {whole.substr(0, 100), std::string(7, '<') + " HEAD\n" + whole, std::string("[]"),
        std::string("{\"0\": 1}"), std::string("{\"0\": \"word\"}"), std::string("{\"scene\": 3}"),
        std::string()}) {
    scene(damaged, "golden/scene.json");
    const Outcome run = golden();
    EXPECT_EQ(run.exit, 4) << damaged;
    EXPECT_THAT(run.out, HasSubstr("golden/scene.json: is no record of states and pictures"));
    EXPECT_THAT(run.out, HasSubstr("2 moments, 2 unreadable"));
  }
  scene("version https://git-lfs.github.com/spec/v1\n", "golden/scene.json");
  EXPECT_THAT(golden().out, HasSubstr("`git lfs pull`"));
  EXPECT_EQ(golden("--update").exit, 0);
  EXPECT_EQ(contents(path("golden/scene.json")), whole);
}

TEST_F(GoldenKept, FromPicturesToHashesAndBackLeavesNothingBehind) {
  const auto files = [&] { return shell("cd golden && ls").out; };
  ASSERT_EQ(golden("--update").exit, 0);
  change("at = [0, 0.5]", "keep = \"hash\"\nat = [0, 0.5]");
  ASSERT_EQ(golden("--update").exit, 0);
  EXPECT_EQ(files(), "pictures\nscene.json\n");
  change("at = [0, 0.5]", "keep = \"hash\"\nat = [0]");
  EXPECT_THAT(golden().out, HasSubstr("golden/scene.json: t = 0.5 s is no moment of the scene any more"));
  ASSERT_EQ(golden("--update").exit, 0);
  EXPECT_THAT(contents(path("golden/scene.json")), Not(HasSubstr("0.5")));
  scene(kKeptScene);
  EXPECT_THAT(golden().out, HasSubstr("golden/scene.json is not needed; --update removes it"));
  ASSERT_EQ(golden("--update").exit, 0);
  EXPECT_EQ(files(), "pictures\nscene-0.5.png\nscene-0.png\n");
}

// Another engine's run is shown, and held, as the simulation is.
class GoldenOfARun : public GoldenKept {
 protected:
  void SetUp() override {
    GoldenKept::SetUp();
    write(1);
  }
  /// A table of a ball that goes to the right, in which one number of the last row may be another one.
  void write(double last) const {
    std::ofstream table(path("run.csv"));
    table << "time,ball.position.x,ball.position.y,ball.angle,ball.velocity.x,ball.velocity.y,ball.spin\n"
          << "0,1,1,0,1,0,0\n0.25,1.25,1,0,1,0,0\n0.5,1.5,1,0," << last << ",0,0\n";
  }
};

TEST_F(GoldenOfARun, IsHeldWithoutSimulatingIt) {
  ASSERT_EQ(golden("--states run.csv --update").exit, 0);
  Outcome run = golden("--states run.csv");
  EXPECT_EQ(run.exit, 0) << run.out;
  ASSERT_EQ(obscura("render scene.toml --at 0.5 --size 160x90 --states run.csv -o still.png").exit, 0);
  EXPECT_EQ(obscura("compare still.png golden/scene-0.5.png").exit, 0);
  // the scene's own run is another one
  run = golden();
  EXPECT_EQ(run.exit, 1);
  EXPECT_THAT(run.out, HasSubstr("A shows run.csv, another program's run, B the simulation"));
  // so is one of another number, if no pixel shows it
  write(1.5);
  run = golden("--states run.csv");
  EXPECT_EQ(run.exit, 1);
  EXPECT_THAT(run.out, HasSubstr("the state is another one, though the picture is the same"));
  EXPECT_THAT(run.out, HasSubstr("run.csv, another program's run has other numbers there"));
  EXPECT_THAT(run.out, HasSubstr("1 differs, 1 same"));
}

TEST_F(GoldenOfARun, MayBeNamedByTheSceneAndLiesBesideIt) {
  std::filesystem::create_directories(path("deep/runs"));
  std::filesystem::rename(path("run.csv"), path("deep/runs/run.csv"));
  std::string text = kKeptScene;
  text.replace(text.find("at = [0"), 0, "states = \"runs/run.csv\"\nkeep = \"hash\"\n");
  scene(text, "deep/scene.toml");
  ASSERT_EQ(obscura("golden deep --update").exit, 0);
  const Outcome run = obscura("golden deep");
  EXPECT_EQ(run.exit, 0) << run.out;
  EXPECT_THAT(run.out, HasSubstr("2 moments, 2 same"));
}

TEST_F(GoldenOfARun, WhatLetsItsPixelsPassLetsItsStatesPass) {
  ASSERT_EQ(golden("--states run.csv --update").exit, 0);
  write(1.5);
  change("size = [160, 90]", "size = [160, 90]\nlevel = 1\nreason = \"its last bits are the processor's\"");
  const Outcome run = golden("--states run.csv");
  EXPECT_EQ(run.exit, 0) << run.out;
  EXPECT_THAT(run.out, HasSubstr("tolerated: its last bits are the processor's"));
}

TEST_F(GoldenOfARun, SaysWhatIsNotThere) {
  Outcome run = golden("--states none.csv");
  EXPECT_EQ(run.exit, 4);
  EXPECT_THAT(run.out, HasSubstr("none.csv: cannot be read"));
  change("[0, 0.5]", "[0, 0.4]");
  run = golden("--states run.csv");
  EXPECT_EQ(run.exit, 4);
  EXPECT_THAT(run.out,
              HasSubstr("run.csv: has no row at t = 0.4 s, a moment of scene's [golden]; the nearest are at "
                        "0.25 s and 0.5 s"));
  scene(kKeptScene, "other.toml");
  run = obscura("golden scene.toml other.toml --states run.csv");
  EXPECT_EQ(run.exit, 2);
  EXPECT_THAT(run.err, HasSubstr("--states run.csv is one scene's run, and there are 2"));
}

}  // namespace
}  // namespace obscura::app

// obscura compare and verify of films: when their frames are shown, which folders' pictures belong together,
// and whether a film is one of the scene as it is today.

#include <gmock/gmock.h>
#include <nlohmann/json.hpp>

#include "needs.h"
#include "program.h"
#include "where.h"

namespace obscura::app {
namespace {

using testing::HasSubstr;
using testing::Not;

class FilmsCompared : public Program {
 protected:
  void SetUp() override {
    Program::SetUp();
    scene(kCrateAndBall + kFilm);
  }
  void film(const std::string& out, const std::string& flags = "") const {
    const Outcome made = obscura("render scene.toml -o " + out + " " + flags);
    ASSERT_EQ(made.exit, 0) << made.err;
  }
  // the scene with another [film], or another word anywhere
  void change(const std::string& from, const std::string& to) const {
    std::string text = kCrateAndBall + kFilm;
    text.replace(text.find(from), from.size(), to);
    scene(text, "today.toml");
  }
  Outcome verified(const std::string& file) const {
    return obscura("verify " + file + " --scene today.toml");
  }

  const std::string kFilm = "[film]\nsize = [160, 90]\nfps = 10\n";
};

TEST_F(FilmsCompared, AnotherFrameRateIsTheCauseAndNotThePixels) {
  film("a.mp4");
  film("b.mp4", "--fps 5");
  const Outcome run = obscura("compare a.mp4 b.mp4");
  EXPECT_EQ(run.exit, 1);
  EXPECT_THAT(run.out, HasSubstr("frame 1 is at 0.1 s in a.mp4 and at 0.2 s in b.mp4"));
  EXPECT_THAT(run.out, HasSubstr("cause: other frame rate: 10 and 5"));
  EXPECT_THAT(run.out, Not(HasSubstr("pixels only")));
}

TEST_F(FilmsCompared, AnotherSpeedShowsOtherInstantsOfOneRun) {
  film("a.mp4");
  film("b.mp4", "--set film.speed=0.5");
  const Outcome run = obscura("compare a.mp4 b.mp4");
  EXPECT_THAT(run.out, HasSubstr("film.speed is left out and 0.5"));
  EXPECT_THAT(run.out, HasSubstr("frames show other instants: frame 1 t = 0.1 s and t = 0.05 s"));
  EXPECT_THAT(run.out, HasSubstr("at one instant states are the same"));
  EXPECT_THAT(run.out, Not(HasSubstr("only the drawing differs")));
  film("c.mp4", "--set film.speed=0.5 --set crate.mass=3");
  EXPECT_THAT(obscura("compare a.mp4 c.mp4").out, HasSubstr("states part at step"));
}

TEST_F(FilmsCompared, TheSamePixelsAtHalfTheSpeedAreAnotherFilm) {
  OBSCURA_NEEDS(installed("ffmpeg"), "ffmpeg");
  film("a.mp4");
  ASSERT_EQ(shell("ffmpeg -v error -itsscale 2 -i a.mp4 -c copy -movflags use_metadata_tags slow.mp4").exit,
            0);
  Outcome run = obscura("compare a.mp4 slow.mp4");
  EXPECT_EQ(run.exit, 1);
  EXPECT_THAT(run.out, HasSubstr("a.mp4 and slow.mp4 differ; the pixels of 10 frames are the same"));
  EXPECT_THAT(run.out, HasSubstr("frame 1 is at 0.1 s in a.mp4 and at 0.2 s in slow.mp4"));
  run = obscura("verify slow.mp4");
  EXPECT_EQ(run.exit, 1) << run.out;
  EXPECT_THAT(run.out, HasSubstr("frame 1 is at 0.2 s"));
  // a file that is only packed otherwise, and rounds times otherwise, is the same film
  ASSERT_EQ(shell("ffmpeg -v error -i a.mp4 -c copy a.mkv").exit, 0);
  run = obscura("compare a.mp4 a.mkv");
  EXPECT_EQ(run.exit, 0) << run.out;
}

TEST_F(FilmsCompared, FoldersWithThoseInThem) {
  film("one.png", "--at 0.5"), film("two.png", "--at 0.9");
  ASSERT_EQ(
      shell("mkdir -p a/sub b/sub && cp one.png a/0.png && cp one.png b/0.png && cp one.png a/sub/k.png && "
            "cp two.png b/sub/k.png")
          .exit,
      0);
  Outcome run = obscura("compare a b");
  EXPECT_EQ(run.exit, 1);
  EXPECT_THAT(run.out, HasSubstr("a and b differ in 1 of 2 frames"));
  EXPECT_THAT(run.out, HasSubstr("sub/k.png"));
  std::filesystem::remove(path("b/sub/k.png"));
  run = obscura("compare a b");
  EXPECT_EQ(run.exit, 1);
  EXPECT_THAT(run.out, HasSubstr("only a has sub/k.png"));
  // what is compared is not written over there either
  run = obscura("compare a b --diff a/sub/k.png");
  EXPECT_EQ(run.exit, 2);
  EXPECT_THAT(run.err, HasSubstr("which is compared"));
}

TEST_F(FilmsCompared, FoldersWithoutANameInCommonArePairedByOrderAndThatIsSaid) {
  film("one.png", "--at 0.5"), film("two.png", "--at 0.9");
  ASSERT_EQ(
      shell(
          "mkdir a b && cp one.png a/a.png && cp two.png a/b.png && cp one.png b/c.png && cp two.png b/d.png")
          .exit,
      0);
  Outcome run = obscura("compare a b");
  EXPECT_EQ(run.exit, 0);
  EXPECT_THAT(run.out, HasSubstr("the folders have no name of a file in common"));
  ASSERT_EQ(shell("cp one.png b/d.png").exit, 0);
  run = obscura("compare a b");
  EXPECT_EQ(run.exit, 1);
  EXPECT_THAT(run.out, HasSubstr("the folders have no name of a file in common"));
  EXPECT_THAT(run.out, HasSubstr("b.png and d.png"));
  const auto json = nlohmann::json::parse(obscura("compare a b --format json").out);
  EXPECT_EQ(json["by_order"], true);
}

TEST_F(FilmsCompared, AFilmIsNoLongerTrueOfASceneThatIsFilmedOtherwise) {
  film("f.mp4");
  change("duration = 1", "duration = 1.0");
  EXPECT_EQ(verified("f.mp4").exit, 0);
  for (const auto& [from, to, told] :
       {std::tuple("fps = 10", "fps = 5", "frame rate: 10, and now 5"),
        {"size = [160, 90]", "size = [320, 180]", "size: 160x90, and now 320x180"},
        {"duration = 1", "duration = 2", "frames: 10, and now 20"},
        {"duration = 1", "duration = 0.5", "frames: 10, and now 5"},
        {"fps = 10", "fps = 10\nspeed = 0.5", "frame 1: t = 0.1 s, and now t = 0.05 s"},
        {"fps = 10", "fps = 10\ncrf = 45", "of 10 frames differ"}}) {
    change(from, to);
    const Outcome run = verified("f.mp4");
    EXPECT_EQ(run.exit, 1) << to;
    EXPECT_THAT(run.out, HasSubstr("f.mp4: no longer true")) << to;
    EXPECT_THAT(run.out, HasSubstr(told)) << to;
    EXPECT_THAT(run.out, HasSubstr("other scene (scene.toml): ")) << to;
    EXPECT_THAT(run.out, Not(HasSubstr("--frames"))) << to;
  }
  // what shows in no state is left out where nothing is drawn
  change("size = [160, 90]", "size = [320, 180]");
  EXPECT_EQ(obscura("verify f.mp4 --states --scene today.toml").exit, 0);
  film("f.png", "--at 0.5");
  EXPECT_EQ(verified("f.png").exit, 1);
}

// A flag is given again: it stands over what the scene says, now as then.
TEST_F(FilmsCompared, WhatAFlagSaidOfAFilmStaysSo) {
  film("f.mp4", "--fps 5 --size 96x54 --crf 30 --to 0.6");
  change("size = [160, 90]\nfps = 10", "size = [320, 180]\nfps = 20\ncrf = 45");
  const Outcome run = verified("f.mp4");
  EXPECT_EQ(run.exit, 0) << run.out;
  change("duration = 1", "duration = 0.4");
  EXPECT_THAT(verified("f.mp4").out, HasSubstr("its frames 0..2: the film has frames 0 to 1"));
}

TEST_F(FilmsCompared, AFilmWithKeysThatWereSetSaysSo) {
  film("f.mp4", "--set crate.mass=2 --set seed=3");
  scene(contents(path("scene.toml")), "today.toml");
  const Outcome run = verified("f.mp4");
  EXPECT_EQ(run.exit, 0) << run.out;
  EXPECT_THAT(run.out, HasSubstr("of the scene with --set crate.mass=2 --set seed=3, as it was made"));
  EXPECT_THAT(obscura("verify f.mp4").out, Not(HasSubstr("--set")));
}

}  // namespace
}  // namespace obscura::app

// obscura compare and verify: what differs, and why.

#include <cmath>
#include <cstdlib>

#include <gmock/gmock.h>
#include <nlohmann/json.hpp>

#include "needs.h"
#include "program.h"
#include "where.h"

namespace obscura::app {
namespace {

using testing::HasSubstr;
using testing::Not;
using Json = nlohmann::json;

/// One short scene, filmed in many ways.
class Compare : public Program {
 protected:
  void SetUp() override {
    Program::SetUp();
    scene(text_);
  }
  // a still at 0.5 s, 160x90
  std::string still(const std::string& name, const std::string& flags = "", const std::string& env = "") {
    const Outcome run = shell(env + " " + OBSCURA_BINARY + " render scene.toml --at 0.5 --size 160x90 -o " +
                              name + " " + flags);
    EXPECT_EQ(run.exit, 0) << run.err;
    return name;
  }
  Json compared(const std::string& arguments, int exit) {
    const Outcome run = obscura("compare --format json " + arguments);
    EXPECT_EQ(run.exit, exit) << run.out << run.err;
    return Json::parse(run.out, nullptr, false);
  }

  const std::string text_ = kCrateAndBall;
};

TEST_F(Compare, TheSameBytesAreTheSameWithoutAnotherLook) {
  still("a.png");
  const Json json = compared("a.png a.png", 0);
  EXPECT_EQ(json["same_bytes"], true);
}

TEST_F(Compare, AMassByOneUnitInTheLastPlaceIsNamedWhetherItShowsOrNot) {
  still("a.png");
  still("b.png", "--set crate.mass=1.5000000000000002");
  const Outcome run = obscura("compare a.png b.png");
  EXPECT_THAT(run.out, HasSubstr("other scene"));
  EXPECT_THAT(run.out, HasSubstr("crate.mass is 1.5 and 1.5000000000000002"));
  EXPECT_THAT(run.out, HasSubstr("states part at step"));
  EXPECT_THAT(run.out, HasSubstr("body crate, "));
}

TEST_F(Compare, ALargerMassPartsTheStatesAtAStepABodyAndAQuantity) {
  still("a.png");
  still("b.png", "--set crate.mass=3");
  const Json json = compared("a.png b.png", 1);
  EXPECT_EQ(json["cause"]["kind"], "scene");
  const Json& states = json["cause"]["states"];
  EXPECT_EQ(states["body"], "crate");
  EXPECT_THAT(states["quantity"].get<std::string>(), HasSubstr("velocity"));
  // the state before that step is the same, and that at it is not
  const int step = states["step"];
  ASSERT_GE(step, 1);
  for (const int at : {step - 1, step}) {
    const std::string when = " --at " + std::to_string(at) + "/600";
    const auto hash = [&](const std::string& flags) {
      return std::string(Json::parse(obscura("states scene.toml" + when + flags).out)["states"][0]["hash"]);
    };
    EXPECT_EQ(hash("") == hash(" --set crate.mass=3"), at < step) << at;
  }
}

TEST_F(Compare, AColourAndACameraAreNamedAndTheStatesAreInnocent) {
  still("a.png");
  still("b.png", "--set crate.color=purple");
  still("c.png", "--set camera.width=3");
  Outcome run = obscura("compare a.png b.png");
  EXPECT_EQ(run.exit, 1);
  EXPECT_THAT(run.out, HasSubstr("crate.color is \"green\" and \"purple\""));
  EXPECT_THAT(run.out, HasSubstr("states are the same"));
  run = obscura("compare a.png c.png");
  EXPECT_THAT(run.out, HasSubstr("camera.width is left out and 3"));
  EXPECT_THAT(run.out, HasSubstr("states are the same"));
  still("d.png", "--theme screen");
  EXPECT_THAT(obscura("compare a.png d.png").out, HasSubstr("cause: other theme: paper and screen"));
}

TEST_F(Compare, AnotherBackEndAndOtherNumbersOfThreadsGiveTheSamePixels) {
  still("a.png");
  for (const char* threads : {"0", "1", "3", "8"}) {
    still("b.png", "", std::string("LP_NUM_THREADS=") + threads);
    EXPECT_EQ(compared("a.png b.png", 0)["same_bytes"], true) << threads;
  }
  const Outcome egl = obscura("render scene.toml --at 0.5 --size 160x90 -o egl.png --backend egl");
  const Outcome osmesa = obscura("render scene.toml --at 0.5 --size 160x90 -o osmesa.png --backend osmesa");
  OBSCURA_NEEDS(egl.exit == 0 && osmesa.exit == 0, "libosmesa6, libegl1 and libegl-mesa0");
  const Outcome run = obscura("compare osmesa.png egl.png");
  EXPECT_EQ(run.exit, 0) << run.out;
  EXPECT_THAT(run.out, HasSubstr("other OpenGL"));
}

TEST_F(Compare, AllOfAProcessorsInstructionsAreNamedWhetherTheyShowOrNot) {
  still("a.png");
  still("b.png", "--native");
  const Outcome run = obscura("compare a.png b.png");
  EXPECT_THAT(run.out, HasSubstr("--native"));
  if (run.exit == 1) {
    EXPECT_THAT(run.out, HasSubstr("cause: one was drawn with all"));
  }
}

TEST_F(Compare, OtherSizesAPixelAndAStillAgainstAMovieAreSaidPlainly) {
  still("a.png");
  ASSERT_EQ(obscura("render scene.toml --at 0.5 --size 320x180 -o b.png").exit, 0);
  Outcome run = obscura("compare a.png b.png --diff d.png");
  EXPECT_EQ(run.exit, 1);
  EXPECT_THAT(run.out, HasSubstr("other sizes: 160x90 and 320x180"));
  EXPECT_TRUE(std::filesystem::exists(path("d.png")));
  ASSERT_EQ(obscura("render scene.toml --to 0.2 --size 160x90 -o m.mp4").exit, 0);
  run = obscura("compare a.png m.mp4");
  EXPECT_EQ(run.exit, 2);
  EXPECT_EQ(obscura("compare a.png none.png").exit, 4);
  scene("not a picture", "b.png");
  EXPECT_EQ(obscura("compare a.png b.png").exit, 4);
}

TEST_F(Compare, FramesSayTheFirstTheWorstAndTheCause) {
  ASSERT_EQ(obscura("render scene.toml --size 160x90 --fps 10 -o a/").exit, 0);
  ASSERT_EQ(obscura("render scene.toml --size 160x90 --fps 10 -o b/ --set crate.mass=3").exit, 0);
  const Outcome run = obscura("compare a b --report report.html");
  EXPECT_EQ(run.exit, 1);
  EXPECT_THAT(run.out, HasSubstr("of 10 frames"));
  EXPECT_THAT(run.out, HasSubstr("first"));
  EXPECT_THAT(run.out, HasSubstr("worst"));
  EXPECT_THAT(run.out, HasSubstr("states part at step"));
  EXPECT_THAT(contents(path("report.html")), HasSubstr("data:image/png;base64,"));
  // a frame that is gone is no agreement
  std::filesystem::remove_all(path("b"));
  ASSERT_EQ(obscura("render scene.toml --size 160x90 --fps 10 -o b/ --frames 0..8").exit, 0);
  const Outcome fewer = obscura("compare a b");
  EXPECT_EQ(fewer.exit, 1);
  EXPECT_THAT(fewer.out, HasSubstr("only a has 0009.png"));
}

TEST_F(Compare, MoviesAgreeOrSayWhichFrameParts) {
  ASSERT_EQ(obscura("render scene.toml --size 160x90 --fps 10 -o a.mp4").exit, 0);
  ASSERT_EQ(obscura("render scene.toml --size 160x90 --fps 10 -o same.mp4 -j 1").exit, 0);
  ASSERT_EQ(obscura("render scene.toml --size 160x90 --fps 10 -o shorter.mp4 --to 0.9").exit, 0);
  ASSERT_EQ(obscura("render scene.toml --size 160x90 --fps 10 -o b.mp4 --set crate.mass=3").exit, 0);
  EXPECT_EQ(compared("a.mp4 same.mp4", 0)["same_bytes"], true);
  const Json json = compared("a.mp4 b.mp4", 1);
  EXPECT_EQ(json["frames"], 10);
  EXPECT_GT(json["first"], 0);
  EXPECT_GT(json["cause"]["states"]["step"], 0);
  EXPECT_THAT(obscura("compare a.mp4 shorter.mp4").out,
              HasSubstr("a.mp4 has 10 frames and shorter.mp4 has 9"));
}

TEST_F(Compare, WritesOverNoneOfItsInputs) {
  still("a.png");
  still("b.png", "--theme screen");
  ASSERT_EQ(
      shell("mkdir left right && cp a.png left/0.png && cp b.png right/0.png && ln -s a.png link.png").exit,
      0);
  const std::string before = contents(path("a.png"));
  for (const char* flags :
       {"a.png b.png --diff a.png", "a.png b.png --diff ./b.png", "a.png b.png --diff link.png",
        "a.png b.png --report b.png", "left right --diff left/0.png"}) {
    const Outcome run = obscura(std::string("compare ") + flags);
    EXPECT_EQ(run.exit, 2) << flags;
    EXPECT_THAT(run.err, HasSubstr("which is compared")) << flags;
  }
  EXPECT_EQ(contents(path("a.png")), before);
  EXPECT_EQ(contents(path("left/0.png")), before);
  EXPECT_EQ(obscura("compare left right --diff left.png").exit, 1);
}

// A difference that is not told is no answer.
TEST_F(Compare, StandardOutputThatIsFullIsAnError) {
  still("a.png");
  still("b.png", "--theme screen");
  const Outcome run = obscura("compare a.png b.png > /dev/full");
  EXPECT_EQ(run.exit, 4);
  EXPECT_THAT(run.err, HasSubstr("standard output: cannot write"));
}

TEST_F(Compare, APageIsNotComparedAndThatIsSaid) {
  ASSERT_EQ(obscura("render scene.toml -o a.html").exit, 0);
  const Outcome run = obscura("compare a.html a.html");
  EXPECT_EQ(run.exit, 2);
  EXPECT_THAT(run.err,
              HasSubstr("a.html: is a page, and no page is compared: `obscura verify` makes it again"));
}

TEST_F(Compare, WhoeverDrawsCanBeToldWithWhat) {
  // EGL without a library of its own cannot be had: whoever takes it says so
  const std::string without =
      "__EGL_VENDOR_LIBRARY_FILENAMES=/dev/null __EGL_VENDOR_LIBRARY_DIRS=/nonexistent " OBSCURA_BINARY " ";
  const Outcome osmesa = obscura("render scene.toml --at 0.5 --size 160x90 -o a.png --backend osmesa");
  OBSCURA_NEEDS(osmesa.exit == 0, "libosmesa6");
  scene(text_ + "[golden]\nat = [0.5]\nsize = [160, 90]\n");
  for (const char* command :
       {"verify a.png", "golden scene.toml --update", "figure scene.toml -o f.png --dpi 50",
        "sweep scene.toml --vary seed=1,2 --at 0 -o s.png"}) {
    EXPECT_EQ(shell(without + command + " --backend osmesa").exit, 0) << command;
    EXPECT_EQ(shell(without + command + " --backend egl").exit, 5) << command;
  }
}

using Runs = Compare;

TEST_F(Runs, OfOneSceneAgreeAndOfAnotherPartAtABodyAndAQuantity) {
  ASSERT_EQ(obscura("states scene.toml --every 0.1 --format csv > a.csv").exit, 0);
  ASSERT_EQ(obscura("states scene.toml --every 0.1 --format csv --set crate.velocity=[1.001,1] > b.csv").exit,
            0);
  EXPECT_EQ(obscura("compare a.csv a.csv").exit, 0);
  const Outcome run = obscura("compare a.csv b.csv");
  EXPECT_EQ(run.exit, 1);
  EXPECT_THAT(run.out, HasSubstr("part first at t = 0 s"));
  // until it hits something the crate is 0.001 t further right
  const Json loose = compared("a.csv b.csv --atol 0.00025 --rtol 0", 1);
  EXPECT_EQ(loose["part"]["body"], "crate");
  EXPECT_EQ(compared("a.csv b.csv --atol 100 --rtol 0", 0)["same"], true);
}

TEST_F(Runs, AreMatchedByNamesAndTimesAndInterpolatedOnlyIfTold) {
  scene("time,ball.position.x,ball.position.y\n0,0,0\n1,1,10\n2,2,20\n", "a.csv");
  scene("# by hand\ntime, ball.position.y, ball.position.x\r\n0,0,0\r\n2,20,2\r\n", "b.csv");
  Outcome run = obscura("compare a.csv b.csv");
  EXPECT_EQ(run.exit, 1);
  EXPECT_THAT(run.out, HasSubstr("b.csv has no row at 1 of 3 times, the first t = 1 s"));
  EXPECT_EQ(obscura("compare a.csv b.csv --interpolate").exit, 0);
  scene("time,bell.position.x,bell.position.y\n0,0,0\n1,1,10\n2,2,20\n", "b.csv");
  run = obscura("compare a.csv b.csv");
  EXPECT_EQ(run.exit, 1);
  EXPECT_THAT(run.out, HasSubstr("b.csv has no ball"));
}

// A table that leaves out where a body is, or a component, shows another run; what may be left out is told.
TEST_F(Runs, WhatWasAskedForAndIsNotThereIsADifference) {
  const std::string names =
      "time,step,hash,energy.total,ball.position.x,ball.position.y,ball.angle,ball.velocity.x,ball.velocity."
      "y,ball.charge\n";
  scene(names + "0,0,f,1,2,3,4,5,6,7\n", "a.csv");
  const auto without = [&](const std::string& table) {
    scene(table, "b.csv");
    return obscura("compare a.csv b.csv");
  };
  Outcome run = without("time,ball.position.x,ball.position.y,ball.charge\n0,2,3,7\n");
  EXPECT_EQ(run.exit, 0) << run.out;
  EXPECT_THAT(run.out, HasSubstr("not compared, because only a.csv has it: energy.total, ball.angle, "
                                 "ball.velocity.x, ball.velocity.y"));
  EXPECT_THAT(run.out, HasSubstr("never compared: hash, step"));
  for (const auto& [table, lacking] :
       {std::pair("time,ball.position.x,ball.charge\n0,2,7\n", "ball.position.y"),
        {"time,ball.position.x,ball.position.y,ball.velocity.x,ball.charge\n0,2,3,5,7\n", "ball.velocity.y"},
        {"time,ball.position.x,ball.position.y\n0,2,3\n", "ball.charge"}}) {
    run = without(table);
    EXPECT_EQ(run.exit, 1) << lacking;
    EXPECT_THAT(run.out, HasSubstr("a.csv and b.csv differ")) << lacking;
    EXPECT_THAT(run.out, HasSubstr(std::string("b.csv has no column ") + lacking + "\n"));
  }
}

TEST_F(Runs, WhatOfJsonIsNoColumnIsTold) {
  ASSERT_EQ(obscura("states scene.toml --at 0.5 > a.json").exit, 0);
  const Outcome run = obscura("compare a.json a.json");
  EXPECT_EQ(run.exit, 0);
  EXPECT_THAT(run.out, HasSubstr("never compared: hash, "));
  EXPECT_THAT(run.out, HasSubstr("bodies.at_rest"));
}

TEST_F(Runs, TakeAWholeTurnAndTheOtherQuaternionForTheSame) {
  scene("time,a.angle,b.orientation.x,b.orientation.y,b.orientation.z,b.orientation.w\n0,7,0,0,0.6,0.8\n",
        "a.csv");
  scene(
      "time,a.angle,b.orientation.x,b.orientation.y,b.orientation.z,b.orientation.w\n0,0.7168146928204138,0,"
      "0,"
      "-0.6,-0.8\n",
      "b.csv");
  const Outcome run = obscura("compare a.csv b.csv --atol 1e-12");
  EXPECT_EQ(run.exit, 0);
  EXPECT_THAT(run.out, HasSubstr("compared without whole turns, by which they differ: a.angle"));
  scene("time,a.angle\n0,0\n1,0.5\n", "b.csv");
  EXPECT_THAT(obscura("compare b.csv b.csv").out, Not(HasSubstr("turns")));
}

TEST_F(Runs, AreTakenAsJsonTooAsStatesWritesIt) {
  const std::string states = "states scene.toml --every 0.1 ";
  ASSERT_EQ(obscura(states + "--format csv > a.csv").exit, 0);
  ASSERT_EQ(obscura(states + "> a.json").exit, 0);
  ASSERT_EQ(obscura(states + "--set crate.mass=3 > b.json").exit, 0);
  Outcome run = obscura("compare a.csv a.json");
  EXPECT_EQ(run.exit, 0) << run.out << run.err;
  EXPECT_THAT(run.out, HasSubstr("exactly"));
  EXPECT_EQ(obscura("compare a.json b.json").exit, 1);
  ASSERT_EQ(obscura("render scene.toml --at 0.5 --size 160x90 -o a.png").exit, 0);
  ASSERT_EQ(obscura("render scene.toml --at 0.5 --size 160x90 -o b.png --states a.json").exit, 0);
  EXPECT_EQ(obscura("compare a.png b.png").exit, 0);
  for (const char* bad : {"{", "{\"states\": [{}]}", "{\"states\": []}", "{\"states\": [{\"time\": \"x\"}]}",
                          "{\"states\": [{\"time\": 1}, {\"time\": 0}]}",
                          "{\"states\": [{\"time\": 1}, {\"time\": 2, \"step\": 1}]}"}) {
    scene(bad, "b.json");
    run = obscura("compare a.csv b.json");
    EXPECT_EQ(run.exit, 4) << bad;
    EXPECT_THAT(run.err, HasSubstr("b.json")) << bad;
  }
}

TEST_F(Runs, WhatIsNotFiniteIsTheSameAsItselfAloneAtAnyTolerance) {
  const auto table = [&](const std::string& value, const std::string& name) {
    scene("time,ball.position.x,ball.angle\n0,0,0\n1," + value + "," + value + "\n2,0,0\n", name);
  };
  const std::vector<std::string> values = {"inf", "-inf", "nan", "1", "1e+300"};
  for (const std::string& a : values) {
    for (const std::string& b : values) {
      table(a, "a.csv"), table(b, "b.csv");
      const bool finite = a.find('n') == a.npos && b.find('n') == b.npos;
      const int exit = a == b || finite ? 0 : 1;
      const Outcome run = obscura("compare a.csv b.csv --rtol 2 --atol 1e300");
      EXPECT_EQ(run.exit, exit) << a << " " << b << run.out;
      if (exit == 0) continue;
      EXPECT_THAT(run.out, HasSubstr(a + " and " + b + "; values that are not finite equal only themselves"));
      const Json json = compared("a.csv b.csv --rtol 1e300", 1);
      EXPECT_EQ(json["part"]["body"], "ball");
      EXPECT_EQ(json["quantities"][0]["largest"], "inf");
    }
  }
  table("-nan", "a.csv"), table("nan", "b.csv");
  EXPECT_THAT(obscura("compare a.csv b.csv").out, HasSubstr("exactly"));
}

TEST_F(Runs, SayWhatIsWrongWithATable) {
  scene("time,ball.position.x\n0,0\n", "a.csv");
  const auto told = [&](const std::string& text) {
    scene(text, "b.csv");
    const Outcome run = obscura("compare a.csv b.csv");
    EXPECT_EQ(run.exit, 4) << text;
    return run.err;
  };
  EXPECT_THAT(told("time,ball.position.x\n0,zero\n"),
              HasSubstr("b.csv:2:3: 'zero' under ball.position.x is no number"));
  EXPECT_THAT(told("time,ball.position.x\n0\n"), HasSubstr("b.csv:2: 1 cells under 2 columns"));
  EXPECT_THAT(told("time,ball.position.x\n1,0\n1,0\n"), HasSubstr("b.csv:3:1: times must increase"));
  EXPECT_THAT(told("t,ball.position.x\n1,0\n"), HasSubstr("no column is called 'time'"));
  EXPECT_EQ(obscura("compare a.csv a.png").exit, 2);
}

using Verify = Compare;

TEST_F(Verify, WhatWasJustMadeIsTrue) {
  still("a.png");
  ASSERT_EQ(obscura("render scene.toml --size 160x90 --fps 10 -o a.mp4 --frames 2..5 --crf 20").exit, 0);
  const Outcome run = obscura("verify a.png a.mp4");
  EXPECT_EQ(run.exit, 0) << run.out << run.err;
  EXPECT_THAT(run.out, HasSubstr("a.png: still true"));
  EXPECT_THAT(run.out, HasSubstr("movie: the same, byte by byte"));
}

// each frame of a card, and of a caption that comes while the film stands still, has the run's one instant
TEST_F(Verify, FramesOfAFilmThatStandsStillAreTrue) {
  scene(R"(
duration = 1
[room]
size = [4, 3]
[[ball]]
position = [1, 2]
velocity = [1, 0]
[film]
size = [160, 90]
fps = 10
speed = [{ time = 0.3, freeze = 0.7 }]
[[film.card]]
title = "Half of it"
time = 0.5
lasting = 1
[[film.caption]]
text = "It waits."
start = { time = 0.3, after = 0.2 }
end = 0.6
)");
  ASSERT_EQ(obscura("render scene.toml -o 'frames/{frame:03}.png' --progress none").exit, 0);
  const Outcome verified = shell(OBSCURA_NOT_FOR_EVER OBSCURA_BINARY " verify frames/*.png");
  EXPECT_EQ(verified.exit, 0) << verified.out << verified.err;
  EXPECT_EQ(verified.out.find("no longer"), std::string::npos) << verified.out;
  // a still of the instant is the first of them
  ASSERT_EQ(obscura("render scene.toml --at 0.3 -o still.png --progress none").exit, 0);
  EXPECT_EQ(contents(path("still.png")), contents(path("frames/003.png")));
  EXPECT_EQ(obscura("verify still.png").exit, 0);
}

TEST_F(Verify, AgainstASceneThatHasChangedItIsTrueNoLonger) {
  still("a.png");
  scene(std::string(text_).replace(text_.find("1.5"), 3, "2.5"));
  EXPECT_EQ(obscura("verify a.png").exit, 0) << "it carries its own scene";
  const Outcome run = obscura("verify a.png --scene scene.toml --states");
  EXPECT_EQ(run.exit, 1);
  EXPECT_THAT(run.out, HasSubstr("no longer true"));
  EXPECT_THAT(run.out, HasSubstr("crate.mass is 1.5 and 2.5"));
}

TEST_F(Verify, AMovieWhoseStatesPartLaterThanItsFirstFrameIsTrueNoLonger) {
  // the ball strikes the wall after 0.8 s
  for (const char* movie : {"a.mp4", "a.gif", "a.webm"})
    ASSERT_EQ(obscura(std::string("render scene.toml --size 160x90 --fps 10 -o ") + movie).exit, 0);
  Outcome run = obscura("verify a.mp4 a.gif a.webm --states");
  EXPECT_EQ(run.exit, 0) << run.out;
  EXPECT_THAT(run.out, HasSubstr("states of 10 frames: the same"));
  scene(
      std::string(text_).replace(text_.find("position = [3, 1]"), 17, "elasticity = 0.1\nposition = [3, 1]"));
  run = obscura("verify a.mp4 a.gif a.webm --states --scene scene.toml");
  EXPECT_EQ(run.exit, 1);
  for (const char* movie : {"a.mp4", "a.gif", "a.webm"})
    EXPECT_THAT(run.out, HasSubstr(std::string(movie) + ": no longer true"));
  // what was named is where the tables part
  const auto at = [&](int frame, const std::string& set) {
    const Json all = Json::parse(
        obscura("states scene.toml --at " + std::to_string(frame) + "/10 --set ball.elasticity=" + set).out);
    return std::string(all["states"][0]["hash"]);
  };
  int first = 0;
  while (first < 10 && at(first, "0.1") == at(first, "0.5")) ++first;
  ASSERT_GT(first, 0);
  ASSERT_LT(first, 10);
  EXPECT_THAT(run.out, HasSubstr("states differ from frame " + std::to_string(first) + " (t = 0." +
                                 std::to_string(first) + " s) on: bod"));
  EXPECT_THAT(run.out, HasSubstr("body ball, position and velocity"));
  // drawn, it is found as well
  run = obscura("verify a.mp4 --scene scene.toml");
  EXPECT_EQ(run.exit, 1);
  EXPECT_THAT(run.out, HasSubstr("states differ from frame"));
}

TEST_F(Verify, AnotherSimulatorsMovieIsToldByFrameAndBody) {
  ASSERT_EQ(obscura("render scene.toml --size 160x90 --fps 10 -o a.mp4").exit, 0);
  const std::string bytes = contents(path("a.mp4"));
  // as if frame 7 had shown another place of the second body, the crate
  std::string other = bytes;
  const auto change = [&](const std::string& key, std::size_t letter) {
    const std::size_t at = other.find("\"" + key + "\":{");
    ASSERT_NE(at, std::string::npos) << key;
    const std::size_t sums = other.find("\"sums\":\"", at) + 8 + letter;
    other[sums] = other[sums] == 'A' ? 'B' : 'A';
  };
  change("of_frames", 2 * 7);
  change("of_bodies", 2 * (2 * 7 + 1));
  scene(other, "a.mp4");
  const Outcome run = obscura("verify a.mp4 --states");
  EXPECT_EQ(run.exit, 1) << run.err;
  EXPECT_THAT(run.out, HasSubstr("states of 10 frames: others"));
  EXPECT_THAT(run.out, HasSubstr("states differ from frame 7 (t = 0.7 s) on: body crate"));
  EXPECT_THAT(run.out, HasSubstr("it is by obscura"));
  EXPECT_THAT(run.out, HasSubstr(", as this is: another build made it, or it was changed since"));
  // pixels are the same, and so said; the verdict is no
  const Outcome drawn = obscura("verify a.mp4");
  EXPECT_EQ(drawn.exit, 1);
  EXPECT_THAT(drawn.out, HasSubstr("movie: the same pixels in all frames"));
  scene(bytes, "b.mp4");
  EXPECT_THAT(obscura("compare b.mp4 a.mp4").out, HasSubstr("states differ from frame 7"));
}

TEST_F(Verify, OfAnOldOriginTheFirstStateAloneIsKnownAndThatIsSaid) {
  ASSERT_EQ(obscura("render scene.toml --size 160x90 --fps 10 -o a.mp4").exit, 0);
  std::string bytes = contents(path("a.mp4"));
  bytes.replace(bytes.find("\"states\":"), 9, "\"status\":");
  scene(bytes, "a.mp4");
  Outcome run = obscura("verify a.mp4 --states");
  EXPECT_EQ(run.exit, 0);
  EXPECT_THAT(run.out, HasSubstr("a.mp4: still true of its state at t = 0 s, the only state in its origin"));
  run = obscura("verify a.mp4");
  EXPECT_EQ(run.exit, 0);
  EXPECT_THAT(run.out, HasSubstr("a.mp4: still true\n"));
}

TEST_F(Verify, FilmsInSharesAndThoseThatWereStoppedTellOfTheSameStates) {
  const std::string film = "render scene.toml --size 160x90 --fps 30 --set duration=3 -o ";
  ASSERT_EQ(obscura(film + "a.mp4").exit, 0);
  for (const char* shard : {"3/3", "1/3", "2/3"}) ASSERT_EQ(obscura(film + "b.mp4 --shard " + shard).exit, 0);
  ASSERT_EQ(obscura("join b.mp4").exit, 0);
  EXPECT_EQ(compared("a.mp4 b.mp4", 0)["same_bytes"], true);
  // a part that is missing leaves no states that could be told
  ASSERT_EQ(obscura(film + "c.mp4 --shard 3/3").exit, 0);
  ASSERT_EQ(obscura("join c.mp4 --partial").exit, 0);
  const Outcome run = obscura("verify b.mp4 c.partial.mp4 --states");
  EXPECT_EQ(run.exit, 0) << run.out;
  EXPECT_THAT(run.out, HasSubstr("states of 90 frames: the same"));
  EXPECT_THAT(run.out, HasSubstr("c.partial.mp4: still true of its state at t = 2 s, the only state"));
}

TEST_F(Verify, APictureWithoutAnOriginCannotBe) {
  still("a.png");
  ASSERT_EQ(obscura("compare a.png " + still("b.png", "--theme screen") + " --diff d.png").exit, 1);
  const Outcome run = obscura("verify d.png");
  EXPECT_EQ(run.exit, 4);
  EXPECT_THAT(run.err, HasSubstr("d.png: has no origin"));
}

TEST_F(Verify, OneFileThatIsNotReadableDoesNotEndTheList) {
  still("a.png");
  scene("no picture", "cut.png");
  std::filesystem::create_directory(path("folder"));
  const Outcome run = obscura("verify cut.png none.png folder a.png --states");
  EXPECT_EQ(run.exit, 4);
  EXPECT_THAT(run.out, HasSubstr("a.png: still true"));
  EXPECT_THAT(run.err, HasSubstr("cut.png"));
  EXPECT_THAT(run.err, HasSubstr("none.png: there is no such file"));
  EXPECT_THAT(run.err, HasSubstr("folder: has no PNG in it"));
}

TEST_F(Verify, ASceneThatIsNotThereOrNoneIsNoVerdict) {
  still("a.png");
  Outcome run = obscura("verify a.png --scene typo.toml");
  EXPECT_EQ(run.exit, 4);
  EXPECT_EQ(run.out, "");
  EXPECT_THAT(run.err, HasSubstr("--scene typo.toml: there is no such file"));
  scene("[[bal]]\n", "broken.toml");
  run = obscura("verify a.png --scene broken.toml");
  EXPECT_EQ(run.exit, 3);
  EXPECT_EQ(run.out, "");
  EXPECT_EQ(shell("cat scene.toml | " OBSCURA_BINARY " verify a.png a.png --states --scene -").exit, 0);
}

TEST_F(Verify, FramesThatASceneNoLongerHasAreAVerdict) {
  ASSERT_EQ(obscura("render scene.toml --size 160x90 --fps 10 -o a.mp4 --frames 2..9").exit, 0);
  scene(std::string(text_).replace(text_.find("duration = 1"), 12, "duration = 0.5"));
  const Outcome run = obscura("verify a.mp4 --scene scene.toml");
  EXPECT_EQ(run.exit, 1);
  EXPECT_THAT(run.out, HasSubstr("a.mp4: no longer true"));
  EXPECT_THAT(run.out, HasSubstr("the film has frames 0 to 4"));
}

}  // namespace
}  // namespace obscura::app

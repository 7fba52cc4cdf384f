// render --states: films what another program computed.

#include <gmock/gmock.h>

#include "program.h"

namespace obscura::app {
namespace {

using testing::HasSubstr;

/// A box and a ball that fall, and the table that `states` writes of them.
class Footage : public Program {
 protected:
  void SetUp() override {
    Program::SetUp();
    scene(kCrateAndBall);
    ASSERT_EQ(obscura("states scene.toml --every 0.1 --format csv > run.csv").exit, 0);
  }
};

TEST_F(Footage, OfASimulationsOwnTableIsTheSimulationsPicture) {
  ASSERT_EQ(obscura("render scene.toml --at 0.5 --size 160x90 -o a.png").exit, 0);
  ASSERT_EQ(obscura("render scene.toml --at 0.5 --size 160x90 -o b.png --states run.csv").exit, 0);
  const Outcome run = obscura("compare a.png b.png");
  EXPECT_EQ(run.exit, 0) << run.out;
  const Outcome verified = obscura("verify b.png");
  EXPECT_EQ(verified.exit, 4) << "nobody can simulate it again";
  EXPECT_THAT(verified.err, HasSubstr("name its table too, as in `obscura verify b.png run.csv`"));
}

TEST_F(Footage, IsVerifiedAgainstItsTable) {
  ASSERT_EQ(obscura("render scene.toml --at 0.5 --size 160x90 -o a.png --states run.csv").exit, 0);
  ASSERT_EQ(obscura("render scene.toml --size 160x90 --fps 20 -o a.mp4 --states run.csv --interpolate").exit,
            0);
  Outcome run = obscura("verify a.png a.mp4 run.csv");
  EXPECT_EQ(run.exit, 0) << run.out;
  EXPECT_THAT(run.out, HasSubstr("a.png: still true"));
  EXPECT_THAT(run.out, HasSubstr("pixels: the same"));
  EXPECT_THAT(run.out, HasSubstr("a.mp4: still true"));
  EXPECT_EQ(obscura("verify a.png a.mp4 --states run.csv").exit, 0);
  // a table under another name will do; in its last row the ball is a decimetre farther on
  ASSERT_EQ(
      shell("awk -F, -v OFS=, 'NR == 1 { for (i = 1; i <= NF; ++i) if ($i == \"ball.position.x\") k = i } "
            "NR == 12 { $k += 0.1 } 1' run.csv > new.csv")
          .exit,
      0);
  ASSERT_NE(contents(path("new.csv")), contents(path("run.csv")));
  run = obscura("verify --states a.png a.mp4 new.csv");
  EXPECT_EQ(run.exit, 1);
  EXPECT_THAT(run.out, HasSubstr("a.png: still true"));
  EXPECT_THAT(run.out, HasSubstr("a.mp4: no longer true"));
  EXPECT_EQ(obscura("verify a.mp4 new.csv").exit, 1);
  // of several the one of its name
  EXPECT_EQ(obscura("verify --states a.png a.mp4 new.csv run.csv").exit, 0);
  run = obscura("verify run.csv");
  EXPECT_EQ(run.exit, 2);
  EXPECT_THAT(run.err, HasSubstr("a table is no picture or movie"));
}

TEST_F(Footage, InSpaceTakesOrientationsAsStatesWritesThem) {
  // sides of three lengths: its principal axes are not those in which it was typed
  scene(R"(duration = 1
[room]
size = [4, 2.25, 4]
[[hull]]
name = "wedge"
points = [[0, 0, 0], [1, 0, 0], [1, 0.5, 0], [0, 0, 0.7], [1, 0, 0.7], [1, 0.5, 0.7]]
position = [0, 1, 0]
spin = [100, 40, 10]
)");
  ASSERT_EQ(obscura("states scene.toml --every 0.1 --format csv > run.csv").exit, 0);
  ASSERT_EQ(obscura("render scene.toml --at 0.3 --size 160x90 -o a.png").exit, 0);
  ASSERT_EQ(obscura("render scene.toml --at 0.3 --size 160x90 -o b.png --states run.csv").exit, 0);
  // a last bit of the quaternion may tip a level
  const Outcome run = obscura("compare a.png b.png");
  EXPECT_TRUE(run.exit == 0 || run.out.find("by up to 1 of") != std::string::npos) << run.out;
}

TEST_F(Footage, FramesFallOnRowsOrBetweenThemOnlyIfTold) {
  EXPECT_EQ(obscura("render scene.toml --size 160x90 --fps 10 --states run.csv -o a.mp4").exit, 0);
  const Outcome run = obscura("render scene.toml --size 160x90 --fps 20 --states run.csv -o b.mp4");
  EXPECT_EQ(run.exit, 2);
  EXPECT_THAT(run.err, HasSubstr("run.csv has no row at t = 0.05 s (frame 1)"));
  EXPECT_EQ(obscura("render scene.toml --size 160x90 --fps 20 --states run.csv --interpolate -o b.mp4").exit,
            0);
  EXPECT_EQ(obscura("render scene.toml --interpolate -o c.mp4").exit, 2);
}

// contacts, joints and explosions are the steps', not the states'
TEST_F(Footage, ShowsNoForcesThatAStateDoesNotTell) {
  const std::string marks =
      "[[film.vector]]\nquantity = \"weight\"\nof = \"crate\"\nlabel = \"W = {}\"\n"
      "[[film.vector]]\nquantity = \"normal_force\"\nof = \"crate\"\nlabel = \"N = {}\"\n"
      "[[film.label]]\nat = [2, 2]\ntext = \"a = {}\"\nquantity = \"acceleration\"\nof = \"crate\"\n"
      "[[film.plot]]\nquantity = [\"friction\"]\nof = \"crate\"\n";
  scene(kCrateAndBall + marks);
  const Outcome run = obscura("render scene.toml --at 0.5 --size 320x180 --states run.csv -o a.pdf");
  ASSERT_EQ(run.exit, 0) << run.err;
  EXPECT_THAT(run.err, HasSubstr("places and velocities do not tell acceleration, friction, normal force: "
                                 "its marks and plots are left out"));
  scene(kCrateAndBall + marks.substr(0, marks.find("[[film.vector]]", 1)), "weight.toml");
  const Outcome told = obscura("render weight.toml --at 0.5 --size 320x180 --states run.csv -o b.png");
  EXPECT_EQ(told.err.find("left out"), std::string::npos) << told.err;
  ASSERT_EQ(obscura("render scene.toml --at 0.5 --size 320x180 --states run.csv -o a.png").exit, 0);
  EXPECT_EQ(obscura("compare a.png b.png").exit, 0);
}

TEST_F(Footage, NeedsThePlacesOfTheScenesBodiesAndSaysWhatItLeavesOut) {
  scene("time,crate.position.x,crate.position.y,bell.position.x,bell.position.y\n0,1,1,3,1\n", "run.csv");
  Outcome run = obscura("render scene.toml --at 0 --states run.csv -o a.png");
  EXPECT_EQ(run.exit, 4);
  EXPECT_THAT(
      run.err,
      HasSubstr(
          "run.csv:1: has no column ball.position.x, ball.position.y; is its 'bell' the scene's 'ball'?"));
  scene(
      "time,crate.position.x,crate.position.y,ball.position.x,ball.position.y,cat.position.x\n0,1,1,3,1,0\n",
      "run.csv");
  run = obscura("render scene.toml --at 0 --size 160x90 --states run.csv -o a.png");
  EXPECT_EQ(run.exit, 0) << run.err;
  EXPECT_THAT(run.err, HasSubstr("left out, because the scene has no such body: cat"));
  EXPECT_THAT(run.err, HasSubstr("does not say how ball, crate turns"));
}

/// Names of columns that do not fit the scene, and cells that no body can be at.
class HandMade : public Footage {
 protected:
  std::string refused(const std::string& table, const std::string& scene = "scene.toml") const {
    this->scene(table, "hand.csv");
    const Outcome run = obscura("render " + scene + " --at 0 --size 160x90 --states hand.csv -o a.png");
    EXPECT_EQ(run.exit, 4) << table << run.err;
    EXPECT_FALSE(std::filesystem::exists(path("a.png"))) << table;
    return run.err;
  }
  const std::string head_ = "time,crate.position.x,crate.position.y,ball.position.x,ball.position.y";
};

TEST_F(HandMade, WhatIsNotFiniteIsRefusedAtItsCell) {
  for (const char* bad : {"nan", "inf", "-inf", "-nan"}) {
    const std::string told = refused("# by hand\n" + head_ + "\n0, 1,1,3,1\n1, 1," + bad + ",3,1\n");
    EXPECT_THAT(told, HasSubstr("hand.csv:4:6: ")) << bad;
  }
  EXPECT_THAT(refused(head_ + ",ball.angle\n0,1,1,3,1,nan\n"), HasSubstr("hand.csv:2:11: ball.angle is nan"));
  // what is not filmed may be what it likes
  scene(head_ + ",ball.heat\n0,1,1,3,1,nan\n", "hand.csv");
  const Outcome run = obscura("render scene.toml --at 0 --size 160x90 --states hand.csv -o a.png");
  EXPECT_EQ(run.exit, 0) << run.err;
  EXPECT_THAT(run.err, HasSubstr("left out, because a film does not show it: ball.heat"));
}

TEST_F(HandMade, MisspeltAndMissingColumnsAreRefusedByName) {
  EXPECT_THAT(refused("time,crate.position.x,crate.position.y,ball.position.x\n0,1,1,3\n"),
              HasSubstr("hand.csv:1: has no column ball.position.y\n"));
  EXPECT_THAT(refused(head_ + ",ball.velocity.x\n0,1,1,3,1,0\n"),
              HasSubstr("hand.csv:1: has no column ball.velocity.y\n"));
  EXPECT_THAT(refused(head_ + ",ball.anlge\n0,1,1,3,1,0\n"),
              HasSubstr("hand.csv:1:72: a body has no 'ball.anlge'; did you mean 'ball.angle'?"));
  EXPECT_THAT(refused(head_ + ",ball.Velocity.x,ball.velocity.y\n0,1,1,3,1,0,0\n"),
              HasSubstr("did you mean 'ball.velocity.x'?"));
}

TEST_F(HandMade, OfThreeDimensionsItIsRefusedInThePlaneWhereItWouldLoseOne) {
  EXPECT_THAT(refused(head_ + ",ball.position.z\n0,1,1,3,1,0\n1,1,1,3,1,0.25\n"),
              HasSubstr("hand.csv:3:11: ball.position.z is 0.25: the scene is in the plane"));
  EXPECT_THAT(refused(head_ + ",ball.spin.z\n0,1,1,3,1,0\n"), HasSubstr("where ball.spin is one number"));
  EXPECT_THAT(refused(head_ + ",ball.orientation.x\n0,1,1,3,1,0\n"),
              HasSubstr("where a body turns by its angle"));
  scene(head_ + ",ball.position.z,crate.velocity.z\n0,1,1,3,1,0,-0\n", "hand.csv");
  const Outcome run = obscura("render scene.toml --at 0 --size 160x90 --states hand.csv -o a.png");
  EXPECT_EQ(run.exit, 0) << "nothing is lost: " << run.err;
}

TEST_F(HandMade, InSpaceItNeedsOrientationsOfLengthOneAndAllThreePlaces) {
  scene("duration = 1\n[room]\nsize = [4, 2.25, 4]\n[[box]]\nname = \"b\"\nsize = [1, 1, 1]\n", "space.toml");
  const std::string head = "time,b.position.x,b.position.y,b.position.z";
  const std::string turn = ",b.orientation.x,b.orientation.y,b.orientation.z,b.orientation.w\n";
  EXPECT_THAT(refused(head + turn + "0,0,1,0,0,0,0,0\n", "space.toml"),
              HasSubstr("hand.csv:2:9: b.orientation.x and so on are a quaternion of length 0"));
  EXPECT_THAT(refused(head + turn + "0,0,1,0,1,0,0,1\n", "space.toml"),
              HasSubstr("quaternion of length 1.41"));
  EXPECT_THAT(refused("time,b.position.x,b.position.y\n0,0,1\n", "space.toml"),
              HasSubstr("has no column b.position.z\n"));
  EXPECT_THAT(refused(head + ",b.angle\n0,0,1,0,1\n", "space.toml"), HasSubstr("the scene is in space"));
  // a pipe cannot be read again: its line is told
  scene(head + turn + "0,0,1,0,0,0,0,0\n", "hand.csv");
  EXPECT_THAT(
      shell("cat hand.csv | " OBSCURA_BINARY " render space.toml --at 0 --states /dev/stdin -o a.png").err,
      HasSubstr("/dev/stdin:2: b.orientation.x"));
}

}  // namespace
}  // namespace obscura::app

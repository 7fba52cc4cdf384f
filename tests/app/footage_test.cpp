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
  EXPECT_EQ(obscura("verify b.png").exit, 4) << "nobody can simulate it again";
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

TEST_F(Footage, NeedsThePlacesOfTheScenesBodiesAndSaysWhatItLeavesOut) {
  scene("time,crate.position.x,crate.position.y,bell.position.x,bell.position.y\n0,1,1,3,1\n", "run.csv");
  Outcome run = obscura("render scene.toml --at 0 --states run.csv -o a.png");
  EXPECT_EQ(run.exit, 4);
  EXPECT_THAT(run.err, HasSubstr("run.csv: has no position of ball; did you mean 'bell'?"));
  scene(
      "time,crate.position.x,crate.position.y,ball.position.x,ball.position.y,cat.position.x\n0,1,1,3,1,0\n",
      "run.csv");
  run = obscura("render scene.toml --at 0 --size 160x90 --states run.csv -o a.png");
  EXPECT_EQ(run.exit, 0) << run.err;
  EXPECT_THAT(run.err, HasSubstr("left out, for the scene has no such body: cat"));
  EXPECT_THAT(run.err, HasSubstr("does not say how ball, crate turns"));
}

}  // namespace
}  // namespace obscura::app

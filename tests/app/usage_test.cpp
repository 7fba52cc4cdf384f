// Command lines that are wrong: told at once, in one line, with exit code 2.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>

#include "app/program.h"

namespace obscura::app {
namespace {

using ::testing::HasSubstr;

class Usage : public Program {
 protected:
  void SetUp() override {
    Program::SetUp();
    scene("duration = 0.1\n[[ball]]\nname = \"ball\"\nradius = 0.2\nposition = [1, 1]\n");
  }
  void refuses(const std::string& arguments, const std::string& says, int exit = 2) const {
    const Outcome outcome = shell("timeout 60 " OBSCURA_BINARY " " + arguments);
    EXPECT_EQ(outcome.exit, exit) << arguments << outcome.err;
    EXPECT_THAT(outcome.err, HasSubstr(says)) << arguments;
    EXPECT_EQ(std::count(outcome.err.begin(), outcome.err.end(), '\n'), 1) << outcome.err;
  }
};

TEST_F(Usage, AnUnknownOptionIsToldWithTheOneThatWasMeant) {
  refuses("render scene.toml --fsp 30", "render has no option --fsp; did you mean '--fps'?");
  refuses("states scene.toml --fromat=csv", "states has no option --fromat; did you mean '--format'?");
  refuses("golden scene.toml --udpate", "golden has no option --udpate; did you mean '--update'?");
  refuses("render scene.toml --zzzzzzzz", "render has no option --zzzzzzzz; see obscura render --help");
  refuses("--verson", "there is no option --verson; did you mean '--version'?");
}

TEST_F(Usage, WhatIsNoCommandIsToldWhatIs) {
  refuses("help", "see obscura --help");
  refuses("scene.toml", "'scene.toml' is a scene, not a command: obscura render scene.toml");
  refuses("zzzzz", "the commands are ");
  refuses("zzzzz", "; see obscura --help");
}

TEST_F(Usage, WhatVariesIsNamedAsItWasTyped) {
  const std::string asked = "sweep scene.toml --measure energy.total@end --vary ";
  refuses(asked + "mass=1,2", "--vary mass=1: ", 3);
  refuses(asked + "ball.mass=1..5", "; a range is from:to or from:to:stride, as in 1:5", 3);
  for (const char* out : {"a.png --at 0", "a.mp4", "a.html"}) {
    refuses("sweep scene.toml --vary ball.mas=1,2 -o " + std::string(out), "--vary ball.mas=1: ", 3);
    refuses("sweep scene.toml --vary seed=1:400 -o " + std::string(out), "400 runs are more than ");
  }
  refuses("figure scene.toml -o a.svg --vary ball.mas=1,2", "--vary ball.mas=1: ", 3);
  EXPECT_EQ(shell("timeout 60 " OBSCURA_BINARY " " + asked + "mass=1,2").err.find("--set"),
            std::string::npos);
}

// of a key whose values are numbers of copies
TEST_F(Usage, CopiesThatVaryAreNoRange) {
  scene(
      "duration = 0.1\n[[ball]]\nname = \"ball\"\nradius = 0.2\nposition = [1, 1]\ncopies = { count = 3, "
      "offset = [1, "
      "0] }\n");
  const Outcome run = obscura("sweep scene.toml --measure energy.total@0 --vary ball.fixed=0..1,0..2");
  EXPECT_EQ(run.exit, 0) << run.err;
}

TEST_F(Usage, AnEndingThatNothingMakesIsUsage) {
  for (const char* name : {"a.jpg", "a.avi", "a"}) {
    refuses(std::string("render scene.toml -o ") + name, std::string(name) + ": ");
    refuses(std::string("join ") + name, std::string(name) + ": ");
    refuses(std::string("submit scene.toml --tasks 2 --dry-run -o ") + name, std::string(name) + ": ");
    refuses(std::string("figure scene.toml -o ") + name, std::string("-o ") + name);
    refuses(std::string("export scene.toml -o ") + name, std::string("-o ") + name);
  }
  refuses("render scene.toml --at 0 -o a.jpg", "a.jpg: a still (--at) ends in .png");
  refuses("golden scene.toml --report a.txt", "--report a.txt");
}

// No save of the scene mends what stands on the command line.
TEST_F(Usage, WatchServesNothingWithFlagsThatAreWrong) {
  refuses("watch scene.toml --fps soon", "--fps soon");
  refuses("watch scene.toml --set ball.radius=-1", "--set ball.radius=-1", 3);
  refuses("watch scene.toml --set ball.radus=1", "radus", 3);
  refuses("watch none.toml --fps 30", "none.toml", 4);
}

}  // namespace
}  // namespace obscura::app

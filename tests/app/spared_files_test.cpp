// What is not the program's stays as it is: inputs, files of others, what --no-overwrite keeps.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>

#include "app/program.h"

namespace obscura::app {
namespace {

using ::testing::HasSubstr;

constexpr const char* kBox = R"toml(duration = 0.1
[[box]]
size     = [0.4, 0.4]
position = [2, 1.5]
[golden]
[film]
size = [64, 48]
fps  = 20
)toml";

class SparedFiles : public Program {
 protected:
  void SetUp() override {
    Program::SetUp();
    write("box.toml", kBox);
  }
  void write(const std::string& name, const std::string& text) const { std::ofstream(path(name)) << text; }
  void refuses(const std::string& arguments, int exit, const std::string& says) const {
    const Outcome outcome = obscura(arguments);
    EXPECT_EQ(outcome.exit, exit) << arguments;
    EXPECT_THAT(outcome.err, HasSubstr(says)) << arguments;
    EXPECT_EQ(contents(path("box.toml")), kBox) << arguments;
  }
};

TEST_F(SparedFiles, AScenesFileIsNoReport) {
  refuses("golden --report box.toml", 2, "--report box.toml: expected a name that ends with .html");
  refuses("golden --junit box.toml", 2, "--junit box.toml: expected a name that ends with .xml");
  refuses("compare a.png b.png --diff box.toml", 2, "--diff box.toml: expected a name that ends with .png");
  refuses("compare a.png b.png --report box.toml", 2, "expected a name that ends with .html");
  refuses("states box.toml --format csv -o box.toml", 2, "would be written over box.toml, which is read");
  refuses("sweep box.toml --vary seed=1,2 --measure energy.total@0 --format csv -o box.toml", 2,
          "would be written over box.toml, which is read");
}

TEST_F(SparedFiles, NoOverwriteKeepsEachFrameAndTheCaptionsAndThePoster) {
  shell("mkdir f && touch f/1.png box.poster.png");
  refuses("render box.toml -o 'f/{frame}.png' --no-overwrite", 4, "f/1.png: is there already");
  EXPECT_EQ(contents(path("f/1.png")), "");
  refuses("render box.toml -o box.mp4 --poster 0 --no-overwrite", 4, "box.poster.png: is there already");
  EXPECT_FALSE(std::filesystem::exists(path("box.mp4"))) << "it is told before the film is made";
  write("said.toml", std::string(kBox) + "[[film.caption]]\ntext = \"so\"\n");
  shell("touch said.vtt");
  refuses("render said.toml -o said.mp4 --no-overwrite", 4, "said.vtt: is there already");
}

// A sequence that takes the place of a longer one takes it whole; what others wrote there stays.
TEST_F(SparedFiles, AShorterSequenceLeavesNoFramesOfTheLongerOne) {
  ASSERT_EQ(obscura("render box.toml -o 'f/{frame}.png' --set duration=0.4").exit, 0);
  ASSERT_TRUE(std::filesystem::exists(path("f/7.png")));
  const Outcome shorter = obscura("render box.toml -o 'f/{frame}.png' --set duration=0.2");
  EXPECT_EQ(shorter.exit, 0);
  EXPECT_THAT(shorter.err, HasSubstr("f/4.png to f/7.png are removed"));
  EXPECT_FALSE(std::filesystem::exists(path("f/4.png")));
  EXPECT_FALSE(std::filesystem::exists(path("f/7.png")));
  EXPECT_TRUE(std::filesystem::exists(path("f/3.png")));
  // a part of the film does not touch the rest of it
  ASSERT_EQ(obscura("render box.toml -o 'f/{frame}.png' --set duration=0.2 --frames 0,1").exit, 0);
  EXPECT_TRUE(std::filesystem::exists(path("f/3.png")));
  // nor does a film what is no frame, or of another scene
  shell("echo mine > f/2.png && cp box.toml disc.toml");
  ASSERT_EQ(obscura("render box.toml -o 'f/{frame}.png'").exit, 0);
  EXPECT_TRUE(std::filesystem::exists(path("f/2.png")));
  ASSERT_EQ(obscura("render box.toml -o 'f/{frame}.png' --set duration=0.2").exit, 0);
  ASSERT_EQ(obscura("render disc.toml -o 'f/{frame}.png'").exit, 0);
  EXPECT_TRUE(std::filesystem::exists(path("f/2.png")));
}

TEST_F(SparedFiles, AFigureForLatexLeavesTheFiguresPdf) {
  ASSERT_EQ(obscura("figure box.toml -o box.svg").exit, 0);
  shell("echo mine > box.pdf");
  const Outcome made = obscura("figure box.toml -o box.tex");
  if (made.exit == 2) GTEST_SKIP() << made.err;  // built without Cairo
  EXPECT_EQ(made.exit, 0);
  EXPECT_EQ(contents(path("box.pdf")), "mine\n");
  EXPECT_TRUE(std::filesystem::exists(path("box-lines.pdf")));
}

TEST_F(SparedFiles, AFolderOfPartsKeepsWhatIsNotItsOwn) {
  shell("mkdir box.mp4.parts && touch box.mp4.parts/thesis.txt");
  EXPECT_EQ(obscura("render box.toml -o box.mp4").exit, 0);
  EXPECT_TRUE(std::filesystem::exists(path("box.mp4.parts/thesis.txt")));
}

TEST_F(SparedFiles, ObstaclesAreToldBeforeTheFilmIsMade) {
  shell("mkdir film.mp4");
  refuses("render box.toml -o film.mp4", 4, "film.mp4: is a folder");
  EXPECT_FALSE(std::filesystem::exists(path("film.mp4.parts")));
  refuses("render box.toml -o box.mp4 --poster soon", 2, "--poster soon");
  EXPECT_FALSE(std::filesystem::exists(path("box.mp4")));
  refuses("render box.toml -o '{camra}.mp4'", 2, "{camra} is not known");
  refuses("render box.toml -o '{frame}{frame}.png'", 2, "{frame} is not known");
}

TEST_F(SparedFiles, GoldenUpdateRemovesMomentsAlone) {
  shell("mkdir golden");
  EXPECT_EQ(obscura("golden box.toml --update").exit, 0);
  EXPECT_EQ(obscura("render box.toml --at 0.05 -o golden/box-poster.png").exit, 0);
  EXPECT_EQ(obscura("render box.toml --at 0.025 -o golden/box-0.025.png").exit, 0);
  const Outcome outcome = obscura("golden box.toml --update");
  EXPECT_TRUE(std::filesystem::exists(path("golden/box-poster.png"))) << outcome.out;
  EXPECT_FALSE(std::filesystem::exists(path("golden/box-0.025.png"))) << outcome.out;
}

TEST_F(SparedFiles, GoldenLooksIntoFoldersOfFolders) {
  shell("mkdir -p suite/deep && cp box.toml suite/one.toml && cp box.toml suite/deep/two.toml");
  EXPECT_THAT(obscura("golden suite").out, HasSubstr("2 scenes"));
}

// A step that is too long for what the scene has is told by every command, and a run that it feeds ends.
TEST_F(SparedFiles, StepsThatAreTooLongAreTold) {
  write("drag.toml", "duration = 1\n[room]\nsize = [8, 800]\ndrag = 5000\nwind = [0, 2]\n[[particle]]\n");
  for (const char* command :
       {"states drag.toml --at 1", "describe drag.toml", "render drag.toml --at 1 -o d.png"}) {
    const Outcome outcome = obscura(command);
    EXPECT_EQ(outcome.exit, 6) << command;
    EXPECT_THAT(outcome.err, HasSubstr("raise physics.rate above")) << command;
  }
  // what pushing it out of walls is said to have given is no source
  write("stiff.toml",
        "duration = 2\n[physics]\nrate = 60\n[room]\nsize = [8, 8]\ngravity = [0, 0]\n[[particle]]\nname = "
        "\"p\"\n"
        "position = [2.001, 4]\n[[spring]]\nbetween = [\"p\", [1, 4]]\nstiffness = 1e7\nrest_length = 1\n");
  EXPECT_EQ(obscura("states stiff.toml --at 2").exit, 6);
  // what the scheme hardly does not stand is told; what it does not at all ends the run
  write("wild.toml", "duration = 1\n[room]\nwalls = \"none\"\ndrag = 2\n[[particle]]\nmass = 0.001\n");
  EXPECT_EQ(obscura("states wild.toml --at 1").exit, 6);
  write("soft.toml", "duration = 1\n[room]\nwalls = \"none\"\ndrag = 1.68\n[[particle]]\nmass = 0.001\n");
  const Outcome outcome = obscura("states soft.toml --at 0.05");
  EXPECT_EQ(outcome.exit, 0);
  EXPECT_THAT(outcome.err, HasSubstr("soft.toml: warning: step 1/600 s is longer than"));
}

}  // namespace
}  // namespace obscura::app

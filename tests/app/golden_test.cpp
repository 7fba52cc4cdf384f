// obscura golden: what is the same passes, what is not fails and says why.

#include <gmock/gmock.h>

#include "driven.h"
#include "needs.h"
#include "program.h"

namespace obscura::app {
namespace {

using testing::HasSubstr;
using testing::Not;

const char* const kScene = R"(duration = 2
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

class Golden : public Program {
 protected:
  void SetUp() override {
    Program::SetUp();
    scene(kScene);
  }
  Outcome golden(const std::string& arguments = "") const {
    return obscura("golden scene.toml " + arguments);
  }
  void change(const std::string& from, const std::string& to) const {
    std::string text = kScene;
    text.replace(text.find(from), from.size(), to);
    scene(text);
  }
};

TEST_F(Golden, AMissingReferenceFailsAndLeavesThePicture) {
  const Outcome run = golden();
  EXPECT_EQ(run.exit, 1);
  EXPECT_THAT(run.out, HasSubstr("golden/scene-0.5.png: there is no such reference"));
  EXPECT_TRUE(std::filesystem::exists(path("render_out/golden/scene-0.5.png")));
  EXPECT_FALSE(std::filesystem::exists(path("golden"))) << "only --update writes references";
}

TEST_F(Golden, WhatWasTakenIsTheSameAndItsPicturesAreThoseOfRender) {
  EXPECT_EQ(golden("--update").exit, 0);
  const Outcome run = golden();
  EXPECT_EQ(run.exit, 0) << run.out;
  EXPECT_THAT(run.out, HasSubstr("2 moments, 2 same"));
  ASSERT_EQ(obscura("render scene.toml --at 0.5 --size 160x90 -o still.png").exit, 0);
  EXPECT_EQ(obscura("compare still.png golden/scene-0.5.png").exit, 0);
  EXPECT_EQ(obscura("verify golden/scene-0.5.png").exit, 0);
}

TEST_F(Golden, AChangeIsNamedLeavesItsDifferenceAndIsTakenByUpdate) {
  ASSERT_EQ(golden("--update").exit, 0);
  change("\"green\"", "\"purple\"");
  Outcome run = golden("--junit out.xml");
  EXPECT_EQ(run.exit, 1);
  EXPECT_THAT(run.out, HasSubstr("ball.color is \"green\" and \"purple\""));
  EXPECT_THAT(run.out, HasSubstr("states are the same: only the drawing differs"));
  EXPECT_TRUE(std::filesystem::exists(path("render_out/golden/scene-0.difference.png")));
  const std::string xml = contents(path("out.xml"));
  EXPECT_THAT(xml, HasSubstr("tests=\"2\" failures=\"2\" errors=\"0\""));
  EXPECT_THAT(xml, HasSubstr("[[ATTACHMENT|"));
  EXPECT_THAT(xml, HasSubstr("&quot;purple&quot;"));
  run = golden("--update");
  EXPECT_EQ(run.exit, 0);
  EXPECT_THAT(run.out, HasSubstr("pixels differ by up to"));
  EXPECT_EQ(golden().exit, 0);
}

TEST_F(Golden, AStateThatDoesNotShowFailsAllTheSame) {
  ASSERT_EQ(golden("--update").exit, 0);
  change("[1, 1]\ncolor", "[1.0000000000000002, 1]\ncolor");
  const Outcome run = golden();
  EXPECT_EQ(run.exit, 1);
  EXPECT_THAT(run.out, HasSubstr("the state is another one, though the picture is the same"));
  EXPECT_THAT(run.out, HasSubstr("states part at step 0 (t = 0 s): body ball, velocity"));
}

// A mass that nothing feels is in neither: it is told all the same.
TEST_F(Golden, AKeyThatShowsInNeitherStateNorPictureIsTold) {
  ASSERT_EQ(golden("--update").exit, 0);
  ASSERT_EQ(obscura("render scene.toml --at 0.5 --size 160x90 -o a.png").exit, 0);
  change("[1, 1]\ncolor", "[1, 1]\nmass = 5\ncolor");
  const Outcome run = golden();
  EXPECT_EQ(run.exit, 0) << run.out;
  EXPECT_THAT(run.out, HasSubstr("state and picture are the same; other scene (scene.toml): ball.mass is "
                                 "left out and 5"));
  ASSERT_EQ(obscura("render scene.toml --at 0.5 --size 160x90 -o b.png").exit, 0);
  const Outcome compared = obscura("compare a.png b.png");
  EXPECT_EQ(compared.exit, 0) << compared.out;
  EXPECT_THAT(compared.out, HasSubstr("states and pictures are the same"));
  EXPECT_THAT(compared.out, testing::Not(HasSubstr("only the drawing differs")));
  scene(kScene);
  EXPECT_THAT(golden().out, testing::Not(HasSubstr("other scene")));
}

TEST_F(Golden, ARecordTellsOfAnotherTextOfTheScene) {
  change("[golden]", "[golden]\nkeep = \"hash\"");
  ASSERT_EQ(golden("--update").exit, 0);
  change("color = \"green\"\n[golden]", "mass = 5\ncolor = \"green\"\n[golden]\nkeep = \"hash\"");
  const Outcome run = golden();
  EXPECT_EQ(run.exit, 0) << run.out;
  EXPECT_THAT(run.out, HasSubstr("state and picture are the same; the text of the scene is another one"));
}

// A plot spans the run: at 0 s both stand alike, and the plot of what follows does not.
TEST_F(Golden, APlotOfARunThatDiffersLaterIsNoDrawingThatDiffers) {
  change("[golden]", "[[film.plot]]\nquantity = [\"vy\"]\nof = \"ball\"\n[golden]");
  ASSERT_EQ(obscura("render scene.toml --at 0 --size 160x90 -o a.png").exit, 0);
  ASSERT_EQ(obscura("render scene.toml --at 0 --size 160x90 -o b.png --set ball.elasticity=0.9").exit, 0);
  const Outcome run = obscura("compare a.png b.png");
  EXPECT_EQ(run.exit, 1) << run.out;
  EXPECT_THAT(run.out, HasSubstr("states are the same at t = 0 s, but not through the run"));
  EXPECT_THAT(run.out, HasSubstr("states part at step"));
  EXPECT_THAT(run.out, testing::Not(HasSubstr("only the drawing differs")));
}

TEST_F(Golden, WhatIsLetPassNeedsAReasonAndPassesWithIt) {
  ASSERT_EQ(golden("--update").exit, 0);
  change("size = [160, 90]", "size = [160, 90]\nstates = false");
  Outcome run = golden();
  EXPECT_EQ(run.exit, 3);
  EXPECT_THAT(run.out, HasSubstr("give it a 'reason'"));
  change(
      "[1, 1]\ncolor = \"green\"\n[golden]",
      "[1.0000000000000002, 1]\ncolor = \"green\"\n[golden]\nstates = false\nreason = \"another compiler\"");
  run = golden();
  EXPECT_EQ(run.exit, 0) << run.out;
  EXPECT_THAT(run.out, HasSubstr("tolerated: another compiler"));
}

TEST_F(Golden, ReferencesAreOfScenesAsTheyStandInTheirFiles) {
  const Outcome run = golden("--update --set ball.color=purple");
  EXPECT_EQ(run.exit, 2);
  EXPECT_THAT(run.err, HasSubstr("--set"));
  EXPECT_FALSE(std::filesystem::exists(path("golden")));
}

TEST_F(Golden, AReferenceOfNoMomentIsToldAndSweptByUpdate) {
  ASSERT_EQ(golden("--update").exit, 0);
  change("[0, 0.5]", "[0]");
  EXPECT_THAT(golden().out, HasSubstr("golden/scene-0.5.png is no moment of the scene any more"));
  ASSERT_EQ(golden("--update").exit, 0);
  EXPECT_FALSE(std::filesystem::exists(path("golden/scene-0.5.png")));
}

TEST_F(Golden, OfAFolderTakesTheScenesWithATable) {
  std::filesystem::create_directories(path("scenes"));
  scene(kScene, "scenes/one.toml");
  scene("duration = 1\n", "scenes/two.toml");
  scene("duration = -1\n[golden]\n", "scenes/broken.toml");
  const Outcome run = obscura("golden --update");
  EXPECT_EQ(run.exit, 3);
  EXPECT_THAT(run.out, HasSubstr("broken.toml:1:12"));
  EXPECT_THAT(run.out, Not(HasSubstr("two")));
  EXPECT_TRUE(std::filesystem::exists(path("scenes/golden/one-0.png")));
}

// Two scenes of one name in two folders: each has references and pictures of what fails of its own.
class TwoOfOneName : public Golden {
 protected:
  void SetUp() override {
    Golden::SetUp();
    for (const char* folder : {"one", "two", "build"}) std::filesystem::create_directories(path(folder));
    scene(kScene, "one/x.toml");
    std::string other = kScene;
    other.replace(other.find("green"), 5, "purple");
    scene(other, "two/x.toml");
  }
  bool is_there(const std::string& name) const { return std::filesystem::exists(path(name)); }
};

TEST_F(TwoOfOneName, HaveReferencesOfTheirOwnHoweverTheyAreNamed) {
  ASSERT_EQ(obscura("golden one/x.toml --references kept --update").exit, 0);
  ASSERT_EQ(obscura("golden two --references kept --update").exit, 0);
  EXPECT_TRUE(is_there("kept/one/x-0.png") && is_there("kept/two/x-0.png"));
  const Outcome run = obscura("golden \"$PWD/one\" ./two/../two/x.toml --references kept");
  EXPECT_EQ(run.exit, 0) << run.out << run.err;
  EXPECT_THAT(run.out, HasSubstr("one/x "));
  EXPECT_THAT(run.out, HasSubstr("two/x "));
  EXPECT_THAT(run.out, HasSubstr("2 scenes, 4 moments, 4 same"));
}

TEST_F(TwoOfOneName, LeavePicturesOfTheirOwn) {
  EXPECT_EQ(obscura("golden one two").exit, 1);
  EXPECT_TRUE(is_there("render_out/golden/one/x-0.png") && is_there("render_out/golden/two/x-0.png"));
  EXPECT_NE(contents(path("render_out/golden/one/x-0.png")), contents(path("render_out/golden/two/x-0.png")));
}

TEST_F(TwoOfOneName, AreRefusedWhereTheyWouldMeet) {
  Outcome run = shell("cd build && " OBSCURA_BINARY " golden ../one ../two");
  EXPECT_EQ(run.exit, 2);
  EXPECT_THAT(run.err, HasSubstr("../one/x.toml and ../two/x.toml are both called x: "
                                 "name a folder that holds both with --root"));
  run = shell("cd build && " OBSCURA_BINARY " golden ../one --references ../kept --update");
  EXPECT_EQ(run.exit, 2);
  EXPECT_THAT(run.err, HasSubstr("../one/x.toml lies outside of the current folder"));
  EXPECT_FALSE(is_there("kept"));
  run = shell("cd build && " OBSCURA_BINARY " golden ../one ../two --root .. --references ../kept --update");
  EXPECT_EQ(run.exit, 0) << run.err;
  EXPECT_TRUE(is_there("kept/one/x-0.png") && is_there("kept/two/x-0.png"));
  run = obscura("golden one two --root two");
  EXPECT_EQ(run.exit, 2);
  EXPECT_THAT(run.err, HasSubstr("--root two: one/x.toml lies outside of it"));
  run = obscura("golden one one/x.toml");
  EXPECT_EQ(run.exit, 2);
  EXPECT_THAT(run.err, HasSubstr("one/x.toml: is named twice"));
  scene(kScene, "one/x.scene");
  run = obscura("golden one/x.toml one/x.scene");
  EXPECT_EQ(run.exit, 2);
  EXPECT_THAT(run.err, HasSubstr("one/x.toml and one/x.scene are both called one/x: rename one of them"));
}

TEST_F(TwoOfOneName, AReferenceThatLiesWhereTheRootWasOnceIsPointedAt) {
  ASSERT_EQ(obscura("golden one --root one --references kept --update").exit, 0);
  EXPECT_TRUE(is_there("kept/x-0.png"));
  const Outcome run = obscura("golden one --references kept");
  EXPECT_EQ(run.exit, 1);
  EXPECT_THAT(run.out, HasSubstr("kept/x-0.png would be it with --root one"));
}

TEST_F(Golden, PicturesOfAnEarlierFailureGo) {
  ASSERT_EQ(golden("--update").exit, 0);
  change("\"green\"", "\"purple\"");
  ASSERT_EQ(golden().exit, 1);
  ASSERT_TRUE(std::filesystem::exists(path("render_out/golden/scene-0.5.difference.png")));
  // what is of other scenes, or no picture of a moment, stays
  for (const char* name : {"scene-1-0.png", "scene-0.5.txt", "scene-nan.png", "scenery-0.png"})
    std::ofstream(path(std::string("render_out/golden/") + name)) << "mine";
  scene(kScene);
  ASSERT_EQ(golden().exit, 0);
  std::vector<std::string> left;
  for (const auto& entry : std::filesystem::directory_iterator(path("render_out/golden")))
    left.push_back(entry.path().filename().string());
  EXPECT_THAT(left, testing::UnorderedElementsAre("scene-1-0.png", "scene-0.5.txt", "scene-nan.png",
                                                  "scenery-0.png"));
}

TEST_F(Golden, PicturesOfWhatFailsDoNotGoWhereTheReferencesAre) {
  ASSERT_EQ(golden("--update").exit, 0);
  const std::string reference = contents(path("golden/scene-0.png"));
  change("\"green\"", "\"purple\"");
  const Outcome run = golden("--actual golden");
  EXPECT_EQ(run.exit, 2);
  EXPECT_THAT(run.err, HasSubstr("--actual golden: the references are there, and would be overwritten"));
  EXPECT_EQ(contents(path("golden/scene-0.png")), reference);
}

TEST_F(Golden, OnAnotherOpenGlStatesAreComparedAloneIfAskedFor) {
  ASSERT_EQ(golden("--update").exit, 0);
  // drawn with other instructions it is another OpenGL's; the colour is what that one would do otherwise
  ASSERT_EQ(
      obscura("render scene.toml --at 0 --size 160x90 --native --set ball.color=purple -o golden/scene-0.png")
          .exit,
      0);
  EXPECT_EQ(golden().exit, 1);
  const Outcome run = golden("--other-gl-states");
  EXPECT_EQ(run.exit, 0) << run.out;
  EXPECT_THAT(run.out, HasSubstr("the state is the same; drawn by another OpenGL"));
  // on the same OpenGL it excuses nothing
  ASSERT_EQ(
      obscura("render scene.toml --at 0 --size 160x90 --set ball.color=purple -o golden/scene-0.png").exit,
      0);
  EXPECT_EQ(golden("--other-gl-states").exit, 1);
}

TEST_F(Golden, OnlyTheMomentThatIsNamedIsTaken) {
  ASSERT_EQ(golden("--update").exit, 0);
  std::filesystem::copy_file(path("golden/scene-0.png"), path("golden/scene-1.75.png"));
  change("\"green\"", "\"purple\"");
  const std::string before = contents(path("golden/scene-0.png"));
  Outcome run = golden("--update --only scene@0.5");
  EXPECT_EQ(run.exit, 0) << run.out << run.err;
  EXPECT_THAT(run.out, HasSubstr("1 moment, 1 updated"));
  EXPECT_EQ(contents(path("golden/scene-0.png")), before);
  EXPECT_TRUE(std::filesystem::exists(path("golden/scene-1.75.png"))) << "what was not named is left alone";
  run = golden();
  EXPECT_EQ(run.exit, 1);
  EXPECT_THAT(run.out, HasSubstr("1 differs, 1 same"));
  EXPECT_EQ(golden("--only scene@1/2").exit, 0);
}

TEST_F(Golden, AMomentThatIsNotThereIsAUsageError) {
  Outcome run = golden("--only scene@0.7");
  EXPECT_EQ(run.exit, 2);
  EXPECT_THAT(run.err, HasSubstr("--only scene@0.7: its moments are 0, 0.5"));
  run = golden("--only scone@0.5");
  EXPECT_EQ(run.exit, 2);
  EXPECT_THAT(run.err, HasSubstr("did you mean 'scene'?"));
  for (const char* wrong : {"scene", "@0.5", "scene@", "scene@x"}) {
    run = golden(std::string("--only ") + wrong);
    EXPECT_EQ(run.exit, 2) << wrong;
    EXPECT_THAT(run.err, HasSubstr("expected SCENE@SECONDS, as in room@2.5")) << wrong;
  }
}

TEST_F(Golden, WhatIsApprovedOnThePageIsWrittenAndNothingElse) {
  OBSCURA_NEEDS(media::browser(), "chromium-headless-shell");
  const std::string name = "it's a scene.toml", reference = path("golden/it's a scene-0.5.png");
  const auto colored = [&](const std::string& color) {
    std::string text = kScene;
    scene(text.replace(text.find("green"), 5, color), name);
  };
  colored("green");
  ASSERT_EQ(obscura("golden \"it's a scene.toml\" --update").exit, 0);
  colored("purple");
  ASSERT_EQ(obscura("golden \"it's a scene.toml\" --report report.html").exit, 1);
  // the second of two
  const std::string said = drive(contents(path("report.html")), R"js(
    many(".take input")[1].click();
    more = btoa(one(".approve code").textContent);
  )js",
                                 folder_.string());
  ASSERT_EQ(said.substr(0, 5), "PASS ") << said;
  const std::string encoded = said.substr(5, said.find(' ', 5) - 5);
  const std::string run =
      "obscura() { " OBSCURA_BINARY " \"$@\"; }; eval \"$(echo " + encoded + " | base64 -d)\"";

  // meanwhile there is another picture: that one was not approved
  const std::string before = contents(reference);
  colored("orange");
  Outcome outcome = shell(run);
  EXPECT_EQ(outcome.exit, 1) << outcome.out << outcome.err;
  EXPECT_THAT(outcome.out, HasSubstr("it is not the picture that was approved: look at it again"));
  EXPECT_EQ(contents(reference), before);

  colored("purple");
  outcome = shell(run);
  EXPECT_EQ(outcome.exit, 0) << outcome.out << outcome.err;
  EXPECT_NE(contents(reference), before);
  outcome = obscura("golden \"it's a scene.toml\"");
  EXPECT_EQ(outcome.exit, 1);
  EXPECT_THAT(outcome.out, HasSubstr("1 differs, 1 same"));
}

TEST_F(Golden, WhatSetChangedIsNotApprovedOnThePage) {
  ASSERT_EQ(golden("--update").exit, 0);
  ASSERT_EQ(golden("--set ball.color=purple --report report.html").exit, 1);
  const std::string page = contents(path("report.html"));
  EXPECT_THAT(page, HasSubstr("data-state=\"differs\""));
  EXPECT_THAT(page, Not(HasSubstr("type=\"checkbox\"")));
}

TEST_F(Golden, ThePageHasEveryMomentWhatDiffersFirst) {
  ASSERT_EQ(golden("--update").exit, 0);
  // later, when the second moment shows it, the ball is elsewhere
  change("[1, 1]\ncolor", "[1.5, 1]\ncolor");
  ASSERT_EQ(obscura("render scene.toml --at 0 --size 160x90 -o golden/scene-0.png").exit, 0);
  ASSERT_EQ(golden("--report report.html").exit, 1);
  const std::string page = contents(path("report.html"));
  const std::size_t differs = page.find("data-state=\"differs\""), same = page.find("data-state=\"same\"");
  EXPECT_LT(differs, same);
  EXPECT_NE(same, std::string::npos);
  EXPECT_THAT(page, HasSubstr("scene, t = 0.5 s"));
  EXPECT_THAT(page, HasSubstr("ball.velocity is [1, 1] and [1.5, 1]"));
  EXPECT_THAT(page, HasSubstr("OpenGL ")) << "what drew the two is said";
}

}  // namespace
}  // namespace obscura::app

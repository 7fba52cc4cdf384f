// obscura describe: sentences whose numbers are the run's, and the text that a picture carries for those who
// do not see it.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>

#include "media/png.h"
#include "program.h"

namespace obscura::app {
namespace {

using testing::HasSubstr;
using testing::Not;

using Describe = Program;

// falls 1 m from rest: 0.4515 s, 4.429 m/s
const char* const kFall = R"(title = "A fall"
duration = 2
[room]
size = [4, 3]
gravity = [0, -9.81]
[[ball]]
name = "big_ball"
radius = 0.25
position = [2, 1.25]
elasticity = 0
[[film.caption]]
text = "It hits."
start = 0.5
)";

TEST_F(Describe, SaysWhatHitsWhatWhenAndHowFast) {
  scene(kFall);
  const Outcome run = obscura("describe scene.toml");
  ASSERT_EQ(run.exit, 0) << run.err;
  EXPECT_THAT(run.out, HasSubstr("A fall.\n"));
  EXPECT_THAT(run.out, HasSubstr("In the plane there is one disc; gravity is 9.81 m/s²."));
  EXPECT_THAT(run.out, HasSubstr("starts at (2, 1.25) m, at rest."));
  EXPECT_THAT(run.out, testing::ContainsRegex("At 0\\.45[0-9]* s .* hits the floor at 4\\.4[0-9]* m/s\\."));
  EXPECT_THAT(run.out, HasSubstr("The film says at 0.5 s: \"It hits.\""));
  EXPECT_THAT(run.out, testing::ContainsRegex("comes to rest at 0\\.[0-9]* s, at \\(2, 0\\.25\\) m"));
  // m g h of a disc of 1 kg falls by 9.81 J
  EXPECT_THAT(run.out, HasSubstr("The energy goes from "));
  // once, and not at every step that it lies there
  EXPECT_EQ(run.out.find("hits the floor"), run.out.rfind("hits the floor"));
}

// a pendulum that is let go level is lowest after K(sqrt(1/2)) sqrt(l / g) = 0.5295 s, with sqrt(2 g l)
TEST_F(Describe, SaysWhenABodyIsFastestAndNotWhenItNearlyIs) {
  scene(R"(duration = 2
[room]
size = [2, 2]
walls = "none"
gravity = [0, -9.81]
[[particle]]
name = "bob"
position = [1.8, 1.2]
[[joint]]
type = "rod"
between = [[1, 1.2], "bob"]
)");
  EXPECT_THAT(obscura("describe scene.toml").out,
              testing::ContainsRegex("fastest at 0\\.5(29|3)[0-9]* s, with 3\\.96 m/s"));
}

// bodies that an event joins are joined when it happens, at 0.25 s, not where the step of 0.1 s ends
TEST_F(Describe, TellsWhenBodiesAreJoined) {
  scene(R"toml(duration = 1
[room]
size = [8, 4]
walls = "none"
gravity = [0, 0]
[physics]
rate = 10
collision = "event"
[[ball]]
name = "bullet"
radius = 0.1
position = [1, 2]
velocity = [4, 0]
[[ball]]
name = "block"
radius = 0.1
position = [2.2, 2]
[[when]]
touches = ["bullet", "block"]
do = [{ stick = true }]
)toml");
  const Outcome run = obscura("describe scene.toml");
  ASSERT_EQ(run.exit, 0) << run.err;
  EXPECT_THAT(run.out, HasSubstr("At 0.25 s the bullet and the block are joined."));
}

// a push there and back leaves the energy as it was, but not in between
TEST_F(Describe, TellsOfEnergyThatComesAndGoes) {
  scene(R"toml(duration = 2
[room]
size = [20, 4]
walls = "none"
gravity = [0, 0]
[[ball]]
radius = 0.1
mass = 1
[[force]]
components = ["if(t < 1, 3, -3)", "0"]
)toml");
  const Outcome run = obscura("describe scene.toml");
  ASSERT_EQ(run.exit, 0) << run.err;
  EXPECT_THAT(run.out, HasSubstr("The energy is 0 J at the start and at the end, up to 4.5 J at 1 s."));
}

/// Marks, what conditions let go, what arrows and plots show, and words that come at an instant.
TEST_F(Describe, TellsOfMarksAndOfWhatIsShown) {
  scene(R"(title = 'It falls by $\frac{1}{2} g t^2$'
duration = 1
[room]
size = [4, 3]
[[ball]]
name = "bob"
radius = 0.1
position = [2, 2]
[[joint]]
name = "thread"
type = "rod"
between = [[2, 2.8], "bob"]
[[when]]
time = 0.25
do = [{ release = "thread" }, { mark = "cut" }]
[film]
figure = true
[[film.vector]]
quantity = "joint_force"
of = "bob"
[[film.vector]]
quantity = "weight"
of = "bob"
[[film.plot]]
quantity = ["height"]
of = "bob"
[[film.label]]
at = "bob"
text = '"free"'
start = "cut"
)");
  const Outcome run = obscura("describe scene.toml");
  ASSERT_EQ(run.exit, 0) << run.err;
  EXPECT_THAT(run.out, HasSubstr("It falls by ½ g t².\n"));
  EXPECT_THAT(run.out, HasSubstr("Arrows show joint force and weight of the bob."));
  EXPECT_THAT(run.out, HasSubstr("A plot shows height of the bob over time."));
  EXPECT_THAT(run.out, HasSubstr("At 0.25 s is the mark \"cut\"."));
  EXPECT_THAT(run.out, HasSubstr("joint thread is let go"));
  EXPECT_THAT(run.out, HasSubstr("The film says at 0.25 s: \"free\""));
  EXPECT_THAT(run.out, Not(HasSubstr("breaks")));
}

// Cards say what they say where the run stands still for them.
TEST_F(Describe, TellsWhatCardsSay) {
  scene(
      "duration = 2\n[room]\nsize = [4, 3]\n[[ball]]\nname = \"ball\"\nradius = 0.2\nposition = [2, 2.5]\n"
      "[film]\nspeed = [{ time = 0.3, freeze = 1 }]\n[[film.card]]\ntitle = \"Part one\"\n"
      "text = \"a ball falls by $g$\"\n[[film.card]]\ntitle = \"Part two\"\ntime = 1.5\nlasting = 1\n"
      "[[film.card]]\ntext = \"The end\"\ntime = 2\nlasting = 1\n");
  const Outcome run = obscura("describe scene.toml");
  ASSERT_EQ(run.exit, 0) << run.err;
  EXPECT_THAT(run.out, HasSubstr("A card says at 0 s: \"Part one: a ball falls by g\""));
  EXPECT_THAT(run.out, HasSubstr("A card says at 1.5 s: \"Part two\""));
  EXPECT_THAT(run.out, HasSubstr("A card says at 2 s: \"The end\""));
}

// In space, along which axes: what is to the right is the camera's business.
TEST_F(Describe, TellsAlongWhichAxesItFliesInSpace) {
  scene(
      "duration = 0.1\n[room]\nsize = [9, 3, 9]\n[[ball]]\nname = \"a\"\nradius = 0.1\nposition = [0, 1, 0]\n"
      "velocity = [3, 2.5, -0.6]\n[[ball]]\nname = \"c\"\nradius = 0.1\nposition = [0, 1, 2]\n"
      "velocity = [-2, 0.2, -2]\n");
  const Outcome run = obscura("describe scene.toml");
  ASSERT_EQ(run.exit, 0) << run.err;
  EXPECT_THAT(run.out, HasSubstr("The a starts at (0, 1, 0) m, at 3.95 m/s along x and up.\n"));
  EXPECT_THAT(run.out, HasSubstr("The c starts at (0, 1, 2) m, at 2.84 m/s along −x and along −z.\n"));
}

// A body that turns on the spot is not said to stand still; about its middle axis it turns over.
TEST_F(Describe, WallsOfSpaceHaveTheirNames) {
  scene(R"(duration = 1
[room]
size = [4, 4, 4]
gravity = [0, 0, 0]
[[ball]]
name = "a"
radius = 0.1
position = [0, 1, 0]
velocity = [0, 0, -3]
[[ball]]
name = "b"
radius = 0.1
position = [1, 1, 0]
velocity = [0, 0, 3]
)");
  const Outcome run = obscura("describe scene.toml");
  ASSERT_EQ(run.exit, 0) << run.err;
  EXPECT_THAT(run.out, HasSubstr("hits the back wall at"));
  EXPECT_THAT(run.out, HasSubstr("hits the front wall at"));
}

TEST_F(Describe, TellsOfWhatTurns) {
  scene(
      "duration = 2\n[room]\nsize = [4, 3]\nwalls = \"none\"\ngravity = [0, 0]\n[[box]]\nname = \"wheel\"\n"
      "size = [0.6, 0.4]\nposition = [2, 1.5]\nspin = 90\n");
  const Outcome run = obscura("describe scene.toml");
  ASSERT_EQ(run.exit, 0) << run.err;
  EXPECT_THAT(run.out, HasSubstr("the wheel is at (2, 1.5) m and turns at 1.57 rad/s."));

  scene(
      "duration = 12\n[room]\nsize = [3, 3, 3]\nwalls = \"none\"\ngravity = [0, 0, 0]\n[[box]]\n"
      "name = \"slab\"\nsize = [1, 0.4, 0.1]\nposition = [0, 1.5, 0]\nspin = [0.5, 300, 0.5]\n");
  const Outcome over = obscura("describe scene.toml");
  ASSERT_EQ(over.exit, 0) << over.err;
  EXPECT_THAT(over.out, testing::ContainsRegex("The slab turns over [0-9]+ times, first at "));
  EXPECT_THAT(over.out, Not(HasSubstr("does not move")));

  // neither what swings to and fro does, nor what rolls about its length while it tumbles
  const std::string swings =
      "[[box]]\nname = \"bob\"\nsize = [0.2, 0.4, 0.2]\nposition = [0.5, 1.5, 0]\nspin = [0, 0, -30]\n"
      "[[joint]]\ntype = \"hinge\"\nbetween = [\"bob\", [0, 1.5, 0]]\naxis = [0, 0, 1]\n";
  const std::string rolls =
      "gravity = [0, 0, 0]\n[[box]]\nname = \"bob\"\nsize = [1, 0.2, 0.2]\nposition = [0, 1.5, 0]\n"
      "spin = [200, 400, 0]\n";
  for (const std::string& bodies : {swings, rolls}) {
    scene("duration = 6\n[room]\nsize = [3, 3, 3]\nwalls = \"none\"\n" + bodies);
    const Outcome not_over = obscura("describe scene.toml");
    ASSERT_EQ(not_over.exit, 0) << not_over.err;
    EXPECT_THAT(not_over.out, Not(HasSubstr("turns over"))) << bodies;
  }
}

// What holds lets go: bonds break, fixed bodies are let go at a time or by an event, one is held.
TEST_F(Describe, TellsOfBondsAndOfWhatIsLetGoAndHeld) {
  scene(R"(duration = 1
[room]
size = [4, 3]
[[box]]
name = "left"
size = [0.2, 0.2]
position = [1, 1.5]
[[box]]
name = "right"
size = [0.2, 0.2]
position = [1.2, 1.5]
[[bond]]
of = ["left", "right"]
breaks = 0.001
)");
  const Outcome bond = obscura("describe scene.toml");
  ASSERT_EQ(bond.exit, 0) << bond.err;
  EXPECT_THAT(bond.out, HasSubstr("one bond; gravity"));
  EXPECT_THAT(bond.out,
              testing::ContainsRegex("At 0\\.[0-9]* s the bond of the left and the right breaks\\."));

  scene(R"(duration = 1
[room]
size = [4, 3]
[[ball]]
name = "late"
radius = 0.1
position = [2, 2]
fixed = true
release = 0.2
[[ball]]
name = "ball"
radius = 0.1
position = [3, 1]
fixed = true
[[when]]
time = 0.3
do = [{ release = "ball" }]
[[when]]
time = 0.4
do = [{ set = "ball.fixed", to = true }]
)");
  const Outcome run = obscura("describe scene.toml");
  ASSERT_EQ(run.exit, 0) << run.err;
  EXPECT_THAT(run.out, HasSubstr("At 0.2 s the late is let go."));
  EXPECT_THAT(run.out, HasSubstr("At 0.3 s the ball is let go."));
  EXPECT_THAT(run.out, HasSubstr("At 0.4 s the ball is held where it is."));
}

// What moves bodies: a hand, an explosion. Boxes that cannot turn are boxes in every pose.
TEST_F(Describe, TellsOfHandsAndExplosions) {
  scene(R"(duration = 2
[room]
size = [4, 3]
[physics]
rotation = false
[[box]]
name = "crate"
size = [0.4, 0.4]
position = [1, 0.2]
[[box]]
size = [0.4, 0.2]
position = [3, 0.5]
angle = 30
arrows = ["velocity"]
[[mouse]]
path = [[0.5, 1, 0.2], [1.5, 1.5, 1]]
[[explosion]]
center = [2, 0.1]
strength = 1
start = 0.25
duration = 0.1
)");
  const Outcome run = obscura("describe scene.toml");
  ASSERT_EQ(run.exit, 0) << run.err;
  EXPECT_THAT(run.out, HasSubstr("In the plane there are 2 boxes;"));
  EXPECT_THAT(run.out, HasSubstr("Arrows show velocity of "));
  EXPECT_THAT(run.out, HasSubstr("At 0.25 s there is an explosion at (2, 0.1) m, which lasts 0.1 s."));
  EXPECT_THAT(run.out, testing::ContainsRegex(
                           "From 0\\.5[0-9]* s to 1\\.[0-9]* s a hand's spring pulls the crate\\."));
}

// sqrt(2 g h) = 4.429 m/s, half of that after it: not the speed with which the step began; a millionth as
// large too
TEST_F(Describe, TellsTheSpeedOfAnImpactInRoomsOfEverySize) {
  for (const char* const unit : {"", "e-6"}) {
    const auto m = [&](const char* number) { return std::string(number) + unit; };
    scene("duration = 1\n[room]\nsize = [" + m("4") + ", " + m("3") + "]\ngravity = [0, " + m("-9.81") +
          "]\n[[ball]]\nname = \"ball\"\nradius = " + m("0.25") + "\nposition = [" + m("2") + ", " +
          m("1.25") + "]\nelasticity = 0.5\n");
    const Outcome run = obscura("describe scene.toml");
    ASSERT_EQ(run.exit, 0) << run.err;
    EXPECT_THAT(run.out, HasSubstr("starts at (" + m("2") + ", " + m("1.25") + ") m, at rest."));
    EXPECT_THAT(run.out, HasSubstr("At 0.452 s the ball hits the floor at " + m("4.43") + " m/s."));
    EXPECT_THAT(run.out, HasSubstr("At 0.903 s the ball hits the floor at " + m("2.21") + " m/s."));
  }
}

TEST_F(Describe, SaysNothingOfWhatComesAfterAStop) {
  const std::string run_of_a_second =
      "duration = 3\n[room]\nsize = [4, 3]\n[[ball]]\nname = \"ball\"\nposition = [2, 1]\n"
      "[[film.caption]]\ntext = \"First.\"\nstart = 0.5\n[[film.caption]]\ntext = \"Second.\"\nstart = 2\n";
  scene(run_of_a_second + "[[when]]\ntime = 1\ndo = [{ stop = true }]\n");
  const Outcome run = obscura("describe scene.toml");
  ASSERT_EQ(run.exit, 0) << run.err;
  EXPECT_THAT(run.out, HasSubstr("\"First.\""));
  EXPECT_THAT(run.out, Not(HasSubstr("Second.")));
  // without the stop it is a mistake to say something after the end
  scene(run_of_a_second + "[[film.caption]]\ntext = \"Third.\"\nstart = 4\n");
  const Outcome late = obscura("check scene.toml");
  EXPECT_EQ(late.exit, 3);
  EXPECT_THAT(late.err, HasSubstr("a caption from 4 s on is never shown: the scene ends at 3 s"));
  // but a shorter run that is asked for leaves out what comes later
  scene(run_of_a_second);
  EXPECT_EQ(obscura("check scene.toml --set duration=1").exit, 0);
}

TEST_F(Describe, SaysNothingOfWhatDoesNotCome) {
  scene(
      "duration = 1\n[room]\nsize = [4, 3]\ngravity = [0, 0]\n[[ball]]\nname = \"hub\"\nradius = 0.2\n"
      "position = [2, 1]\nspin = 180\n[[force]]\nof = \"hub\"\ncomponents = [\"0\", \"1\"]\n"
      "[[when]]\ntouches = [\"hub\", \"left\"]\ndo = [{ mark = \"hit\" }]\n"
      "[[film.caption]]\ntext = \"Hit.\"\nstart = \"hit\"\n");
  const Outcome run = obscura("describe scene.toml");
  ASSERT_EQ(run.exit, 0) << run.err;
  EXPECT_THAT(run.out, HasSubstr("forces of the scene"));
  EXPECT_THAT(run.out, HasSubstr("turning at 3.14 rad/s"));
  EXPECT_THAT(run.out, Not(HasSubstr("there is no gravity")));
  EXPECT_THAT(run.out, Not(HasSubstr("The film says")));
}

TEST_F(Describe, TellsOfManyTogether) {
  scene(
      "duration = 1\n[room]\nsize = [4, 3]\n[[ball]]\nname = \"drop\"\nradius = 0.05\nposition = [0.2, 1]\n"
      "copies = { count = 30, offset = [0.12, 0.01] }\n");
  const Outcome run = obscura("describe scene.toml");
  ASSERT_EQ(run.exit, 0) << run.err;
  EXPECT_THAT(run.out, HasSubstr("30 discs"));
  EXPECT_THAT(run.out, HasSubstr("impacts: the first at "));
  EXPECT_LT(std::count(run.out.begin(), run.out.end(), '\n'), 12);
}

TEST_F(Describe, PicturesSayWhatTheyShow) {
  scene(kFall);
  ASSERT_EQ(obscura("render scene.toml --at 0 --size 320x180 -o a.png").exit, 0);
  const auto tags = media::read_png(path("a.png")).tags;
  ASSERT_TRUE(tags.contains("Description"));
  EXPECT_EQ(tags.at("Description"),
            "A fall. One disc at 0 s. The big ball is at (2, 1.25) m and does not move.");
  ASSERT_EQ(obscura("figure scene.toml --at 0,0.3 -o a.svg").exit, 0);
  const std::string svg = contents(path("a.svg"));
  EXPECT_THAT(svg, HasSubstr("role=\"img\""));
  EXPECT_THAT(svg, HasSubstr("<desc>(a) A fall. One disc at 0 s."));
  EXPECT_THAT(svg, HasSubstr("(b) One disc at 0.3 s."));
  if (obscura("figure scene.toml --at 0 -o a.pdf").exit == 0) {
    EXPECT_THAT(contents(path("a.pdf")), HasSubstr("/Subject"));
    if (installed("pdfinfo")) {
      EXPECT_THAT(shell("pdfinfo a.pdf").out, testing::ContainsRegex("Tagged: +yes"));
      EXPECT_THAT(shell("pdfinfo -struct a.pdf").out, HasSubstr("Figure"));
    }
  }
}

}  // namespace
}  // namespace obscura::app

// --set: any key by its path, with the same complaints as in the file.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "scene/error.h"
#include "scene/scene.h"

namespace obscura::scene {
namespace {

using testing::ElementsAre;

using Vec = sim::Vec<2>;

constexpr const char* kScene = R"(title = "t"
[room]
size = [8, 4]
[[particle]]
name = "ball"
position = [1, 1]
elasticity = { from = 0, to = 1 }
copies = { count = 5, offset = [0.5, 0], jitter = 0.01 }
[[box]]
name = "crate"
position = [5, 2]
[[box]]
[[mouse]]
path = [[0, 1, 1], [1, 2, 2]]
)";

Scene with(const std::vector<std::string>& sets) { return parse(kScene, "a.toml", sets); }

void refused(const std::vector<std::string>& sets, const std::string& line) {
  try {
    with(sets);
    ADD_FAILURE() << sets.front() << " is taken";
  } catch (const Error& error) {
    EXPECT_EQ(error.what(), line);
  }
}

TEST(Overrides, ReachEveryKindOfKey) {
  const Scene it =
      with({"crate.elasticity=0.5", "room.gravity=[0, -1.6]", "film.fps=30000/1001", "seed=4",
            "mouse[0].stiffness=7", "look.theme=screen", "title=The room = mine", "crate.position.y=1.5",
            "box[1].density = 2", "look.trails={ crate = 2 }", "physics.rate=1000"});
  EXPECT_EQ(it.plane().model.bodies[5].elasticity, 0.5);
  EXPECT_EQ(it.plane().model.gravity, Vec(0, -1.6));
  EXPECT_EQ(it.film.fps, sim::rational(30000, 1001));
  EXPECT_EQ(it.seed, 4u);
  EXPECT_EQ(it.plane().model.mice[0].stiffness, 7);
  EXPECT_EQ(it.look.theme, draw::Theme::screen);
  EXPECT_EQ(it.look.title, "The room = mine");
  EXPECT_EQ(it.plane().state.x[5], Vec(5, 1.5));
  EXPECT_DOUBLE_EQ(it.plane().model.bodies[6].mass, 0.8);
  EXPECT_EQ(it.look.bodies[5].trail, 2);
  EXPECT_EQ(it.plane().model.rate, sim::rational(1000));
  EXPECT_EQ(it.sets.size(), 11u);
  EXPECT_EQ(it.text, kScene);
}

TEST(Overrides, ReachIntoListsAndDefaults) {
  const Scene it =
      with({"mouse[0].path[1][2]=3", "room.gravity.y=-1", "ball.copies.count=3", "film.size[0]=640"});
  EXPECT_EQ(it.plane().model.mice[0].path[1].place, Vec(2, 3));
  EXPECT_EQ(it.plane().model.gravity, Vec(0, -1));
  EXPECT_EQ(it.plane().model.particles(), 3);
}

TEST(Overrides, OneCopyOfMany) {
  const Scene plain = with({});
  const Scene it =
      with({"ball[3].position.y=2", "ball[3].mass=7", "ball[1].fixed=true", "ball[0].color=#f00"});
  EXPECT_EQ(it.plane().state.x[3], Vec(plain.plane().state.x[3].x(), 2));
  EXPECT_EQ(it.plane().model.bodies[3].mass, 7);
  EXPECT_EQ(it.plane().model.bodies[3].elasticity, 0.75);
  EXPECT_TRUE(it.plane().model.bodies[1].fixed);
  EXPECT_EQ(it.look.bodies[0].color, draw::color("#f00"));
  for (int i : {0, 1, 2, 4}) {
    EXPECT_EQ(it.plane().state.x[i], plain.plane().state.x[i]) << i;
    EXPECT_EQ(it.plane().model.bodies[i].mass, 1) << i;
  }
}

TEST(Overrides, OfAMassTakesThePlaceOfADensityAndTheOtherWayRound) {
  const auto mass = [](const std::string& has, const std::string& set) {
    return std::get<sim::World<2>>(parse("[[box]]\nname = 'b'\nsize = [1, 1]\n" + has, "a.toml", {set}).world)
        .model.bodies[0]
        .mass;
  };
  EXPECT_EQ(mass("density = 3\n", "b.mass=2"), 2);
  EXPECT_EQ(mass("mass = 2\n", "b.density=3"), 3);
}

TEST(Overrides, TheLastOneWins) { EXPECT_EQ(with({"seed=1", "seed=2"}).seed, 2u); }

TEST(Overrides, AreCheckedAsTheFileIs) {
  refused({"crate.elasticty=0.5"},
          "--set crate.elasticty=0.5: unknown key 'elasticty' in [[box]]; did you mean 'elasticity'?");
  refused({"crate.elasticity=2"}, "--set crate.elasticity=2: 'elasticity' must be between 0 and 1, got 2");
  refused({"crate.mass=heavy"},
          "--set crate.mass=heavy: 'mass': expected a number of kilograms, got the string \"heavy\"");
  refused({"crat.mass=1"}, "--set crat.mass=1: nothing here is called 'crat'; did you mean 'crate'?");
  refused({"rom.size=[1, 1]"}, "--set rom.size=[1, 1]: nothing here is called 'rom'; did you mean 'room'?");
  refused({"ball[9].mass=1"}, "--set ball[9].mass=1: 'ball' has 5 copies: ball[0] .. ball[4]");
  refused({"crate[0].mass=1"}, "--set crate[0].mass=1: 'crate' has no copies");
  refused({"ball[2].mass=-1"}, "--set ball[2].mass=-1: 'mass' must be positive, got -1");
  refused({"ball[2].name=x"}, "--set ball[2].name=x: 'name' is one for all copies; set ball.name");
  refused({"box.mass=1"}, "--set box.mass=1: which of them? The scene has 2 [[box]]: box[0] .. box[1]");
  refused({"spring[0].damping=1"}, "--set spring[0].damping=1: the scene has no [[spring]]");
  refused({"seed"}, "--set seed: expected KEY=VALUE, such as crate.elasticity=0.5");
  refused(
      {"=3"},
      "--set =3: is not a path; expected one such as crate.elasticity, room.gravity or ball[3].position.y");
  refused({"seed="}, "--set seed=: expected a value after =");
  refused({"room.size=[1"}, "--set room.size=[1: not TOML: a bracket is opened here and not closed");
  refused({"seed=1\nduration=2"}, "--set seed=1 duration=2: expected one value after =");
  refused({"crate.position.z=1"}, "--set crate.position.z=1: a list has no 'z'; expected x or y");
  refused({"seed.x=1"}, "--set seed.x=1: 'x' is asked of 0, which is no table");
  refused({"crate=3"}, "--set crate=3: expected a key of 'crate', such as crate.position=...");
  refused(
      {"crate.position=[9, 1]"},
      "--set crate.position=[9, 1]: 'crate' is outside the room: 1.4 m beyond the right wall (a.toml:3:8)");
}

TEST(Overrides, ComeAfterTheFilesOwnComplaints) {
  try {
    parse("sed = 1", "a.toml", {"seed=-1"});
  } catch (const Error& error) {
    ASSERT_EQ(error.complaints.size(), 2u);
    EXPECT_EQ(error.complaints[0].file, "a.toml");
    EXPECT_EQ(error.complaints[1].file, "--set seed=-1");
  }
}

}  // namespace
}  // namespace obscura::scene

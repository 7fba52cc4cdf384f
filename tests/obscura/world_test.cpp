// Worlds: steps, states, forces of a program, contacts and events between steps.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <filesystem>
#include <functional>
#include <limits>
#include <map>
#include <semaphore>
#include <thread>
#include <utility>

#include "obscura/obscura.h"
#include "where.h"

namespace obscura {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;

const fs::path kScenes = fs::path(OBSCURA_SOURCE_DIR) / "scenes";

Scene scene_named(const std::string& name) { return Scene::read((kScenes / (name + ".toml")).string()); }

// bodies far from walls, under no gravity, with no forces of their own
Scene balls(int n, double rate, const std::string& more = "") {
  std::string text =
      "[room]\nsize = [4, 4]\nwalls = \"none\"\ngravity = [0, 0]\n[physics]\nrate = " + std::to_string(rate) +
      "\n" + more;
  for (int i = 0; i < n; ++i)
    text += "[[ball]]\nname = \"b" + std::to_string(i) + "\"\nradius = 0.01\nmass = 2\nposition = [" +
            std::to_string(3 - 0.07 * i) + ", 2]\nvelocity = [0, 1]\n";
  return Scene::parse(text);
}

// f = -8 (x - 2), a full turn in pi seconds at m = 2
void spring(const Stage& stage, const Push& push) {
  const std::size_t d = stage.positions.columns;
  for (std::size_t i = 0; i < stage.positions.size(); ++i)
    push.forces[i] = i % d < 2 ? -8 * (stage.positions.first[i] - 2) : 0;
}

TEST(Force, OfAProgramKeepsTheOrderOfTheScheme) {
  const auto error = [](double rate) {
    World world(balls(1, rate).with_force("spring", spring));
    world.step_to(1);
    const double w = 2, t = world.time();
    return std::hypot(world.positions()(0, 0) - (2 + std::cos(w * t)),
                      world.positions()(0, 1) - (2 + std::sin(w * t) / w));
  };
  const double order = std::log2(error(20) / error(40));
  EXPECT_NEAR(order, 4.0, 0.1);
}

TEST(Force, OfAProgramIsTheSameAsThatOfAFormula) {
  const std::string formula = "[[force]]\nname = \"spring\"\ncomponents = [\"-8*(x-2)\", \"-8*(y-2)\"]\n";
  World program(balls(5, 100).with_force("spring", spring)), text(balls(5, 100, formula));
  // before they meet in the middle
  program.step(60), text.step(60);
  for (std::size_t i = 0; i < program.positions().size(); ++i)
    EXPECT_NEAR(program.positions().first[i], text.positions().first[i], 1e-12);
  // and its work is booked
  EXPECT_NEAR(program.energies().work, text.energies().work, 1e-9);
  EXPECT_NEAR(program.energies().kinetic - program.energies().work, 5 * 0.5 * 2 * 1, 1e-6);
}

TEST(Force, IsCalledOnceAStageForAllBodies) {
  // four stages of Runge-Kutta, and two points at which work is booked; the direct solver asks once more, for
  // the modes of contacts at the beginning of the step
  for (const auto& [solver, calls_a_step] : std::map<std::string, int>{{"iterative", 6}, {"direct", 7}}) {
    int calls = 0;
    const Scene scene = balls(20, 100, "solver = \"" + solver + "\"\n")
                            .with_force("none", [&](const Stage& stage, const Push&) {
                              ++calls;
                              EXPECT_EQ(stage.positions.rows, 20u);
                            });
    World world(scene);
    calls = 0;
    world.step(10);
    EXPECT_EQ(calls, 10 * calls_a_step) << solver;
  }
}

TEST(Force, TurnsBodiesOfSpaceInTheAxesOfTheRoom) {
  const Scene scene = Scene::parse(
                          "[room]\nsize = [4, 4, 4]\nwalls = \"none\"\ngravity = [0, 0, 0]\n[[box]]\nname = "
                          "\"box\"\nsize = [1, 2, 3]\n"
                          "mass = 6\nposition = [2, 2, 2]\norientation = { axis = [0, 0, 1], angle = 90 }\n")
                          .with_force("twist", [](const Stage& stage, const Push& push) {
                            // the box's own x axis stands along the room's y
                            EXPECT_NEAR(stage.orientations(0, 3), 1, 1e-12);
                            EXPECT_EQ(stage.spins.columns, 3u);
                            push.torques[1] = 6.5;
                          });
  World world(scene);
  world.step_to(1);
  // about its x axis: I = m (2^2 + 3^2) / 12 = 6.5 kg m^2
  EXPECT_NEAR(world.spins()(0, 1), 1, 1e-9);
  EXPECT_NEAR(world.energies().work, 0.5 * 6.5, 1e-6);
}

TEST(Force, WhatItThrowsComesOutAndTheStepIsNotTaken) {
  bool fails = false;
  World world(balls(2, 100).with_force("moody", [&](const Stage& stage, const Push& push) {
    if (fails && stage.time > 0.104) throw std::domain_error("enough");
    spring(stage, push);
  }));
  world.step(10);
  const std::string before = world.hash();
  fails = true;
  EXPECT_THROW(world.step(), std::domain_error);
  EXPECT_EQ(world.hash(), before);
  fails = false;
  world.step(10);
  World other(balls(2, 100).with_force("moody", spring));
  other.step(20);
  EXPECT_EQ(world.hash(), other.hash());
}

TEST(Force, ThatIsNoNumberIsTroubleOfItsBody) {
  World world(balls(2, 100).with_force("hole", [](const Stage&, const Push& push) {
    push.forces[3] = std::numeric_limits<double>::quiet_NaN();
  }));
  try {
    world.step();
    FAIL();
  } catch (const RunError& error) {
    EXPECT_EQ(error.body, "b1");
    EXPECT_EQ(error.quantity, "force");
    EXPECT_THAT(error.what(), HasSubstr("is not a number"));
  }
}

TEST(Force, ActsWhereBodiesTouchByEachSolver) {
  for (const char* solver : {"direct", "iterative"}) {
    // a block on the floor is pushed with more than friction holds: a = (F - mu m g) / m
    const Scene scene =
        Scene::parse(std::string("[room]\nsize = [8, 4]\n[physics]\ncollision = \"contact\"\nsolver = \"") +
                     solver + "\"\n[[box]]\nname = \"box\"\nsize = [1, 1]\nmass = 2\nposition = [1, 0.5]\n" +
                     "friction = 0.5\nelasticity = 0\n")
            .with_force("push", [](const Stage&, const Push& push) { push.forces[0] = 15; });
    World world(scene);
    world.step_to(1);
    EXPECT_NEAR(world.velocities()(0, 0), (15 - 0.5 * 2 * 9.81) / 2, 1e-3) << solver;
  }
}

TEST(World, ColumnsStayWhereTheyAreInEveryShippedScene) {
  for (const auto& entry : fs::directory_iterator(kScenes)) {
    if (entry.path().extension() != ".toml") continue;
    World world(Scene::read(entry.path().string()));
    const Columns before = world.positions();
    const State start = world.save();
    world.step(4);
    world.restore(start);
    world.step(3);
    EXPECT_EQ(world.positions().first, before.first) << entry.path();
    EXPECT_EQ(world.positions().rows, world.scene().bodies().size()) << entry.path();
  }
}

TEST(World, GoesOnFromASavedStateToTheSameBits) {
  for (const char* name : {"room", "tower", "pinball", "slope"}) {
    World world(scene_named(name));
    world.step(40);
    const State state = world.save();
    world.step(60);
    const std::string end = world.hash();
    World other(scene_named(name));
    other.restore(state);
    EXPECT_EQ(other.save(), state) << name;
    other.step(60);
    EXPECT_EQ(other.hash(), end) << name;
    world.restore(state);
    world.step(60);
    EXPECT_EQ(world.hash(), end) << name;
  }
  World room(scene_named("room")), tower(scene_named("tower"));
  EXPECT_THROW(room.restore(tower.save()), UsageError);
  EXPECT_THROW(room.restore({}), UsageError);
}

TEST(World, SetVelocitiesHoldFromTheNextStepOn) {
  World world(balls(2, 100));
  const std::vector<double> v = {1, 0, 0, -1};
  world.set_velocities(v);
  world.step(100);
  EXPECT_NEAR(world.positions()(0, 0), 4, 1e-12);
  EXPECT_NEAR(world.positions()(1, 1), 1, 1e-12);
  EXPECT_THROW(world.set_velocities(std::vector<double>(3)), UsageError);
  EXPECT_THROW(world.set_velocities(std::vector<double>(4, std::nan(""))), UsageError);
}

TEST(World, ABodyThatSleepsWakesWhenItIsSet) {
  const Scene scene = Scene::parse(
      "[room]\nsize = [8, 4]\n[physics]\ncollision = \"contact\"\n[[box]]\nname = \"box\"\nsize = [1, "
      "1]\nmass = 2\n"
      "position = [4, 0.5]\nfriction = 0.5\nelasticity = 0\n");
  World world(scene);
  world.step_to(1);
  world.set_velocities(std::vector<double>{2, 0});
  world.step_to(4);
  // v^2 / (2 mu g)
  EXPECT_NEAR(world.positions()(0, 0), 4 + 4 / (2 * 0.5 * 9.81), 1e-3);
}

TEST(World, TellsWhoComesToTouchAndWhatFires) {
  const Scene scene = Scene::parse(
      "[room]\nsize = [4, 4]\n[physics]\ncollision = \"event\"\n[[ball]]\nname = \"ball\"\nradius = "
      "0.1\nposition = [2, 1]\n"
      "elasticity = 0.5\n[[when]]\nname = \"hit\"\ntouches = [\"ball\", \"floor\"]\ndo = [{ mark = \"hit\" "
      "}]\n");
  World world(scene);
  std::vector<Pair> began;
  while (world.time() < 0.6) {
    world.step();
    for (const Pair& each : world.contact_changes().began) began.push_back(each);
  }
  ASSERT_GE(began.size(), 1u);
  EXPECT_EQ(began[0].body, world.body("ball"));
  EXPECT_EQ(began[0].other, -1);
  ASSERT_EQ(world.events().size(), 1u);
  EXPECT_EQ(world.events()[0].name, "hit");
  EXPECT_NEAR(world.events()[0].time, std::sqrt(2 * 0.9 / 9.81), 1e-9);
}

TEST(World, ReadsWhatStatesPrintsAndNamesWhatItDoesNotHave) {
  World world(balls(1, 100));
  EXPECT_EQ(world.read("b0.velocity.y"), 1);
  EXPECT_EQ(world.read("energy.total"), 1);
  try {
    (void)world.read("energy.totl");
    FAIL();
  } catch (const UsageError& error) {
    EXPECT_THAT(error.what(), HasSubstr("did you mean 'energy.total'"));
  }
  EXPECT_THROW((void)world.body("b9"), UsageError);
}

TEST(World, InThreadsAtOnceIsTheSameAsAlone) {
  const Scene scene = scene_named("room");
  World alone(scene);
  alone.step(120);
  std::vector<std::string> hashes(4);
  {
    std::vector<std::jthread> all;
    for (std::string& hash : hashes)
      all.emplace_back([&] {
        World world(scene);
        world.step(120);
        hash = world.hash();
      });
  }
  for (const std::string& hash : hashes) EXPECT_EQ(hash, alone.hash());
}

TEST(World, ThatIsAtWorkRefusesAnotherThread) {
  std::binary_semaphore within(0), asked(0);
  bool first = true;
  const Scene scene = balls(1, 100).with_force("slow", [&](const Stage&, const Push&) {
    if (!std::exchange(first, false)) return;
    within.release();
    asked.acquire();
  });
  World world(scene);
  {
    const std::jthread other([&] { world.step(); });
    within.acquire();
    EXPECT_THROW(world.step(), UsageError);
    EXPECT_THROW(world.set_velocities(std::vector<double>{0, 0}), UsageError);
    EXPECT_THROW((void)world.contacts(), UsageError);
    asked.release();
  }
  world.step();
  EXPECT_EQ(world.steps(), 2);
}

TEST(World, RefusesAForceThatAsksIt) {
  World* its = nullptr;
  std::function<void(World&)> asks;
  const Scene scene = balls(1, 100).with_force("itself", [&](const Stage&, const Push&) {
    if (its) asks(*its);
  });
  World world(scene);
  its = &world;
  const std::vector<std::function<void(World&)>> all = {[](World& it) { it.step(); },
                                                        [](World& it) { (void)it.time(); },
                                                        [](World& it) { (void)it.steps(); },
                                                        [](World& it) { (void)it.positions(); },
                                                        [](World& it) { (void)it.spins(); },
                                                        [](World& it) { (void)it.energies(); },
                                                        [](World& it) {
                                                          it.set_velocities(std::vector<double>{0, 0});
                                                        }};
  for (const auto& one : all) {
    asks = one;
    try {
      world.step();
      FAIL();
    } catch (const UsageError& error) {
      EXPECT_THAT(error.what(), HasSubstr("at work"));
    }
    EXPECT_EQ(world.steps(), 0);
  }
  its = nullptr;
  world.step();
}

TEST(World, ThatWasMovedIntoAnotherSaysSo) {
  World world(balls(1, 100));
  World other(std::move(world));
  other.step();
  const auto refuses = [](auto&& act) {
    try {
      act();
      FAIL();
    } catch (const UsageError& error) {
      EXPECT_THAT(error.what(), HasSubstr("this World was moved into another"));
    }
  };
  // NOLINTBEGIN(bugprone-use-after-move): what is tried
  refuses([&] { world.step(); });
  refuses([&] { (void)world.time(); });
  refuses([&] { (void)world.scene(); });
  refuses([&] { (void)world.positions(); });
  refuses([&] { (void)world.save(); });
  world = std::move(other);
  EXPECT_EQ(world.steps(), 1);
  // a scene is copied
  Scene scene = balls(1, 100);
  const Scene moved = std::move(scene);
  EXPECT_EQ(scene.hash(), moved.hash());
  // NOLINTEND(bugprone-use-after-move)
}

TEST(World, TakesAStateOfOtherValuesButNotOfAnotherMake) {
  const Scene one = balls(1, 100);
  World world(one), heavy(one.with("b0.mass", 5)), two(balls(2, 100));
  world.step(10);
  heavy.restore(world.save());
  EXPECT_EQ(heavy.steps(), 10);
  EXPECT_EQ(heavy.positions()(0, 1), world.positions()(0, 1));
  EXPECT_THROW(two.restore(world.save()), UsageError);
  World other_rate(one.with("physics.rate", 250));
  try {
    other_rate.restore(world.save());  // 10 steps would be another time
    FAIL();
  } catch (const UsageError& error) {
    EXPECT_THAT(error.what(), HasSubstr("saved at physics.rate = 100, and this world has 250"));
  }
}

TEST(World, RefusesAVelocityWhoseStateItWouldRefuse) {
  World world(balls(1, 100));
  const auto set = [&](double v) { world.set_velocities(std::array{v, 0.0}); };
  set(1e5);
  world.restore(world.save());
  EXPECT_THROW(set(1e9), UsageError);
  EXPECT_EQ(world.velocities()(0, 0), 1e5);
}

TEST(World, RefusesPlacesOutsideOfTheRoom) {
  const auto refuses = [](const Scene& scene, const std::vector<double>& x, const char* why) {
    World world(scene);
    const std::string before = world.hash();
    try {
      world.set_positions(x);
      FAIL() << why;
    } catch (const UsageError& error) {
      EXPECT_THAT(error.what(), HasSubstr(why));
    }
    EXPECT_EQ(world.hash(), before);
  };
  const Scene plane = Scene::parse(
      "[room]\nsize = [4, 3]\n[[particle]]\nname = 'p'\nposition = [1, 1]\n"
      "[[box]]\nname = 'box'\nsize = [1, 0.2]\nposition = [2, 1]\n");
  refuses(plane, {9, 1, 2, 1}, "p would be outside the room: 5 m beyond the right wall");
  refuses(plane, {1, 1, -0.3, 1}, "box would be outside the room: 0.3 m beyond the left wall");
  refuses(plane, {1, 1, 2, 3.5}, "0.5 m beyond the ceiling");
  refuses(plane, {1, -1e-3, 2, 1}, "0.001 m beyond the floor");
  World(plane).set_positions(std::array{0.0, 0.0, 3.5, 2.9});

  // upright it fits beside the wall: positions and turns may be set in either order
  const std::array beside = {1.0, 1.0, 0.1, 1.0};
  const std::array upright = {1.5707963267948966};
  World first(plane), second(plane);
  first.set_positions(beside), first.set_turns(upright);
  second.set_turns(upright), second.set_positions(beside);
  first.step(), second.step();
  EXPECT_EQ(first.hash(), second.hash());
  // and lying it does not, which the step tells
  World lying(plane);
  lying.set_positions(beside);
  const std::string before = lying.hash();
  try {
    lying.step();
    FAIL();
  } catch (const RunError& error) {
    EXPECT_EQ(error.body, "box");
    EXPECT_THAT(error.what(), HasSubstr("is outside the room: 0.4 m beyond the left wall"));
  }
  EXPECT_EQ(lying.hash(), before);
  EXPECT_THROW(lying.step(), RunError);
  lying.set_turns(upright);
  lying.step();
  EXPECT_EQ(lying.hash(), first.hash());

  const Scene space = Scene::parse(
      "[room]\nsize = [4, 3, 2]\n[[ball]]\nname = 'ball'\nradius = 0.5\nposition = [0, 1, 0]\n"
      "[[box]]\nname = 'sill'\nsize = [1, 1, 1]\nposition = [-1.9, 0, 0]\nfixed = true\n");
  refuses(space, {0, 1, 3, -1.9, 0, 0}, "ball would be outside the room: 2.5 m beyond the front wall");
  refuses(space, {0, 1, -3, -1.9, 0, 0}, "beyond the back wall");
  // one that is held counts by its centre
  refuses(space, {0, 1, 0, -2.5, 0, 0}, "sill would be outside the room: 0.5 m beyond the left wall");
  World(space).set_positions(std::array{0.0, 1.0, 0.0, -2.0, 0.0, 0.0});
  // a room of its own walls, and one of none
  refuses(Scene::parse("[room]\nwalls = [{ point = [0, 0], normal = [1, 1] }]\n[[particle]]\nname = 'p'\n"
                       "position = [1, 1]\n"),
          {-1, -1}, "1.41 m beyond wall 0");
  World(balls(1, 100)).set_positions(std::array{-900.0, 900.0});
}

TEST(World, StandsWhereTheLastWholeStepLeftItWhenItsRunEnds) {
  const Scene scene = Scene::parse(
      "[room]\nsize = [4, 3]\nwalls = 'none'\n[physics]\nrate = 60\nintegrator = 'euler'\n"
      "[[particle]]\nname = 'p'\nposition = [1, 1]\n[[spring]]\nbetween = [[2, 1], 'p']\nstiffness = 1e7\n",
      "stiff.toml");
  World world(scene);
  std::string hash = world.hash();
  double time = 0, x = world.positions()(0, 0);
  try {
    for (int i = 0; i < 1000; ++i) {
      world.step();
      hash = world.hash(), time = world.time(), x = world.positions()(0, 0);
    }
    FAIL();
  } catch (const RunError&) {
  }
  EXPECT_GT(time, 0);
  EXPECT_EQ(world.time(), time);
  EXPECT_EQ(world.positions()(0, 0), x);
  EXPECT_EQ(world.hash(), hash);
}

TEST(World, OfTheInterruptedCanGoOn) {
  World world(balls(1, 100));
  int left = 10;
  interrupt_by([&] { return left-- <= 0; });
  EXPECT_THROW(world.step(100), Interrupted);
  interrupt_by({});
  EXPECT_LT(world.steps(), 100);
  world.step(100 - world.steps());
  World other(balls(1, 100));
  other.step(100);
  EXPECT_EQ(world.hash(), other.hash());
}

TEST(Sweep, OfAProgramsForceMeasuresEachRun) {
  const Scene scene = balls(1, 100).with("duration", 1).with_force("spring", spring);
  const Sweep made = sweep(scene, {"b0.mass=1,2,4"}, {"b0.position.x@1"}, 2);
  ASSERT_EQ(made.rows.size(), 3u);
  EXPECT_EQ(made.heads, (std::vector<std::string>{"b0.mass", "b0.position.x@1", "trouble"}));
  for (const auto& row : made.rows)
    EXPECT_NEAR(std::stod(row[1]), 2 + std::cos(std::sqrt(8 / std::stod(row[0]))), 1e-6);
}

}  // namespace
}  // namespace obscura

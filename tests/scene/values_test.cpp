// What a scene means once it is read: defaults, exact times, copies, ends, names, the camera.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>

#include "scene/error.h"
#include "scene/scene.h"
#include "where.h"

namespace obscura::scene {
namespace {

using testing::ElementsAre;

using Vec = sim::Vec<2>;

Scene scene(const std::string& text, const std::vector<std::string>& sets = {}) {
  return parse(text, "a.toml", sets);
}

// bodies that lie on each other, which only this mode lets them
Scene crossing(const std::string& text) { return scene(text, {"physics.collision=handout"}); }

// the end of each spring, as a place in the room at the start; boxes at no angle
std::vector<std::pair<int, int>> pairs(const Scene& it) {
  std::vector<std::pair<int, int>> all;
  for (const sim::Spring<2>& spring : it.plane().model.springs)
    all.emplace_back(spring.a.body, spring.b.body);
  return all;
}

TEST(Values, ABareParticleHasEveryDefault) {
  const Scene it = scene("[[particle]]");
  EXPECT_EQ(it.duration, sim::rational(10));
  EXPECT_EQ(it.plane().model.rate, sim::rational(600));
  EXPECT_EQ(it.plane().model.integrator, sim::Integrator::rk4);
  EXPECT_EQ(it.plane().model.gravity, Vec(0, -9.81));
  EXPECT_EQ(it.plane().model.scale, 4.5);
  EXPECT_EQ(it.plane().state.x[0], Vec(4, 2.25));
  EXPECT_EQ(it.plane().state.v[0], Vec(0, 0));
  const sim::Body<2>& body = it.plane().model.bodies[0];
  EXPECT_EQ(body.name, "particle[0]");
  EXPECT_TRUE(sim::is_point(body.shape));
  EXPECT_EQ(body.mass, 1);
  EXPECT_EQ(body.elasticity, 0.8);
  EXPECT_EQ(body.drag, 0);
  EXPECT_FALSE(body.fixed);
  EXPECT_EQ(it.film.width, 1920);
  EXPECT_EQ(it.film.height, 1080);
  EXPECT_EQ(it.film.fps, sim::rational(60));
  EXPECT_FALSE(it.film.crf);
  EXPECT_TRUE(it.cameras.front().keys.empty());
  EXPECT_EQ(it.look.theme, draw::Theme::paper);
  EXPECT_EQ(it.name, "a");
  EXPECT_EQ(it.extent.high, sim::Vec3(8, 4.5, 0));
  EXPECT_FALSE(std::signbit(it.extent.low.x()));
}

TEST(Values, TypedDecimalsAreExactTimes) {
  const Scene it = scene(
      "duration = 0.1\n[film]\nfps = \"30000/1001\"\n[physics]\nrate = 240.5\n[[particle]]\n[[mouse]]\npath "
      "= [[0.1, 1, 1], [0.7, 2, "
      "2]]");
  EXPECT_EQ(it.duration, sim::rational(1, 10));
  EXPECT_EQ(it.film.fps, sim::rational(30000, 1001));
  EXPECT_EQ(it.plane().model.rate, sim::rational(481, 2));
  EXPECT_EQ(it.plane().model.mice[0].path[0].time, sim::rational(1, 10));
  EXPECT_EQ(it.plane().model.mice[0].path[1].time, sim::rational(7, 10));
  EXPECT_EQ(scene("[film]\nfps = 29.97\n[[box]]").film.fps, sim::rational(2997, 100));
}

TEST(Values, FourWallsInTheirOrder) {
  const Scene it = scene("[room]\nsize = [4, 3]\ncorner = [-1, 2]\nelasticity = 0.5\n[[box]]");
  const auto& walls = it.plane().model.walls;
  ASSERT_EQ(walls.size(), 4u);
  EXPECT_EQ(walls[0].normal, Vec(0, 1));
  EXPECT_EQ(walls[1].normal, Vec(1, 0));
  EXPECT_EQ(walls[2].normal, Vec(-1, 0));
  EXPECT_EQ(walls[3].normal, Vec(0, -1));
  EXPECT_EQ(walls[0].point, Vec(-1, 2));
  EXPECT_EQ(walls[3].point, Vec(3, 5));
  for (const auto& wall : walls) EXPECT_EQ(wall.elasticity, 0.5);
  EXPECT_EQ(it.plane().state.x[0], Vec(1, 3.5));
  EXPECT_EQ(it.plane().model.scale, 3);
}

TEST(Values, WallsAloneMayCloseARoom) {
  const Scene it = scene(
      "[room]\nwalls = [{ point = [0, 0], normal = [0, 2] }, { point = [0, 0], normal = [1, 0], elasticity = "
      "0.3 }, { point = [2, 2], normal = "
      "[-1, -1] }]\n[[particle]]");
  ASSERT_EQ(it.plane().model.walls.size(), 3u);
  EXPECT_EQ(it.plane().model.walls[0].normal, Vec(0, 1));
  EXPECT_EQ(it.plane().model.walls[1].elasticity, 0.3);
  EXPECT_NEAR(it.plane().model.walls[2].normal.norm(), 1, 1e-15);
  // corners are where two walls meet: to the last bits
  EXPECT_NEAR(it.extent.high.x(), 4, 1e-14);
  EXPECT_NEAR(it.extent.high.y(), 4, 1e-14);
  EXPECT_NEAR(it.plane().model.scale, 4, 1e-14);
}

TEST(Values, AnOpenRoomIsAsLargeAsWhatIsInIt) {
  const Scene it = scene(
      "[room]\nwalls = [{ point = [0, 0], normal = [0, 1] }]\n[[particle]]\nposition = [0, "
      "4]\n[[particle]]\nposition = [10, 1]\nradius = 1\n"
      "[[mouse]]\npath = [[0, 0, 1], [1, 2, 1]]");
  // from (0, 0) to (11, 4), a tenth more on each side
  EXPECT_NEAR(it.extent.low.x(), -1.1, 1e-12);
  EXPECT_NEAR(it.extent.high.x(), 12.1, 1e-12);
  EXPECT_NEAR(it.extent.high.y() - it.extent.low.y(), 4.8, 1e-12);
  EXPECT_NEAR(it.plane().model.mice[0].rest_length, 20.0 / 480 * 4.8, 1e-12);
}

// no less than it is high as a film, and no metre around it
TEST(Values, AnOpenRoomOfTinyThingsIsTiny) {
  const draw::Extent it =
      scene(
          "[room]\nwalls = [{ point = [0, 0], normal = [0, 1] }]\n[[particle]]\nposition = "
          "[0, 0.001]\n[[particle]]\nposition = [0.01, 0.001]\n")
          .extent;
  EXPECT_NEAR(it.high.x() - it.low.x(), 0.012, 1e-12);
  EXPECT_NEAR(it.high.y() - it.low.y(), 9.0 / 16 * 0.012, 1e-12);
}

TEST(Values, TheMouseRestsAtTwentyReferencePixelsWhateverThePicture) {
  for (const char* film : {"", "[film]\nsize = [640, 480]\n"}) {
    const Scene it =
        scene(std::string(film) + "[room]\nsize = [4, 3]\n[[box]]\n[[mouse]]\npath = [[0, 1, 1], [1, 2, 2]]");
    EXPECT_EQ(it.plane().model.mice[0].rest_length, 20.0 / 480 * 3);
    EXPECT_EQ(it.plane().model.mice[0].stiffness, 60);
    EXPECT_EQ(it.plane().state.grips.size(), 1u);
  }
}

TEST(Values, DegreesBecomeRadiansAndMassComesFromDensity) {
  const Scene it =
      crossing("[[box]]\nsize = [2, 0.5]\nangle = 30\nspin = -90\ndensity = 3\n[[box]]\nmass = 0.5");
  EXPECT_NEAR(it.plane().state.turn[0][0], M_PI / 6, 1e-15);
  EXPECT_NEAR(it.plane().state.spin[0][0], -M_PI / 2, 1e-15);
  EXPECT_DOUBLE_EQ(it.plane().model.bodies[0].mass, 3);
  EXPECT_DOUBLE_EQ(it.plane().model.bodies[0].inertia[0], 3 * (4 + 0.25) / 12);
  EXPECT_EQ(it.plane().model.bodies[1].mass, 0.5);
}

TEST(Values, ParticlesComeBeforeBoxes) {
  const Scene it = crossing(
      "[[box]]\nname = \"b\"\n[[particle]]\nname = \"p\"\n[[box]]\nname = \"c\"\n[[particle]]\nname = \"q\"");
  std::vector<std::string> names;
  for (const auto& body : it.plane().model.bodies) names.push_back(body.name);
  EXPECT_THAT(names, ElementsAre("p", "q", "b", "c"));
  EXPECT_EQ(it.plane().model.particles(), 2);
  EXPECT_EQ(it.plane().state.turn.size(), 2u);
  EXPECT_EQ(it.plane().state.spin.size(), 2u);
}

TEST(Values, DragOfTheRoomIsThatOfBodiesWithNone) {
  const Scene it = crossing("[room]\ndrag = 0.3\n[[particle]]\n[[box]]\ndrag = 0.1");
  EXPECT_EQ(it.plane().model.bodies[0].drag, 0.3);
  EXPECT_EQ(it.plane().model.bodies[1].drag, 0.1);
}

TEST(Copies, AGridCountsAlongItsFirstDirection) {
  const Scene it = scene(
      "[[particle]]\nname = \"b\"\nposition = [1, 1]\nvelocity = [1, 0]\ncopies = { count = [3, 2], offset = "
      "[[0.5, 0], [0, 0.25]] }");
  ASSERT_EQ(it.plane().state.x.size(), 6u);
  EXPECT_EQ(it.plane().model.bodies[4].name, "b[4]");
  EXPECT_EQ(it.plane().state.x[2], Vec(2, 1));
  EXPECT_EQ(it.plane().state.x[4], Vec(1.5, 1.25));
  EXPECT_EQ(it.plane().state.v[5], Vec(1, 0));
}

TEST(Copies, ARingTurnsPlaceVelocityAndAngle) {
  const Scene it = scene(
      "[[box]]\nsize = [0.2, 0.2]\nposition = [5, 2]\nvelocity = [1, 0]\nangle = 10\ncopies = { count = 4, "
      "turn = 90, around = [4, 2] }");
  // sines of multiples of a right angle are off by a part in 2^53
  EXPECT_NEAR((it.plane().state.x[1] - Vec(4, 3)).norm(), 0, 1e-15);
  EXPECT_NEAR((it.plane().state.v[2] - Vec(-1, 0)).norm(), 0, 1e-15);
  EXPECT_NEAR(it.plane().state.turn[3][0], 280 * M_PI / 180, 1e-15);
}

TEST(Copies, ValuesMayVaryOverThem) {
  const Scene it = scene(
      "[[particle]]\nelasticity = { from = 0, to = 1 }\nmass = [1, 2, 4, 8, 16]\ncolor = [\"blue\", "
      "\"#ff0000\"]\nvelocity = { from = [0, 0], to = [2, "
      "4] }\nlabel = [\"e = 0\", \"a\", \"b\"]\ncopies = { count = 5 }");
  EXPECT_EQ(it.look.bodies[2].label, "b");
  EXPECT_EQ(it.look.bodies[3].label, "e = 0");
  EXPECT_EQ(it.plane().model.bodies[0].elasticity, 0);
  EXPECT_EQ(it.plane().model.bodies[1].elasticity, 0.25);
  EXPECT_EQ(it.plane().model.bodies[4].elasticity, 1);
  EXPECT_EQ(it.plane().model.bodies[3].mass, 8);
  EXPECT_EQ(it.plane().state.v[2], Vec(1, 2));
  EXPECT_EQ(it.look.bodies[3].color, draw::color("#ff0000"));
  EXPECT_EQ(it.look.bodies[4].color, draw::color("blue"));
}

TEST(Copies, JitterIsSmallSeededAndOfTheCopyAlone) {
  const auto at = [](const std::string& before, const std::string& seed) {
    return scene(seed + before + "[[particle]]\nposition = [2, 2]\ncopies = { count = 50, jitter = 0.02 }");
  };
  const Scene a = at("", ""), b = at("", ""), other = at("", "seed = 1\n");
  double widest = 0;
  Vec sum = Vec::Zero();
  for (int i = 0; i < 50; ++i) {
    EXPECT_EQ(a.plane().state.x[i], b.plane().state.x[i]);
    EXPECT_NE(a.plane().state.x[i], other.plane().state.x[i]);
    widest = std::max(widest, (a.plane().state.x[i] - Vec(2, 2)).cwiseAbs().maxCoeff());
    sum += a.plane().state.x[i] - Vec(2, 2);
  }
  EXPECT_LE(widest, 0.02);
  EXPECT_GT(widest, 0.015);                            // 100 even numbers all below three quarters: 3e-13
  EXPECT_LT((sum / 50).cwiseAbs().maxCoeff(), 0.008);  // five standard deviations
  const Scene more = at("[[box]]\n", "");
  EXPECT_EQ(more.plane().state.x[7], a.plane().state.x[7]);
}

// SplitMix64 by hand, of (seed, the first [[particle]], which copy and coordinate)
TEST(Copies, JitterIsTheSameEverywhere) {
  const Scene it = scene(
      "seed = 4\n[[particle]]\nposition = [0, 0]\ncopies = { count = 2, jitter = 1 }\n[room]\nsize = [4, "
      "4]\ncorner = [-2, -2]");
  EXPECT_EQ(it.plane().state.x[0].x(), -0x1.785605e3e1c00p-4);
  EXPECT_EQ(it.plane().state.x[1].y(), 0x1.7e3be376daac0p-3);
}

TEST(Copies, SomeMayBeHeld) {
  const Scene it = scene("[[particle]]\nfixed = \"0,2..3\"\ncopies = { count = 5 }");
  std::vector<bool> held;
  for (const auto& body : it.plane().model.bodies) held.push_back(body.fixed);
  EXPECT_THAT(held, ElementsAre(true, false, true, true, false));
}

TEST(GoldenTable, StatesAreHeldOrLetPassOrThoseOfARun) {
  EXPECT_TRUE(scene("[golden]").golden.states);
  EXPECT_FALSE(scene("[golden]\nstates = false\nreason = \"\"\"two compilers\"\"\"").golden.states);
  const Golden run = scene("[golden]\nstates = \"run.csv\"").golden;
  EXPECT_TRUE(run.states);
  EXPECT_EQ(run.run, "run.csv");
  EXPECT_FALSE(run.hashes);
  EXPECT_TRUE(scene("[golden]\nkeep = \"hash\"").golden.hashes);
  EXPECT_EQ(scene("[[box]]", {"golden.states=other.csv"}).golden.run, "other.csv");
}

TEST(Springs, RestAsLongAsTheyAreAtTheStart) {
  const Scene it = scene(
      "[[box]]\nname = \"crate\"\nsize = [2, 1]\nangle = 90\nposition = [4, 2]\n[[spring]]\nbetween = [{ "
      "body = \"crate\", at = \"right\" }, [4, "
      "4.5]]\n[[spring]]\nbetween = [\"crate\", { body = \"crate\", local = [0.3, 0.4] }]\nrest_length = "
      "2\ndamping = 0.5");
  const auto& springs = it.plane().model.springs;
  ASSERT_EQ(springs.size(), 2u);
  EXPECT_NEAR(springs[0].rest_length, 1.5, 1e-15);  // the box's right side is up
  EXPECT_EQ(springs[0].a.local, Vec(1, 0));
  EXPECT_EQ(springs[0].b.body, -1);
  EXPECT_EQ(springs[0].b.local, Vec(4, 4.5));
  EXPECT_EQ(springs[0].stiffness, 40);
  EXPECT_EQ(springs[1].rest_length, 2);
  EXPECT_EQ(springs[1].damping, 0.5);
}

TEST(Springs, AStarTiesEachToItsOwn) {
  const std::string two =
      "[[particle]]\nname = \"a\"\ncopies = { count = 3 }\n[[particle]]\nname = \"b\"\ncopies = { count = 3, "
      "offset = [0.5, 0] }\n[[spring]]\n";
  EXPECT_THAT(pairs(scene(two + "between = [\"a[*]\", \"b[*]\"]")),
              ElementsAre(std::pair(0, 3), std::pair(1, 4), std::pair(2, 5)));
  EXPECT_THAT(pairs(scene(two + "between = [\"a[1]\", \"b[0,2]\"]")),
              ElementsAre(std::pair(1, 3), std::pair(1, 5)));
  EXPECT_THAT(pairs(scene(two + "between = [\"b[1..2]\", [1, 1]]")),
              ElementsAre(std::pair(4, -1), std::pair(5, -1)));
  const Scene stiff =
      scene(two + "between = [\"a[*]\", \"b[*]\"]\nstiffness = [1, 2, 3]\ndamping = { from = 0, to = 1 }");
  EXPECT_EQ(stiff.plane().model.springs[2].stiffness, 3);
  EXPECT_EQ(stiff.plane().model.springs[1].damping, 0.5);
}

TEST(Springs, UnnamedBodiesHaveNamesToo) {
  EXPECT_THAT(
      pairs(crossing("[[particle]]\n[[box]]\n[[box]]\n[[spring]]\nbetween = [\"box[1]\", \"particle[0]\"]")),
      ElementsAre(std::pair(2, 0)));
  EXPECT_THAT(
      pairs(crossing(
          "[[particle]]\ncopies = { count = 2 }\n[[spring]]\nbetween = [\"particle[0][1]\", [1, 1]]")),
      ElementsAre(std::pair(1, -1)));
}

TEST(Nets, JoinNeighbours) {
  const std::string knots =
      "[[particle]]\nname = \"k\"\nposition = [1, 1]\ncopies = { count = [3, 2], offset = [[0.5, 0], [0, "
      "0.5]] }\n[[net]]\nof = \"k\"\n";
  EXPECT_THAT(pairs(scene(knots)), testing::UnorderedElementsAre(
                                       std::pair(0, 1), std::pair(1, 2), std::pair(3, 4), std::pair(4, 5),
                                       std::pair(0, 3), std::pair(1, 4), std::pair(2, 5)));
  const Scene shear = scene(knots + "diagonals = true\nrest_length = 0.4");
  EXPECT_EQ(shear.plane().model.springs.size(), 11u);
  int across = 0;
  for (const auto& spring : shear.plane().model.springs)
    across += std::abs(spring.rest_length - 0.4 * std::sqrt(2.0)) < 1e-15;
  EXPECT_EQ(across, 4);
  EXPECT_EQ(
      scene("[[particle]]\nname = \"k\"\ncopies = { count = 5, offset = [0.1, 0] }\n[[net]]\nof = \"k\"")
          .plane()
          .model.springs.size(),
      4u);
}

TEST(Looks, TrailsAreOfAllOrByName) {
  const Scene all = crossing(
      "[look]\ntrails = 1.5\narrows = [\"velocity\"]\n[[particle]]\n[[box]]\nfixed = true\n[[box]]\ntrail = "
      "0.5\narrows = []");
  EXPECT_EQ(all.look.bodies[0].trail, 1.5);
  EXPECT_EQ(all.look.bodies[1].trail, 0);
  EXPECT_EQ(all.look.bodies[2].trail, 0.5);
  EXPECT_TRUE(all.look.bodies[0].velocity);
  EXPECT_FALSE(all.look.bodies[1].velocity);
  EXPECT_FALSE(all.look.bodies[2].velocity);
  const Scene some = crossing(
      "[look]\ntrails = { ball = 1, \"b[1]\" = 2 }\n[[particle]]\nname = \"ball\"\ncopies = { count = 2 "
      "}\n[[box]]\nname = \"b\"\ncopies = { count = 2 }");
  EXPECT_EQ(some.look.bodies[1].trail, 1);
  EXPECT_EQ(some.look.bodies[2].trail, 0);
  EXPECT_EQ(some.look.bodies[3].trail, 2);
}

TEST(Looks, ColoursGoOnFromDeclarationToDeclaration) {
  const Scene it = crossing(
      "[[particle]]\ncopies = { count = 3 }\n[[particle]]\n[[box]]\nfixed = true\n[[particle]]\nname = "
      "\"k\"\ncopies = { count = 2, offset = [1, 0] }\n"
      "[[net]]\nof = \"k\"");
  EXPECT_EQ(it.look.bodies[0].color, it.look.bodies[2].color);
  EXPECT_NE(it.look.bodies[0].color, it.look.bodies[3].color);
  EXPECT_FALSE(it.look.bodies[4].color);  // a net's
  EXPECT_FALSE(it.look.bodies[6].color);  // held
}

TEST(Looks, TheCameraStandsOrMoves) {
  const Scene stands = scene("[camera]\nwidth = 3\n[[box]]");
  ASSERT_EQ(stands.cameras.front().keys.size(), 1u);
  EXPECT_EQ(stands.cameras.front().keys[0].width, 3);
  EXPECT_FALSE(stands.cameras.front().keys[0].center);
  const Scene moves = scene(
      "[camera]\nkeys = [{ time = 0 }, { time = 2.5, center = [1, 2], width = 4, ease = \"hold\" "
      "}]\n[[box]]");
  ASSERT_EQ(moves.cameras.front().keys.size(), 2u);
  EXPECT_EQ(moves.cameras.front().keys[1].center, sim::Vec3(1, 2, 0));
  EXPECT_EQ(moves.cameras.front().keys[1].time, 2.5);
  EXPECT_EQ(moves.cameras.front().keys[1].ease, draw::CameraKey::Ease::hold);
  EXPECT_EQ(moves.cameras.front().keys[0].ease, draw::CameraKey::Ease::in_out);
}

TEST(Scenes, EveryOneThatShipsIsGood) {
  int n = 0;
  for (const auto& entry :
       std::filesystem::directory_iterator(std::filesystem::path(OBSCURA_SOURCE_DIR) / "scenes")) {
    if (entry.is_directory()) continue;  // figures have tests of their own
    SCOPED_TRACE(entry.path().filename());
    const Scene it = read(entry.path().string());
    EXPECT_TRUE(it.text.starts_with("#:schema ../docs/scene.schema.json\n# "));
    EXPECT_FALSE(it.look.title.empty());
    EXPECT_FALSE(it.look.subtitle.empty());
    ++n;
  }
  EXPECT_GE(n, 8);
}

TEST(Scenes, RoomIsTenSecondsOf1080p60) {
  const Scene it = read(OBSCURA_SOURCE_DIR "/scenes/room.toml");
  EXPECT_EQ(it.duration, sim::rational(10));
  EXPECT_EQ(it.film.fps, sim::rational(60));
  EXPECT_EQ(it.film.width, 1920);
}

}  // namespace
}  // namespace obscura::scene

// Bodies do not lie in each other, whatever the solver for many bodies is asked for: the deepest overlap of
// any pair, of the narrower width, while they fall and when they rest; and how high a column stands.

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <string>
#include <vector>

#include "scene/error.h"
#include "scene/scene.h"
#include "scene/text_run.h"
#include "sim/collide/broad_phase.h"
#include "sim/collide/may_touch.h"
#include "sim/collide/narrow_phase.h"
#include "sim/step/run.h"
#include "sim/step/stepper.h"
#include "where.h"

namespace obscura::scene {
namespace {

struct Outcome {
  double falling = 0, resting = 0;  // deepest overlap, of the narrower width: in all of the run, at its end
  double top = 0;                   // m: the highest centre at its end
};

// by the narrow phase's distance of shapes, and of corners from walls: not by the solver's own contacts
template <int D>
double deepest(const sim::Model<D>& model, const sim::State<D>& state, sim::BroadPhase<D>& broad,
               const sim::MayTouch<D>& may_touch) {
  const int n = int(model.bodies.size());
  std::vector<sim::Bounds<D>> bounds;
  std::vector<sim::BodyMotion<D>> at;
  std::vector<char> still;
  std::vector<double> width;
  for (int i = 0; i < n; ++i) {
    at.push_back(sim::body_motion(state, i));
    bounds.push_back(sim::bounds(model.bodies[i].shape, at[i]));
    still.push_back(model.bodies[i].fixed);
    width.push_back(2 * sim::half_thickness(model.bodies[i].shape));
  }
  double most = 0;
  for (const auto& [a, b] : broad.find(bounds, still)) {
    if (!may_touch(a, b)) continue;
    most = std::max(most, -sim::separation(model.bodies[a].shape, at[a], model.bodies[b].shape, at[b]) /
                              std::min(width[a], width[b]));
  }
  std::vector<sim::ContactCandidate<D>> gaps;
  for (int i = 0; i < n; ++i) {
    for (int wall = 0; !model.bodies[i].fixed && wall < int(model.walls.size()); ++wall) {
      gaps.clear();
      sim::collide(i, model.bodies[i].shape, at[i], wall, model.walls[wall], 0.0, gaps);
      for (const auto& gap : gaps) most = std::max(most, -gap.value / width[i]);
    }
  }
  return most;
}

template <int D>
Outcome run(const sim::World<D>& world, double seconds) {
  sim::Stepper<D> stepper(world.model);
  sim::State<D> state = world.state;
  stepper.begin(state);
  sim::BroadPhase<D> broad;
  const sim::MayTouch<D> may_touch(world.model);
  const double rate = sim::value(world.model.rate);
  const int steps = int(seconds * rate), every = std::max(1, int(rate / 60));
  Outcome out;
  for (int i = 1; i <= steps; ++i) {
    if (stepper.step(state)) ADD_FAILURE() << "trouble at step " << i;
    if (i % every != 0) continue;
    out.resting = deepest(world.model, state, broad, may_touch);
    out.falling = std::max(out.falling, out.resting);
  }
  for (int i = 0; i < int(world.model.bodies.size()); ++i) {
    if (!world.model.bodies[i].fixed) out.top = std::max(out.top, state.x[i][1]);
  }
  return out;
}

Outcome run(const Scene& scene, double seconds) {
  return scene.dimension() == 2 ? run(scene.plane(), seconds) : run(scene.space(), seconds);
}

// `count` balls of radius 0.05 m above each other, whose lowest falls half a metre
std::string column(bool space, int count) {
  const double height = 0.1 * count + 2;
  return fmt::format(R"(
[room]
size = {}
[physics]
solver = "iterative"
[[ball]]
radius     = 0.05
elasticity = 0
position   = {}
copies     = {{ count = {}, offset = {} }}
)",
                     space ? fmt::format("[4, {}, 4]", height) : fmt::format("[4, {}]", height),
                     space ? "[0, 0.55, 0]" : "[2, 0.55]", count, space ? "[0, 0.1, 0]" : "[0, 0.1]");
}

class Column : public testing::TestWithParam<std::tuple<bool, int, int>> {};

TEST_P(Column, FallsAndStacksUp) {
  const auto [space, count, rate] = GetParam();
  const Scene scene = parse(column(space, count), "column.toml", {fmt::format("physics.rate={}", rate)});
  const Outcome out = run(scene, 3);
  EXPECT_LE(out.falling, 0.05);
  EXPECT_LE(out.resting, 0.01);
  EXPECT_NEAR(out.top, (2 * count - 1) * 0.05, 0.002 * (2 * count - 1) * 0.05);
}

INSTANTIATE_TEST_SUITE_P(Overlaps, Column,
                         testing::Combine(testing::Bool(), testing::Values(2, 3, 7, 21, 60, 200),
                                          testing::Values(60, 200, 600)));

// a million kilograms that fall by a centimetre onto a block of one
class HeavyOnLight : public testing::TestWithParam<std::tuple<bool, int>> {};

TEST_P(HeavyOnLight, StandsOnIt) {
  const auto [space, rate] = GetParam();
  const std::string size = space ? "[0.4, 0.4, 0.4]" : "[0.4, 0.4]";
  const auto place = [&](double y) {
    return space ? fmt::format("[0, {}, 0]", y) : fmt::format("[4, {}]", y);
  };
  const Scene scene = parse(fmt::format("[room]\nsize = {}\n[physics]\nsolver = \"iterative\"\n"
                                        "[[box]]\nsize = {}\nmass = 1\nelasticity = 0\nposition = {}\n"
                                        "[[box]]\nsize = {}\nmass = 1e6\nelasticity = 0\nposition = {}\n",
                                        space ? "[8, 8, 8]" : "[8, 8]", size, place(0.2), size, place(0.61)),
                            "heavy.toml", {fmt::format("physics.rate={}", rate)});
  const Outcome out = run(scene, 1);
  EXPECT_LE(out.falling, 1e-3);
  EXPECT_NEAR(out.top, 0.6, 1e-4);
}

INSTANTIATE_TEST_SUITE_P(Overlaps, HeavyOnLight, testing::Combine(testing::Bool(), testing::Values(60, 600)));

// a block of balls, boxes or sticks that falls onto the floor
std::string heap(bool space, const std::string& kind) {
  const std::string size = space ? "[0.2, 0.2, 0.2]" : "[0.1, 0.1]";
  const std::string stick = space ? "[0.5, 0.06, 0.1]" : "[0.25, 0.04]";
  const std::string body = kind == "balls"   ? std::string("[[ball]]\nradius = ") + (space ? "0.1" : "0.05")
                           : kind == "boxes" ? "[[box]]\nsize = " + size
                                             : "[[box]]\nsize = " + stick;
  const double apart = kind == "sticks" ? (space ? 0.55 : 0.33) : (space ? 0.27 : 0.12);
  const double above = kind == "sticks" ? (space ? 0.15 : 0.06) : apart;
  return fmt::format(R"(
[room]
size = {}
[physics]
solver = "iterative"
{}
elasticity = 0.1
friction   = 0.3
position   = {}
copies     = {{ {}, jitter = 0.005 }}
)",
                     space ? "[3, 6, 3]" : "[6, 6]", body, space ? "[-1, 0.8, -1]" : "[1.2, 0.8]",
                     space
                         ? fmt::format("count = [4, 5, 4], offset = [[{0}, 0.01, 0.02], [0.02, {1}, 0], "
                                       "[0.01, 0, {0}]]",
                                       apart, above)
                         : fmt::format("count = [10, 20], offset = [[{}, 0.005], [0.01, {}]]", apart, above));
}

class Heap : public testing::TestWithParam<std::tuple<bool, std::string, int>> {};

TEST_P(Heap, FallsAndRests) {
  const auto [space, kind, rate] = GetParam();
  const Scene scene = parse(heap(space, kind), "heap.toml", {fmt::format("physics.rate={}", rate)});
  const Outcome out = run(scene, 3);
  EXPECT_LE(out.falling, 0.05);
  EXPECT_LE(out.resting, 0.01);
}

INSTANTIATE_TEST_SUITE_P(Overlaps, Heap,
                         testing::Combine(testing::Bool(),
                                          testing::Values(std::string("balls"), std::string("boxes"),
                                                          std::string("sticks")),
                                          testing::Values(60, 240, 600)));

// What flies high above a heap that lands falls as alone.
class FallBeside : public testing::TestWithParam<std::tuple<bool, int>> {};

TEST_P(FallBeside, AHeapIsThatOfABodyAlone) {
  const auto [space, rate] = GetParam();
  const std::string high =
      fmt::format("\n[[ball]]\nradius = 0.05\nposition = {}\n", space ? "[0, 5.9, 0]" : "[3, 5.9]");
  const Scene scene =
      parse(heap(space, "sticks") + high, "heap.toml", {fmt::format("physics.rate={}", rate)});
  const auto falls = [&](const auto& world) {
    sim::Stepper stepper(world.model);
    auto state = world.state;
    stepper.begin(state);
    std::size_t ball = 0;
    for (std::size_t i = 0; i < state.x.size(); ++i) ball = state.x[i][1] > state.x[ball][1] ? i : ball;
    for (int i = 1; i <= rate * 7 / 10; ++i) {
      ASSERT_FALSE(stepper.step(state));
      ASSERT_NEAR(state.v[ball][1], -9.81 * i / rate, 1e-9) << i;
    }
  };
  space ? falls(scene.space()) : falls(scene.plane());
}

INSTANTIATE_TEST_SUITE_P(Overlaps, FallBeside, testing::Combine(testing::Bool(), testing::Values(60, 240)));

// Fifty blocks that fall onto each other by a millimetre come to rest within two seconds and stay as they
// are.
class TallTower : public testing::TestWithParam<std::tuple<bool, int>> {};

TEST_P(TallTower, OfFiftyBlocksStandsForTenMinutes) {
  const auto [space, rate] = GetParam();
  const Scene scene =
      parse(fmt::format(R"(
[room]
size = {}
[physics]
solver = "iterative"
rate   = {}
[[box]]
size       = {}
elasticity = 0
position   = {}
copies     = {{ count = 50, offset = {} }}
)",
                        space ? "[10, 30, 10]" : "[10, 30]", rate, space ? "[0.5, 0.5, 0.5]" : "[0.5, 0.5]",
                        space ? "[0, 0.25, 0]" : "[5, 0.25]", space ? "[0, 0.501, 0]" : "[0, 0.501]"),
            "tower.toml", {});
  const auto stands = [&](const auto& world) {
    sim::Stepper stepper(world.model);
    auto state = world.state;
    stepper.begin(state);
    for (int i = 0; i < 2 * rate; ++i) ASSERT_FALSE(stepper.step(state));
    EXPECT_EQ(std::count(state.frozen.begin(), state.frozen.end(), 1), 50);
    EXPECT_NEAR(state.x.back()[1], 24.75, 0.002 * 24.75);
    const auto before = state.x;
    for (int i = 2 * rate; i < 600 * rate; ++i) ASSERT_FALSE(stepper.step(state));
    EXPECT_EQ(state.x, before);
  };
  space ? stands(scene.space()) : stands(scene.plane());
}

INSTANTIATE_TEST_SUITE_P(Overlaps, TallTower, testing::Combine(testing::Bool(), testing::Values(60, 600)));

// Blocks set down askew on each other by a centimetre rock on their corners, and come to rest: each blow of a
// corner passes through its whole tower at once. Iterations that were cut short let towers sink and lifted
// them again, for ever.
class Towers : public testing::TestWithParam<std::tuple<bool, int, int>> {};

TEST_P(Towers, StopRocking) {
  const auto [space, towers, rate] = GetParam();
  const std::string text =
      fmt::format(R"(
[room]
size = {}
[physics]
solver = "iterative"
rate   = {}
[[box]]
size     = {}
position = {}
copies   = {{ count = [{}, 6], offset = {}, jitter = 0.004 }}
)",
                  space ? "[12, 4, 12]" : "[12, 4]", rate, space ? "[0.1, 0.1, 0.1]" : "[0.1, 0.1]",
                  space ? "[0, 0.06, 0]" : "[6, 0.06]", towers,
                  space ? "[[0.13, 0, 0], [0, 0.11, 0]]" : "[[0.13, 0], [0, 0.11]]");
  const Scene scene = parse(text, "towers.toml", {});
  const auto asleep = [](const auto& world) {
    sim::Stepper stepper(world.model);
    auto state = world.state;
    stepper.begin(state);
    const int steps = int(8 * sim::value(world.model.rate));
    for (int i = 0; i < steps; ++i) EXPECT_FALSE(stepper.step(state));
    return std::count(state.frozen.begin(), state.frozen.end(), 1);
  };
  EXPECT_EQ(space ? asleep(scene.space()) : asleep(scene.plane()), 6 * towers);
}

INSTANTIATE_TEST_SUITE_P(Overlaps, Towers,
                         testing::Combine(testing::Bool(), testing::Values(1, 3, 10),
                                          testing::Values(60, 240, 600)));

// Boxes that fall askew onto the floor and each other, corners on corners too. In space they stand, move and
// turn in one plane of it.
std::string tumbling(bool space, bool mirrored, const std::string& solver, int rate, unsigned seed) {
  std::mt19937 random(seed);
  const auto number = [&](double most) { return most * (double(random() >> 5) / double(1u << 26) - 1); };
  const double side = mirrored ? -1 : 1;
  std::string text = fmt::format("[room]\nsize = {}\n[physics]\nsolver = \"{}\"\nrate = {}\n",
                                 space ? "[4, 3, 4]" : "[4, 3]", solver, rate);
  for (int i = 0; i < 5; ++i) {
    const double x = side * number(1.2), angle = side * number(40), vx = side * number(1), vy = number(1),
                 spin = side * number(200), y = 0.4 + 0.35 * i;
    text += space
                ? fmt::format(
                      "[[box]]\nsize = [0.3, 0.2, 0.25]\nposition = [{}, {}, 0]\norientation = {{ axis = [0, "
                      "0, 1], angle = {} }}\nvelocity = [{}, {}, 0]\nspin = [0, 0, {}]\n"
                      "elasticity = 0.5\n",
                      x, y, angle, vx, vy, spin)
                : fmt::format(
                      "[[box]]\nsize = [0.3, 0.2]\nposition = [{}, {}]\nangle = {}\nvelocity = [{}, {}]\n"
                      "spin = {}\n",
                      2 + x, y, angle, vx, vy, spin);
  }
  return text;
}

// what becomes of such a scene in so many seconds
template <int D>
sim::State<D> after(double seconds, const std::string& text) {
  const Scene scene = parse(text, "tumbling.toml", {});
  const auto& world = std::get<sim::World<D>>(scene.world);
  sim::Stepper<D> stepper(world.model);
  sim::State<D> state = world.state;
  stepper.begin(state);
  const int steps = int(std::lround(seconds * sim::value(world.model.rate)));
  for (int i = 0; i < steps; ++i) EXPECT_FALSE(stepper.step(state));
  return state;
}

class Mirrored : public testing::TestWithParam<std::tuple<bool, std::string, int>> {};

TEST_P(Mirrored, RunsStayMirrorImages) {
  const auto [space, solver, rate] = GetParam();
  const auto compare = [&](const auto& x, const auto& image, double both) {
    for (std::size_t i = 0; i < x.size(); ++i) {
      EXPECT_NEAR(x[i][0] + image[i][0], both, 1e-6);
      EXPECT_NEAR(x[i][1], image[i][1], 1e-6);
    }
  };
  for (unsigned seed = 0; seed < 12; ++seed) {
    SCOPED_TRACE(seed);
    const std::string text = tumbling(space, false, solver, rate, seed),
                      image = tumbling(space, true, solver, rate, seed);
    if (space)
      compare(after<3>(0.5, text).x, after<3>(0.5, image).x, 0);
    else
      compare(after<2>(0.5, text).x, after<2>(0.5, image).x, 4);
  }
}

INSTANTIATE_TEST_SUITE_P(Overlaps, Mirrored,
                         testing::Combine(testing::Bool(), testing::Values("direct", "iterative"),
                                          testing::Values(60, 600)));

// What moves in one plane of space stays in it: it is its own mirror image. Whatever pushes from both sides
// of the plane pushes alike, though one after the other.
class Planar : public testing::TestWithParam<std::tuple<std::string, int>> {};

TEST_P(Planar, MotionStaysInItsPlane) {
  const auto [solver, rate] = GetParam();
  for (unsigned seed = 0; seed < 12; ++seed) {
    SCOPED_TRACE(seed);
    const sim::State<3> state = after<3>(0.6, tumbling(true, false, solver, rate, seed));
    for (const auto& x : state.x) EXPECT_NEAR(x[2], 0, 1e-6);
    for (const auto& spin : state.spin) EXPECT_NEAR(std::hypot(spin[0], spin[1]), 0, 1e-4);
  }
}

// Two lower corners lie equally deep: by turning the body back by one and then by the other it would be left
// askew.
TEST_P(Planar, WhatIsPushedApartTurnsWithinIt) {
  const auto [solver, rate] = GetParam();
  const sim::State<3> state = after<3>(0.3, fmt::format(R"(
[room]
size = [4, 3, 4]
[physics]
solver  = "{}"
rate    = {}
overlap = "separate"
[[box]]
size     = [1, 0.2, 1]
position = [0, 1, 0]
fixed    = true
[[box]]
size        = [0.3, 0.2, 0.25]
position    = [0.1, 1.243, 0]
orientation = {{ axis = [0, 0, 1], angle = 20 }}
)",
                                                        solver, rate));
  EXPECT_NEAR(state.x[1][2], 0, 1e-11);
  EXPECT_NEAR(std::hypot(state.spin.back()[0], state.spin.back()[1]), 0, 1e-10);
}

INSTANTIATE_TEST_SUITE_P(Overlaps, Planar,
                         testing::Combine(testing::Values("direct", "iterative"), testing::Values(60, 600)));

class Shipped : public testing::TestWithParam<std::tuple<std::string, int>> {};

TEST_P(Shipped, SceneKeepsItsBodiesApart) {
  const auto& [name, rate] = GetParam();
  const Scene scene =
      read(OBSCURA_SOURCE_DIR "/scenes/" + name + ".toml", {fmt::format("physics.rate={}", rate)});
  EXPECT_LE(run(scene, name == "cards" ? 9 : 1).falling, 0.05);
}

INSTANTIATE_TEST_SUITE_P(Overlaps, Shipped,
                         testing::Combine(testing::Values(std::string("pour"), std::string("cards")),
                                          testing::Values(60, 600)));

// Less than a millionth of the size is no mistake, between bodies and at walls, and nothing is shot away:
// rounding puts bodies so.
TEST(Overlaps, OfAMillionthArePushedApartWithoutAWord) {
  for (const bool space : {false, true}) {
    for (const char* physics : {"solver = \"direct\"", "solver = \"iterative\"", "collision = \"event\""}) {
      for (const bool gravity : {false, true}) {
        const auto at = [&](double x, double y) {
          return space ? fmt::format("[{}, {}, 0]", x, y) : fmt::format("[{}, {}]", x, y);
        };
        std::string text = fmt::format("[room]\nsize = {}\n{}[physics]\n{}\n", space ? "[4, 3, 4]" : "[4, 3]",
                                       gravity ? "" : fmt::format("gravity = {}\n", at(0, 0)), physics);
        const char* size = space ? "[0.5, 0.5, 0.5]" : "[0.5, 0.5]";
        // in the floor by 2e-7 m, and in each other by 4e-7 m
        for (const auto& [x, y] :
             {std::pair(1.0, 0.2499998), std::pair(1.0, 0.7499994), std::pair(1.4999996, 0.25)})
          text += fmt::format("[[box]]\nsize = {}\nposition = {}\nelasticity = 1\n", size, at(x, y));
        text += fmt::format("[[ball]]\nradius = 0.25\nposition = {}\nelasticity = 1\n",
                            at(space ? -1 : 3, 0.2499998));
        const Scene scene = parse(text, "a.toml");
        const auto run = scene.run();
        const auto now = std::get<sim::Snapshot>(run->at(sim::rational(1)));
        for (const auto& body : now.bodies) {
          EXPECT_LT(body.velocity.norm(), 1e-5) << physics << space << gravity;
          EXPECT_LT(body.spin.norm(), 1e-5) << physics << space << gravity;
        }
        // to the rounding of their sizes, under load, too
        const auto place = [&](const char* name) {
          const auto& cast = run->scene_info().bodies;
          const auto found =
              std::find_if(cast.begin(), cast.end(), [&](const auto& it) { return it.name == name; });
          return now.bodies[std::size_t(found - cast.begin())].position;
        };
        if (gravity) {
          EXPECT_NEAR(place("box[0]").y(), 0.25, 1e-9) << physics << space;
          EXPECT_NEAR(place("box[1]").y(), 0.75, 2e-9) << physics << space;
          EXPECT_NEAR(place("ball[0]").y(), 0.25, 1e-9) << physics << space;
        }
        EXPECT_GT(place("box[2]").x() - place("box[0]").x(), 0.5 - 1e-9) << physics << space << gravity;
        EXPECT_NEAR(now.bodies[3].position.y(), 0.25, 2.5e-7) << physics << space << gravity;
        EXPECT_LT(now.energies.kinetic, 1e-10) << physics << space << gravity;
      }
    }
  }
  // a millionth of a box's size and a half is said
  try {
    parse("[room]\nsize = [4, 3]\n[[box]]\nsize = [0.5, 0.5]\nposition = [1, 0.249999]\n", "a.toml");
    ADD_FAILURE();
  } catch (const Error& error) {
    EXPECT_THAT(error.what(), testing::HasSubstr("outside the room: 1e-06 m beyond the floor"));
  }
}

// Balls and boxes of a tenth of a millimetre, which fall several times their width in a 240th of a second,
// lie on each other as large ones do once they have fallen.
TEST(Overlaps, TinyBodiesLieOnEachOther) {
  const TextRun scene(
      "duration = 2\n[physics]\nsolver = 'iterative'\nrate = 60\n[room]\ngravity = [0, -9.81]\nwalls = [{ "
      "point = "
      "[0, 0], normal = [0, 1] }, { point = [-6e-4, 0], normal = [1, 0] }, { point = [6e-4, 0], normal = "
      "[-1, 0] "
      "}]\n[[ball]]\nname = 'a'\nradius = 5.1e-5\nmass = 9e-8\nfriction = 0.4\nposition = [-4.4e-4, "
      "9e-5]\ncopies = { count = [4, 4], offset = [[3e-4, 0], [1e-5, 1.6e-4]] }\n[[box]]\nname = 'b'\nsize = "
      "[8.7e-5, 6.3e-5]\nangle = 22\nmass = 9e-8\nfriction = 0.4\nposition = [-2.9e-4, 9e-5]\ncopies = { "
      "count = "
      "[3, 4], offset = [[3e-4, 0], [1e-5, 1.6e-4]] }\n");
  for (const double t : {0.2, 0.4}) {
    double deepest = 0;
    for (const auto& contact : scene.at(t).contacts) deepest = std::min(deepest, contact.gap);
    EXPECT_GT(deepest, -1e-2 * 6.3e-5) << t << " s";
  }
}

}  // namespace
}  // namespace obscura::scene

// The impacts of every shipped scene, against the closed form of each: a ball in flight that meets one wall
// falls along a parabola, strikes where the parabola meets the wall, and comes back with e times its speed.

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <random>
#include <string>
#include <tuple>
#include <vector>

#include "scene/scene.h"
#include "scene/text_run.h"
#include "sim/shape/shape.h"
#include "sim/step/stepper.h"
#include "where.h"

namespace obscura::scene {
namespace {

struct Count {
  int foreseen = 0, right = 0;
};

// what ties a body, or pulls at it in another way than gravity does
template <int D>
std::vector<char> tied(const sim::Model<D>& model) {
  std::vector<char> all(model.bodies.size(), 0);
  const auto tie = [&](int body) {
    if (body >= 0) all[body] = 1;
  };
  for (const auto& spring : model.springs) tie(spring.a.body), tie(spring.b.body);
  for (const auto& joint : model.joints) tie(joint.a.body), tie(joint.b.body);
  for (const auto& force : model.forces) {
    for (const auto& subject : force.subjects) tie(subject.body);
  }
  for (int i = 0; i < int(all.size()); ++i) {
    const auto& body = model.bodies[i];
    if (!sim::round_radius(body.shape) || body.fixed || body.handout || body.linked || body.drag != 0 ||
        body.quadratic_drag != 0 || body.ground_drag != 0)
      tie(i);
  }
  return all;
}

// Steps a scene through `seconds`, foresees the impacts of balls that are alone with one wall, and counts
// those that come out so.
template <int D>
Count impacts(const sim::World<D>& world, double seconds) {
  const sim::Model<D>& model = world.model;
  Count count;
  if (model.collision == sim::Collision::handout || !model.bonds.empty()) return count;
  const std::vector<char> skip = tied(model);
  if (std::count(skip.begin(), skip.end(), 0) == 0) return count;
  const double h = 1 / value(model.rate), g = std::sqrt(model.gravity.squaredNorm());
  sim::State<D> state = world.state;
  sim::Stepper<D> stepper(model);
  stepper.begin(state);
  for (int step = 0; step < int(seconds / h); ++step) {
    const sim::State<D> before = state;
    if (stepper.step(state)) break;
    const bool blasting =
        std::any_of(before.blasts.begin(), before.blasts.end(), [](const auto& b) { return b.on; });
    for (int i = 0; i < int(skip.size()) && !blasting; ++i) {
      if (skip[i] || before.frozen[i]) continue;
      const double rim = sim::bounding_radius(model.bodies[i].shape);
      const bool held = std::any_of(before.grips.begin(), before.grips.end(),
                                    [&](const auto& grip) { return grip.body == i; });
      // alone: nothing else within thrice what both go
      bool alone = !held;
      for (int j = 0; j < int(skip.size()) && alone; ++j) {
        if (j == i) continue;
        const double ways =
            3 * h * (std::sqrt(before.v[i].squaredNorm()) + std::sqrt(before.v[j].squaredNorm()) + g * h);
        const double far = rim + sim::bounding_radius(model.bodies[j].shape) + ways;
        alone = (before.x[i] - before.x[j]).squaredNorm() > far * far;
      }
      if (!alone) continue;
      // which walls the parabola meets:  gap + u t + a t^2 / 2 = 0
      int met = 0, wall = -1;
      double when = 0, least = 1e300;
      for (int w = 0; w < int(model.walls.size()); ++w) {
        const auto& it = model.walls[w];
        const double gap = (before.x[i] - it.point).dot(it.normal) - rim, u = before.v[i].dot(it.normal);
        const double a = model.gravity.dot(it.normal), end = gap + u * h + 0.5 * a * h * h;
        least = std::min(least, gap);
        if (end > 0) continue;
        const double root = std::sqrt(std::max(0.0, u * u - 2 * a * gap));
        ++met, wall = w, when = 2 * gap / (root - u);
      }
      if (met != 1 || least < 1e-6 * model.scale) continue;
      const auto& it = model.walls[wall];
      const double a = model.gravity.dot(it.normal), strikes = before.v[i].dot(it.normal) + a * when;
      if (strikes > -4 * g * h) continue;  // as slow as what rests
      const double e =
          it.elasticity ? std::sqrt(model.bodies[i].elasticity * *it.elasticity) : model.bodies[i].elasticity;
      ++count.foreseen;
      const double want = -e * strikes + a * (h - when);
      if (std::abs(state.v[i].dot(it.normal) - want) <= 1e-6 * -strikes) ++count.right;
    }
  }
  return count;
}

// Balls in a row without gravity sleep until something strikes them, one after another, within a step or
// within the time between two searches for pairs: what strikes one that sleeps does not strike a wall.
TEST(Impacts, WhatSleepsIsNoWallForWhatStrikesIt) {
  for (const bool space : {false, true}) {
    for (const double elasticity : {0.0, 0.5, 1.0}) {
      for (const double gap : {1e-4, 1e-3, 5e-3, 0.02}) {
        for (const double v : {0.37, 1.0, 3.0}) {
          std::string text = fmt::format(
              "duration = 10\n[room]\nsize = {}\ngravity = {}\nwalls = \"none\"\n[physics]\nsolver = "
              "\"iterative\"\n",
              space ? "[40, 4, 4]" : "[40, 4]", space ? "[0, 0, 0]" : "[0, 0]");
          for (int i = 0; i <= 5; ++i) {
            const double x = i == 0 ? 3 : 4.4 + i * (0.4 + gap);
            text += fmt::format(
                "[[ball]]\nradius = 0.2\nelasticity = {}\nposition = [{:.17g}, 2{}]\nvelocity = [{}, 0{}]\n",
                elasticity, x, space ? ", 2" : "", i == 0 ? v : 0, space ? ", 0" : "");
          }
          TextRun scene(text);
          const sim::Snapshot now = scene.at(6);
          double momentum = 0, energy = 0;
          for (const auto& body : now.bodies)
            momentum += body.velocity.x() / v / 6, energy += body.velocity.squaredNorm() / (v * v);
          EXPECT_NEAR(6 * momentum, 1, 1e-9) << space << elasticity << " " << gap << " " << v;
          EXPECT_LT(energy, 1 + 1e-9) << space << elasticity << " " << gap << " " << v;
          if (elasticity == 1) {
            EXPECT_NEAR(now.bodies[5].velocity.x(), v, 1e-9 * v) << space << " " << gap << " " << v;
          }
        }
      }
    }
  }
}

TEST(Impacts, OfEveryShippedSceneAreThoseOfTheClosedForm) {
  int foreseen = 0, scenes = 0;
  for (const auto& entry : std::filesystem::directory_iterator(OBSCURA_SOURCE_DIR "/scenes")) {
    // bounce's balls begin in one place: see below
    if (entry.path().extension() != ".toml" || entry.path().stem() == "bounce") continue;
    // of scenes by the handout's recipe, that finds impacts at the ends of steps, as they are by forces
    const std::string file = entry.path().string();
    Scene scene = read(file);
    const bool recipe = std::visit(
        [](const auto& world) { return world.model.collision == sim::Collision::handout; }, scene.world);
    if (recipe) scene = read(file, {"physics.collision=contact", "physics.rate=600"});
    const Count count = std::visit([](const auto& world) { return impacts(world, 4); }, scene.world);
    EXPECT_EQ(count.right, count.foreseen) << entry.path();
    foreseen += count.foreseen, scenes += count.foreseen > 0;
    RecordProperty(entry.path().stem().string(), count.foreseen);
  }
  // so that the count is one of something
  EXPECT_GE(foreseen, 50);
  EXPECT_GE(scenes, 5);
}

// bounce.toml by forces: ball k of elasticity e strikes the floor n times faster than `slowest` in 8 s,
//   t_1 = sqrt(2 H / g),   v_n = e^(n-1) g t_1,   2 e v_n / g between two
TEST(Impacts, OfFiveElasticitiesAreAsManyAsTheClosedFormHas) {
  constexpr double kSlowest = 0.5;
  for (const std::string solver : {"direct", "iterative"}) {
    for (const std::string rate : {"60", "600", "6000"}) {
      const Scene scene = read(OBSCURA_SOURCE_DIR "/scenes/bounce.toml",
                               {"physics.collision=contact", "physics.rate=" + rate,
                                "physics.solver=" + solver, "room.size=[20,6]", "ball.copies.offset=[3,0]"});
      const sim::World<2>& world = scene.plane();
      sim::State<2> state = world.state;
      sim::Stepper<2> stepper(world.model);
      stepper.begin(state);
      const double h = 1 / value(world.model.rate), g = -world.model.gravity[1];
      std::vector<int> struck(state.x.size(), 0), want(state.x.size(), 0);
      for (int step = 0; step < int(8 / h + 0.5); ++step) {
        const std::vector<sim::Vec<2>> before = state.v;
        ASSERT_FALSE(stepper.step(state));
        for (std::size_t i = 0; i < struck.size(); ++i)
          struck[i] += before[i][1] < -kSlowest && state.v[i][1] > 0;
      }
      for (std::size_t i = 0; i < struck.size(); ++i) {
        const auto& body = world.model.bodies[i];
        double t = std::sqrt(2 * (world.state.x[i][1] - *sim::round_radius(body.shape)) / g), v = g * t;
        // one within a step of the slowest, or of the end, may be counted or not
        for (; t < 8 && v > kSlowest + 1.5 * g * h; t += 2 * v / g) ++want[i], v *= body.elasticity;
        EXPECT_NEAR(struck[i], want[i], v > kSlowest && t < 8 + 2 * h ? 1 : 0)
            << solver << " at " << rate << ", ball " << i;
      }
    }
  }
}

// Two rods on hinges, or on welds and sliders of one more, swing in a plane of space against a post. What is
// across that plane is as small as rounding, 1e-320 and less; all else keeps its energy, as by ball joints.
TEST(Impacts, HingesInSpaceKeepTheirEnergy) {
  for (const std::string mode : {"contact", "event"}) {
    for (const std::string second : {"hinge", "weld"}) {
      const auto rod = [](int i) {
        return fmt::format(
            "[[box]]\nname = \"b{0}\"\nsize = [0.5, 0.05, 0.05]\nmass = 1\nposition = [{1}, 3, "
            "0]\nelasticity = "
            "1\nfriction = 0\n",
            i, 0.25 + 0.5 * i);
      };
      const TextRun run(
          "duration = 9\n[room]\nsize = [4, 4, 4]\nwalls = \"none\"\n[physics]\ncollision = \"" + mode +
          "\"\n" + rod(0) + rod(1) +
          "[[joint]]\ntype = \"hinge\"\nbetween = [\"b0\", \"room\"]\nat = [0, 3, 0]\n[[joint]]\ntype = \"" +
          second +
          "\"\nbetween = [\"b1\", \"b0\"]\nat = [0.5, 3, 0]\n[contact]\nignore = [[\"b0\", "
          "\"b1\"]]\n[[box]]\nname "
          "= \"post\"\nsize = [0.1, 0.1, 0.3]\nposition = [-0.2, 2.3, 0]\nfixed = true\nelasticity = "
          "1\nfriction = "
          "0\n");
      const double begun = run.at(0).energies.total();
      for (const double t : {1.0, 4.0, 8.0})
        EXPECT_NEAR(run.at(t).energies.total(), begun, 1e-7) << mode << second << t;
    }
  }
}

// A ball of radius 0.1 in either dimension at (x, y), with the rest of its keys.
std::string ball_at(int dimension, const std::string& name, double mass, double x, double y, double vx,
                    double vy, const std::string& more) {
  return disc(name, mass, 0.1,
              fmt::format("position = [{0}, {1}{4}]\nvelocity = [{2}, {3}{4}]\n{5}", x, y, vx, vy,
                          dimension == 2 ? "" : ", 0", more));
}

// What meets in one instant is solved together, by every solver to the same end, mirrored where it is
// mirrored, with restitution and friction: two balls on both ends of a slab; one between two; one on a row
// that touches; one on a slab on which two others lie; and balls on rods.
TEST(Impacts, OfOneInstantAreSolvedTogetherByEverySolver) {
  for (const int dimension : {2, 3}) {
    const std::string deep = dimension == 2 ? "" : ", 0.4";
    for (const double e : {1.0, 0.5, 0.0}) {
      for (const double mu : {0.0, 0.3}) {
        const std::string made = fmt::format("elasticity = {}\nfriction = {}\n", e, mu);
        const auto ball = [&](const std::string& name, double mass, double x, double y, double vx,
                              double vy) { return ball_at(dimension, name, mass, x, y, vx, vy, made); };
        const auto slab = [&](double height) {
          return fmt::format("[[box]]\nname = \"m\"\nsize = [0.4, {}{}]\nmass = 2\nposition = [0, 0{}]\n{}",
                             height, deep, dimension == 2 ? "" : ", 0", made);
        };
        const std::string rods = "[[joint]]\ntype = \"rod\"\nbetween = [\"c\", \"d\"]\n";
        const std::tuple<const char*, double, std::string> cases[] = {
            {"both ends", 0.51, slab(2) + ball("p", 1, -1.3, 0.9, 2, 0) + ball("q", 1, 1.3, -0.9, -2, 0)},
            {"between two", 0.336,
             ball("a", 1, -0.15, 0, 0, 0) + ball("b", 2, 0.15, 0, 0, 0) +
                 ball("c", 1.5, 0, std::sqrt(0.0175) + 1, 0, -3)},
            {"a row", 0.27,
             ball("a", 1, -1, 0.02, 3, 0) + ball("b", 1, 0, 0, 0, 0) + ball("c", 2, 0.2, 0, 0, 0) +
                 ball("d", 1, 0.4, 0, 0, 0)},
            {"on a slab", 0.51,
             slab(1) + ball("p", 1, -1.3, 0.2, 2, 0.3) + ball("q", 1, 0.3, 0.3, 0, 0) +
                 ball("r", 1, 0.3, -0.3, 0, 0)},
            {"on a rod", 0.27,
             ball("a", 1, -1, 0.02, 3, 0) + ball("b", 1, -0.2, 0, 0, 0) + ball("c", 1, 0, 0, 0, 0) +
                 ball("d", 1, 0.3, 0.6, 0, 0) + rods},
        };
        for (const auto& [what, time, bodies] : cases) {
          // what stays in touch turns on; forces of contact are of first order by iterations
          const bool stays = e == 0 || what == std::string("on a slab");
          std::vector<sim::Snapshot> ends;
          for (const Manner& manner : kManners) {
            for (const int rate : {60, 600}) {
              SCOPED_TRACE(fmt::format("{} in {}D by {} at {}, e = {}, mu = {}", what, dimension, manner.name,
                                       rate, e, mu));
              const TextRun run(empty_room(manner, dimension, "") + fmt::format("rate = {}\n", rate) +
                                bodies);
              ends.push_back(run.at(time));
              for (std::size_t i = 0; i < ends[0].bodies.size(); ++i) {
                EXPECT_LT((ends.back().bodies[i].velocity - ends[0].bodies[i].velocity).norm(),
                          stays ? 5e-3 : 2e-6)
                    << i;
                EXPECT_LT((ends.back().bodies[i].spin - ends[0].bodies[i].spin).norm(), stays ? 5e-3 : 1e-5)
                    << i;
              }
            }
          }
          if (what == std::string("both ends")) {
            for (const sim::Snapshot& end : ends) {
              const std::size_t p = 0, q = 1, m = 2;
              ASSERT_EQ(end.bodies.size(), 3u);
              EXPECT_LT((end.bodies[p].velocity + end.bodies[q].velocity).norm(), 1e-9);
              EXPECT_LT((end.bodies[p].spin - end.bodies[q].spin).norm(), 1e-9);
              EXPECT_LT(end.bodies[m].velocity.norm(), 1e-9);
            }
          }
        }
      }
    }
  }
}

// A ball that only touches the block that is struck under it: nothing presses them together, so that nothing
// rubs.
TEST(Impacts, WhatDoesNotPressDoesNotRub) {
  for (const int dimension : {2, 3}) {
    for (const Manner& manner : kManners) {
      SCOPED_TRACE(fmt::format("{}D by {}", dimension, manner.name));
      const std::string size = dimension == 2 ? "[0.6, 0.2]" : "[0.6, 0.2, 0.4]",
                        more = "elasticity = 1\nfriction = 0.5\n";
      const TextRun run(empty_room(manner, dimension) +
                        fmt::format("[[box]]\nname = \"block\"\nsize = {}\nmass = 1\nposition = [0, 0{}]\n{}",
                                    size, dimension == 2 ? "" : ", 0", more) +
                        ball_at(dimension, "a", 1, 0, 0.2, 0, 0, more) +
                        ball_at(dimension, "b", 1, 0.43, 0, -1, 0, more));
      const sim::Snapshot end = run.at(0.05);
      EXPECT_LT(end.bodies[number_of(run, "a")].velocity.norm(), 1e-12);
      EXPECT_LT(end.bodies[number_of(run, "a")].spin.norm(), 1e-12);
      EXPECT_NEAR(end.bodies[number_of(run, "block")].velocity.x(), -1, 1e-12);
    }
  }
}

// Limits that are reached, taut ropes and pulleys hold what is struck at once, as rods and pins do: a ball
// that falls 1 m onto a shelf on two ropes, a flap and a slab at their ends, or the far link of a row of
// flaps, comes back from it as from the floor; one that falls onto a weight of a pulley meets both weights.
TEST(Impacts, EndsOfJointsHoldWhatIsStruck) {
  const double e = 0.8, fast = std::sqrt(2 * 9.81), fell = std::sqrt(2 / 9.81), later = 0.5 - fell;
  for (const int dimension : {2, 3}) {
    const std::string z = dimension == 2 ? "" : ", 0", deep = dimension == 2 ? "" : ", 0.5",
                      turns = dimension == 2 ? "type = \"pin\"" : "type = \"hinge\"\naxis = [0, 0, 1]";
    for (const double way : {1.0, -1.0}) {
      const auto slab = [&](const std::string& name, double mass, double x, double width) {
        return fmt::format(
            "[[box]]\nname = \"{}\"\nmass = {}\nsize = [{}, 0.1{}]\nposition = [{}, 0{}]\nelasticity = 1\n",
            name, mass, width, deep, way * x, z);
      };
      const auto rope = [&](double x) {
        return fmt::format(
            "[[joint]]\ntype = \"rope\"\nbetween = [[{0}, 2{1}], {{ body = \"s\", local = [{0}, 0{1}] }}]\n",
            x, z);
      };
      const auto flap = [&](const std::string& name, const std::string& on, double x) {
        return fmt::format("[[joint]]\n{}\nbetween = [\"{}\", \"{}\"]\nat = [{}, 0{}]\nlimits = {}\n", turns,
                           name, on, way * x, z, way > 0 ? "[0, 60]" : "[-60, 0]");
      };
      const std::string rails =
          fmt::format("[[joint]]\ntype = \"slider\"\nbetween = [\"s\", \"room\"]\naxis = [0, 1{}]\n", z);
      std::string row;
      for (int i = 0; i < 4; ++i) {
        row += slab(fmt::format("f{}", i), 0.5, 0.5 * i, 0.5);
        row += flap(fmt::format("f{}", i), i == 0 ? "room" : fmt::format("f{}", i - 1), 0.5 * i - 0.25);
      }
      const std::string weights =
          slab("s", 1.5, 0, 2) + rails + ball_at(dimension, "w", 1.5, way * 2, 0, 0, 0, "") +
          fmt::format(
              "[[joint]]\ntype = \"pulley\"\nbetween = [{{ body = \"s\", local = [{0}, 0{1}] }}, \"w\"]\n"
              "over = [[{0}, 2{1}], [{2}, 2{1}]]\n",
              way * 0.7, z, way * 2);
      // what is struck, its mass as the ball meets it, and how near
      const std::tuple<const char*, std::string, double, double> cases[] = {
          {"a shelf on ropes", slab("s", 2, 0, 2) + rope(0.9) + rope(-0.9), 1e300, 1e-8},
          {"a flap", slab("s", 2, 0, 2) + flap("s", "room", -1), 1e300, 1e-8},
          {"a slab on rails", slab("s", 2, 0, 2) + rails + "limits = [0, 1]\n", 1e300, 1e-8},
          {"a row of flaps", row, 1e300, 1e-7},
          {"weights", weights, 3, 1e-8},
      };
      for (const auto& [what, bodies, mass, near] : cases) {
        for (const Manner& manner : kManners) {
          for (const int rate : {60, 600}) {
            for (const char* impacts : {"simultaneous", "sequential"}) {
              SCOPED_TRACE(fmt::format("{} in {}D by {} at {}, {}, {}", what, dimension, manner.name, rate,
                                       impacts, way));
              const std::string keys = fmt::format("rate = {}\nimpacts = \"{}\"\n", rate, impacts);
              const TextRun run((dimension == 2 ? plane_without_walls(manner) : space_without_walls(manner)) +
                                keys + bodies +
                                ball_at(dimension, "b", 1, way * (mass < 1e300 ? -0.4 : 0.6), 1.15, 0, 0,
                                        "elasticity = 0.64\nfriction = 0\n"));
              const double back = mass < 1e300 ? (e * mass - 1) / (1 + mass) : e;
              EXPECT_NEAR(run.at(0.5).bodies[number_of(run, "b")].velocity.y(), back * fast - 9.81 * later,
                          near);
            }
          }
        }
      }
    }
  }
}

// A slack rope that snaps taut where one of its ends touches another body: both ends go on together, without
// a rebound, as by the direct solver, whenever within a step it is.
TEST(Impacts, ARopeThatSnapsTautBesideAContactDoesNotRebound) {
  for (const int dimension : {2, 3}) {
    const std::string z = dimension == 2 ? "" : ", 0", deep = dimension == 2 ? "" : ", 0.3";
    for (const int rate : {60, 600}) {
      for (const double length : {0.7, 0.8, 0.9, 1.2}) {
        const auto speeds = [&](const Manner& manner) {
          const std::string clay = "elasticity = 0\nfriction = 0\nmass = 1\n";
          const TextRun run(
              empty_room(manner, dimension, "") + fmt::format("rate = {}\n", rate) +
              fmt::format(
                  "[[ball]]\nname = \"a\"\nposition = [-0.6, 0{0}]\nradius = 0.2\nvelocity = [-2, 0{0}]\n",
                  z) +
              clay +
              fmt::format("[[box]]\nname = \"b\"\nposition = [0, 0{}]\nsize = [0.3, 0.4{}]\n", z, deep) +
              clay +
              fmt::format(
                  "[[ball]]\nname = \"c\"\nposition = [0.36, 0.1{0}]\nradius = 0.2\nvelocity = [-1, 0{0}]\n",
                  z) +
              clay +
              fmt::format("[[joint]]\ntype = \"rope\"\nbetween = [\"a\", \"b\"]\nlength = {}\n", length));
          const sim::Snapshot end = run.at(0.8);
          return std::pair(end.bodies[number_of(run, "a")].velocity.x(),
                           end.bodies[number_of(run, "b")].velocity.x());
        };
        const auto exact = speeds(kManners[0]), many = speeds(kManners[2]);
        SCOPED_TRACE(fmt::format("{}D at {}, {} m", dimension, rate, length));
        EXPECT_NEAR(many.first, exact.first, 3e-3);
        EXPECT_NEAR(many.second, exact.second, 3e-3);
      }
    }
  }
}

/// A box that does not bounce, and how it moves. `turn`: its angle, in space about x, y and z, degrees.
struct ClayBox {
  std::vector<double> size, position, turn, spin, velocity;
  double mass = 1;

  /// Mirrored at the plane x = 0: a turn about x goes on, others go the other way.
  ClayBox mirrored() const {
    ClayBox it = *this;
    it.position[0] = -it.position[0], it.velocity[0] = -it.velocity[0];
    for (std::vector<double>* angles : {&it.turn, &it.spin})
      for (std::size_t i = angles->size() == 1 ? 0 : 1; i < angles->size(); ++i) (*angles)[i] = -(*angles)[i];
    return it;
  }
  std::string text(double friction) const {
    const auto list = [](const std::vector<double>& of) {
      return of.size() == 1 ? fmt::format("{}", of[0]) : fmt::format("[{}]", fmt::join(of, ", "));
    };
    return fmt::format(
        "[[box]]\nsize = {}\nposition = {}\n{} = {}\nspin = {}\nvelocity = {}\nmass = {}\nelasticity = 0\n"
        "friction = {}\n",
        list(size), list(position), size.size() == 2 ? "angle" : "orientation", list(turn), list(spin),
        list(velocity), mass, friction);
  }
};
using ClayPair = std::array<ClayBox, 2>;

// one corner slides along the other box and past its end
const ClayPair kSlideOff = {{{{0.33, 0.26}, {0, 0.14}, {30}, {0}, {1.91, -0.44}, 1},
                             {{0.29, 0.25}, {0.6, 0.02}, {5}, {-45}, {-0.49, -0.07}, 1}}};
const ClayPair kSlideOffInSpace = {{{{0.337, 0.353, 0.381},
                                     {-0.3, 2.928, 0.041},
                                     {36.4, 33.5, 6.56},
                                     {-99, -27, 148},
                                     {1.86, -0.4, -0.18},
                                     2.87},
                                    {{0.242, 0.263, 0.382},
                                     {0.3, 2.951, -0.022},
                                     {11.5, 27.5, -0.71},
                                     {-126, 22, -139},
                                     {-0.51, -0.41, -0.31},
                                     2.17}}};
// they slide on an edge until faces come to lie on each other
const ClayPair kComeToLie = {{{{0.357, 0.3041, 0.3023},
                               {-0.3, 2.9681, 0.149},
                               {-18.9572, -31.6566, -21.5029},
                               {-71.8688, -51.7899, -69.6267},
                               {1.5157, -0.3924, -0.1745},
                               1.14},
                              {{0.2403, 0.2142, 0.2405},
                               {0.3, 3.0127, -0.0334},
                               {21.0124, 27.2754, -7.7006},
                               {-120.1925, 68.3985, 76.6989},
                               {-0.3738, -0.1039, 0.1583},
                               1.107}}};
const ClayPair kComeToLieRubbing = {{{{0.2047, 0.3931, 0.2572},
                                      {-0.3, 3.0427, -0.0952},
                                      {-12.1113, 19.1476, 38.5826},
                                      {-54.0509, -89.1588, -129.546},
                                      {1.3356, -0.0087, -0.1793},
                                      0.376},
                                     {{0.3132, 0.33, 0.3309},
                                      {0.3, 3.0737, -0.0654},
                                      {-33.6294, 18.1922, 9.5724},
                                      {28.4097, -137.6122, -119.4235},
                                      {-0.8519, 0.2649, -0.3736},
                                      1.36}}};

// such a pair alone
TextRun clay(const ClayPair& pair, const Manner& manner, int rate, double friction) {
  return TextRun(empty_room(manner, int(pair[0].size.size())) + fmt::format("rate = {}\n", rate) +
                 pair[0].text(friction) + pair[1].text(friction));
}

// Clay boxes meet, and a corner of one slides along the other and past its end: it meets nothing there, as it
// goes along the face. The end once struck the other side of the corner within the depth of the overlap that
// iterations leave (a tenth of the energy, at every rate). The iterations lose energy of first order while it
// slides, at 60 and 240 steps a second alike: those are their substeps.
TEST(Impacts, ACornerThatSlidesOffMeetsNothing) {
  for (const ClayPair& drawn : {kSlideOff, kSlideOffInSpace}) {
    for (const ClayPair& pair : {drawn, ClayPair{{drawn[0].mirrored(), drawn[1].mirrored()}}}) {
      for (const double friction : {0.0, 0.3}) {
        const auto energy = [&](const Manner& manner, int rate) {
          return clay(pair, manner, rate, friction).at(1).energies.total();
        };
        const double exact = energy(kManners[1], 600);
        SCOPED_TRACE(
            fmt::format("{}D, friction {}, velocity {}", pair[0].size.size(), friction, pair[0].velocity[0]));
        EXPECT_NEAR(energy(kManners[0], 600), exact, 1e-3 * exact);
        EXPECT_NEAR(energy(kManners[2], 60), exact, 2e-2 * exact);
        EXPECT_NEAR(energy(kManners[2], 1920), exact, 3e-3 * exact);
        // what pushes them apart turns them, and gives nothing
        const TextRun run = clay(pair, kManners[2], 600, friction);
        double last = 1e300;
        for (int i = 0; i <= 60; ++i) {
          const double now = run.at(i / 60.0).energies.total();
          EXPECT_LE(now, last * (1 + 1e-9)) << i;
          last = now;
        }
      }
    }
  }
}

// A ball that meets the upper of three boxes beside a seam meets the next one with the speed that the first
// blow leaves, if it gets there, at every rate: so many touches meet there that iterations take the blows.
// Both at once gave 3.8 m/s to the middle one, at some rates.
TEST(Impacts, ABlowBesideASeamIsNotTwo) {
  const auto middle = [](const Manner& manner, int rate) {
    const TextRun run(
        "duration = 1\n[room]\nsize = [20, 8, 20]\n" + manner.keys + fmt::format("\nrate = {}\n", rate) +
        "[[box]]\nname = 'a'\nsize = [0.4, 0.4, 0.4]\nmass = 0.064\nposition = [0, 0.2, 0]\nelasticity = "
        "0.3\nfriction = 0\ncopies = { count = 3, offset = [0, 0.4, 0] }\n[[ball]]\nname = 'b'\nradius = "
        "0.2\nfriction = 0\nmass = 0.05\nposition = [-1, 0.847, 0]\nvelocity = [8, 0, 0]\n");
    return run.at(0.12).bodies[1].velocity.x();
  };
  const double exact = middle(kManners[1], 600);
  for (const int rate : {60, 240, 300, 600, 1200})
    EXPECT_NEAR(middle(kManners[2], rate), exact, 0.25) << rate;
}

// Clay boxes of space that slide on each other, on an edge, until faces come to lie on each other: all
// corners of these meet at once, though overlaps that iterations leave let them close one after another (a
// fiftieth of the energy, at every rate).
TEST(Impacts, FacesThatComeToLieOnEachOtherMeetAtOnce) {
  for (const auto& [pair, friction] : {std::pair(kComeToLie, 0.0), std::pair(kComeToLieRubbing, 0.3)}) {
    const auto energy = [&](const Manner& manner, int rate) {
      return clay(pair, manner, rate, friction).at(0.29).energies.total();
    };
    const double exact = energy(kManners[1], 600);
    SCOPED_TRACE(friction);
    EXPECT_NEAR(energy(kManners[0], 600), exact, 1e-3 * exact);
    EXPECT_NEAR(energy(kManners[2], 1920), exact, 5e-3 * exact);
    EXPECT_NEAR(energy(kManners[2], 3840), exact, 3e-3 * exact);
  }
}

// Just after a step a contact has the force of that step, not what puts right its errors within next to no
// time (once 1,600 times as much here).
TEST(Impacts, ForcesBetweenStepsAreThoseOfTheLast) {
  for (const Manner& manner : kManners) {
    const TextRun run = clay(kSlideOff, manner, 600, 0);
    const auto force = [&](double t) {
      sim::Vec3 sum = sim::Vec3::Zero();
      for (const sim::Snapshot::Contact& contact : run.at(t).contacts) sum += contact.force;
      return sum;
    };
    SCOPED_TRACE(manner.name);
    const sim::Vec3 whole = force(0.15);
    EXPECT_GT(whole.norm(), 0.5);
    EXPECT_LT((force(0.150001) - whole).norm(), 0.02 * whole.norm());
    EXPECT_LT((force(0.1515) - whole).norm(), 0.1 * whole.norm());
  }
}

// A ball that bounces on what lies at rest, one block or two, loses what e takes and nothing for the step in
// which it strikes: the block under it does not fall before it is struck.
TEST(Impacts, WhatLiesAtRestIsStruckAtRest) {
  const double g = 9.81, drop = 0.4;
  for (const int dimension : {2, 3}) {
    const std::string z = dimension == 2 ? "" : ", 2", deep = dimension == 2 ? "" : ", 0.4";
    for (const Manner& manner : kManners) {
      for (const int blocks : {1, 2}) {
        // more contacts than the iterations take together (sim/solve/iterate/instant_impact.h)
        if (blocks == 2 && dimension == 3 && manner.name == "iterative") continue;
        for (const double e : {1.0, 0.7}) {
          for (const int rate : {60, 600}) {
            SCOPED_TRACE(
                fmt::format("{} blocks in {}D by {} at {}, e = {}", blocks, dimension, manner.name, rate, e));
            std::string text =
                fmt::format("duration = 2\n[room]\nwalls = \"ground\"\nsize = [4, 4{}]\n{}\nrate = {}\n",
                            dimension == 2 ? "" : ", 4", manner.keys, rate);
            for (int i = 0; i < blocks; ++i)
              text += fmt::format(
                  "[[box]]\nname = \"t{}\"\nsize = [0.4, 0.4{}]\nposition = [2, {}{}]\nelasticity = 1\n", i,
                  deep, 0.2 + 0.4 * i, z);
            text +=
                fmt::format("[[ball]]\nname = \"b\"\nradius = 0.1\nposition = [2, {}{}]\nelasticity = {}\n",
                            0.4 * blocks + 0.1 + drop, z, e * e);
            const TextRun run(text);
            double t = std::sqrt(2 * drop / g), up = e * std::sqrt(2 * g * drop);
            for (int bounce = 1; bounce < 4; ++bounce, up *= e) t += 2 * up / g;
            const double when = t + 0.7 * up / g;
            // by the iterations the block falls g h^2 / 2, at most, until it is struck, and so a bounce is
            // late
            const double near = manner.name == "iterative" ? 1.2e-3 : 1e-5;
            EXPECT_NEAR(run.at(when).bodies[number_of(run, "b")].velocity.y(), up - g * (when - t), near);
          }
        }
      }
    }
  }
}

// Eight boxes fall, rubbing, on a sled that slides on the floor without friction: what pushes them out of
// each other, or sees to it that contacts give no energy, is no brake. In space the direct solver goes on by
// approximate forces here, and says so.
TEST(Impacts, AHeapThatFallsOnASledTakesNoMomentum) {
  for (const int dimension : {2, 3}) {
    const std::string z = dimension == 2 ? "" : ", 0", deep = dimension == 2 ? "" : ", 0.3";
    for (const Manner& manner : kManners) {
      if (manner.name == "event") continue;
      for (const int rate : {60, 600}) {
        SCOPED_TRACE(fmt::format("{}D by {} at {}", dimension, manner.name, rate));
        std::string text = fmt::format(
            "duration = 1\n[room]\nwalls = \"ground\"\nsize = [20, 6{}]\ncorner = [-10, 0{}]\n{}\nrate = "
            "{}\n",
            dimension == 2 ? "" : ", 6", dimension == 2 ? "" : ", -3", manner.keys, rate);
        text += fmt::format(
            "[[box]]\nname = \"s\"\nsize = [3, 0.2{}]\nmass = 20\nposition = [0, 0.1{}]\nvelocity = [1, "
            "0{}]\n"
            "friction = 0\n",
            dimension == 2 ? "" : ", 3", z, z);
        for (int i = 0; i < 8; ++i)
          text += fmt::format(
              "[[box]]\nname = \"b{}\"\nsize = [0.3, 0.3{}]\nmass = 1\nposition = [{}, {}{}]\nvelocity = [1, "
              "0{}]\n"
              "friction = 0.4\nelasticity = 0.2\n",
              i, deep, -0.6 + 0.31 * (i % 4) + 0.02 * i, 0.5 + 0.35 * (i / 4), z, z);
        const TextRun run(text);
        const sim::Snapshot end = run.at(1);
        double momentum = 20 * end.bodies[0].velocity.x();
        for (std::size_t i = 1; i < end.bodies.size(); ++i) momentum += end.bodies[i].velocity.x();
        EXPECT_NEAR(momentum, 28, 28 * (dimension == 2 ? 1e-11 : 3e-4));
      }
    }
  }
}

// A ball that rests from the start is struck within the first step.
TEST(Impacts, WhatBeginsAtRestIsNoWallForWhatStrikesItAtOnce) {
  for (const int dimension : {2, 3}) {
    for (const Manner& manner : kManners) {
      for (const int rate : {60, 600}) {
        SCOPED_TRACE(fmt::format("{}D by {} at {}", dimension, manner.name, rate));
        const std::string more = "elasticity = 1\nfriction = 0\n";
        const TextRun run(fmt::format("duration = 1\n[room]\nsize = {}\ngravity = {}\n{}\nrate = {}\n",
                                      dimension == 2 ? "[8, 3]" : "[8, 3, 8]",
                                      dimension == 2 ? "[0, -1]" : "[0, -1, 0]", manner.keys, rate) +
                          ball_at(dimension, "a", 1, 2, 0.1, 0, 0, more) +
                          ball_at(dimension, "b", 1, 1.799, 0.1, 2, 0, more));
        const sim::Snapshot end = run.at(0.05);
        EXPECT_NEAR(end.bodies[number_of(run, "a")].velocity.x(), 2, 1e-9);
        EXPECT_NEAR(end.bodies[number_of(run, "b")].velocity.x(), 0, 1e-9);
      }
    }
  }
}

// A row of balls that lie on the floor, asleep, with gaps that the first crosses within the step in which it
// is struck: the last leaves with the speed of what struck the first, and what sleeps on the way is no wall.
TEST(Impacts, WhatSleepsBesideWhatIsStruckIsNoWall) {
  for (const int dimension : {2, 3}) {
    for (const Manner& manner : kManners) {
      for (const int rate : {60, 120, 600}) {
        for (const double gap : {1e-4, 1e-3, 3e-3}) {
          for (const double way : {1, -1}) {
            SCOPED_TRACE(
                fmt::format("{}D by {} at {}, gaps of {}, {}", dimension, manner.name, rate, gap, way));
            const std::string more = "elasticity = 1\nfriction = 0\n";
            std::string text =
                fmt::format("duration = 1\n[room]\nwalls = \"ground\"\nsize = {}\n{}\nrate = {}\n",
                            dimension == 2 ? "[8, 3]" : "[8, 3, 8]", manner.keys, rate) +
                ball_at(dimension, "cue", 1, 4 - way, 0.1, 5 * way, 0, more);
            for (int i = 0; i < 4; ++i)
              text +=
                  ball_at(dimension, fmt::format("b{}", i), 1, 4 + way * i * (0.2 + gap), 0.1, 0, 0, more);
            const TextRun run(text);
            const sim::Snapshot end = run.at(0.2);
            EXPECT_NEAR(end.bodies[number_of(run, "cue")].velocity.x(), 0, 5e-6);
            EXPECT_NEAR(end.bodies[number_of(run, "b3")].velocity.x(), 5 * way, 5e-6);
          }
        }
      }
    }
  }
}

// One that meets a body at rest where a step ends, but for rounding, finds it awake: it would be a wall.
TEST(Impacts, WhatSleepsIsNoWallWhereAStepEnds) {
  for (const int dimension : {2, 3}) {
    for (const int rate : {60, 100, 240, 300, 600}) {
      for (const double fast : {0.1, 0.15, 0.2, 0.25, 0.7, 2.0}) {
        for (const int steps : {2, 7, 12, 24}) {
          const std::string more = "elasticity = 1\nfriction = 0\n";
          const TextRun run(empty_room(kManners[2], dimension, "") + fmt::format("rate = {}\n", rate) +
                            ball_at(dimension, "cue", 1, 0, 0, fast, 0, more) +
                            ball_at(dimension, "target", 1, 0.2 + fast * steps / rate, 0, 0, 0, more));
          const sim::Snapshot end = run.at(1);
          EXPECT_NEAR(end.bodies[number_of(run, "cue")].velocity.x(), 0, 1e-9)
              << dimension << "D at " << rate << ", " << fast << " m/s, " << steps;
          EXPECT_NEAR(end.bodies[number_of(run, "target")].velocity.x(), fast, 1e-9);
        }
      }
    }
  }
}

// The forces that the first instant shows are also those of what lies a rounding, or a fall shorter than a
// step, above its ground; not of what falls farther, nor of what strikes it in the first step.
TEST(Impacts, ForcesAtTheStartAreOfWhatLiesThere) {
  struct Case {
    double gap, down, newtons;
  };
  for (const int dimension : {2, 3}) {
    for (const Manner& manner : kManners) {
      for (const Case& each : {Case{0, 0, 9.81}, Case{1e-12, 0, 9.81}, Case{1e-6, 0, 9.81}, Case{0.05, 0, 0},
                               Case{1e-3, 3, 0}}) {
        SCOPED_TRACE(
            fmt::format("{}D by {}, {} m above, {} m/s", dimension, manner.name, each.gap, each.down));
        const TextRun run(fmt::format("duration = 1\n[room]\nwalls = \"ground\"\nsize = {}\n{}\n",
                                      dimension == 2 ? "[8, 3]" : "[8, 3, 8]", manner.keys) +
                          ball_at(dimension, "a", 1, 4, 0.1 + each.gap, 0, -each.down, "elasticity = 0\n"));
        const sim::Snapshot begun = run.at(0);
        double up = 0;
        for (const sim::Snapshot::Contact& contact : begun.contacts) {
          up += contact.force.y();
          EXPECT_EQ(contact.impulse.norm(), 0);
        }
        // by the iterations it is the mean over the first step, in which the gap is fallen through
        const double fall = manner.name == "iterative" && each.newtons > 0 ? each.gap * 600 * 600 : 0;
        EXPECT_NEAR(up, each.newtons - fall, 1e-6);
      }
    }
  }
}

// What rests on the limit of its slider, hangs on a taut rope, or is held by friction or a motor, and is
// struck off it from below within a step: until the blow it is held, and after it by what still can.
TEST(Impacts, WhatJointsHeldUntilABlowHasNotFallenBeforeIt) {
  const double g = 9.81, ball = 3, speed = 0.8;
  for (const int dimension : {2, 3}) {
    const auto at = [&](double x, double y) {
      return dimension == 2 ? fmt::format("[{}, {}]", x, y) : fmt::format("[{}, {}, 0]", x, y);
    };
    const std::string smooth = "elasticity = 1\nfriction = 0\n", up = at(0, 1);
    const auto slider = [&](const char* name, double x, const char* more) {
      return fmt::format(
          "[[box]]\nname = '{0}'\nposition = {1}\nsize = {2}\nmass = 1\n{3}[[joint]]\ntype = "
          "'slider'\nbetween = "
          "['{0}', 'room']\naxis = {4}\n{5}\n[[ball]]\nname = 'b{0}'\nradius = 0.1\nmass = {6}\nposition = "
          "{7}\nvelocity = {8}\n{3}",
          name, at(x, 0), dimension == 2 ? "[1, 0.1]" : "[1, 0.1, 1]", smooth, up, more, ball, at(x, -0.17),
          at(0, speed));
    };
    for (const int rate : {60, 240, 960}) {
      const TextRun scene(
          (dimension == 2
               ? plane_without_walls({"", fmt::format("[physics]\nsolver = 'iterative'\nrate = {}", rate)})
               : space_without_walls({"", fmt::format("[physics]\nsolver = 'iterative'\nrate = {}", rate)})) +
          slider("s", 6, "limits = [0, 5]") + slider("f", 3, "friction = 15") +
          slider("m", 0, "motor = { speed = 0, most = 12 }") +
          "[[ball]]\nname = 'h'\nradius = 0.1\nmass = 1\nposition = " + at(-5, 0) + "\n" + smooth +
          "[[joint]]\ntype = 'rope'\nbetween = [" + at(-5, 1) + ", 'h']\n" +
          fmt::format("[[ball]]\nname = 'bh'\nradius = 0.1\nmass = {}\nposition = {}\nvelocity = {}\n", ball,
                      at(-5, -0.22), at(0, speed)) +
          smooth);
      const auto struck = [&](double gap, double brakes, double t) {
        const double when = (speed - std::sqrt(speed * speed - 2 * g * gap)) / g;
        return 2 * ball / (ball + 1) * (speed - g * when) - (g + brakes) * (t - when);
      };
      const sim::Snapshot now = scene.at(0.04);
      const auto speed_of = [&](const char* name) { return now.bodies[number_of(scene, name)].velocity.y(); };
      EXPECT_NEAR(speed_of("s"), struck(0.02, 0, 0.04), 1e-9) << dimension << " at " << rate;
      EXPECT_NEAR(speed_of("h"), struck(0.02, 0, 0.04), 1e-9) << dimension << " at " << rate;
      EXPECT_NEAR(speed_of("f"), struck(0.02, 15, 0.04), 1e-9) << dimension << " at " << rate;
      EXPECT_NEAR(speed_of("m"), struck(0.02, 12, 0.04), 1e-9) << dimension << " at " << rate;
    }
  }
}

// A cube that lies on a plank, which lies on the ground, is struck in its middle: its friction brakes it from
// then on, and not what has struck it.
TEST(Impacts, FrictionOfWhatIsStruckIsNotHandedOn) {
  for (const int rate : {60, 100, 240, 960}) {
    const TextRun scene(fmt::format(
        "duration = 1\n[room]\nwalls = 'ground'\nsize = [20, 10, 10]\n[physics]\nsolver = 'iterative'\nrate "
        "= "
        "{}\n[[box]]\nname = 'plank'\nposition = [0, 0.1, 0]\nsize = [10, 0.2, 4]\nmass = 1000\nfriction = "
        "0.7\nelasticity = 0\n[[box]]\nname = 's'\nposition = [0, 0.4, 0]\nsize = [0.4, 0.4, 0.4]\nmass = "
        "1\nelasticity = 1\nfriction = 0.7\n[[ball]]\nname = 'b'\nradius = 0.1\nposition = [-0.31, 0.4, "
        "0]\nvelocity = [0.7, 0.070071, 0]\nmass = 3\nelasticity = 1\nfriction = 0\n",
        rate));
    const sim::Snapshot now = scene.at(0.03);
    EXPECT_NEAR(now.bodies[number_of(scene, "b")].velocity.x(), 0.35, 2e-5) << rate;
    EXPECT_NEAR(now.bodies[number_of(scene, "s")].velocity.x(), 1.05 - 0.7 * 9.81 * (0.03 - 0.1 / 7), 6e-5)
        << rate;
  }
}

// Two balls on a plank on which a box rests, too: their blow is that of the two alone.
TEST(Impacts, WhatRestsBesideABlowIsNoPartOfIt) {
  for (const int rate : {60, 100, 240}) {
    const TextRun scene(fmt::format(
        "duration = 1\n[room]\nwalls = 'ground'\nsize = [60, 10, 60]\nfriction = 0\n[physics]\nsolver = "
        "'iterative'\nrate = {}\n[[box]]\nname = 'plank'\nposition = [0, 0.1, 0]\nsize = [20, 0.2, 20]\nmass "
        "= "
        "500\nfriction = 0\nelasticity = 0\n[[ball]]\nname = 'b1'\nposition = [-5, 0.4, 0]\nradius = "
        "0.2\nmass = "
        "1\nfriction = 0\nelasticity = 1\nvelocity = [3, 0, 0]\n[[ball]]\nname = 'b2'\nposition = [-4, 0.4, "
        "0.1]\nradius = 0.2\nmass = 1\nfriction = 0\nelasticity = 1\n[[box]]\nposition = [0, 0.3, 0]\nsize = "
        "[0.4, "
        "0.2, 0.4]\nmass = 1\nelasticity = 0\nfriction = 0\n",
        rate));
    const sim::Snapshot now = scene.at(0.3);
    EXPECT_NEAR(now.bodies[number_of(scene, "b1")].velocity.x(), 3 * 0.25 * 0.25, 1e-9) << rate;
    EXPECT_NEAR(now.angular_momentum.y(), 0, 1e-11) << rate;
  }
}

// Two boxes that spin fast strike each other by corners that are others at the end of the substep than at its
// start: what those would say of their speeds is not held against them. e = 1: the energy stays.
TEST(Impacts, FastSpinningBoxesKeepTheirEnergy) {
  for (const int rate : {60, 240, 600, 1200}) {
    const TextRun run(fmt::format("duration = 1\n[room]\nsize = [4, 4]\ngravity = [0, 0]\n[physics]\nsolver "
                                  "= 'iterative'\nrate = {}\n",
                                  rate) +
                      "[[box]]\nname = 'a'\nsize = [0.375, 0.472]\nposition = [1.829507503235185, "
                      "2.3173251943873738]\nangle = "
                      "210.1721403281399\nvelocity = [7.111139871024409, 4.459295909111146]\nspin = "
                      "-865.3646509280613\nmass = "
                      "0.317\nelasticity = 1\nfriction = 0\n"
                      "[[box]]\nname = 'b'\nsize = [0.348, 0.46]\nposition = [2.27535073939613, "
                      "3.061526258085127]\nangle = "
                      "-265.3996547568532\nvelocity = [-2.239072199792284, -2.081221829486255]\nspin = "
                      "-932.9120633946511\nmass = "
                      "1.3647\nelasticity = 1\nfriction = 0\n");
    const auto energy = [&](double t) {
      const sim::Snapshot now = run.at(t);
      double sum = 0;
      for (const char* name : {"a", "b"}) {
        const sim::Snapshot::Body& body = now.bodies[std::size_t(number_of(run, name))];
        const bool first = *name == 'a';
        const double mass = first ? 0.317 : 1.3647,
                     inertia =
                         mass / 12 * (first ? 0.375 * 0.375 + 0.472 * 0.472 : 0.348 * 0.348 + 0.46 * 0.46);
        sum += 0.5 * mass * body.velocity.squaredNorm() + 0.5 * inertia * body.spin.squaredNorm();
      }
      return sum;
    };
    const double before = energy(0);
    EXPECT_NEAR(energy(0.06), before, 1e-9 * before) << rate;
  }
}

// Twelve boxes and balls that spin and fly without gravity, elastic and smooth: those that turn into each
// other within a step, and those that pass by, and what has struck something else before. Energy is that of
// how they move.
TEST(Impacts, AGasOfBoxesAndBallsKeepsItsEnergy) {
  for (unsigned seed = 1; seed <= 10; ++seed) {
    std::mt19937 bits(seed);
    const auto between = [&](double low, double high) {
      return low + (high - low) * (double(bits()) / 4294967296.0);
    };
    std::string bodies;
    std::vector<double> masses, inertias;
    for (int i = 0; i < 12; ++i) {
      const bool ball = between(0, 1) < 0.3;
      const double mass = between(0.3, 3), a = between(0.2, 0.5), b = between(0.2, 0.5);
      masses.push_back(mass);
      inertias.push_back(ball ? 0 : mass / 12 * (a * a + b * b));
      bodies += ball ? fmt::format("[[particle]]\nradius = {}\n", a / 2)
                     : fmt::format("[[box]]\nsize = [{}, {}]\nangle = {}\nspin = {}\n", a, b, between(0, 180),
                                   between(-400, 400));
      bodies += fmt::format(
          "name = 'b{}'\nposition = [{}, {}]\nvelocity = [{}, {}]\nmass = {}\nelasticity = 1\nfriction = 0\n",
          i, 0.6 + 0.9 * (i % 4), 0.7 + 1.2 * (i / 4), between(-6, 6), between(-6, 6), mass);
    }
    for (const int rate : {60, 240}) {
      const TextRun run(
          fmt::format("duration = 4\n[room]\nsize = [4, 4]\ngravity = [0, 0]\n[physics]\n"
                      "solver = 'iterative'\nrate = {}\n{}",
                      rate, bodies));
      const auto energy = [&](double t) {
        const sim::Snapshot now = run.at(t);
        double sum = 0;
        for (std::size_t i = 0; i < masses.size(); ++i) {
          const sim::Snapshot::Body& body = now.bodies[number_of(run, fmt::format("b{}", i))];
          sum += 0.5 * masses[i] * body.velocity.squaredNorm() + 0.5 * inertias[i] * body.spin.squaredNorm();
        }
        return sum;
      };
      const double before = energy(0);
      EXPECT_NEAR(energy(4), before, 1e-12 * before) << "gas " << seed << " at " << rate;
    }
  }
}

// Two boxes in space that meet by other features than those that are nearest where the substep begins: what
// they had says nothing of what parts. The velocity is that of `event` at 2,400 steps a second.
TEST(Impacts, BoxesInSpaceThatTurnIntoEachOtherPartAsByEvents) {
  for (const int rate : {60, 240, 600, 1200}) {
    const TextRun run(
        fmt::format("duration = 0.05\n[room]\nsize = [3, 3, 3]\ngravity = [0, 0, 0]\n[physics]\nsolver = "
                    "'iterative'\nrate = {}\n",
                    rate) +
        "[[box]]\nname = 'a'\nsize = [0.278, 0.393, 0.395]\nmass = 0.97\nelasticity = 1\nfriction = 0\n"
        "position = [-0.1052093277495181, 1.125298368961509, -1.1821710133409487]\n"
        "orientation = { axis = [-0.2334484170512291, 0.9511017179784124, 0.20225567639695047], "
        "angle = 80.43238392822636 }\n"
        "velocity = [-1.3378638265304108, -3.6344797154968203, 1.346178837536685]\n"
        "spin = [-1201.0929530829667, -445.2727384789718, 1088.1299453154813]\n"
        "[[box]]\nname = 'b'\nsize = [0.288, 0.301, 0.472]\nmass = 1.33\nelasticity = 1\nfriction = 0\n"
        "position = [-0.21212602833292593, 1.6398776727690836, -1.1186441990820317]\n"
        "orientation = { axis = [-0.177411962680753, 0.2162419680148492, -0.960085624705853], "
        "angle = 191.81476491056162 }\n"
        "velocity = [4.755195982296663, -2.184759692184657, 0.2924225390771244]\n"
        "spin = [-698.6919265416889, -10.618619164738163, -781.8706352890506]\n");
    const sim::Vec3 v = run.at(0.02).bodies[number_of(run, "a")].velocity;
    EXPECT_NEAR(v[0], -0.75432782, rate < 100 ? 1e-4 : 1e-6) << rate;
    EXPECT_NEAR(v[1], -4.54341591, rate < 100 ? 1e-4 : 1e-6) << rate;
  }
}

// A blow goes through a row of balls that do not touch, one after another within a step, however long it is.
TEST(Impacts, PassThroughARowOfAnyLength) {
  for (const int dimension : {2, 3}) {
    for (const Manner& manner : kManners) {
      for (const int rate : {60, 600}) {
        SCOPED_TRACE(fmt::format("{}D by {} at {}", dimension, manner.name, rate));
        const std::string z = dimension == 2 ? "" : ", 0";
        std::string text = fmt::format(
            "duration = 1\n[room]\nwalls = \"none\"\nsize = [20, 4{}]\ngravity = [0, 0{}]\n{}\nrate = {}\n",
            dimension == 2 ? "" : ", 4", z, manner.keys, rate);
        for (int i = 0; i < 16; ++i)
          text += fmt::format(
              "[[ball]]\nradius = 0.1\nmass = 1\nelasticity = 1\nfriction = 0\nposition = [{}, "
              "2{}]\nvelocity "
              "= [{}, 0{}]\n",
              i == 0 ? 1.5 : 2 + 0.2001 * i, z, i == 0 ? 2 : 0, z);
        const TextRun run(text);
        const sim::Snapshot end = run.at(0.9);
        for (std::size_t i = 0; i < end.bodies.size(); ++i)
          EXPECT_NEAR(end.bodies[i].velocity.x(), i + 1 == end.bodies.size() ? 2 : 0, 1e-9) << i;
      }
    }
  }
}

// So it goes through boxes that have fallen asleep on a floor without friction, also where a step has more
// blows than events: those that it has not yet reached are no walls, and all of clay go on as one. Iterations
// in space end where they change speeds by little, of what gravity does.
TEST(Impacts, PassThroughARowThatSleeps) {
  for (const int dimension : {2, 3}) {
    for (const Manner& manner : kManners) {
      for (const int rate : {15, 30, 60}) {
        SCOPED_TRACE(fmt::format("{}D by {} at {}", dimension, manner.name, rate));
        const bool flat = dimension == 2, iterative = manner.name == std::string("iterative");
        const char *z = flat ? "" : ", 0", *deep = flat ? "" : ", 0.2";
        const int boxes = flat ? 18 : 14;
        std::string text =
            fmt::format("duration = 1\n[room]\nwalls = \"ground\"\nsize = [60, 20{}]\n{}\nrate = {}\n",
                        flat ? "" : ", 20", manner.keys, rate);
        for (int i = 0; i <= boxes; ++i)
          text += fmt::format(
              "[[box]]\nsize = [0.2, 0.2{}]\nmass = 1\nelasticity = 0\nfriction = 0\nposition = [{}, "
              "0.1{}]\nvelocity = [{}, 0{}]\n",
              deep, i == 0 ? 9 : 9.8 + 0.2001 * i, z, i == 0 ? 2 : 0, z);
        const TextRun run(text);
        const sim::Snapshot end = run.at(0.95);
        double momentum = 0;
        for (std::size_t i = 0; i < end.bodies.size(); ++i) {
          const double v = end.bodies[i].velocity.x();
          momentum += v;
          if (!iterative && rate < 60) continue;
          EXPECT_NEAR(v, 2.0 / (boxes + 1), !iterative ? 1e-9 : flat ? 1e-4 : 3e-3) << i;
        }
        EXPECT_NEAR(momentum, 2, 2e-6);
      }
    }
  }
}

// A row of clay that touches takes a blow as one, however long it is: each iteration passes it on by a box,
// and changes little. They had ended there, the first box half as fast as the last.
TEST(Impacts, OfALongRowInSpaceAreOfAllOfIt) {
  for (const int boxes : {15, 30}) {
    for (const int rate : {15, 60, 240, 600}) {
      std::string text = fmt::format(
          "duration = 1\n[room]\nwalls = 'ground'\nsize = [60, 20, 20]\n[physics]\nsolver = "
          "'iterative'\nrate = "
          "{}\n",
          rate);
      for (int i = 0; i <= boxes; ++i)
        text += fmt::format(
            "[[box]]\nsize = [0.2, 0.2, 0.2]\nmass = 1\nelasticity = 0\nfriction = 0\nposition = [{}, 0.1, "
            "0]\nvelocity = [{}, 0, 0]\n",
            -20 + 0.2 * i - (i == 0 ? 0.5 : 0), i == 0 ? 2 : 0);
      const sim::Snapshot end = TextRun(text).at(0.9);
      for (const sim::Snapshot::Body& body : end.bodies)
        EXPECT_NEAR(body.velocity.x(), 2.0 / (boxes + 1), 1e-3 * 2 / (boxes + 1)) << boxes << " at " << rate;
    }
  }
}

// A cradle of many balls on rods that touch: all of them meet the blow together, as by the direct solver.
TEST(Impacts, ACradleOfManyOnRodsTakesABlowTogether) {
  for (const int dimension : {2, 3}) {
    const char* z = dimension == 2 ? "" : ", 0";
    for (const int balls : {9, 10, 25}) {
      const auto ends = [&](const char* solver, int rate) {
        std::string text = fmt::format(
            "duration = 2\n[room]\nwalls = 'none'\nsize = [20, 6{}]\n[physics]\nsolver = "
            "'{}'\nrate = {}\n",
            dimension == 2 ? "" : ", 6", solver, rate);
        for (int i = 0; i < balls; ++i) {
          const double x = 5 + 0.2 * i, x0 = i == 0 ? x - 2 * std::sin(0.5) : x,
                       y0 = 4 - 2 * (i == 0 ? std::cos(0.5) : 1);
          text += fmt::format(
              "[[ball]]\nname = 'b{0}'\nradius = 0.1\nmass = 1\nelasticity = 1\nfriction = 0\nposition = "
              "[{1:.17g}, {2:.17g}{4}]\n[[joint]]\ntype = 'rod'\nbetween = [[{3:.17g}, 4{4}], 'b{0}']\n",
              i, x0, y0, x, z);
        }
        const TextRun run(text);
        const sim::Snapshot now = run.at(1.2);
        return std::pair(now.bodies.front().velocity.x(), now.bodies.back().velocity.x());
      };
      const auto want = ends("direct", 600);
      EXPECT_LT(want.first, -0.5);
      for (const int rate : {60, 600}) {
        const auto got = ends("iterative", rate);
        EXPECT_NEAR(got.first, want.first, 1e-4) << dimension << balls << rate;
        EXPECT_NEAR(got.second, want.second, 1e-4) << dimension << balls << rate;
      }
    }
  }
}

// A box that a belt's end draws down against another on the floor, from the fall of a parcel: no impulses
// hold it there. It comes out slowly, and the run goes on: by events it had been thrown out at hundreds of
// metres a second, by iterations its blows had no end.
TEST(Impacts, WhatABeltWedgesInComesOutSlowly) {
  std::vector<Manner> manners = kManners;
  manners.push_back({"iterative, in turn", kManners.back().keys + "\nimpacts = 'sequential'"});
  for (const Manner& manner : manners) {
    for (const int rate : {60, 240, 600, 1200}) {
      SCOPED_TRACE(manner.name + " " + std::to_string(rate));
      const TextRun run(fmt::format(
          "duration = 0.2\n[room]\nsize = [40, 10]\nwalls = 'ground'\nelasticity = 0.2\nfriction = "
          "0.5\n{}\nrate = "
          "{}\n[[box]]\nname = 'belt'\nsize = [16, 0.4]\nposition = [20, 1]\nfixed = true\nfriction = "
          "0.8\nsurface_speed = 1.5\n[[box]]\nname = 'parcel'\nsize = [0.4, 0.3]\nposition = "
          "[28.033979327767632, 0.5602361766731958]\nangle = 132.29754323867013\nvelocity = "
          "[-0.5864230698612449, -0.4430859136279125]\nspin = 209.685393334607\nmass = 2\n[[box]]\nname = "
          "'other'\nsize = [0.4, 0.3]\nposition = [28.305474571679824, 0.20031729574810112]\nangle = "
          "90.12141741861605\nvelocity = [-1.607e-7, 7.17e-8]\nspin = 2.747e-5\nmass = 3\n",
          manner.keys, rate));
      const double begun = run.at(0).energies.total();
      const sim::Snapshot now = run.at(0.1);
      EXPECT_LT(now.bodies[number_of(run, "parcel")].velocity.norm(), 2);
      EXPECT_NEAR(now.bodies[number_of(run, "parcel")].position.x(), 27.97, 0.05);
      EXPECT_LT(now.energies.total(), begun + 1);  // the belt works on it
    }
  }
}

// Balls of clay that meet a plank side by side go on with it as one: v = -3 n / (n + 5), and it does not
// turn.
TEST(Impacts, ClayThatMeetsAPlankAllAtOnceGoesOnAsOne) {
  for (const Manner& manner : kManners) {
    for (const int n : {8, 9, 20}) {
      for (const int rate : {60, 600}) {
        SCOPED_TRACE(fmt::format("{} balls by {} at {}", n, manner.name, rate));
        std::string text = fmt::format(
            "duration = 1\n[room]\nwalls = \"none\"\nsize = [20, 10]\ngravity = [0, 0]\n{}\nrate = "
            "{}\n[[box]]\n"
            "size = [{}, 0.2]\nposition = [10, 5]\nmass = 5\nelasticity = 0\nfriction = 0\n",
            manner.keys, rate, 0.3 * n + 0.2);
        for (int i = 0; i < n; ++i)
          text += fmt::format(
              "[[ball]]\nradius = 0.1\nmass = 1\nelasticity = 0\nfriction = 0\nposition = [{}, "
              "6.21]\nvelocity = [0, "
              "-3]\n",
              10 + 0.3 * (i - 0.5 * (n - 1)));
        const TextRun run(text);
        const sim::Snapshot end = run.at(0.6);
        for (const sim::Snapshot::Body& it : end.bodies) {
          EXPECT_NEAR(it.velocity.y(), -3.0 * n / (n + 5), 1e-9);
          EXPECT_NEAR(it.spin.z(), 0, 1e-9);
        }
      }
    }
  }
}

// Three courses of two bricks fall flat onto the floor, in no order: all of them leave it as fast as they
// came.
TEST(Impacts, AWallThatFallsFlatBouncesFlat) {
  for (const Manner& manner : kManners) {
    for (const int rate : {60, 600}) {
      SCOPED_TRACE(fmt::format("by {} at {}", manner.name, rate));
      std::string text = fmt::format(
          "duration = 1\n[room]\nwalls = \"ground\"\nsize = [40, 20]\n{}\nrate = {}\n", manner.keys, rate);
      for (int course = 0; course < 3; ++course)
        for (const int brick : {1, 0})
          text += fmt::format(
              "[[box]]\nsize = [0.45, 0.25]\nmass = 1\nelasticity = 1\nfriction = 0\nposition = [{}, {}]\n",
              20 + 0.5 * brick + (course == 1 ? 0.2 : 0), 1.025 + 0.25 * course);
      const TextRun run(text);
      const double falls = std::sqrt(2 * 9.81 * 0.9), t = 0.46;
      const sim::Snapshot end = run.at(t);
      for (const sim::Snapshot::Body& it : end.bodies)
        EXPECT_NEAR(it.velocity.y(), falls - 9.81 * (t - falls / 9.81), 1e-7);  // met within 2e-8 m
    }
  }
}

// Five boxes welded in a row, whatever else the room has far away.
TEST(Impacts, OfAWeldedRowAreThoseOfOneBodyInACrowdToo) {
  for (const Manner& manner : kManners) {
    if (manner.name == "event") continue;
    for (const int rate : {60, 600}) {
      SCOPED_TRACE(fmt::format("by {} at {}", manner.name, rate));
      std::string text = fmt::format(
          "duration = 1\n[room]\nwalls = \"ground\"\nsize = [40, 20]\n{}\nrate = {}\n", manner.keys, rate);
      for (int i = 0; i < 5; ++i)
        text += fmt::format(
            "[[box]]\nname = \"b{}\"\nsize = [0.5, 0.25]\nmass = 1\nelasticity = 0.5\nfriction = 0\nposition "
            "= [{}, "
            "1.025]\n{}",
            i, 20 + 0.5 * i,
            i == 0
                ? ""
                : fmt::format("[[joint]]\ntype = \"weld\"\nbetween = [\"b{}\", \"b{}\"]\nat = [{}, 1.025]\n",
                              i - 1, i, 19.75 + 0.5 * i));
      for (int i = 0; i < 60; ++i)
        text += fmt::format("[[ball]]\nradius = 0.05\nposition = [{}, 15]\n", 2 + 0.2 * i);
      const TextRun run(text);
      const double falls = std::sqrt(2 * 9.81 * 0.9), t = 0.46;
      const sim::Snapshot end = run.at(t);
      for (int i = 0; i < 5; ++i)
        EXPECT_NEAR(end.bodies[number_of(run, fmt::format("b{}", i))].velocity.y(),
                    0.5 * falls - 9.81 * (t - falls / 9.81), 1e-7);
    }
  }
}

// A rope in space that becomes taut is stopped at its time, whatever else the room has far away.
TEST(Impacts, OfARopeInSpaceDoNotDependOnWhatElseThereIs) {
  const auto run_with = [](int others) {
    std::string text =
        "duration = 1\n[room]\nwalls = \"ground\"\nsize = [60, 20, 40]\ncorner = [0, 0, "
        "-20]\n[physics]\nsolver = "
        "\"iterative\"\nrate = 600\n[[box]]\nname = \"a\"\nsize = [0.3, 0.3, 0.3]\nposition = [10, 3, "
        "0]\nvelocity "
        "= [2, 1, 0]\n[[joint]]\ntype = \"rope\"\nbetween = [[9.5, 3.5, 0], { body = \"a\", local = [0.15, "
        "0.15, 0] "
        "}]\nlength = 1\n";
    for (int i = 0; i < others; ++i)
      text += fmt::format("[[ball]]\nradius = 0.05\nposition = [{}, 15, 0]\n", 2 + 0.2 * i);
    const TextRun run(text);
    return run.at(0.7).bodies[number_of(run, "a")];
  };
  const sim::Snapshot::Body alone = run_with(0), beside = run_with(60);
  EXPECT_NEAR((alone.velocity - beside.velocity).norm(), 0, 1e-9);
  EXPECT_NEAR((alone.position - beside.position).norm(), 0, 1e-9);
}

}  // namespace
}  // namespace obscura::scene

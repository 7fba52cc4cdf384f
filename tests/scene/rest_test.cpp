// Heaps of scenes come to rest, and say so.

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <string>
#include <utility>

#include "scene/text_run.h"

namespace obscura::scene {
namespace {

// The overlap that is let be goes by the larger of two that touch, and so does that in which they rest: a
// heap of small boxes between walls eight times as long.
TEST(Rest, OfAHeapInABinOfLongWalls) {
  for (const bool space : {false, true}) {
    const auto at = [&](const std::string& x, const std::string& y) {
      return "[" + x + ", " + y + (space ? ", 0]" : "]");
    };
    const auto wall = [&](const char* x) {
      return "[[box]]\nfixed = true\nposition = " + at(x, "0.9") + "\nsize = [0.1, 1.8" +
             (space ? ", 0.3]\n" : "]\n");
    };
    const TextRun run("duration = 10\n[room]\nwalls = \"ground\"\n" +
                      std::string(space ? "size = [4, 4, 4]\n" : "size = [4, 4]\n") +
                      "[physics]\nsolver = \"iterative\"\nrate = 300\n" + wall("1.6") + wall("2.4") +
                      "[[box]]\nname = \"b\"\nelasticity = 0\nposition = " + at("1.8", "0.3") +
                      "\nsize = [0.2, 0.16" + (space ? ", 0.3]\n" : "]\nangle = { from = 0, to = 200 }\n") +
                      "copies = { count = [2, 7" + (space ? ", 1" : "") + "], offset = [" + at("0.3", "0") +
                      ", " + at("0", "0.3") + (space ? ", [0, 0, 1]" : "") + "] }\n");
    const sim::Snapshot now = run.at(8);
    for (std::size_t i = 2; i < now.bodies.size(); ++i) {
      EXPECT_TRUE(now.bodies[i].at_rest) << space << " " << i;
      EXPECT_EQ(now.bodies[i].velocity.norm(), 0) << space << " " << i;
    }
  }
}

// What begins in equilibrium stays there, however high, or heavy what lies on it, among many: a wall of 24
// courses, a column of eighty plates, a hundred cubes of a kilogram under a lid of three tons; at few steps a
// second and many.
TEST(Rest, OfWhatBearsMuch) {
  const auto sunk = [](int rate, const std::string& rest, int body, double y) {
    const TextRun scene(
        fmt::format("duration = 1\n[physics]\nsolver = \"iterative\"\nrate = {}\n[room]\n{}", rate, rest));
    return y - scene.at(0.5).bodies[std::size_t(body)].position.y();
  };
  const auto bricks = [](const char* name, double x, double y, int count) {
    return fmt::format(
        "[[box]]\nname = \"{}\"\nsize = [0.48, 0.2, 0.24]\nmass = 4\nfriction = 0.6\nelasticity = "
        "0.1\nposition = "
        "[{}, {}, 0]\ncopies = {{ count = [{}, 12], offset = [[0.5, 0, 0], [0, 0.4, 0]] }}\n",
        name, x, y, count);
  };
  for (const int rate : {60, 240, 600}) {
    const std::string wall = "size = [8, 8, 6]\nwalls = \"ground\"\n" + bricks("even", -1.75, 0.1, 8) +
                             bricks("odd", -1.5, 0.3, 7);
    if (rate < 600) {
      EXPECT_LT(sunk(rate, wall, 179, 4.7), 1e-5) << rate;
    }
    const std::string plates =
        "size = [4, 6, 4]\nwalls = \"ground\"\n[[box]]\nname = \"p\"\nsize = [0.6, 0.03, 0.6]\nfriction = "
        "0.4\nelasticity = 0\nposition = [0, 0.015, 0]\ncopies = { count = 80, offset = [0, 0.03, 0] }\n";
    EXPECT_LT(sunk(rate, plates, 79, 2.385), 3e-5) << rate;
    const std::string cubes =
        "size = [1, 3, 1]\n[[box]]\nname = \"c\"\nsize = [0.1, 0.1, 0.1]\nmass = 1\nfriction = "
        "0.5\nelasticity = "
        "0\nposition = [-0.204, 0.05, -0.204]\ncopies = { count = [5, 4, 5], offset = [[0.102, 0, 0], [0, "
        "0.1, "
        "0], [0, 0, 0.102]] }\n[[box]]\nname = \"lid\"\nsize = [0.51, 0.2, 0.51]\nmass = 3000\nfriction = "
        "0.5\nelasticity = 0\nposition = [0, 0.5, 0]\n";
    EXPECT_LT(sunk(rate, cubes, 100, 0.5), 5e-5) << rate;
  }
}

// Boxes that lie in a silo six wide and sixty high do not creep into each other: what they overlap by as they
// come to lie is pushed apart again.
TEST(Rest, OfAHighSilo) {
  const TextRun scene(
      "duration = 2\n[physics]\nsolver = \"iterative\"\nrate = 600\n[room]\nsize = [1.44, 18]\n[[box]]\nname "
      "= "
      "\"b\"\nsize = [0.2, 0.2]\nfriction = 0.4\nelasticity = 0.1\nmass = 1\nangle = 1\nposition = [0.13, "
      "0.15]\ncopies = { count = [6, 60], offset = [[0.21, 0.004], [0.002, 0.22]] }\n");
  const double before = scene.at(1).energies.total();
  EXPECT_GT(scene.at(2).energies.total(), before);
}

// Few boxes in space that fall onto each other come to rest by the direct solver, too, at any rate: a
// pyramid, a tower, a staircase of turned ones, and what lies on a table. Where their contacts are more than
// are solved exactly, pieces of steps go by impulses, which bring down what comes down.
TEST(Rest, OfFewByTheDirectSolverInSpace) {
  const auto box = [](double x, double y, double z, double turn) {
    const char* manner = "[[box]]\nsize = [0.3, 0.2, 0.3]\nmass = 1\nelasticity = 0.2\n";
    return fmt::format("{}position = [{}, {}, {}]\norientation = [0, {}, 0]\n", manner, x, y, z, turn);
  };
  std::string pyramid, stairs, tower;
  for (int row = 0; row < 3; ++row)
    for (int i = 0; i < 3 - row; ++i) pyramid += box(-0.3 + 0.32 * (i + 0.5 * row), 0.12 + 0.22 * row, 0, 0);
  for (int i = 0; i < 5; ++i)
    stairs += box(0, 0.12 + 0.22 * i, 0, 17 * i), tower += box(2 + 0.03 * i, 0.12 + 0.22 * i, 0, 0);
  std::string table = "[[body]]\ndensity = 500\nposition = [0, 0.025, 0]\nshapes = [";
  for (const double x : {-0.45, 0.45})
    for (const double z : {-0.25, 0.25})
      table += fmt::format("{{ size = [0.05, 0.4, 0.05], position = [{}, 0.175, {}] }}, ", x, z);
  table += "{ size = [1, 0.05, 0.6], position = [0, 0.4, 0] }]\n";
  table += box(-0.3, 0.6, 0.02, 10) + box(0.05, 0.65, 0.02, 10);
  for (const auto& [name, bodies] : {std::pair("pyramid", pyramid), std::pair("stairs", stairs),
                                     std::pair("tower", tower), std::pair("table", table)}) {
    for (const int rate : {60, 240, 600}) {
      const TextRun run(fmt::format("[room]\nsize = [6, 3, 4]\nwalls = 'ground'\n[physics]\nsolver = "
                                    "'direct'\nrate = {}\n",
                                    rate) +
                        bodies);
      const sim::Snapshot now = run.at(3);
      for (const sim::Snapshot::Body& body : now.bodies) {
        EXPECT_TRUE(body.at_rest) << name << " at " << rate;
        EXPECT_EQ(body.velocity.norm(), 0) << name << " at " << rate;
      }
    }
  }
}

// A figure of five boxes on pins lies on the floor by its legs' and its trunk's corners. Iterations of
// Coulomb's law one contact after another, the direct solver's last resort, grew without end for these:
// forces of 1e75 N, and with more friction the figure fell flat.
TEST(Rest, OfAFigureOnPinsByTheDirectSolver) {
  const auto box = [](const char* name, const char* size, const char* at, double degrees, double mass) {
    return fmt::format(
        "[[box]]\nname = '{}'\nsize = {}\nposition = {}\nangle = {:.17g}\nmass = {}\n"
        "elasticity = 0.1\nfriction = {{}}\ngroup = 'doll'\n",
        name, size, at, degrees, mass);
  };
  const auto pin = [](const char* limb, const char* at) {
    return fmt::format("[[joint]]\ntype = 'pin'\nbetween = ['{}', 'trunk']\nat = {}\n", limb, at);
  };
  const std::string bodies =
      box("trunk", "[0.2, 0.5]", "[3.7759702780780904, 0.15922857562632248]", -281.1694764439093, 5) +
      box("head", "[0.2, 0.2]", "[3.416782551450649, 0.1740889301545102]", -251.16947644390933, 1) +
      box("arm", "[0.08, 0.4]", "[3.60622573152049, 0.19639587806816952]", -206.96362235702912, 0.7) +
      box("arm2", "[0.08, 0.4]", "[3.6535969581524848, 0.2007068309392141]", -338.44186252853433, 0.7) +
      box("leg", "[0.1, 0.5]", "[4.279422781986459, 0.050000003769374066]", -270.0000025916395, 1.5);
  const std::string joints = pin("head", "[3.5208950701888986, 0.20959362620989302]") +
                             pin("arm", "[3.5291435325819616, 0.044875798188302646]") +
                             pin("arm2", "[3.591131287146356, 0.3588145155903848]") +
                             pin("leg", "[4.019422781986458, 0.050000015529861525]");
  for (const double friction : {0.5, 0.7}) {
    for (const int rate : {60, 240, 600}) {
      const TextRun run(
          fmt::format("[room]\nsize = [8, 4]\n[physics]\nsolver = 'direct'\nrate = {}\noverlap = 'separate'\n"
                      "[contact]\nignore = [['doll', 'doll']]\n",
                      rate) +
          fmt::format(fmt::runtime(bodies), friction, friction, friction, friction, friction) + joints);
      const int arm = number_of(run, "arm2");
      EXPECT_NEAR(run.at(1).bodies[std::size_t(arm)].position.y(), 0.2007, 1e-4) << friction << " " << rate;
    }
  }
}

}  // namespace
}  // namespace obscura::scene

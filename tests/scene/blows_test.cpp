// Blows that follow one another within a substep, and those that pass through what lies on each other.

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

#include "scene/text_run.h"

namespace obscura::scene {
namespace {

// A ball at 5 m/s meets the tip of a rack of elastic balls a millimetre apart, which strike each other within
// the same millisecond: those at rest have to be seen coming before anything has struck them. In the plane
// the same, and by the direct solver and by events to 1e-9.
TEST(Blows, GoThroughARackOfBallsInAMillisecond) {
  for (const int dimension : {2, 3}) {
    for (const int rate : {60, 240, 600}) {
      std::string text =
          empty_room({"", fmt::format("[physics]\nsolver = 'iterative'\nrate = {}\n", rate)}, dimension);
      const auto ball = [&](const std::string& name, double x, double y, double v) {
        const char* z = dimension == 3 ? ", 0" : "";
        text += disc(
            name, 1, 0.1,
            fmt::format("elasticity = 1\nfriction = 0\nposition = [{:.17g}, {:.17g}{}]\nvelocity = [{}, 0{}]",
                        x, y, z, v, z));
      };
      for (int row = 0; row < 3; ++row)
        for (int i = 0; i <= row; ++i)
          ball(fmt::format("b{}{}", row, i), 0.201 * std::sqrt(0.75) * row, 0.201 * (i - 0.5 * row), 0);
      ball("c", -1, 0, 5);
      const TextRun scene(text);
      const sim::Snapshot now = scene.at(0.5);
      const auto speed = [&](const char* name) { return now.bodies[number_of(scene, name)].velocity; };
      const std::string what = fmt::format("{} at {}", dimension, rate);
      EXPECT_NEAR(speed("b00").x(), 0, 1e-9) << what;
      EXPECT_NEAR(std::fabs(speed("b20").y()), 1.7325776815, 1e-8) << what;
      EXPECT_NEAR(std::fabs(speed("b22").y()), 1.7325776815, 1e-8) << what;
      EXPECT_NEAR(std::fabs(speed("b10").y()), 0.0087137976, 1e-8) << what;
    }
  }
}

// Two that attract each other and touch press on each other and lie still: what forces make them close within
// a substep is no blow, of charges no more than of gravity.
TEST(Blows, AreNoneWhereBodiesAttractEachOther) {
  for (const int dimension : {2, 3}) {
    for (const int rate : {60, 240, 600, 960}) {
      const char* z = dimension == 3 ? ", 0" : "";
      std::string text = empty_room({"", fmt::format("[physics]\nsolver = 'iterative'\nrate = {}\n", rate)},
                                    dimension, "coulomb = 1\n");
      text += disc("a", 1, 0.2, fmt::format("charge = 1\nposition = [0, 0{}]", z));
      text += disc("b", 1, 0.2, fmt::format("charge = -1\nposition = [0.4, 0{}]", z));
      const sim::Snapshot now = TextRun(text).at(2);
      const std::string what = fmt::format("{} at {}", dimension, rate);
      ASSERT_EQ(now.contacts.size(), 1u) << what;
      EXPECT_NEAR(std::fabs(now.contacts[0].force.x()), 6.25, 1e-7) << what;
      EXPECT_LT(now.bodies[0].velocity.norm(), 1e-9) << what;
      EXPECT_LT(now.energies.displacement, 1e-6) << what;
    }
  }
}

// A ball strikes the lower half of the upper of two boxes, which slides, tips and is held by other corners
// and edges all the while: the direct solver follows these within the step, as events do.
TEST(Blows, ToTheUpperOfTwoBoxesAreFollowedByTheDirectSolverAtEveryRate) {
  for (const int rate : {60, 240, 600}) {
    const std::string manner = "elasticity = 0.3\nfriction = ";
    const TextRun run(fmt::format("[room]\nsize = [10, 6]\ncorner = [-5, 0]\n"
                                  "[physics]\nsolver = 'direct'\nrate = {}\n",
                                  rate) +
                      disc("b", 2, 0.2, "position = [-0.3, 0.5]\nvelocity = [5, 0]\n" + manner + "0.3") +
                      "[[box]]\nname = 'k'\nsize = [0.3, 0.4]\nmass = 1\nposition = [0.351, 0.2]\n" + manner +
                      "0.4\n[[box]]\nname = 'l'\nsize = [0.3, 0.4]\nmass = 1\nposition = [0.351, 0.6]\n" +
                      manner + "0.4\n");
    // by events at every rate
    EXPECT_NEAR(run.at(0.07).bodies[number_of(run, "l")].spin.z(), 3.6915963, 1e-6) << rate;
  }
}

// A ball pushes four boxes that touch along the ground. The sides where they touch bear nothing but rounding,
// and to let go of that is no event: one of 1e-10 s after another made a step take two seconds.
TEST(Blows, WhereBoxesInARowBearNothingEndNoInterval) {
  const auto ends = [](const char* rules, int dimension) {
    const bool space = dimension == 3;
    const std::string manner = "elasticity = 0.2\nfriction = 0.3\n";
    const char *z = space ? ", 0" : "", *deep = space ? ", 0.3" : "";
    std::string text = fmt::format("[room]\nsize = [12, 6{}]\ncorner = [-6, 0{}]\n[physics]\n{}\n",
                                   space ? ", 20" : "", space ? ", -10" : "", rules);
    for (int i = 0; i < 4; ++i)
      text += fmt::format("[[box]]\nname = 'a{}'\nsize = [0.3, 0.3{}]\nmass = 1\nposition = [{}, 0.15{}]\n{}",
                          i, deep, 0.3 * i, z, manner);
    text += disc("b", 2, 0.15, fmt::format("position = [-1, 0.15{}]\nvelocity = [5, 0{}]\n", z, z) + manner);
    const TextRun run(text);
    return run.at(0.3).bodies[number_of(run, "a3")].velocity.x();
  };
  for (const int dimension : {2, 3}) {
    const double followed = ends("collision = 'event'\nrate = 60", dimension);
    EXPECT_NEAR(followed, dimension == 2 ? 1.3467309445 : 1.3446806682, 1e-9);
    EXPECT_NEAR(ends("collision = 'event'\nrate = 240", dimension), followed, 1e-12);
    EXPECT_NEAR(ends("solver = 'direct'\nrate = 600", dimension), followed, dimension == 2 ? 1e-9 : 1e-5);
  }
}

// A ball bounces on one tile of a floor of tiles that touch as on one alone: what only lies beside has no
// part in the blow. It strikes at v = sqrt(2 g h) and leaves at e v.
TEST(Blows, OnATileDoNotHangOnTheTilesBesideIt) {
  for (const int dimension : {2, 3}) {
    for (const char* rules : {"solver = 'direct'", "solver = 'iterative'", "collision = 'event'"}) {
      const bool space = dimension == 3;
      const char *z = space ? ", 0" : "", *deep = space ? ", 0.4" : "";
      for (const int tiles : space ? std::vector{1, 5} : std::vector{1, 3, 9, 25}) {
        std::string text = fmt::format("[room]\nsize = [12, 4{}]\ncorner = [-6, 0{}]\n[physics]\n{}\n",
                                       space ? ", 4" : "", space ? ", -2" : "", rules);
        for (int i = 0; i < tiles; ++i)
          text += fmt::format(
              "[[box]]\nname = 't{}'\nsize = [0.4, 0.2{}]\nmass = 1\nelasticity = 0.8\nposition = [{}, "
              "0.1{}]\n",
              i, deep, 0.4 * (i - tiles / 2), z);
        text += disc("c", 3, 0.2, fmt::format("elasticity = 0.8\nposition = [0, 1.4{}]\n", z));
        const TextRun run(text);
        const double v = std::sqrt(2 * 9.81), when = v / 9.81;
        // more than sixteen contacts of space are left to the iterations
        const double bound = space && tiles > 1 && std::string(rules) == "solver = 'iterative'" ? 5e-3 : 1e-5;
        EXPECT_NEAR(run.at(when + 0.05).bodies[number_of(run, "c")].velocity.y(), 0.8 * v - 9.81 * 0.05,
                    bound)
            << dimension << " " << rules << " " << tiles;
      }
    }
  }
}

// Nine balls that fall on a plank on the ground at once leave it alike, at e sqrt(2 g h).
TEST(Blows, OfARowOfBallsOnAPlankAreAllAlike) {
  for (const char* rules : {"solver = 'direct'", "solver = 'iterative'", "collision = 'event'"}) {
    for (const int rate : {60, 240, 600}) {
      std::string text = fmt::format(
          "[room]\nsize = [12, 4]\ncorner = [-6, 0]\n[physics]\n{}\nrate = {}\n[[box]]\nname = 'plank'\nsize "
          "= "
          "[5, 0.2]\nmass = 5\nelasticity = 0.5\nposition = [0, 0.1]\n",
          rules, rate);
      for (int i = -4; i <= 4; ++i)
        text += disc(fmt::format("c{}", i + 4), 1, 0.1,
                     fmt::format("elasticity = 0.5\nposition = [{}, 0.8]\n", 0.5 * i));
      const TextRun run(text);
      const double v = std::sqrt(2 * 9.81 * 0.5), when = v / 9.81;
      const sim::Snapshot now = run.at(when + 0.05);
      for (const char* name : {"c0", "c2", "c4", "c8"})
        EXPECT_NEAR(now.bodies[number_of(run, name)].velocity.y(), 0.5 * v - 9.81 * 0.05, 1e-4)
            << rules << " " << rate << " " << name;
    }
  }
}

// One ball in, one out, as often as they swing: those in the middle of Newton's cradle hang still and fall
// asleep between two blows, and asleep one would be a wall. The last ball is at its highest after each half
// of a period,
//   T = 2 pi sqrt(l / g) / agm(1, cos(A / 2))
TEST(Blows, OfNewtonsCradleGoThroughBallsThatSleep) {
  const double length = 2, start = std::numbers::pi / 9;  // m, rad
  double far = 1, near = std::cos(start / 2);
  while (far - near > 1e-15) std::tie(far, near) = std::pair((far + near) / 2, std::sqrt(far * near));
  const double period = 2 * std::numbers::pi * std::sqrt(length / 9.81) / far;
  for (const int dimension : {2, 3}) {
    for (const char* rules : {"solver = 'direct'", "solver = 'iterative'", "collision = 'event'"}) {
      const char *z = dimension == 3 ? ", 0" : "", *deep = dimension == 3 ? ", 4" : "";
      std::string text = fmt::format(
          "[room]\nsize = [8, 5{}]\nwalls = 'none'\n[physics]\nimpacts = 'sequential'\n{}\n", deep, rules);
      for (int i = 0; i < 3; ++i) {
        const double angle = i == 0 ? start : 0, x = 0.4 * i;
        const std::string name = fmt::format("b{}", i);
        text += disc(name, 1, 0.2,
                     fmt::format("elasticity = 1\nfriction = 0\nposition = [{:.17g}, {:.17g}{}]",
                                 x - length * std::sin(angle), 4 - length * std::cos(angle), z));
        text += fmt::format("[[joint]]\ntype = 'rod'\nbetween = ['{}', [{:.17g}, 4{}]]\n", name, x, z);
      }
      const TextRun run(text);
      for (int swing = 0; swing < 4; ++swing) {
        const sim::Snapshot now = run.at((swing + 0.5) * period);
        EXPECT_NEAR(now.bodies[number_of(run, "b2")].position.x(), 0.8 + length * std::sin(start), 5e-6)
            << dimension << " " << rules << " " << swing;
      }
    }
  }
}

}  // namespace
}  // namespace obscura::scene

// Ropes that come taut where something is struck: what they hold bounces, and only what they stop is lost.

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <string>

#include "scene/text_run.h"

namespace obscura::scene {
namespace {

std::string room_at(int dimension, int rate, double gravity) {
  const char* more = dimension == 3 ? ", 0" : "";
  return fmt::format(
      "[room]\nwalls = 'none'\nsize = [20, 20{}]\ngravity = [0, {}{}]\n"
      "[physics]\nsolver = 'iterative'\nrate = {}\n",
      dimension == 3 ? ", 20" : "", gravity, more, rate);
}

std::string at(int dimension, double x, double y) {
  return dimension == 2 ? fmt::format("[{}, {}]", x, y) : fmt::format("[{}, {}, 0]", x, y);
}

std::string smooth(const char* kind, const char* name, double mass, const std::string& more) {
  return fmt::format("[[{}]]\nname = '{}'\nmass = {}\nfriction = 0\nelasticity = 1\n{}\n", kind, name, mass,
                     more);
}

// knots in a row, the first and the last of them fixed, with ropes between them
std::string knots(int dimension, int count, double length) {
  return smooth("ball", "k", 0.1,
                fmt::format("radius = 0.05\nposition = {}\ncopies = {{count = {}, offset = {}}}\n"
                            "fixed = '0,{}'",
                            at(dimension, 5, 10), count, at(dimension, 0.3, 0), count - 1)) +
         fmt::format("[[joint]]\ntype = 'rope'\nbetween = ['k[0..{}]', 'k[1..{}]']\nlength = {}\n", count - 2,
                     count - 1, length);
}

// A ball strikes a knot, which flies ahead until its ropes stop it, and then the knot again, which they hold:
// it bounces off it as off a wall. What the ropes have stopped, the knot's 5.69 m/s, is all that is lost.
TEST(Ropes, AKnotThatTheyHoldIsBouncedOff) {
  for (const int dimension : {2, 3}) {
    for (const double length : {0.3002, 0.303, 0.32}) {
      for (const int rate : {60, 240, 960}) {
        const TextRun scene(room_at(dimension, rate, 0) + knots(dimension, 3, length) +
                            smooth("ball", "w", 2,
                                   fmt::format("radius = 0.2\nposition = {}\nvelocity = {}",
                                               at(dimension, 5.32, 10.3), at(dimension, 0, -3))));
        const sim::Snapshot now = scene.at(0.3);
        const std::string what = fmt::format("{}: {} m at {}", dimension, length, rate);
        EXPECT_NEAR(now.energies.total(), 7.3777959183673, 1e-9) << what;
        EXPECT_GT(now.bodies[number_of(scene, "w")].velocity.y(), 2.6) << what;
      }
    }
  }
}

// A heavy ball on a bridge of light knots, which the ropes between them whip up at it: as by smaller steps
// and by the direct solver.
TEST(Ropes, ABridgeOfThemThrowsABallBack) {
  for (const int dimension : {2, 3}) {
    const TextRun scene(
        room_at(dimension, 240, -9.81) + knots(dimension, 9, 0.32) +
        smooth("ball", "w", 2, fmt::format("radius = 0.2\nposition = {}", at(dimension, 6.25, 11.2))));
    EXPECT_NEAR(scene.at(0.545).energies.total(), 285.1362, 1e-3) << dimension;
  }
}

// A heavy box on a pin, a light one on a rope from that to a third: a blow throws the light one about, whose
// rope comes taut while that goes ever faster. Only the blow of its first tightening, 0.035 J, is lost.
TEST(Ropes, ALightLinkOnOneKeepsItsEnergy) {
  for (const int dimension : {2, 3}) {
    const auto box = [&](const char* name, double height, double x, double mass) {
      return smooth("box", name, mass,
                    fmt::format("size = [0.4, {}{}]\nposition = {}", height, dimension == 3 ? ", 0.2" : "",
                                at(dimension, x, 10)));
    };
    for (const int rate : {60, 120, 240}) {
      const TextRun scene(
          room_at(dimension, rate, 0) + box("a", 0.2, 9.4, 1) + box("l", 0.1, 10, 0.016) +
          box("b", 0.2, 10.6, 5) +
          smooth("ball", "ball", 2,
                 fmt::format("radius = 0.1\nposition = {}\nvelocity = {}", at(dimension, 9.3, 9.5),
                             at(dimension, 0, 3))) +
          fmt::format("[[joint]]\ntype = {}\nbetween = ['a', 'l']\nat = {}\n"
                      "[[joint]]\ntype = 'rope'\nbetween = [{{body = 'l', local = {}}}, {{body = 'b', local "
                      "= {}}}]\n",
                      dimension == 2 ? "'pin'" : "'hinge'\naxis = [0, 0, 1]", at(dimension, 9.7, 10.06),
                      at(dimension, 0.2, 0), at(dimension, -0.2, -0.05)));
      EXPECT_NEAR(scene.at(0.4).energies.total(), 8.96522, 2e-4) << dimension << " at " << rate;
    }
  }
}

}  // namespace
}  // namespace obscura::scene

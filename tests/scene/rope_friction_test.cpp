// Ropes that slide with friction, as Euler and Eytelwein have it: the tension on one side is at most e^(mu
// wrap) times that on the other.

#include "scene/text_run.h"

namespace obscura::scene {
namespace {

constexpr double kOverPost = 3.14159265358979323846;

// the exact solver's manners, which alone know such ropes
const std::vector<Manner> kOfRopes = {kManners[0], kManners[1]};

std::string block(const std::string& name, double mass, double x, double y, const std::string& more = "") {
  return fmt::format("[[box]]\nname = \"{}\"\nmass = {}\nsize = [0.1, 0.1]\nposition = [{}, {}]\n{}\n", name,
                     mass, x, y, more);
}

std::string rope(const std::string& over, const std::string& more) {
  return "[[joint]]\nname = \"rope\"\ntype = \"pulley\"\nbetween = [\"heavy\", \"light\"]\nover = [" + over +
         "]\n" + more + "\n";
}

std::string post(const std::string& more, double radius = 0.3) {
  return fmt::format("[[ball]]\nname = \"post\"\nposition = [0, 0]\nradius = {}\nrotation = true\n{}\n",
                     radius, more);
}

double speed_of(const TextRun& run, double t, const std::string& body) {
  return run.at(t).bodies[number_of(run, body)].velocity.y();
}

// Two weights on a rope around a post that stands still: g (m - E n) / (m + E n), E = e^(mu pi), for the
// heavier down; nothing where m < E n. In the plane around a round post, and in space over a point.
TEST(RopeFriction, TwoWeightsOverAPost) {
  for (const Manner& manner : kOfRopes) {
    for (const double mu : {0.05, 0.3, 0.5, 0.6}) {
      const double E = std::exp(mu * kOverPost), a = 5 > E ? 9.81 * (5 - E) / (5 + E) : 0;
      const std::string keys = fmt::format("friction = {}", mu);
      for (const bool mirrored : {false, true}) {
        const double side = mirrored ? -1 : 1;
        const TextRun run(plane_without_walls(manner) + post("fixed = true") +
                          block("heavy", 5, -0.3 * side, -3) + block("light", 1, 0.3 * side, -3) +
                          rope("\"post\"", keys));
        EXPECT_NEAR(speed_of(run, 0.7, "heavy"), -0.7 * a, 1e-9) << manner.name << mu;
        const sim::Snapshot now = run.at(0.7);
        EXPECT_NEAR(now.bodies[number_of(run, "light")].velocity.y(), 0.7 * a, 1e-9) << manner.name << mu;
        // what it says of its forces is what moves them
        EXPECT_NEAR(now.joints[0].force.y(), 5 * (9.81 - a), 1e-9) << manner.name << mu;
        EXPECT_NEAR(now.bodies[number_of(run, "heavy")].held.y(), 5 * (9.81 - a), 1e-9) << manner.name << mu;
        EXPECT_NEAR(now.bodies[number_of(run, "light")].held.y(), 1 * (9.81 + a), 1e-9) << manner.name << mu;
      }
    }
  }
}

// Whole turns hold far more; over several things the angles add up; in space, too.
TEST(RopeFriction, TurnsAndSeveralPostsAddUp) {
  for (const Manner& manner : kOfRopes) {
    const TextRun turns(plane_without_walls(manner) + post("fixed = true") + block("heavy", 50, -0.3, -3) +
                        block("light", 1, 0.3, -3) + rope("\"post\"", "friction = 0.1\nturns = 2"));
    const double E = std::exp(0.1 * 5 * kOverPost);
    EXPECT_NEAR(speed_of(turns, 0.5, "heavy"), -0.5 * 9.81 * (50 - E) / (50 + E), 1e-9) << manner.name;
    const TextRun holds(plane_without_walls(manner) + post("fixed = true") + block("heavy", 50, -0.3, -3) +
                        block("light", 1, 0.3, -3) + rope("\"post\"", "friction = 0.1\nturns = 7"));
    EXPECT_NEAR(speed_of(holds, 5, "heavy"), 0, 1e-9) << manner.name;
    // two pegs, a quarter turn each
    const double half = std::exp(0.2 * kOverPost), a = 9.81 * (3 - half) / (3 + half);
    const TextRun pegs(plane_without_walls(manner) + block("heavy", 3, -1, -3) + block("light", 1, 1, -3) +
                       rope("[-1, 0], [1, 0]", "friction = 0.2"));
    EXPECT_NEAR(speed_of(pegs, 0.5, "heavy"), -0.5 * a, 1e-9) << manner.name;
    const auto cube = [](const std::string& name, double mass, double x) {
      return fmt::format(
          "[[box]]\nname = \"{}\"\nmass = {}\nsize = [0.1, 0.1, 0.1]\nposition = [{}, -3, 1]\n", name, mass,
          x);
    };
    const TextRun space(space_without_walls(manner) + cube("heavy", 3, -1) + cube("light", 1, 1) +
                        rope("[-1, 0, 1], [1, 0, 1]", "friction = 0.2"));
    EXPECT_NEAR(speed_of(space, 0.5, "heavy"), -0.5 * a, 1e-9) << manner.name;
    EXPECT_NEAR(space.at(0.5).bodies[number_of(space, "light")].held.y(), 9.81 + a, 1e-9) << manner.name;
  }
}

// A wheel that turns under a rope which slips on it: equal weights are dragged along with
// a = g (E - 1) / (E + 1) and brake it by their forces, until it turns as the rope goes; then both stay so.
TEST(RopeFriction, AWheelDragsItsRopeUntilItHasItsSpeed) {
  for (const Manner& manner : kOfRopes) {
    const double mu = 0.1, E = std::exp(mu * kOverPost), a = 9.81 * (E - 1) / (E + 1), R = 0.3,
                 I = 0.5 * 2 * R * R;
    const double slows = 2 * 1.5 * a * R / I, w = 20, stops = w * R / (a + slows * R), u = a * stops;
    const TextRun run(plane_without_walls(manner) + post("mass = 2\nspin = 1145.915590261646") +
                      "[[joint]]\ntype = \"pin\"\nbetween = [\"post\", \"room\"]\n" +
                      block("heavy", 1.5, -0.3, -5) + block("light", 1.5, 0.3, -5) +
                      rope("\"post\"", "friction = 0.1"));
    const double tolerance = manner.name == "event" ? 1e-8 : 0.02;
    const std::size_t wheel = number_of(run, "post"), left = number_of(run, "heavy");
    const sim::Snapshot early = run.at(to_a_microsecond(stops / 2));
    EXPECT_NEAR(early.bodies[wheel].spin.z(), w - slows * to_a_microsecond(stops / 2), 1e-8) << manner.name;
    EXPECT_NEAR(std::abs(early.bodies[left].velocity.y()), a * to_a_microsecond(stops / 2), 1e-8)
        << manner.name;
    const sim::Snapshot late = run.at(to_a_microsecond(stops * 1.5));
    EXPECT_NEAR(std::abs(late.bodies[left].velocity.y()), u, tolerance) << manner.name;
    EXPECT_NEAR(late.bodies[wheel].spin.z() * R, u, tolerance) << manner.name;
  }
}

// Enough friction, and a wheel is turned as by a rope that does not slip.
TEST(RopeFriction, MuchOfItIsAWheelOfAtwood) {
  for (const Manner& manner : kOfRopes) {
    const TextRun run(plane_without_walls(manner) + post("mass = 2") +
                      "[[joint]]\ntype = \"pin\"\nbetween = [\"post\", \"room\"]\n" +
                      block("heavy", 3, -0.3, -5) + block("light", 1, 0.3, -5) +
                      rope("\"post\"", "friction = 1"));
    const double a = 2 * 9.81 / (3 + 1 + 0.5 * 2);
    EXPECT_NEAR(speed_of(run, 0.8, "heavy"), -0.8 * a, 1e-9) << manner.name;
    EXPECT_NEAR(run.at(0.8).bodies[number_of(run, "post")].spin.z(), 0.8 * a / 0.3, 1e-8) << manner.name;
  }
}

// A rope that comes tight: its impulses have the ratio, too. u = m v / (m + E n).
TEST(RopeFriction, AJerkIsSharedByIt) {
  for (const Manner& manner : kOfRopes) {
    const double E = std::exp(0.3 * kOverPost), v = 4;
    const TextRun run(plane_without_walls(manner, "gravity = [0, 0]") + post("fixed = true") +
                      block("heavy", 2, -0.3, -3, "velocity = [0, -4]") + block("light", 1, 0.3, -3) +
                      "[[joint]]\nname = \"rope\"\ntype = \"pulley\"\nbetween = [\"heavy\", "
                      "\"light\"]\nover = [[-0.3, 0], [0.3, 0]]\nfriction = 0.3\nlength = 6.8\n");
    EXPECT_NEAR(speed_of(run, 0.3, "light"), 2 * v / (2 + E), 1e-9) << manner.name;
    EXPECT_NEAR(speed_of(run, 0.4, "heavy"), -2 * v / (2 + E), 1e-9) << manner.name;
  }
}

// A weight that swings around a post winds its rope up: it holds what it slipped under before.
TEST(RopeFriction, ARopeThatWindsUpHoldsMore) {
  for (const Manner& manner : kOfRopes) {
    const TextRun run(plane_without_walls(manner) + "rate = 2000\n" + post("fixed = true", 0.02) +
                      block("heavy", 14, -0.02, -0.5) + block("light", 1, 2.5, 0.02) +

                      rope("\"post\"", "friction = 0.3"));
    const double fell = -run.at(1.2).bodies[number_of(run, "heavy")].position.y();
    EXPECT_LT(fell, 2.5) << manner.name;
    EXPECT_NEAR(-run.at(1.4).bodies[number_of(run, "heavy")].position.y(), fell, 1e-9)
        << manner.name << ": it holds";
  }
}

TEST(RopeFriction, WhatIsNotKnownIsRefused) {
  const auto said = [](const std::string& over, const std::string& keys, const Manner& manner = kManners[0]) {
    return refusal(plane_without_walls(manner) + post("fixed = true") + block("heavy", 5, -0.3, -3) +
                   block("light", 1, 0.3, -3) + rope(over, keys));
  };
  const auto expect = [](const std::string& text, const std::string& part) {
    EXPECT_NE(text.find(part), std::string::npos) << text;
  };
  expect(said("\"post\"", "turns = 2"), "'turns' is for a rope with 'friction'");
  expect(said("\"post\"", "friction = 0.1", kManners[2]), "write solver = \"direct\"");
  expect(said("\"post\", \"light\"", "friction = 0.1"), "several that stand still");
  EXPECT_EQ(said("\"post\"", "friction = 0.1"), "");
}

}  // namespace
}  // namespace obscura::scene

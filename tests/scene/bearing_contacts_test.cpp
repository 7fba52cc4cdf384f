// Contacts that bear, where forces depend on how bodies move: these see what lies there lie, not fall.

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <string>

#include "scene/text_run.h"

namespace obscura::scene {
namespace {

constexpr double kWeightOfAKilogram = 9.81;

std::string at_rate(int rate, const char* more = "") {
  return fmt::format("[physics]\nsolver = 'iterative'\nrate = {}\n{}\n", rate, more);
}

std::string box(const char* name, int dimension, double width, double height, double mass, double y,
                const std::string& more) {
  const char* depth = dimension == 2 ? "" : ", 0.4";
  const char* z = dimension == 2 ? "" : ", 0";
  return fmt::format(
      "[[box]]\nname = '{}'\nsize = [{}, {}{}]\nmass = {}\nposition = [0, {}{}]\nelasticity = 0\n{}\n", name,
      width, height, depth, mass, y, z, more);
}

std::string open_room(int dimension, const char* gravity) {
  return dimension == 2 ? fmt::format(
                              "duration = 100\n[room]\nsize = [40, 40]\ncorner = [-20, -20]\nwalls = "
                              "'none'\ngravity = [0, {}]\n",
                              gravity)
                        : fmt::format(
                              "duration = 100\n[room]\nsize = [40, 40, 40]\ncorner = [-20, -20, "
                              "-20]\nwalls = 'none'\ngravity = [0, {}, 0]\n",
                              gravity);
}

// a plate of 1 kg on the spring of a slider, and 4 kg on it: (1 + 4) g / k lower, however it is damped
TEST(BearingContacts, WhatLiesOnADampedSpringRestsWhereItsWeightSays) {
  for (const int dimension : {2, 3}) {
    for (const int rate : {60, 600}) {
      const char* axis = dimension == 2 ? "axis = [0, 1]\nat = [0, 3]" : "axis = [0, 1, 0]\nat = [0, 3, 0]";
      const TextRun scene(open_room(dimension, "-9.81") + at_rate(rate) +
                          box("p", dimension, 1, 0.1, 1, 3, "") + box("b", dimension, 0.4, 0.4, 4, 3.25, "") +
                          fmt::format("[[joint]]\ntype = 'slider'\nbetween = ['p', 'room']\n{}\nspring = {{ "
                                      "stiffness = 100, damping = 20 }}\n",
                                      axis));
      const sim::Snapshot now = scene.at(20);
      const double lower = 5 * kWeightOfAKilogram / 100;
      EXPECT_NEAR(now.bodies[0].position.y(), 3 - lower, 1e-8) << dimension << " at " << rate;
      EXPECT_NEAR(now.joints[0].force.y(), 5 * kWeightOfAKilogram, 1e-6) << dimension << " at " << rate;
    }
  }
}

// a heavy box on a light plate that the air brakes: v = (1 - e^(-c t / M)) M g / c, by schemes of every order
TEST(BearingContacts, DragBrakesWhatLiesOnAPlateToo) {
  for (const int dimension : {2, 3}) {
    for (const char* scheme : {"rk4", "midpoint", "semi-implicit", "euler"}) {
      for (const int rate : {240, 600}) {
        const TextRun scene(open_room(dimension, "-9.81") +
                            at_rate(rate, fmt::format("integrator = '{}'", scheme).c_str()) +
                            box("p", dimension, 1, 0.1, 0.1, 15, "drag = 20\nrotation = false") +
                            box("b", dimension, 0.4, 0.4, 10, 15.25, "rotation = false"));
        const double falls = 10.1 * kWeightOfAKilogram / 20;
        EXPECT_NEAR(scene.at(6).bodies[0].velocity.y(), -falls * (1 - std::exp(-6 * 20 / 10.1)), 5e-6)
            << dimension << scheme << " at " << rate;
      }
    }
  }
}

// what lies still on a floor without friction feels no force that is a multiple of its speed along the normal
TEST(BearingContacts, WhatLiesStillStaysUnderAForceOfItsVelocity) {
  for (const int rate : {60, 600}) {
    const TextRun scene("duration = 3\n[room]\nsize = [40, 8]\ncorner = [-20, 0]\n" + at_rate(rate) +
                        box("b", 2, 0.4, 0.4, 1, 0.2, "friction = 0") +
                        "[[force]]\nof = 'b'\ncomponents = ['10*vy', 0]\n");
    EXPECT_NEAR(scene.at(2).bodies[0].velocity.x(), 0, 1e-12) << rate;
  }
}

// a charge that glides on such a floor in a magnetic field: its force does no work
TEST(BearingContacts, AMagneticFieldDoesNoWorkOnWhatGlides) {
  const TextRun scene("duration = 3\n[room]\nsize = [40, 8]\nmagnetic = 5\n" + at_rate(600) +
                      "[[ball]]\nname = 'b'\nradius = 0.1\nmass = 1\ncharge = -1\nfriction = 0\nelasticity = "
                      "0\nposition = [3, 0.1]\nvelocity = [0.5, 0]\n");
  EXPECT_NEAR(scene.at(2).bodies[0].velocity.x(), 0.5, 2e-5);
}

// what slides there is braked by mu g and turns as if it were not, whatever way friction takes
TEST(BearingContacts, FrictionInAMagneticFieldTurnsWithWhatItBrakes) {
  const double mu = 0.2, v = 1.2, turns = 4, t = 0.4;
  for (const int rate : {60, 600}) {
    const TextRun scene("duration = 1\n[room]\nsize = [20, 8, 20]\nmagnetic = [0, 4, 0]\n" + at_rate(rate) +
                        box("b", 3, 0.4, 0.4, 1, 0.2,
                            "friction = 0.2\ncharge = 1\nrotation = false\nvelocity = [1.2, 0, 0]"));
    const sim::Vec3 now = scene.at(t).bodies[0].velocity;
    const double speed = v - mu * kWeightOfAKilogram * t;
    EXPECT_NEAR(now.x(), speed * std::cos(turns * t), 2e-5) << rate;
    EXPECT_NEAR(now.z(), speed * std::sin(turns * t), 2e-5) << rate;
  }
}

// A force that jumps cuts steps into pieces as short as rounding, whose impulses are of no force that lasts.
TEST(BearingContacts, ForcesThatJumpLeaveWhatLiesOnASpringThere) {
  for (const int rate : {60, 240}) {
    const TextRun scene(
        "duration = 2\n[room]\nsize = [8, 6]\ncorner = [-4, 0]\ndrag = 0.5\n" + at_rate(rate) +
        box("p", 2, 3, 0.2, 1, 2, "friction = 0.5") + box("b", 2, 0.5, 0.5, 5, 2.35, "friction = 0.5") +
        "[[joint]]\ntype = 'slider'\nbetween = ['p', 'room']\naxis = [0, 1]\nspring = { stiffness = 2000, "
        "damping = 40 }\n[[force]]\nof = 'b'\ncomponents = ['8*sign(sin(37*t))', 0]\n");
    const double begun = scene.at(0).energies.total();
    for (const double t : {0.1, 0.3, 0.7, 1.5})
      EXPECT_LT(scene.at(t).energies.total(), begun) << rate << " " << t;
  }
}

// Two that attract each other, touch and turn: their angular momentum stays, to the second order of the step.
TEST(BearingContacts, APairThatTurnsKeepsItsAngularMomentum) {
  const auto lost = [](const std::string& scene) {
    const TextRun run(scene);
    const sim::Snapshot begun = run.at(0), now = run.at(2);
    EXPECT_NEAR(now.energies.total(), begun.energies.total(), 2e-3 * std::fabs(begun.energies.total()));
    return std::fabs(now.angular_momentum.z() / begun.angular_momentum.z() - 1);
  };
  for (const int rate : {240, 600}) {
    const double h = 1.0 / rate;
    EXPECT_LT(
        lost(open_room(2, "0") + at_rate(rate) +
             "[[ball]]\nname = 'a'\nradius = 0.3\nmass = 1\nelasticity = 0\nfriction = 0\nposition = [0, "
             "0]\nvelocity = [0, 0.75]\n[[ball]]\nname = 'b'\nradius = 0.2\nmass = 3\nelasticity = "
             "0\nfriction = 0\nposition = [0.5, 0]\nvelocity = [0, -0.25]\n[[spring]]\nbetween = ['a', "
             "'b']\nstiffness = 20\nrest_length = 0.1\n"),
        15 * h * h)
        << rate;
    const auto cube = [](const char* name, double side) {
      return fmt::format(
          "[[box]]\nname = '{}'\nsize = [0.4, 0.4, 0.4]\nmass = 1\nelasticity = 0\nposition = [{}, 0, "
          "0]\nvelocity = [0, {}, 0]\nspin = [0, 0, 57.29577951308232]\n",
          name, 0.2 * side, 0.2 * side);
    };
    EXPECT_LT(lost(open_room(3, "0") + "gravitation = 5\n" + at_rate(rate) + cube("a", -1) + cube("b", 1)),
              150 * h * h)
        << rate;
  }
}

// A box slides along a table that turns about a pin, with and without a spring and a damper: where it bears
// wanders, and turns, within each step. The scheme is of second order there; of first, the table was off by
// 7e-3 of its speed.
TEST(BearingContacts, WhatSlidesOnATableThatTurnsIsOfSecondOrder) {
  for (const int dimension : {2, 3}) {
    for (const bool held : {false, true}) {
      const char* pin =
          dimension == 2 ? "type = 'pin'\nat = [0, 2]" : "type = 'hinge'\nat = [0, 2, 0]\naxis = [0, 0, 1]";
      const auto spin = [&](const std::string& physics) {
        const TextRun scene(
            open_room(dimension, "-9.81") + physics + box("t", dimension, 2, 0.2, 3, 2, "friction = 0.1") +
            box("b", dimension, 0.4, 0.3, 2, 2.25,
                fmt::format("friction = 0.1\nvelocity = [{}]", dimension == 2 ? "2, 0" : "2, 0, 0")) +
            "[[joint]]\nbetween = ['t', 'room']\n" + pin +
            (held ? "\nspring = { stiffness = 60, damping = 4 }\n" : "\n"));
        return scene.at(0.25).bodies[0].spin.z();
      };
      const double exact = spin("[physics]\ncollision = 'event'\n");
      EXPECT_LT(exact, -0.1);
      for (const int rate : {240, 600, 2400})
        EXPECT_NEAR(spin(at_rate(rate)), exact, 2.5 / (double(rate) * rate))
            << dimension << held << " at " << rate;
    }
  }
}

// What rides on a turntable stays where it is on it: by the velocities that rows have where a step begins it
// went outwards by w^2 h / 2 of its radius a second, 2 % in a round.
TEST(BearingContacts, WhatRidesOnAFreeTurntableStaysThere) {
  for (const int rate : {60, 600}) {
    const TextRun scene(
        open_room(3, "-9.81") + at_rate(rate) +
        "[[box]]\nname = 't'\nsize = [3, 0.2, 3]\nmass = 100\nposition = [0, 0, 0]\nfriction = "
        "1\nspin = [0, 114.59155902616465, 0]\n[[joint]]\ntype = 'hinge'\nbetween = ['t', "
        "'room']\nat = [0, 0, 0]\naxis = [0, 1, 0]\n[[box]]\nsize = [0.2, 0.1, 0.2]\nmass = "
        "1\nposition = [1, 0.15, 0]\nvelocity = [0, 0, -2]\nspin = [0, 114.59155902616465, "
        "0]\nfriction = 1\nelasticity = 0\n");
    const sim::Snapshot now = scene.at(3);
    EXPECT_NEAR(std::hypot(now.bodies[1].position.x(), now.bodies[1].position.z()), 1, 4e-5) << rate;
    EXPECT_NEAR(now.bodies[1].position.x(), std::cos(6), 1e-3) << rate;
  }
}

}  // namespace
}  // namespace obscura::scene

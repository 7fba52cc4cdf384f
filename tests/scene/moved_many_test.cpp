// Prescribed motion, belts and letting go by the solver for many bodies: what motion_test.cpp has of the
// exact one. Where a tolerance is 1e-4, the body leaves or sticks at the end of a substep of 1/600 s.

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <string>

#include "scene/text_run.h"

namespace obscura::scene {
namespace {

constexpr double kFullTurn = 2 * std::numbers::pi;
constexpr double kWeight = 9.81;  // of a kilogram, N

// a plane without walls
std::string by_iterations(const std::string& room = "", const std::string& physics = "") {
  return "duration = 1000\n[room]\nsize = [8, 8]\ncorner = [-4, -4]\nwalls = \"none\"\n" + room +
         "\n[physics]\nsolver = \"iterative\"\n" + physics + "\n";
}

// what there is less what was given
double without_work(const sim::Snapshot& now) { return now.energies.total() - now.energies.work; }

// A ball rests on a platform y = A sin w t until that falls faster than g, sin w t = g / (A w^2), and then
// flies. It sinks by the third derivative of y, h^3 A w^3 / 12 in a step, of which a share of h / (h + 1/60
// s) is pushed back in each, beside a half millionth of the platform's radius that is let be: 1.4e-6 m.
TEST(MovedMany, APlatformThatFallsFasterThanGIsLeft) {
  const double A = 0.2, w = 10;
  const double t0 = std::asin(kWeight / (A * w * w)) / w;
  TextRun scene(
      by_iterations() +
      "[[box]]\nname = \"platform\"\nsize = [2, 0.2]\nposition = [0, -0.1]\nelasticity = 0\n"
      "motion = { y = \"0.2*sin(10*t)\" }\n"
      "[[ball]]\nname = \"ball\"\nradius = 0.1\nposition = [0, 0.1]\nvelocity = [0, 2]\nelasticity = 0\n");
  const std::size_t ball = number_of(scene, "ball");
  const double begun = without_work(scene.at(0)), early = to_a_microsecond(0.9 * t0);
  const sim::Snapshot before = scene.at(early);
  EXPECT_NEAR(before.bodies[ball].position.y(), 0.1 + A * std::sin(w * early), 2e-6);
  EXPECT_NEAR(before.bodies[ball].velocity.y(), A * w * std::cos(w * early), 1e-9);
  EXPECT_NEAR(without_work(before), begun, 1e-4);
  const double t = to_a_microsecond(t0 + 0.15);
  const double flies =
      0.1 + A * std::sin(w * t0) + A * w * std::cos(w * t0) * (t - t0) - 0.5 * kWeight * (t - t0) * (t - t0);
  EXPECT_NEAR(scene.at(t).bodies[ball].position.y(), flies, 1e-4);
  EXPECT_NEAR(without_work(scene.at(t)), begun, 1e-4);
}

// A wall that comes with u meets a ball at rest with elasticity e: it leaves with (1 + e) u, at its own time.
TEST(MovedMany, ARacketGivesItsVelocity) {
  TextRun scene(by_iterations("gravity = [0, 0]") +
                "[[box]]\nname = \"racket\"\nsize = [0.2, 1]\nposition = [-1, 0]\nelasticity = 0.5\n"
                "motion = { x = \"2*t\" }\n"
                "[[ball]]\nname = \"ball\"\nradius = 0.1\nposition = [0, 0]\nelasticity = 0.5\nmass = 2\n");
  const std::size_t ball = number_of(scene, "ball");
  const sim::Snapshot now = scene.at(0.8);
  EXPECT_NEAR(now.bodies[ball].velocity.x(), 3, 1e-9);
  EXPECT_NEAR(now.bodies[ball].position.x(), 3 * (0.8 - 0.4), 1e-6);
  EXPECT_NEAR(now.energies.work, 2 * 3 * 2, 1e-8);  // p u = m v u
}

// A racket that accelerates, x = 4 t^2, meets it where it has 8 t: the impact has the velocity of its time.
TEST(MovedMany, ARacketThatAcceleratesGivesWhatItHasThen) {
  TextRun scene(by_iterations("gravity = [0, 0]") +
                "[[box]]\nname = \"racket\"\nsize = [0.2, 1]\nposition = [-1, 0]\nelasticity = 1\n"
                "motion = { x = \"4*t^2\" }\n"
                "[[ball]]\nname = \"ball\"\nradius = 0.1\nposition = [0, 0]\nelasticity = 1\n");
  const std::size_t ball = number_of(scene, "ball");
  const double met = std::sqrt(0.8 / 4), u = 8 * met;
  const sim::Snapshot now = scene.at(0.6);
  EXPECT_NEAR(now.bodies[ball].velocity.x(), 2 * u, 1e-6);
  EXPECT_NEAR(now.bodies[ball].position.x(), 2 * u * (0.6 - met), 1e-6);
}

// A crate that friction holds on a turntable in space goes round at its radius, and on a bar in the plane
// that rocks it keeps its place: what sticks follows the matter under it, to the second order, with the work
// that it is given in the books.
TEST(MovedMany, WhatSticksToWhatTurnsKeepsItsPlaceOnIt) {
  const double quarter = kFullTurn / 4, rocks = 15 * kFullTurn / 360;
  for (const bool space : {false, true}) {
    double off[2] = {};
    for (const int rate : {600, 1200}) {
      TextRun scene(fmt::format(
          "duration = 10\n[room]\nsize = [8, 8{0}]\ncorner = [-4, -4{1}]\nwalls = \"none\"\n[physics]\n"
          "rate = {2}\nsolver = \"iterative\"\n[[box]]\nsize = [4, 0.2{3}]\nposition = [0, 0{4}]\nfriction = "
          "1\n"
          "motion = {{ {5} }}\n[[box]]\nname = \"crate\"\nsize = [0.4, 0.4{6}]\nposition = [1, 0.3{4}]\n"
          "velocity = {7}\nspin = {8}\nfriction = 1\nelasticity = 0\n",
          space ? ", 8" : "", space ? ", -4" : "", rate, space ? ", 4" : "", space ? ", 0" : "",
          space ? "angle = \"90*t\", axis = [0, 1, 0]" : "angle = \"5*sin(3*t)\"", space ? ", 0.4" : "",
          space ? fmt::format("[0, 0, {:.17g}]", -quarter)
                : fmt::format("[{:.17g}, {:.17g}]", -0.3 * rocks, rocks),
          space ? "[0, 90, 0]" : "15"));
      const std::size_t crate = number_of(scene, "crate");
      const double begun = scene.at(0).energies.total();
      for (const double t : {0.8, 2.0}) {
        const sim::Snapshot now = scene.at(t);
        const sim::Vec3 at = now.bodies[crate].position;
        const double angle = space ? quarter * t : rocks / 3 * std::sin(3 * t), c = std::cos(angle),
                     s = std::sin(angle);
        const sim::Vec3 right = space ? sim::Vec3(c, 0.3, -s) : sim::Vec3(c - 0.3 * s, s + 0.3 * c, 0);
        // in the plane the normal turns, by which the work of the normal force is of the first order
        EXPECT_NEAR(now.energies.total() - begun, now.energies.work, space ? 1e-6 : 0.03 / rate)
            << space << rate << t;
        off[rate / 1200] = std::max(off[rate / 1200], (at - right).norm());
      }
    }
    EXPECT_LT(off[0], 1e-4) << space;
    EXPECT_LT(off[1], off[0] / 3.5) << space;
  }
}

// A platform, or a bar, of which `motion` is said, and two balls, the second at `beside` of the first.
std::string there_and_back(bool space, const std::string& solver, const std::string& motion, double x,
                           double y, double beside) {
  const auto at = [&](double px, double py) {
    return space ? fmt::format("[{}, {}, 0]", px, py) : fmt::format("[{}, {}]", px, py);
  };
  return fmt::format(
      "duration = 10\n[room]\nsize = [8, 8{0}]\ncorner = [-4, -4{1}]\nwalls = \"none\"\ngravity = {2}\n"
      "[physics]\nrate = 60\nsolver = \"{3}\"\n"
      "[[box]]\nname = \"bar\"\nsize = [1, 0.1{4}]\nposition = {2}\nelasticity = 0.5\nmotion = {{ {5} }}\n"
      "[[ball]]\nname = \"struck\"\nradius = 0.05\nposition = {6}\nelasticity = 0.5\n"
      "[[ball]]\nradius = 0.05\nposition = {7}\nelasticity = 0.5\n",
      space ? ", 8" : "", space ? ", -4" : "", at(0, 0), solver, space ? ", 1" : "", motion, at(x, y),
      at(x + beside, y));
}

// There and back within a step, or twice: y = A (1 - cos w t) is where it was at the end of each sixtieth of
// a second, at 60 and 120 Hz without a velocity. A ball at A above it is met in the middle of the way up,
// where it has A w, and leaves with (1 + e) A w. By iterations the course of a substep is a parabola.
TEST(MovedMany, APlatformThatGoesThereAndBackWithinAStepMeetsWhatLiesInItsWay) {
  for (const bool space : {false, true}) {
    for (const char* solver : {"direct", "iterative"}) {
      for (const int frequency : {30, 40, 60, 90, 120}) {
        TextRun scene(there_and_back(
            space, solver, fmt::format("y = \"0.1*(1 - cos(2*pi*{}*t))\"", frequency), 0, 0.2, 0.1005));
        const double up =
            scene.at(to_a_microsecond(2 / 60.0)).bodies[number_of(scene, "struck")].velocity.y();
        const double Aw = 0.1 * kFullTurn * frequency;
        EXPECT_NEAR(up, 1.5 * Aw, 0.01 * Aw) << space << " " << solver << " " << frequency;
      }
    }
  }
}

// The same of a bar that turns there and back: its end passes where the ball lies. By both solvers the ball
// leaves alike.
TEST(MovedMany, ABarThatTurnsThereAndBackWithinAStepMeetsWhatLiesInItsWay) {
  for (const bool space : {false, true}) {
    for (const int frequency : {30, 40, 60, 90, 120}) {
      double up[2] = {};
      for (const bool many : {false, true}) {
        TextRun scene(there_and_back(space, many ? "iterative" : "direct",
                                     fmt::format("angle = \"12.5*(1 - cos(2*pi*{}*t))\"{}", frequency,
                                                 space ? ", axis = [0, 0, 1]" : ""),
                                     0.4, 0.18, -0.1005));
        up[many] = scene.at(to_a_microsecond(2 / 60.0)).bodies[number_of(scene, "struck")].velocity.y();
      }
      EXPECT_GT(up[0], 0.5 * frequency) << space << " " << frequency;
      EXPECT_NEAR(up[1], up[0], 0.01 * up[0]) << space << " " << frequency;
    }
  }
}

// A block at rest on a belt of speed u slips for u / (mu g), then goes along; the belt has given m u^2, half
// of which is heat.
TEST(MovedMany, ABlockSticksToABeltWhenItHasItsSpeed) {
  const double u = 1.5, mu = 0.3, sticks = u / (mu * kWeight);
  TextRun scene(
      by_iterations() +
      "[[box]]\nname = \"belt\"\nsize = [8, 0.2]\nposition = [0, -0.1]\nfixed = true\n"
      "surface_speed = 1.5\nfriction = 0.3\nelasticity = 0\n"
      "[[box]]\nname = \"block\"\nsize = [0.4, 0.2]\nposition = [-3, 0.1]\nmass = 2\nfriction = 0.3\n"
      "elasticity = 0\n");
  const std::size_t block = number_of(scene, "block");
  const double before = to_a_microsecond(0.6 * sticks);
  sim::Snapshot now = scene.at(before);
  EXPECT_NEAR(now.bodies[block].velocity.x(), mu * kWeight * before, 1e-6);
  EXPECT_NEAR(now.energies.work, mu * 2 * kWeight * u * before, 1e-5);
  EXPECT_TRUE(now.contacts[0].sliding);
  const double later = to_a_microsecond(sticks + 0.5);
  now = scene.at(later);
  EXPECT_NEAR(now.bodies[block].velocity.x(), u, 1e-6);
  EXPECT_NEAR(now.bodies[block].position.x(), -3 + 0.5 * u * sticks + u * (later - sticks), 1e-4);
  EXPECT_NEAR(now.energies.work, 2 * u * u, 1e-3);
  EXPECT_FALSE(now.contacts[0].sliding);
}

// A ball without spin falls onto a belt: the impact rubs against the belt's speed, mu (1 + e) v.
TEST(MovedMany, ABallThatFallsOntoABeltIsRubbedByItsSpeed) {
  TextRun scene(by_iterations("gravity = [0, 0]") +
                "[[box]]\nname = \"belt\"\nsize = [8, 0.2]\nposition = [0, -0.1]\nfixed = true\n"
                "surface_speed = 5\nfriction = 0.1\nelasticity = 0.5\n"
                "[[ball]]\nname = \"ball\"\nradius = 0.1\nposition = [-1, 0.5]\nvelocity = [0, -2]\n"
                "friction = 0.1\nelasticity = 0.5\nmass = 2\n");
  const std::size_t ball = number_of(scene, "ball");
  const sim::Snapshot now = scene.at(0.5);
  EXPECT_NEAR(now.bodies[ball].velocity.y(), 1, 1e-9);
  EXPECT_NEAR(now.bodies[ball].velocity.x(), 0.1 * 3, 1e-9);
  EXPECT_NEAR(now.energies.work, 2 * 0.1 * 3 * 5, 1e-8);
}

// A load on a spring, and a bob on a rod, whose other ends are moved: the books have their work. By
// iterations the rod is of second order.
TEST(MovedMany, WorkThroughSpringsAndJointsIsInTheBooks) {
  {
    TextRun scene(by_iterations("", "rate = 1200") +
                  "[[particle]]\nname = \"hand\"\nradius = 0.02\nposition = [0, 1]\n"
                  "motion = { x = \"0.5*sin(3*t)\", y = \"0.2*t\" }\n"
                  "[[particle]]\nname = \"weight\"\nposition = [1, 1]\n"
                  "[[spring]]\nbetween = [\"hand\", \"weight\"]\nstiffness = 30\n");
    const double begun = without_work(scene.at(0));
    EXPECT_GT(std::fabs(scene.at(2).energies.work), 0.1);
    EXPECT_NEAR(without_work(scene.at(2)), begun, 1e-7);
  }
  const auto off = [](int rate) {
    TextRun scene(by_iterations("", fmt::format("rate = {}", rate)) +
                  "[[particle]]\nname = \"pivot\"\nradius = 0.02\nposition = [0, 1]\n"
                  "motion = { x = \"0.3*(1 - cos(4*t))\", y = \"0.1*t^2\" }\n"
                  "[[particle]]\nname = \"bob\"\nradius = 0.05\nposition = [0.8, 1]\n"
                  "[[joint]]\ntype = \"rod\"\nbetween = [\"pivot\", \"bob\"]\n");
    const double begun = without_work(scene.at(0));
    EXPECT_GT(std::fabs(scene.at(2).energies.work), 0.1);
    return std::fabs(without_work(scene.at(2)) - begun);
  };
  const double coarse = off(600), fine = off(1200);
  EXPECT_LT(coarse, 1e-3);
  EXPECT_GT(coarse / fine, 3.5);
}

// A pendulum from a pivot that is moved is that of the exact solver, to fourth order.
TEST(MovedMany, APendulumFromAMovedPivotIsThatOfTheExactSolver) {
  const auto place = [](const std::string& solver, int rate) {
    TextRun scene(fmt::format("duration = 1000\n[room]\nsize = [8, 8]\ncorner = [-4, -4]\nwalls = \"none\"\n"
                              "[physics]\nsolver = \"{}\"\nrate = {}\n",
                              solver, rate) +
                  "[[particle]]\nname = \"pivot\"\nradius = 0.02\nposition = [0, 1]\n"
                  "motion = { x = \"0.3*sin(4*t)\", y = \"0.1*cos(5*t)\" }\n"
                  "[[particle]]\nname = \"bob\"\nradius = 0.05\nposition = [0.8, 1.1]\nvelocity = [1.2, 0]\n"
                  "[[joint]]\ntype = \"rod\"\nbetween = [\"pivot\", \"bob\"]\n");
    return scene.place(1, number_of(scene, "bob"));
  };
  const sim::Vec3 right = place("direct", 1200);
  const double coarse = (place("iterative", 300) - right).norm(),
               fine = (place("iterative", 600) - right).norm();
  EXPECT_LT(fine, 1e-8);
  EXPECT_NEAR(std::log2(coarse / fine), 4, 0.3);
}

// What a body that is moved comes near to wakes: a pusher that waits for two seconds, then accelerates into a
// block that sleeps.
TEST(MovedMany, WhatItComesToWakes) {
  TextRun scene(
      "duration = 9\n[room]\nsize = [8, 4.5]\n[physics]\nsolver = \"iterative\"\n"
      "[[box]]\nname = \"pusher\"\nsize = [0.2, 0.6]\nposition = [1, 0.5]\nfriction = 0\n"
      "elasticity = 0\nmotion = { x = \"if(t < 2, 0, 2*(t - 2)^2)\" }\n"
      "[[box]]\nname = \"block\"\nsize = [0.4, 0.4]\nposition = [2, 0.2]\nfriction = 0.2\nelasticity = 0\n");
  const std::size_t block = number_of(scene, "block");
  EXPECT_NEAR(scene.at(1.5).bodies[block].position.x(), 2, 1e-6);
  // it is pushed from 2.59 s on, and goes along
  EXPECT_NEAR(scene.at(3).bodies[block].position.x(), 1 + 2 + 0.1 + 0.2, 1e-3);
  EXPECT_NEAR(scene.at(3).bodies[block].velocity.x(), 4, 1e-2);
}

// Squares in a drum that turns stay in it, and have no more than what it gives them.
TEST(MovedMany, ADrumKeepsThemIn) {
  std::string text = by_iterations() +
                     "[[body]]\nname = \"drum\"\nposition = [0, 0]\nfriction = 0.8\nelasticity = 0\n"
                     "motion = { angle = \"-60*t\" }\nshapes = [\n";
  for (int i = 0; i < 24; ++i) {
    const double at = i * kFullTurn / 24;
    text += fmt::format("{{ size = [0.2, 0.6], position = [{:.6f}, {:.6f}], angle = {} }},\n",
                        2.1 * std::cos(at), 2.1 * std::sin(at), 15 * i);
  }
  text +=
      "]\n[[box]]\nname = \"square\"\nsize = [0.2, 0.2]\nposition = [-0.9, -0.9]\n"
      "copies = { count = [8, 8], offset = [[0.25, 0], [0, 0.25]] }\nfriction = 0.5\nelasticity = 0.2\n";
  TextRun scene(text);
  const double begun = without_work(scene.at(0));
  for (const double t : {1.0, 2.0, 4.0}) {
    const sim::Snapshot now = scene.at(t);
    for (const sim::Snapshot::Body& body : now.bodies) EXPECT_LT(body.position.norm(), 1.95) << t;
    EXPECT_LT(without_work(now), begun + 1e-3 * std::fabs(begun)) << t;
    EXPECT_GT(now.energies.work, 1) << t;
  }
}

// --- in space

std::string by_iterations_in_space(const std::string& room = "") {
  return "duration = 1000\n[room]\nsize = [8, 8, 8]\ncorner = [-4, -4, -4]\nwalls = \"none\"\n" + room +
         "\n[physics]\nsolver = \"iterative\"\n";
}

TEST(MovedMany, InSpaceAPlatformThatFallsFasterThanGIsLeft) {
  const double A = 0.2, w = 10;
  const double t0 = std::asin(kWeight / (A * w * w)) / w;
  TextRun scene(by_iterations_in_space() +
                "[[box]]\nname = \"platform\"\nsize = [2, 0.2, 2]\nposition = [0, -0.1, 0]\nelasticity = 0\n"
                "motion = { y = \"0.2*sin(10*t)\" }\n"
                "[[ball]]\nname = \"ball\"\nradius = 0.1\nposition = [0, 0.1, 0]\nvelocity = [0, 2, 0]\n"
                "elasticity = 0\n");
  const std::size_t ball = number_of(scene, "ball");
  const double begun = without_work(scene.at(0)), early = to_a_microsecond(0.9 * t0);
  EXPECT_NEAR(scene.place(early, ball).y(), 0.1 + A * std::sin(w * early), 2e-6);
  const double t = to_a_microsecond(t0 + 0.15);
  const double flies =
      0.1 + A * std::sin(w * t0) + A * w * std::cos(w * t0) * (t - t0) - 0.5 * kWeight * (t - t0) * (t - t0);
  EXPECT_NEAR(scene.place(t, ball).y(), flies, 1e-4);
  EXPECT_NEAR(without_work(scene.at(t)), begun, 1e-3);
}

TEST(MovedMany, InSpaceARacketGivesItsVelocity) {
  TextRun scene(
      by_iterations_in_space("gravity = [0, 0, 0]") +
      "[[box]]\nname = \"racket\"\nsize = [0.2, 1, 1]\nposition = [-1, 0, 0]\nelasticity = 0.5\n"
      "motion = { x = \"2*t\" }\n"
      "[[ball]]\nname = \"ball\"\nradius = 0.1\nposition = [0, 0, 0]\nelasticity = 0.5\nmass = 2\n");
  const std::size_t ball = number_of(scene, "ball");
  const sim::Snapshot now = scene.at(0.8);
  EXPECT_NEAR(now.bodies[ball].velocity.x(), 3, 1e-9);
  EXPECT_NEAR(now.bodies[ball].position.x(), 3 * (0.8 - 0.4), 1e-6);
  EXPECT_NEAR(now.energies.work, 2 * 3 * 2, 1e-8);
}

TEST(MovedMany, InSpaceABeltGoesAlongItsVector) {
  TextRun scene(by_iterations_in_space() +
                "[[box]]\nname = \"belt\"\nsize = [6, 0.2, 6]\nposition = [0, -0.1, 0]\nfixed = true\n"
                "surface_speed = [0.3, 0, -0.4]\nfriction = 0.4\nelasticity = 0\n"
                "[[box]]\nname = \"block\"\nsize = [0.4, 0.2, 0.3]\nposition = [0, 0.1, 0]\nfriction = 0.4\n"
                "elasticity = 0\nmass = 2\n");
  const std::size_t block = number_of(scene, "block");
  const sim::Snapshot now = scene.at(1);
  EXPECT_NEAR((now.bodies[block].velocity - sim::Vec3(0.3, 0, -0.4)).norm(), 0, 1e-6);
  EXPECT_NEAR(now.energies.work, 2 * 0.25, 1e-3);  // m u^2
}

// A ball that rolls on a turntable goes around at 2/7 of its rate, wherever and however fast it starts.
TEST(MovedMany, InSpaceABallOnATurntableGoesAroundAtTwoSeventhsOfItsRate) {
  const double omega = std::numbers::pi, radius = 0.1, v0 = 0.3, r0 = 0.5;
  const double slip = v0 + omega * r0;  // along z, of the ball against the table
  TextRun scene(
      by_iterations_in_space() +
      fmt::format("[[box]]\nname = \"table\"\nsize = [6, 0.2, 6]\nposition = [0, -0.1, 0]\n"
                  "elasticity = 0\nfriction = 2\nmotion = {{ angle = \"180*t\", axis = [0, 1, 0] }}\n"
                  "[[ball]]\nname = \"ball\"\nradius = {}\nposition = [{}, {}, 0]\n"
                  "velocity = [0, 0, {}]\nspin = [{}, 0, 0]\nelasticity = 0\nfriction = 2\n",
                  radius, r0, radius, v0, slip / radius * 360 / kFullTurn));
  const std::size_t ball = number_of(scene, "ball");
  const double rate = 2.0 / 7 * omega;
  for (const double t : {0.5, 1.0, 1.75}) {
    const sim::Snapshot now = scene.at(t);
    EXPECT_NEAR(now.bodies[ball].velocity.z(), v0 * std::cos(rate * t), 1e-3) << t;
    EXPECT_NEAR(now.bodies[ball].velocity.x(), v0 * std::sin(rate * t), 1e-3) << t;
    EXPECT_NEAR(now.bodies[ball].position.y(), radius, 1e-5) << t;
  }
}

TEST(MovedMany, GoesOnToTheSameBitsFromACheckpoint) {
  const Scene scene = parse(
      "duration = 9\n[room]\nsize = [8, 4.5]\n[physics]\nsolver = \"iterative\"\n"
      "[[box]]\nname = \"platform\"\nsize = [2, 0.2]\nposition = [4, 1]\nelasticity = 0.3\n"
      "surface_speed = 0.3\nmotion = { y = \"0.3*sin(4*t)\", angle = \"20*sin(3*t)\" }\nrelease = 1.2345\n"
      "[[box]]\nname = \"load\"\nsize = [0.3, 0.3]\nposition = [4, 1.3]\n"
      "copies = { count = 3, offset = [0.1, 0.35] }\n",
      "a.toml");
  const auto words_at = [&](sim::Run& run, const char* t) {
    (void)run.at(*sim::parse_rational(t));
    return run.words();
  };
  const auto whole = scene.run(), part = scene.run();
  (void)words_at(*part, "1.1");
  const auto words = words_at(*whole, "2.5");
  const auto resumed = scene.run(part->saved());
  ASSERT_TRUE(resumed);
  EXPECT_EQ(words_at(*resumed, "2.5"), words);
  (void)words_at(*part, "1.7");
  const auto late = scene.run(part->saved());
  ASSERT_TRUE(late);
  EXPECT_EQ(words_at(*late, "2.5"), words);
  const auto filmed = scene.run();
  for (int i = 1; i < 50; ++i) (void)filmed->at({i * 37, 1000});
  EXPECT_EQ(words_at(*filmed, "2.5"), words);
}

// A press that comes down on a box on the floor, where nothing gives way: the run ends with what there is no
// room between, once a tenth of the box has gone into them, and not where it is merely held.
TEST(MovedMany, APressThatLeavesNoRoomEndsTheRun) {
  for (const int dimension : {2, 3}) {
    const char* z = dimension == 2 ? "" : ", 0";
    for (const Manner& manner : kManners) {
      for (const int rate : {60, 240}) {
        for (const double e : {0.0, 0.8}) {
          // by events it takes its time, and what bounces does at high rates
          if (manner.name == "event" || (rate > 60 && e > 0)) continue;
          SCOPED_TRACE(fmt::format("{}D by {} at {}, e = {}", dimension, manner.name, rate, e));
          const auto press = [&](const char* height) {
            return TextRun(fmt::format(
                "duration = 2\n[room]\nwalls = 'ground'\nsize = [8, 4{0}]\n{1}\nrate = {2}\n[[box]]\nname = "
                "'b'\n"
                "size = [0.4, 0.4{3}]\nmass = 1\nelasticity = {4}\nposition = [1, 0.2{5}]\n[[box]]\nname = "
                "'p'\n"
                "size = [1, 0.2{6}]\nelasticity = {4}\nposition = [1, 0.8{5}]\nmotion = {{ y = '{7}' }}\n",
                dimension == 2 ? "" : ", 8", manner.keys, rate, dimension == 2 ? "" : ", 0.4", e, z,
                dimension == 2 ? "" : ", 1", height));
          };
          const TextRun crushed = press("-0.5 * t");
          const auto outcome = crushed.run->at(*sim::parse_rational("1.5"));
          const auto* trouble = std::get_if<sim::Trouble>(&outcome);
          ASSERT_TRUE(trouble);
          EXPECT_EQ(trouble->body, "b");
          // room for it until 0.6 s; what bounces between them without end is told at once
          EXPECT_NEAR(trouble->time, 0.65, 0.06);
          EXPECT_NE((trouble->what + trouble->likely).find("nothing stops"), std::string::npos);
          const TextRun held = press("-0.145 * (1 - cos(2 * t))");
          EXPECT_NEAR(held.at(1.5).bodies[number_of(held, "b")].position.y(), 0.2, 1e-6);
        }
      }
    }
  }
}

}  // namespace
}  // namespace obscura::scene

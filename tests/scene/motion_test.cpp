// Prescribed motion, belts and letting go: against closed forms, in every mode.

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <string>
#include <variant>
#include <vector>

#include "scene/error.h"
#include "scene/scene.h"
#include "scene/text_run.h"
#include "sim/step/run.h"

namespace obscura::scene {
namespace {

using sim::Vec3;
using testing::HasSubstr;

constexpr double kRound = 2 * std::numbers::pi;
constexpr double kFall = 9.81;

// what is wrong with a text; empty: nothing
std::string said_of(const std::string& text, const std::vector<std::string>& sets = {}) {
  try {
    parse(text, "a.toml", sets);
  } catch (const Error& error) {
    return error.what();
  }
  return "";
}

const std::vector<std::string> kBothModes = {"contact", "event"};

// books: what there is less what was given
double owned(const sim::Snapshot& now) { return now.energies.total() - now.energies.work; }

std::string open_plane(const std::string& more = "") {
  return "duration = 1000\n[room]\nsize = [8, 8]\ncorner = [-4, -4]\nwalls = \"none\"\n" + more + "\n";
}

// --- motion

TEST(Motion, IsThatOfItsExpressionsWithExactVelocity) {
  TextRun scene(open_plane() +
                "[[box]]\nname = \"table\"\nsize = [1, 0.2]\nposition = [1, 0.5]\n"
                "motion = { x = \"0.3*sin(2*pi*t)\", y = \"0.1*t^2\", angle = \"90*t\" }\n");
  for (const double t : {0.0, 0.37, 1.25}) {
    const sim::Snapshot now = scene.at(t);
    EXPECT_NEAR(now.bodies[0].position.x(), 1 + 0.3 * std::sin(kRound * t), 1e-14);
    EXPECT_NEAR(now.bodies[0].position.y(), 0.5 + 0.1 * t * t, 1e-14);
    EXPECT_NEAR(now.bodies[0].velocity.x(), 0.3 * kRound * std::cos(kRound * t), 1e-13);
    EXPECT_NEAR(now.bodies[0].velocity.y(), 0.2 * t, 1e-14);
    EXPECT_NEAR(now.bodies[0].angle, std::numbers::pi / 2 * t, 1e-14);
    EXPECT_NEAR(now.bodies[0].spin.z(), std::numbers::pi / 2, 1e-14);
  }
}

TEST(Motion, OfAPathGoesThroughItsPlacesAndRestsAtItsEnds) {
  TextRun scene(open_plane() +
                "[[box]]\nname = \"table\"\nsize = [1, 0.2]\n"
                "motion = { path = [[0.5, 0, 1], [1, 2, 1], [2, 2, 3]] }\n");
  EXPECT_EQ(scene.at(0.25).bodies[0].position, Vec3(0, 1, 0));
  EXPECT_EQ(scene.at(0.5).bodies[0].velocity, Vec3(0, 0, 0));
  EXPECT_NEAR((scene.at(1).bodies[0].position - Vec3(2, 1, 0)).norm(), 0, 1e-14);
  EXPECT_GT(scene.at(1).bodies[0].velocity.norm(), 1);
  EXPECT_NEAR(scene.at(2.5).bodies[0].velocity.norm(), 0, 1e-14);
  EXPECT_NEAR((scene.at(3).bodies[0].position - Vec3(2, 3, 0)).norm(), 0, 1e-14);
}

// A ball rests on a platform y = A sin w t until that falls faster than g, sin w t = g / (A w^2), and then
// flies.
TEST(Motion, APlatformThatFallsFasterThanGIsLeft) {
  const double A = 0.2, w = 10;
  const double t0 = std::asin(kFall / (A * w * w)) / w;
  for (const std::string& mode : kBothModes) {
    TextRun scene(
        open_plane("[physics]\ncollision = \"" + mode + "\"") +
        "[[box]]\nname = \"platform\"\nsize = [2, 0.2]\nposition = [0, -0.1]\nelasticity = 0\n"
        "motion = { y = \"0.2*sin(10*t)\" }\n"
        "[[ball]]\nname = \"ball\"\nradius = 0.1\nposition = [0, 0.1]\nvelocity = [0, 2]\nelasticity = 0\n");
    const std::size_t ball = scene.run->scene_info().bodies[0].name == "ball" ? 0 : 1;
    const double begun = owned(scene.at(0)), early = to_a_microsecond(0.9 * t0);
    const sim::Snapshot before = scene.at(early);
    EXPECT_NEAR(before.bodies[ball].position.y(), 0.1 + A * std::sin(w * early), 1e-9) << mode;
    EXPECT_NEAR(owned(before), begun, 1e-7) << mode;
    const double t = to_a_microsecond(t0 + 0.15);
    const double flies =
        0.1 + A * std::sin(w * t0) + A * w * std::cos(w * t0) * (t - t0) - 0.5 * kFall * (t - t0) * (t - t0);
    EXPECT_NEAR(scene.at(t).bodies[ball].position.y(), flies, mode == "event" ? 1e-6 : 2e-4) << mode;
    EXPECT_TRUE(scene.at(t).contacts.empty()) << mode;
    // what it gave is what the ball has
    EXPECT_NEAR(owned(scene.at(t)), begun, mode == "event" ? 1e-7 : 1e-5) << mode;
  }
}

// Kapitza's pendulum: on a pivot that shakes by a at Omega it stands upside down where (a Omega)^2 > 2 g l,
// up to (a/l)^2 / 2 of that (Mathieu's equation; here 0.2 % of the speed).
TEST(Motion, KapitzasPendulumStandsFromItsThresholdOn) {
  const auto tip = [](const std::string& mode, double of_threshold, double until) {
    const double a = 0.1, speed = of_threshold * std::sqrt(2 * kFall * 1.0);
    TextRun scene(open_plane("[physics]\nrate = 600\n" + mode) +
                  fmt::format("[[particle]]\nname = \"pivot\"\nposition = [0, 0]\nradius = 0.02\n"
                              "motion = {{ y = \"{}*cos({}*t) - {}\" }}\n"
                              "[[particle]]\nname = \"bob\"\nposition = [0.03, 1]\nradius = 0.05\n"
                              "[[joint]]\ntype = \"rod\"\nbetween = [\"pivot\", \"bob\"]\n",
                              a, speed / a, a));
    double least = 2;
    for (double t = 0.5; t <= until; t += 0.5) {
      const sim::Snapshot now = scene.at(t);
      least = std::min(least, now.bodies[1].position.y() - now.bodies[0].position.y());
    }
    return least;
  };
  for (const char* mode : {"", "collision = \"event\"", "solver = \"iterative\""}) {
    EXPECT_GT(tip(mode, 1.01, 10), 0.98) << mode;
    EXPECT_LT(tip(mode, 0.99, 10), 0.8) << mode;
  }
}

// A ball that rolls on a turntable goes around at 2/7 of its rate, wherever and however fast it starts.
TEST(Motion, ABallOnATurntableGoesAroundAtTwoSeventhsOfItsRate) {
  const double omega = std::numbers::pi, radius = 0.1, v0 = 0.3, r0 = 0.5;
  // w = y x (v - Omega x r) / R; y x ((0,0,v0) - omega (0,0,-r0)...) with r = (r0, 0, 0)
  const double slip = v0 + omega * r0;  // of (v - Omega x r) along z: Omega x r = (0, 0, -omega r0)
  const double spin = slip / radius * 180 / std::numbers::pi;  // about x: y x z = x
  TextRun scene(fmt::format(
      "duration = 1000\n[room]\nsize = [8, 8, 8]\ncorner = [-4, -4, -4]\nwalls = \"none\"\n"
      "[[box]]\nname = \"table\"\nsize = [6, 0.2, 6]\nposition = [0, -0.1, 0]\nelasticity = 0\nfriction = 2\n"
      "motion = {{ angle = \"180*t\" }}\n"
      "[[ball]]\nname = \"ball\"\nradius = {}\nposition = [{}, {}, 0]\nvelocity = [0, 0, {}]\n"
      "spin = [{}, 0, 0]\nelasticity = 0\nfriction = 2\n",
      radius, r0, radius, v0, spin));
  const std::size_t ball = scene.run->scene_info().bodies[0].name == "ball" ? 0 : 1;
  // v turns about y by 2/7 omega: from +z to +x
  const double rate = 2.0 / 7 * omega;
  for (const double t : {0.5, 1.0, 1.75}) {
    const sim::Snapshot now = scene.at(t);
    EXPECT_NEAR(now.bodies[ball].velocity.z(), v0 * std::cos(rate * t), 1e-6) << t;
    EXPECT_NEAR(now.bodies[ball].velocity.x(), v0 * std::sin(rate * t), 1e-6) << t;
    EXPECT_NEAR(now.bodies[ball].position.y(), radius, 1e-9) << t;
  }
}

// The order of a scheme is that which it has: a weight on a spring whose other end is moved, x'' = -w^2 (x -
// X), X = A sin W t.
TEST(Motion, KeepsTheOrderOfTheScheme) {
  const double k = 30, w2 = k, W = 3, A = 0.2;
  const double p = A * w2 / (w2 - W * W);  // x = p sin W t - p W / w sin w t
  const auto off = [&](const std::string& scheme, int rate, const std::string& mode) {
    TextRun scene(open_plane(fmt::format("gravity = [0, 0]\n[physics]\nrate = {}\nintegrator = \"{}\"\n"
                                         "collision = \"{}\"",
                                         rate, scheme, mode)) +
                  "[[particle]]\nname = \"hand\"\nradius = 0.02\nposition = [0, 1]\n"
                  "motion = { x = \"0.2*sin(3*t)\" }\n"
                  "[[particle]]\nname = \"weight\"\nposition = [1, 1]\nmass = 1\n"
                  "[[spring]]\nbetween = [\"hand\", \"weight\"]\nstiffness = 30\nrest_length = 1\n");
    const double t = 1, w = std::sqrt(w2);
    return std::fabs(scene.at(t).bodies[1].position.x() - 1 -
                     (p * std::sin(W * t) - p * W / w * std::sin(w * t)));
  };
  for (const char* mode : {"contact", "handout"}) {
    EXPECT_NEAR(std::log2(off("rk4", 50, mode) / off("rk4", 100, mode)), 4, 0.2) << mode;
    EXPECT_NEAR(std::log2(off("midpoint", 100, mode) / off("midpoint", 200, mode)), 2, 0.2) << mode;
    EXPECT_NEAR(std::log2(off("euler", 1600, mode) / off("euler", 3200, mode)), 1, 0.2) << mode;
  }
}

// A pendulum on a rod from a pivot that is moved: the rod's row has the pivot's acceleration in every stage.
TEST(Motion, OfAJointsEndKeepsTheOrderOfTheScheme) {
  const auto place = [&](int rate) {
    TextRun scene(open_plane(fmt::format("[physics]\nrate = {}\ncollision = \"event\"", rate)) +
                  "[[particle]]\nname = \"pivot\"\nradius = 0.02\nposition = [0, 1]\n"
                  "motion = { x = \"0.3*sin(4*t)\", y = \"0.1*cos(5*t)\" }\n"
                  "[[particle]]\nname = \"bob\"\nradius = 0.05\nposition = [0.8, 1.1]\nvelocity = [1.2, 0]\n"
                  "[[joint]]\ntype = \"rod\"\nbetween = [\"pivot\", \"bob\"]\n");
    return scene.at(1).bodies[1].position;
  };
  const Vec3 right = place(400);
  const double coarse = (place(6) - right).norm(), fine = (place(12) - right).norm();
  EXPECT_GT(std::log2(coarse / fine), 3.5) << coarse << " " << fine;
  EXPECT_LT((place(50) - right).norm(), 1e-9);
}

TEST(Motion, GivesWorkThatIsInTheBooks) {
  for (const char* mode : {"contact", "event", "handout"}) {
    TextRun scene(open_plane(fmt::format("[physics]\nrate = 1200\ncollision = \"{}\"", mode)) +
                  "[[particle]]\nname = \"hand\"\nradius = 0.02\nposition = [0, 1]\n"
                  "motion = { x = \"0.5*sin(3*t)\", y = \"0.2*t\" }\n"
                  "[[particle]]\nname = \"weight\"\nposition = [1, 1]\n"
                  "[[spring]]\nbetween = [\"hand\", \"weight\"]\nstiffness = 30\n");
    const double begun = owned(scene.at(0));
    const sim::Snapshot now = scene.at(2);
    EXPECT_GT(std::fabs(now.energies.work), 0.1) << mode;
    EXPECT_NEAR(owned(now), begun, 1e-7) << mode;
  }
  // through a joint
  TextRun scene(open_plane("[physics]\nrate = 1200") +
                "[[particle]]\nname = \"pivot\"\nradius = 0.02\nposition = [0, 1]\n"
                "motion = { x = \"0.3*(1 - cos(4*t))\", y = \"0.1*t^2\" }\n"
                "[[particle]]\nname = \"bob\"\nradius = 0.05\nposition = [0.8, 1]\n"
                "[[joint]]\ntype = \"rod\"\nbetween = [\"pivot\", \"bob\"]\n");
  const double begun = owned(scene.at(0));
  EXPECT_NEAR(owned(scene.at(2)), begun, 1e-7);
}

// A wall that comes with u meets a ball at rest with elasticity e: it leaves with (1 + e) u.
TEST(Motion, ARacketGivesItsVelocity) {
  for (const std::string& mode : kBothModes) {
    TextRun scene(open_plane("gravity = [0, 0]\n[physics]\ncollision = \"" + mode + "\"") +
                  "[[box]]\nname = \"racket\"\nsize = [0.2, 1]\nposition = [-1, 0]\nelasticity = 0.5\n"
                  "motion = { x = \"2*t\" }\n"
                  "[[ball]]\nname = \"ball\"\nradius = 0.1\nposition = [0, 0]\nelasticity = 0.5\nmass = 2\n");
    const std::size_t ball = scene.run->scene_info().bodies[0].name == "ball" ? 0 : 1;
    const sim::Snapshot now = scene.at(0.8);
    EXPECT_NEAR(now.bodies[ball].velocity.x(), 3, 1e-9) << mode;
    EXPECT_NEAR(now.bodies[ball].position.x(), 3 * (0.8 - 0.4), 1e-6) << mode;
    EXPECT_NEAR(now.energies.work, 2 * 3 * 2, 1e-8) << mode;  // p u = m v u
  }
}

// --- belts

// A block at rest on a belt of speed u slips for u / (mu g), then goes along; the belt has given m u^2, half
// of which is heat.
TEST(Belt, ABlockSticksWhenItHasItsSpeedAndTheBeltGivesTwiceItsEnergy) {
  const double u = 1.5, mu = 0.3, sticks = u / (mu * kFall);
  for (const std::string& mode : kBothModes) {
    TextRun scene(
        open_plane("[physics]\ncollision = \"" + mode + "\"") +
        "[[box]]\nname = \"belt\"\nsize = [8, 0.2]\nposition = [0, -0.1]\nfixed = true\n"
        "surface_speed = 1.5\nfriction = 0.3\nelasticity = 0\n"
        "[[box]]\nname = \"block\"\nsize = [0.4, 0.2]\nposition = [-3, 0.1]\nmass = 2\nfriction = 0.3\n"
        "elasticity = 0\n");
    const double before = to_a_microsecond(0.6 * sticks);
    sim::Snapshot now = scene.at(before);
    EXPECT_NEAR(now.bodies[1].velocity.x(), mu * kFall * before, 1e-6) << mode;
    EXPECT_NEAR(now.energies.work, mu * 2 * kFall * u * before, 1e-5) << mode;
    EXPECT_TRUE(now.contacts[0].sliding) << mode;
    const double later = to_a_microsecond(sticks + 0.5);
    now = scene.at(later);
    EXPECT_NEAR(now.bodies[1].velocity.x(), u, 1e-6) << mode;
    EXPECT_NEAR(now.bodies[1].position.x(), -3 + 0.5 * u * sticks + u * (later - sticks),
                mode == "event" ? 1e-6 : 1e-4)
        << mode;
    EXPECT_NEAR(now.energies.work, 2 * u * u, mode == "event" ? 1e-5 : 1e-3) << mode;
    EXPECT_FALSE(now.contacts[0].sliding) << mode;
  }
}

TEST(Belt, InSpaceGoesAlongItsVector) {
  TextRun scene(
      "duration = 1000\n[room]\nsize = [8, 8, 8]\ncorner = [-4, -4, -4]\nwalls = \"none\"\n"
      "[[box]]\nname = \"belt\"\nsize = [6, 0.2, 6]\nposition = [0, -0.1, 0]\nfixed = true\n"
      "surface_speed = [0.3, 0, -0.4]\nfriction = 0.4\nelasticity = 0\n"
      "[[box]]\nname = \"block\"\nsize = [0.4, 0.2, 0.3]\nposition = [0, 0.1, 0]\nfriction = 0.4\nelasticity "
      "= 0\n");
  const sim::Snapshot now = scene.at(1);
  const std::size_t block = scene.run->scene_info().bodies[0].name == "block" ? 0 : 1;
  EXPECT_NEAR((now.bodies[block].velocity - Vec3(0.3, 0, -0.4)).norm(), 0, 1e-6);
}

// A body that has a belt goes by it: its lower side goes back, and in space all of it along the vector.
TEST(Belt, OfAFreeBodyDrivesItByFriction) {
  const std::string body = "name = \"b\"\nmass = 2\nfriction = 0.5\nelasticity = 0\n";
  for (const char* mode :
       {"solver = \"direct\"", "solver = \"iterative\"", "collision = \"event\"", "integrator = \"euler\""}) {
    const std::string room = fmt::format("duration = 10\n[physics]\n{}\n[room]\nwalls = \"ground\"\n", mode);
    TextRun plane(room + "size = [8, 4]\n[[box]]\n" + body +
                  "size = [1, 0.4]\nposition = [0, 0.2]\nsurface_speed = 3\n");
    TextRun rolls(room + "size = [8, 4]\n[[ball]]\n" + body +
                  "radius = 0.2\nposition = [0, 0.2]\nsurface_speed = 3\n");
    TextRun space(room + "size = [8, 4, 8]\n[[box]]\n" + body +
                  "size = [1, 0.4, 0.6]\nposition = [0, 0.2, 0]\nsurface_speed = [-3, 0, 4]\n");
    for (const double t : {0.1, 0.5, 2.0}) {
      EXPECT_NEAR(plane.at(t).bodies[0].velocity.x(), std::min(0.5 * kFall * t, 3.0), 1e-9) << mode << t;
      // while it slips it is pushed alike, and turns back by 2 v / r: it ends when v (1 + 2) is the belt's
      // speed
      EXPECT_NEAR(rolls.at(t).bodies[0].velocity.x(), std::min(0.5 * kFall * t, 1.0), 1e-6) << mode << t;
      const double along = std::min(0.5 * kFall * t, 5.0);
      EXPECT_NEAR((space.at(t).bodies[0].velocity - along * Vec3(0.6, 0, -0.8)).norm(), 0, 1e-9) << mode << t;
    }
    EXPECT_NEAR(plane.at(2).energies.work, 2 * 3 * 3, 1e-9) << mode;
  }
}

// --- letting go

TEST(Release, LetsGoWithTheVelocityAndBooksTheEnergy) {
  for (const char* mode : {"contact", "event", "handout"}) {
    TextRun scene(open_plane(fmt::format("[physics]\ncollision = \"{}\"", mode)) +
                  "[[particle]]\nname = \"ball\"\nradius = 0.1\nposition = [-2, 0]\n"
                  "motion = { x = \"1.5*t\", y = \"2*t\" }\nrelease = 0.5003\n");
    EXPECT_NEAR(scene.at(0.4).energies.total(), 0, 1e-14) << mode;
    const sim::Snapshot now = scene.at(1);
    const double s = 1 - 0.5003;
    EXPECT_NEAR(now.bodies[0].position.x(), -2 + 1.5, 1e-12) << mode;
    EXPECT_NEAR(now.bodies[0].position.y(), 2 - 0.5 * kFall * s * s, 1e-11) << mode;
    EXPECT_NEAR(owned(now), 0, 1e-10) << mode;
    EXPECT_GT(now.energies.work, 1) << mode;
  }
}

TEST(Release, OfAGateWakesWhatLeansOnIt) {
  for (const char* solver : {"direct", "iterative"}) {
    TextRun scene(fmt::format("duration = 9\n[room]\nsize = [8, 4.5]\n[physics]\nsolver = \"{}\"\n", solver) +
                  "[[box]]\nname = \"shelf\"\nsize = [1, 0.1]\nposition = [4, 2]\nfixed = true\nrelease = "
                  "2\nelasticity = 0\n"
                  "[[box]]\nname = \"load\"\nsize = [0.3, 0.3]\nposition = [4, 2.2]\nelasticity = 0\n");
    EXPECT_NEAR(scene.at(1.9).bodies[1].position.y(), 2.2, 1e-4) << solver;
    const sim::Snapshot now = scene.at(2.3);
    EXPECT_NEAR(now.bodies[0].position.y(), 2 - 0.5 * kFall * 0.09, 2e-3) << solver;
    EXPECT_NEAR(now.bodies[1].position.y(), 2.2 - 0.5 * kFall * 0.09, 2e-3) << solver;
    // and lies on the floor in the end
    EXPECT_NEAR(scene.at(6).bodies[0].position.y(), 0.05, 5e-3) << solver;
  }
}

TEST(Release, GoesOnToTheSameBitsFromACheckpoint) {
  const Scene scene = parse(
      "duration = 9\n[room]\nsize = [8, 4.5]\n"
      "[[box]]\nname = \"platform\"\nsize = [2, 0.2]\nposition = [4, 1]\nelasticity = 0.3\n"
      "motion = { y = \"0.3*sin(4*t)\", angle = \"20*sin(3*t)\" }\nrelease = 1.2345\n"
      "[[box]]\nname = \"load\"\nsize = [0.3, 0.3]\nposition = [4, 1.3]\n",
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
  // frames between steps change nothing
  const auto filmed = scene.run();
  for (int i = 1; i < 50; ++i) (void)filmed->at({i * 37, 1000});
  EXPECT_EQ(words_at(*filmed, "2.5"), words);
}

// --- what is wrong is told

TEST(Motion, FaultsAreToldWithTheirColumn) {
  const std::string box = open_plane() + "[[box]]\nname = \"table\"\nsize = [1, 0.2]\nposition = [0, 0]\n";
  EXPECT_THAT(said_of(box + "motion = { x = \"0.3*sinn(t)\" }\n"), HasSubstr("'x', column 5"));
  EXPECT_THAT(said_of(box + "motion = { x = \"vx\" }\n"), HasSubstr("depends on t alone"));
  EXPECT_THAT(said_of(box + "motion = {}\n"), HasSubstr("moves nothing"));
  EXPECT_THAT(said_of(box + "motion = { x = \"t\" }\nvelocity = [1, 0]\n"), HasSubstr("follows from that"));
  EXPECT_THAT(said_of(box + "motion = { x = \"t\" }\nfixed = true\n"), HasSubstr("leave one out"));
  EXPECT_THAT(said_of(box + "release = 2\n"), HasSubstr("this is free"));
  EXPECT_THAT(said_of(box + "motion = { x = \"log(t)\" }\n"), HasSubstr("not finite at the start"));
  EXPECT_THAT(said_of(box + "motion = { path = [[0, 0, 0], [1, 1, 0]] }\n"),
              HasSubstr("leave out 'position'"));
  EXPECT_EQ(said_of(box + "motion = { x = \"v*t\" }\n[constants]\nv = 2\n"), "");
  EXPECT_EQ(said_of(box + "motion = { x = \"t\" }\n", {"table.motion.x=2*t", "table.release=2"}), "");
}

TEST(Motion, ThatIsNotFiniteEndsTheRunWithBodyAndTime) {
  const auto run = parse(open_plane() +
                             "[[box]]\nname = \"table\"\nsize = [1, 0.2]\nposition = [0, 0]\n"
                             "motion = { x = \"sqrt(1 - t)\" }\n",
                         "a.toml")
                       .run();
  const auto outcome = run->at({2, 1});
  const auto* trouble = std::get_if<sim::Trouble>(&outcome);
  ASSERT_TRUE(trouble);
  EXPECT_EQ(trouble->body, "table");
  EXPECT_EQ(trouble->quantity, "motion");
  EXPECT_NEAR(trouble->time, 1, 0.01);
}

// The spring of a hand is beside the room's energy: the two together stay while the hand rests, and where it
// lets go the room's own goes on.
TEST(Hand, HasItsEnergyBesideTheRooms) {
  for (const char* mode : {"handout", "contact", "event"}) {
    const TextRun run(fmt::format(
        "duration = 3\n[room]\nsize = [8, 8]\nwalls = \"none\"\n[physics]\ncollision = \"{}\"\n"
        "[[particle]]\nname = \"p\"\nposition = [3, 4]\nmass = 2\n"
        "[[spring]]\nbetween = [\"p\", [3, 6]]\nstiffness = 15\n"
        "[[mouse]]\npath = [[0.5, 4, 4], [1.25, 4, 4]]\nstiffness = 50\nrest_length = 0\ndamping = 0\n",
        mode));
    EXPECT_EQ(run.at(0.4).energies.hand, 0) << mode;
    const sim::Energies held = run.at(0.6).energies, later = run.at(1.2).energies;
    EXPECT_GT(held.hand, 1) << mode;
    EXPECT_GT(held.springs, 1) << mode;
    EXPECT_GT(std::abs(later.hand - held.hand), 0.1) << mode;
    EXPECT_NEAR(held.total() + held.hand, later.total() + later.hand, 1e-7) << mode;
    const sim::Energies before = run.at(1.249999).energies, after = run.at(1.250001).energies;
    EXPECT_GT(before.hand, 0.1) << mode;
    EXPECT_EQ(after.hand, 0) << mode;
    EXPECT_NEAR(before.total(), after.total(), 1e-3) << mode;
    EXPECT_NEAR(run.at(2.5).energies.total(), after.total(), 1e-7) << mode;
  }
}

}  // namespace
}  // namespace obscura::scene

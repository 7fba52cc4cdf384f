// What an event changes beside bodies and joints that it holds together: springs that are let go, joined or
// set, the mass of a body, gears and pulleys that engage.

#include <algorithm>

#include "scene/text_run.h"

namespace obscura::scene {
namespace {

constexpr double kSemicircle = 3.14159265358979323846;

const std::string kPins =
    "[[joint]]\nname = \"p\"\ntype = \"{0}\"\nbetween = [\"a\", \"room\"]\n"
    "[[joint]]\nname = \"q\"\ntype = \"{0}\"\nbetween = [\"b\", \"room\"]\n";

// Two that a spring drives apart until it is relaxed, where it is let go: p^2 (1/m + 1/n) = k d^2. What it
// had left is booked as work.
TEST(Changing, ASpringIsLetGo) {
  for (const Manner& manner : kManners) {
    for (const int dimension : {2, 3}) {
      const std::string third = dimension == 3 ? ", 0" : "";
      const TextRun run(
          empty_room(manner, dimension) + "rate = 600\n" +
          disc("a", 1, 0.1, "position = [0, 0" + third + "]") +
          disc("b", 3, 0.1, "position = [0.5, 0" + third + "]") +
          "[[spring]]\nname = \"band\"\nbetween = [\"a\", \"b\"]\nstiffness = 100\nrest_length = 1\n"
          "[[when]]\nvalue = \"b.x - a.x > 1\"\ndo = [{ release = \"band\" }]\n");
      const std::size_t a = number_of(run, "a"), b = number_of(run, "b");
      const sim::Snapshot now = run.at(2);
      const double p = std::sqrt(18.75), tolerance = manner.name == "event" ? 1e-7 : 1e-3;
      EXPECT_NEAR(now.bodies[a].velocity.x(), -p, tolerance) << manner.name << dimension;
      EXPECT_NEAR(3 * now.bodies[b].velocity.x(), p, tolerance) << manner.name << dimension;
      EXPECT_NEAR(now.bodies[a].velocity.x() + 3 * now.bodies[b].velocity.x(), 0, 1e-12) << manner.name;
      EXPECT_NEAR(now.energies.total() - now.energies.work, 12.5, 1e-8) << manner.name;
      EXPECT_TRUE(now.springs[0].loose);
      EXPECT_EQ(now.springs[0].force.norm(), 0);
    }
  }
}

// One of a list of springs, by its number; the others hold.
TEST(Changing, OneSpringOfSeveral) {
  const TextRun run(plane_without_walls(kManners[1], "gravity = [0, 0]") +
                    "[[particle]]\nname = \"p\"\nmass = 1\nposition = [0, 1]\nvelocity = [1, 0]\n"
                    "copies = { count = 3, offset = [1, 0] }\n"
                    "[[spring]]\nname = \"s\"\nbetween = [\"p[*]\", [0, 0]]\nrest_length = 0\n"
                    "[[when]]\ntime = 1\ndo = [{ release = \"s[1]\" }]\n");
  const sim::Snapshot now = run.at(2);
  EXPECT_FALSE(now.springs[0].loose);
  EXPECT_TRUE(now.springs[1].loose);
  EXPECT_FALSE(now.springs[2].loose);
}

// A spring that an event joins, sets and lets go: x(t) of each piece, with its w^2 = k / m. Times are exact
// in every manner, and in the handout's, too.
TEST(Changing, ASpringIsJoinedAndSet) {
  std::vector<Manner> manners = kManners;
  manners.push_back({"handout", "[physics]\ncollision = \"handout\""});
  for (const Manner& manner : manners) {
    const TextRun run(plane_without_walls(manner, "gravity = [0, 0]") +
                      "[[particle]]\nname = \"p\"\nmass = 2\nposition = [0, 0]\nvelocity = [1, 0]\n"
                      "[[spring]]\nname = \"s\"\nbetween = [\"p\", [0, 0]]\nstiffness = 8\nrest_length = 0\n"
                      "joined = false\n"
                      "[[when]]\ntime = 1\ndo = [{ join = \"s\" }]\n"
                      "[[when]]\ntime = 1.5\ndo = [{ set = \"s.stiffness\", to = 18 }]\n"
                      "[[when]]\ntime = 2\ndo = [{ release = \"s\" }]\n");
    EXPECT_NEAR(run.place(1).x(), 1, 1e-12) << manner.name;
    const double x = std::cos(1.0) + 0.5 * std::sin(1.0), v = std::cos(1.0) - 2 * std::sin(1.0);
    EXPECT_NEAR(run.place(1.5).x(), x, 1e-8) << manner.name;
    const double then = x * std::cos(1.5) + v / 3 * std::sin(1.5),
                 u = v * std::cos(1.5) - 3 * x * std::sin(1.5);
    EXPECT_NEAR(run.place(2).x(), then, 1e-8) << manner.name;
    EXPECT_NEAR(run.place(3).x(), then + u, 1e-8) << manner.name;
  }
}

// A mass that changes keeps its velocity: what comes or goes has it. Its frequency and its weight are those
// of the new mass, and its inertia goes with it.
TEST(Changing, AMassIsSet) {
  for (const Manner& manner : kManners) {
    const TextRun run(plane_without_walls(manner, "gravity = [0, 0]") +
                      disc("b", 1, 0.2, "position = [1, 0]\nspin = 100") +
                      "[[spring]]\nbetween = [\"b\", [0, 0]]\nstiffness = 4\nrest_length = 0\n"
                      "[[when]]\ntime = 1\ndo = [{ set = \"b.mass\", to = 4 }]\n");
    const double x = std::cos(2.0), v = -2 * std::sin(2.0);
    EXPECT_NEAR(run.place(1).x(), x, 1e-8) << manner.name;
    const sim::Snapshot now = run.at(2);
    EXPECT_NEAR(now.bodies[0].position.x(), x * std::cos(1.0) + v * std::sin(1.0), 1e-8) << manner.name;
    EXPECT_NEAR(now.bodies[0].spin.z(), 100 * kSemicircle / 180, 1e-12) << manner.name;
    EXPECT_NEAR(now.angular_momentum.z(), 0.5 * 4 * 0.04 * 100 * kSemicircle / 180, 1e-9) << manner.name;
    EXPECT_EQ(sim::mass(run.run->scene_info(), now, 0), 4);
    EXPECT_NEAR(now.energies.total() - now.energies.work,
                2 + 0.5 * 0.02 * std::pow(100 * kSemicircle / 180, 2), 1e-8);
  }
}

// Newton's attraction goes by the masses: a planet whose sun loses half of its mass at the apex of its circle
// is free.
TEST(Changing, AttractionGoesByTheMassThatIsSet) {
  const TextRun run(plane_without_walls(kManners[1], "gravity = [0, 0]\ngravitation = 1") +
                    "[[particle]]\nname = \"sun\"\nmass = 1000\nposition = [0, 0]\n"
                    "[[particle]]\nname = \"planet\"\nmass = 1e-9\nposition = [10, 0]\nvelocity = [0, 10]\n"
                    "[[when]]\ntime = 1\ndo = [{ set = \"sun.mass\", to = 500 }]\n");
  const std::size_t planet = number_of(run, "planet");
  EXPECT_NEAR(run.place(1, planet).norm(), 10, 1e-8);
  // a parabola of r = p / (1 + cos f), p = 20: Barker's equation, f/2 + tan^3(f/2) / 3 = sqrt(mu / p^3) t
  const double M = 2 * std::sqrt(500 / 8000.0) * 4, B = 1.5 * M, c = std::cbrt(B + std::sqrt(B * B + 1));
  const double D = c - 1 / c;
  EXPECT_NEAR(run.place(5, planet).norm(), 10 * (1 + D * D), 1e-6);
}

// A gear that engages: the wheels share the angular momentum by its ratio, and keep their phase from then on.
TEST(Changing, AGearEngages) {
  for (const Manner& manner : kManners) {
    for (const int dimension : {2, 3}) {
      const std::string third = dimension == 3 ? ", 0" : "";
      const TextRun run(
          empty_room(manner, dimension) +
          disc("a", 1, 0.2,
               "position = [0, 0" + third +
                   "]\nrotation = true\nspin = " + (dimension == 2 ? "360" : "[0, 0, 360]")) +
          disc("b", 2, 0.4, "position = [0.6, 0" + third + "]\nrotation = true") +
          fmt::format(fmt::runtime(kPins), dimension == 2 ? "pin" : "hinge") +
          "[[joint]]\nname = \"g\"\ntype = \"gear\"\njoints = [\"p\", \"q\"]\nratio = -2\njoined = false\n"
          "[[when]]\ntime = 1.3\ndo = [{ join = \"g\" }]\n"
          "[[when]]\ntime = 4\ndo = [{ release = \"g\" }]\n");
      const std::size_t a = number_of(run, "a"), b = number_of(run, "b");
      EXPECT_NEAR(run.at(1.2).bodies[a].spin.z(), 2 * kSemicircle, 1e-9) << manner.name << dimension;
      const sim::Snapshot now = run.at(3);
      EXPECT_NEAR(now.bodies[a].spin.z(), 2 * kSemicircle / 3, 1e-8) << manner.name << dimension;
      EXPECT_NEAR(now.bodies[b].spin.z(), -kSemicircle / 3, 1e-8) << manner.name << dimension;
      if (dimension == 2) {
        EXPECT_NEAR(now.bodies[a].angle + 2 * now.bodies[b].angle, 2 * kSemicircle * 1.3, 1e-6)
            << manner.name;
      }
      EXPECT_NEAR(run.at(6).bodies[a].spin.z(), 2 * kSemicircle / 3, 1e-8) << manner.name << dimension;
    }
  }
}

// A rope that is caught while both of its weights fall: it stops the sum of their ways, and then they go on
// as Atwood's.
TEST(Changing, APulleyEngages) {
  for (const Manner& manner : kManners) {
    for (const bool wheel : {false, true}) {
      const TextRun run(plane_without_walls(manner) + disc("a", 3, 0.1, "position = [-0.3, -5]") +
                        disc("b", 1, 0.1, "position = [0.3, -5]") +
                        disc("w", 2, 0.3, "position = [0, 0]\nrotation = true") +
                        "[[joint]]\ntype = \"pin\"\nbetween = [\"w\", \"room\"]\n"
                        "[[joint]]\nname = \"rope\"\ntype = \"pulley\"\nbetween = [\"a\", \"b\"]\nover = " +
                        (wheel ? "[\"w\"]" : "[[-0.3, 0], [0.3, 0]]") +
                        "\njoined = false\n[[when]]\ntime = 0.4\ndo = [{ join = \"rope\" }]\n");
      const std::size_t a = number_of(run, "a"), b = number_of(run, "b");
      const double v = 0.4 * 9.81, whole = 4 + (wheel ? 0.5 * 2 : 0), u = v * (3 - 1) / whole;
      const double falls = 9.81 * 2 / whole;
      const sim::Snapshot now = run.at(0.9);
      EXPECT_NEAR(now.bodies[a].velocity.y(), -u - 0.5 * falls, manner.name == "iterative" ? 1e-6 : 1e-9)
          << manner.name << wheel;
      EXPECT_NEAR(now.bodies[b].velocity.y(), u + 0.5 * falls, manner.name == "iterative" ? 1e-6 : 1e-9)
          << manner.name << wheel;
    }
  }
}

// A kick gives a velocity or a spin at once; what holds a body answers in the same instant. Its work is
// booked.
TEST(Changing, AKickGivesAVelocity) {
  for (const Manner& manner : kManners) {
    const TextRun run(
        plane_without_walls(manner, "gravity = [0, 0]") +
        disc("a", 2, 0.2, "position = [0, 0]\nvelocity = [1, 0]") + disc("b", 3, 0.2, "position = [0, 2]") +
        "[[joint]]\ntype = \"rod\"\nbetween = [\"b\", [0, 4]]\n"
        "[[when]]\ntime = 1\ndo = [{ set = \"a.velocity\", to = [0, 3] }, { set = \"a.spin\", to = 90 "
        "}, { set = \"b.velocity\", to = [1, 5] }]\n");
    EXPECT_NEAR(run.at(0.9).bodies[0].velocity.x(), 1, 1e-12) << manner.name;
    const sim::Snapshot now = run.at(1.5);
    EXPECT_NEAR((now.bodies[0].velocity - sim::Vec3(0, 3, 0)).norm(), 0, 1e-12) << manner.name;
    EXPECT_NEAR((now.bodies[0].position - sim::Vec3(1, 1.5, 0)).norm(), 0, 1e-9) << manner.name;
    EXPECT_NEAR(now.bodies[0].spin.z(), std::acos(0.0), 1e-12) << manner.name;
    EXPECT_NEAR(now.bodies[1].velocity.norm(), 1, 1e-8) << manner.name;  // along the rod nothing is left
    EXPECT_NEAR((now.bodies[1].position - sim::Vec3(2 * std::sin(0.25), 4 - 2 * std::cos(0.25), 0)).norm(), 0,
                1e-7)
        << manner.name;
    const double spins = 0.5 * 0.5 * 2 * 0.04 * std::pow(std::acos(0.0), 2);
    EXPECT_NEAR(now.energies.total(), 9 + spins + 1.5, 1e-7) << manner.name;
  }
  for (const std::string actions :
       {"{ release = \"c\" }, { set = \"c.velocity\", to = [1, 0] }",
        "{ set = \"c.velocity\", to = [1, 0] }, { set = \"c.fixed\", to = false }"}) {
    const TextRun let_go(plane_without_walls(kManners[0], "gravity = [0, 0]") +
                         disc("c", 2, 0.2, "position = [0, 0]\nfixed = true") + "[[when]]\ntime = 1\ndo = [" +
                         actions + "]\n");
    EXPECT_NEAR(let_go.place(2).x(), 1, 1e-9) << actions;
  }
  // a bar on a hinge takes what its hinge lets it: 3/4 of the energy of its middle at 3 m/s
  const TextRun bar(
      plane_without_walls(kManners[0], "gravity = [0, 0]") +
      "[[box]]\nname = \"c\"\nsize = [1, 0.1]\nmass = 2\nposition = [0.5, 0]\n[[joint]]\ntype = "
      "\"pin\"\nbetween = [\"c\", \"room\"]\nat = [0, 0]\n"
      "[[when]]\ntime = 1\ndo = [{ set = \"c.velocity\", to = [0, 3] }]\n");
  const sim::Snapshot after_kick = bar.at(2);
  EXPECT_NEAR(after_kick.energies.work, after_kick.energies.kinetic, 1e-9);
  EXPECT_NEAR(after_kick.bodies[0].spin.z(), 2 * 3 * 0.5 / (2 * (1 + 0.01) / 12 + 2 * 0.25), 1e-9);
  const TextRun space(space_without_walls(kManners[1], "gravity = [0, 0, 0]") +
                      "[[box]]\nname = \"c\"\nsize = [1, 2, 3]\nposition = [0, 0, 0]\nspin = [10, 20, 30]\n"
                      "[[when]]\ntime = 1\ndo = [{ set = \"c.spin\", to = [0, 0, 180] }]\n");
  const sim::Vec3 before = space.at(0.5).angular_momentum, after = space.at(1).angular_momentum;
  EXPECT_GT((before - after).norm(), 1e-3);
  EXPECT_NEAR((space.at(1).bodies[0].spin - sim::Vec3(0, 0, std::acos(-1.0))).norm(), 0, 1e-11);
  EXPECT_NEAR((space.at(4).angular_momentum - after).norm(), 0, 1e-9);
}

// Charge and drag are those of the event from then on; a clutch grips by its friction.
TEST(Changing, ChargeDragAndTheFrictionOfAJointAreSet) {
  for (const Manner& manner : kManners) {
    const TextRun charge(plane_without_walls(manner, "gravity = [0, 0]\nelectric = [2, 0]") +
                         disc("a", 1, 0.2, "position = [0, 0]\ncharge = 1") +
                         "[[when]]\ntime = 1\ndo = [{ set = \"a.charge\", to = -1 }]\n");
    EXPECT_NEAR(charge.at(1.5).bodies[0].velocity.x(), 2 - 1, 1e-9) << manner.name;
    // one that has none at the start, in a field and in the wind
    const TextRun none(plane_without_walls(manner, "gravity = [0, 0]\nelectric = [2, 0]") +
                       disc("a", 1, 0.2, "position = [0, 0]") +
                       "[[when]]\ntime = 1\ndo = [{ set = \"a.charge\", to = 3 }]\n");
    EXPECT_NEAR(none.at(2).bodies[0].velocity.x(), 6, 1e-9) << manner.name;
    for (const std::string key : {"drag", "quadratic_drag"}) {
      const TextRun wind(plane_without_walls(manner, "gravity = [0, 0]\nwind = [1, 0]") +
                         disc("a", 2, 0.2, "position = [0, 0]\nvelocity = [1, 0]") +
                         disc("b", 2, 0.2, "position = [0, 5]") + "[[when]]\ntime = 1\ndo = [{ set = \"a." +
                         key + "\", to = 3 }, { set = \"b." + key + "\", to = 2 }]\n");
      const sim::Snapshot now = wind.at(2);
      EXPECT_NEAR(now.bodies[0].velocity.x(), 1, 1e-9) << manner.name << key;
      EXPECT_NEAR(now.bodies[1].velocity.x(), key == "drag" ? 1 - std::exp(-1.0) : 0.5, 1e-7)
          << manner.name << key;
    }
    const TextRun drag(plane_without_walls(manner, "gravity = [0, 0]") +
                       disc("a", 2, 0.2, "position = [0, 0]\nvelocity = [1, 0]") +
                       "[[when]]\ntime = 1\ndo = [{ set = \"a.drag\", to = 3 }]\n");
    EXPECT_NEAR(drag.at(2).bodies[0].velocity.x(), std::exp(-1.5), 1e-8) << manner.name;
    const TextRun clutch(plane_without_walls(manner, "gravity = [0, 0]") +
                         disc("a", 1, 0.4, "position = [0, 0]\nspin = 1080") +
                         "[[joint]]\nname = \"brake\"\ntype = \"pin\"\nbetween = [\"a\", \"room\"]\n"
                         "[[when]]\ntime = 1\ndo = [{ set = \"brake.friction\", to = 0.4 }]\n");
    EXPECT_NEAR(clutch.at(2).bodies[0].spin.z(), 6 * kSemicircle - 0.4 / 0.08, 1e-7) << manner.name;
  }
}

// A kick may be a formula of what was just before: two bodies exchange their velocities, one turns back.
TEST(Changing, AKickReadsWhatWasBefore) {
  for (const Manner& manner : kManners) {
    for (const int dimension : {2, 3}) {
      const std::string z = dimension == 3 ? ", 0" : "", more = dimension == 3 ? ", \"0\"" : "";
      const TextRun run(empty_room(manner, dimension) +
                        disc("a", 2, 0.2, "position = [0, 0" + z + "]\nvelocity = [1, 0.5" + z + "]") +
                        disc("b", 1, 0.2, "position = [0, -3" + z + "]\nvelocity = [0.2, 0" + z + "]") +
                        "[[when]]\ntime = 1\ndo = [{ set = \"a.velocity\", to = [\"1.2*a.vx\", \"-a.vy\"" +
                        more +
                        "] }]\n[[when]]\ntime = 2\ndo = [{ set = \"a.velocity\", to = [\"b.vx\", \"b.vy\"" +
                        more + "] }, { set = \"b.velocity\", to = [\"a.vx\", \"a.vy\"" + more + "] }]\n");
      const sim::Snapshot kicked = run.at(1.5);
      EXPECT_NEAR(kicked.bodies[0].velocity.x(), 1.2, 1e-12) << manner.name << dimension;
      EXPECT_NEAR(kicked.bodies[0].velocity.y(), -0.5, 1e-12) << manner.name << dimension;
      EXPECT_NEAR(kicked.energies.work, 1.2 * 1.2 - 1, 1e-9) << manner.name << dimension;
      const sim::Snapshot exchanged = run.at(2.5);
      EXPECT_NEAR(exchanged.bodies[0].velocity.x(), 0.2, 1e-12) << manner.name << dimension;
      EXPECT_NEAR(exchanged.bodies[1].velocity.x(), 1.2, 1e-12) << manner.name << dimension;
      EXPECT_NEAR(exchanged.bodies[1].velocity.y(), -0.5, 1e-12) << manner.name << dimension;
    }
    const TextRun back(empty_room(manner, 2) + disc("a", 2, 0.2, "position = [0, 0]\nspin = 90") +
                       "[[when]]\ntime = 1\ndo = [{ set = \"a.spin\", to = \"-2*a.spin/deg\" }]\n");
    EXPECT_NEAR(back.at(1.5).bodies[0].spin.z(), -kSemicircle, 1e-12) << manner.name;
  }
}

// A belt that starts by an event: what lies on it comes to its speed by friction, and sticks.
TEST(Changing, ABeltStartsAndStops) {
  for (const Manner& manner : kManners) {
    for (const int dimension : {2, 3}) {
      const bool space = dimension == 3;
      const std::string z = space ? ", 0" : "", depth = space ? ", 1" : "";
      const std::string speed = space ? "[{}, 0, 0]" : "{}";
      const auto belt = [&](double v) { return fmt::format(fmt::runtime(speed), v); };
      const TextRun run(
          (space ? space_without_walls(manner) : plane_without_walls(manner)) +
          "[[box]]\nname = \"belt\"\nsize = [12, 0.5" + depth + "]\nposition = [0, -0.25" + z +
          "]\nfixed = true\nsurface_speed = " + belt(0) +
          "\nfriction = 0.2\n[[box]]\nname = \"block\"\nsize = [0.4, 0.4" + (space ? ", 0.4" : "") +
          "]\nmass = 2\nposition = [-2, 0.2" + z +
          "]\nfriction = 0.2\n[[when]]\ntime = 1\ndo = [{ set = \"belt.surface_speed\", to = " + belt(1) +
          " }]\n[[when]]\ntime = 2\ndo = [{ set = \"belt.surface_speed\", to = " + belt(0) + " }]\n");
      const double a = 0.2 * 9.81;
      EXPECT_NEAR(run.at(1.2).bodies[1].velocity.x(), 0.2 * a, 1e-6) << manner.name << dimension;
      const sim::Snapshot carried = run.at(1.9);
      EXPECT_NEAR(carried.bodies[1].velocity.x(), 1, 1e-6) << manner.name << dimension;
      EXPECT_NEAR(carried.energies.work, 2.0, 2e-3) << manner.name << dimension;  // twice what it has: m v^2
      EXPECT_NEAR(run.at(2.2).bodies[1].velocity.x(), 1 - 0.2 * a, 1e-6) << manner.name << dimension;
      EXPECT_NEAR(run.at(3).bodies[1].velocity.x(), 0, 1e-6) << manner.name << dimension;
    }
  }
}

TEST(Changing, WhatCannotBeChangedIsRefused) {
  const std::string room = plane_without_walls(kManners[0]) + disc("a", 1, 0.3, "position = [-2, 0.25]") +
                           disc("c", 1, 0.3, "position = [2, 0]\nfixed = true") +
                           "[[spring]]\nname = \"band\"\nbetween = [\"a\", \"c\"]\n";
  const auto when = [&](const std::string& more) {
    return refusal(room + "[[when]]\ntime = 1\ndo = [{ " + more + " }]\n");
  };
  const auto expect = [](const std::string& text, const std::string& part) {
    EXPECT_NE(text.find(part), std::string::npos) << text;
  };
  expect(when("set = \"c.mass\", to = 2"), "'c' is fixed, and its mass stays");
  expect(when("set = \"a.mass\", to = -2"), "mass");
  expect(when("set = \"a.velocity\", to = 2"), "'a.velocity': expected [x, y]");
  expect(when("set = \"a.spin\", to = [1, 2]"), "'a.spin': expected degrees a second, or an expression");
  expect(when("set = \"a.velocity\", to = [\"a.vy\", \"1 + d.vx\"]"),
         "'to', column 5: nothing is called 'd.vx' here");
  expect(when("set = \"band.stiffness\", to = -2"), "stiffness");
  expect(when("set = \"a.radius\", to = 2"), "SPRING.stiffness");
  expect(when("release = \"bend\""), "no body, joint or spring is called 'bend'; did you mean 'band'?");
  expect(refusal(room + "joined = false\n"), "needs 'rest_length'");
  expect(refusal(room + "joined = false\nrest_length = 1\n"), "no event joins this spring");
  EXPECT_EQ(when("release = \"band\""), "");
  // a joint that is wrong is told once, and what is wrong elsewhere, too
  const std::string wrong =
      refusal(room +
              "[[joint]]\nname = \"hook\"\ntype = \"rod\"\nbetween = [\"a\", \"room\"]\n"
              "[[when]]\ntime = 1\ndo = [{ release = \"hook\" }]\n"
              "[[when]]\nvalue = \"hook.force > 1\"\ndo = [{ set = \"band.stiffness\", to = 1 }]\n"
              "[[when]]\ntime = 1\ndo = [{ release = \"bend\" }]\n");
  expect(wrong, "where in the room? A rod needs a place");
  expect(wrong, "no body, joint or spring is called 'bend'");
  EXPECT_EQ(std::count(wrong.begin(), wrong.end(), '\n'), 1) << wrong;
}

// A box that is let go is held by the floor, and rubbed by it, from then on: many bodies in the plane looked
// for its contacts a sixtieth of a second later, and it fell into the floor. Another pushes it: a = (F - mu
// (m + m') g) / (m + m').
TEST(Changing, WhatIsLetGoLiesOnTheFloorAtOnce) {
  for (const bool space : {false, true}) {
    for (const int rate : {60, 240}) {
      const auto box = [&](const char* name, double x, const char* more) {
        return fmt::format(
            "[[box]]\nname = '{}'\nsize = [0.4, 0.4{}]\nposition = [{}, 0.2{}]\nmass = 1\nfriction = "
            "0.3\nelasticity = 0\n{}",
            name, space ? ", 0.4" : "", x, space ? ", 0" : "", more);
      };
      const TextRun run(
          fmt::format("[room]\nsize = {}\nwalls = 'ground'\n[physics]\nsolver = 'iterative'\nrate = {}\n",
                      space ? "[12, 4, 12]" : "[12, 4]", rate) +
          box("held", 3, "fixed = true\n") + box("pushes", 2.6, "") +
          fmt::format("[[force]]\nof = 'pushes'\ncomponents = [10, 0{}]\n[[when]]\ntime = 0.5\ndo = "
                      "[{{ release = 'held' }}]\n",
                      space ? ", 0" : ""));
      const double a = (10 - 0.3 * 2 * 9.81) / 2;
      for (const double after : {0.005, 0.05}) {
        const sim::Snapshot::Body now = run.at(0.5 + after).bodies[std::size_t(number_of(run, "held"))];
        EXPECT_NEAR(now.velocity.x(), a * after, 1e-3 * a * after) << space << " " << rate << " " << after;
        EXPECT_NEAR(now.position.y(), 0.2, 1e-6) << space << " " << rate << " " << after;
      }
    }
  }
}

}  // namespace
}  // namespace obscura::scene

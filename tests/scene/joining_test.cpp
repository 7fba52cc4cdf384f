// Bodies that an event joins: momentum and angular momentum are those before, and nothing moves between them
// from then on, in every manner, in the plane and in space.

#include "scene/text_run.h"

namespace obscura::scene {
namespace {

constexpr double kPi = 3.14159265358979323846;

const std::string kStick =
    "[[when]]\ntouches = [\"a\", \"b\"]\ndo = [{ stick = true }, { mark = \"hit\" }]\n";

// One that comes from the left meets one at rest off its middle: both move by the momentum, and turn by the
// angular momentum about their common centre, w = J / (I_a + I_b + m d^2), m the reduced mass. By steps it
// is the place in which they are when they stick that counts.
TEST(Joining, WhatSticksKeepsMomentumAndAngularMomentum) {
  for (const Manner& manner : kManners) {
    for (const double e : {0.0, 0.7}) {
      for (const int dimension : {2, 3}) {
        const std::string surface = fmt::format("elasticity = {}\nfriction = 0.3", e);
        const std::string third = dimension == 3 ? ", 0" : "";
        const std::string text =
            empty_room(manner, dimension, surface) + "rate = 600\n" +
            disc("a", 1, 0.3, "position = [-2, 0.25" + third + "]\nvelocity = [3, 0" + third + "]") +
            disc("b", 2, 0.3, "position = [0, 0" + third + "]") + kStick;
        const TextRun run(text);
        const std::size_t a = number_of(run, "a"), b = number_of(run, "b");
        const double part = dimension == 2 ? 0.5 : 0.4, inertia = part * 3 * 0.09;
        for (const double t : {1.0, 2.0, 5.0}) {
          const sim::Snapshot now = run.at(t);
          const sim::Snapshot::Body &one = now.bodies[a], &two = now.bodies[b];
          const std::string where = fmt::format("{} e = {} D = {} t = {}", manner.name, e, dimension, t);
          const sim::Vec3 momentum = one.velocity + 2 * two.velocity;
          EXPECT_NEAR(momentum.x(), 3, 1e-12) << where;
          EXPECT_NEAR(momentum.y(), 0, 1e-12) << where;
          const sim::Vec3 d = one.position - two.position;
          const double reduced = 2.0 / 3, w = -reduced * 0.25 * 3 / (inertia + reduced * d.squaredNorm());
          EXPECT_NEAR(one.spin.z(), w, manner.name == "iterative" ? 1e-6 : 1e-9) << where;
          EXPECT_NEAR(two.spin.z(), one.spin.z(), 1e-9) << where;
          const sim::Vec3 u = one.velocity - two.velocity - one.spin.cross(d);
          EXPECT_NEAR(u.norm(), 0, 1e-8) << where;
          EXPECT_NEAR(d.norm(), 0.6, manner.name == "iterative" ? 1e-5 : 1e-7) << where;
        }
      }
    }
  }
}

// A bullet in a hanging block, without gravity until then: w = m v L / I about the hinge; and it rises until
// that energy is spent.
TEST(Joining, ABallisticPendulumRisesByWhatIsLeft) {
  for (const Manner& manner : kManners) {
    const std::string text =
        plane_without_walls(manner, "gravity = [0, 0]") + "rate = 2000\n" +
        "[[box]]\nname = \"b\"\nsize = [0.2, 2]\nposition = [0, 0]\nmass = 4\n"
        "[[joint]]\ntype = \"pin\"\nbetween = [{ body = \"b\", at = \"top\" }, \"room\"]\n" +
        disc("a", 0.1, 0.05, "position = [-0.5, -0.8]\nvelocity = [40, 0]") +
        "[[when]]\ntouches = [\"a\", \"b\"]\ndo = [{ stick = true }, { set = \"room.gravity\", to = [0, -10] "
        "}]\n";
    const TextRun run(text);
    const std::size_t a = number_of(run, "a"), b = number_of(run, "b");
    const sim::Vec3 hinge(0, 1, 0);
    for (const double t : {0.1, 0.3, 0.6, 2.0}) {
      const sim::Snapshot now = run.at(t);
      const sim::Vec3 arm = now.bodies[a].position - hinge;
      const double whole = 4 * (4 + 0.04) / 12 + 4 + 0.1 * (arm.squaredNorm() + 0.5 * 0.0025);
      const double begun = 0.5 * std::pow(0.1 * 40 * 1.8, 2) / whole;
      const double w = now.bodies[b].spin.z();
      const double rise = 40 * now.bodies[b].position.y() + now.bodies[a].position.y() + 0.8;
      EXPECT_NEAR(0.5 * whole * w * w + rise, begun, 1e-3 * begun) << manner.name << t;
      EXPECT_NEAR(now.bodies[a].spin.z(), w, 1e-8) << manner.name << t;
    }
  }
}

// Particles have no turn: what sticks to a body is carried around, what sticks to a wall stays.
TEST(Joining, ParticlesAndWallsMayBeOne) {
  for (const Manner& manner : kManners) {
    const TextRun run(plane_without_walls(manner, "gravity = [0, 0]") +
                      "[[particle]]\nname = \"a\"\nposition = [-1, 0.2]\nvelocity = [2, 0]\nmass = 1\n" +
                      disc("b", 1, 0.3, "position = [0, 0]") + kStick);
    const sim::Snapshot now = run.at(3);
    const std::size_t a = number_of(run, "a"), b = number_of(run, "b");
    const sim::Vec3 d = now.bodies[a].position - now.bodies[b].position;
    const double w = -0.5 * 2 * 0.2 / (0.5 * 0.09 + 0.5 * d.squaredNorm());
    EXPECT_NEAR(now.bodies[b].spin.z(), w, 1e-6) << manner.name;
    EXPECT_NEAR(d.norm(), 0.3, manner.name == "iterative" ? 1e-5 : 1e-7) << manner.name;

    const TextRun stuck("duration = 9\n[room]\nsize = [4, 4]\nelasticity = 1\n" + manner.keys + "\n" +
                        disc("a", 1, 0.3, "position = [2, 2]\nvelocity = [5, 0]\nspin = 200") +
                        "[[when]]\ntouches = [\"a\", \"right\"]\ndo = [{ stick = true }]\n");
    EXPECT_NEAR(stuck.at(2).bodies[0].position.x(), 3.7, manner.name == "iterative" ? 1e-5 : 1e-7)
        << manner.name;
    const sim::Vec3 early = stuck.place(2);
    EXPECT_NEAR((early - stuck.place(8)).norm(), 0, 1e-7) << manner.name;
    EXPECT_NEAR(stuck.at(8).bodies[0].spin.z(), 0, 1e-9) << manner.name;
  }
}

// A joint that is not there at the start: a rod, a pin with limits counted from then, a hinge in space; each
// keeps what its kind keeps.
TEST(Joining, AJointThatIsMadeHoldsTheEndsAsTheyStand) {
  for (const Manner& manner : kManners) {
    const TextRun rod(plane_without_walls(manner, "gravity = [0, 0]") +
                      disc("a", 1, 0.1, "position = [-1, 0]\nvelocity = [0, 2]") +
                      disc("b", 1, 0.1, "position = [1, 0]\nvelocity = [0, -2]") +
                      "[[joint]]\nname = \"rod\"\ntype = \"rod\"\nbetween = [\"a\", \"b\"]\njoined = false\n"
                      "[[when]]\ntime = 1\ndo = [{ join = \"rod\" }]\n"
                      "[[when]]\ntime = 4\ndo = [{ release = \"rod\" }]\n");
    const double length = std::sqrt(4 + 16.0);  // and across it 2 * 2 / length each
    const sim::Snapshot before = rod.at(0.9);
    EXPECT_NEAR((before.bodies[0].position - before.bodies[1].position).norm(), std::sqrt(4 + 3.6 * 3.6),
                1e-9)
        << manner.name;
    for (const double t : {1.5, 3.0, 3.9}) {
      const sim::Snapshot now = rod.at(t);
      EXPECT_NEAR((now.bodies[0].position - now.bodies[1].position).norm(), length, 1e-6) << manner.name;
      EXPECT_NEAR(now.bodies[0].velocity.norm(), 2 * 2 / length, 1e-6) << manner.name;
    }
    const sim::Snapshot apart = rod.at(6);
    EXPECT_NEAR((apart.bodies[0].position - apart.bodies[1].position).norm(),
                std::hypot(length, 2 * 2 * 4 / length), 1e-6)
        << manner.name;

    const TextRun pin(
        plane_without_walls(manner, "gravity = [0, 0]") +
        "[[box]]\nname = \"a\"\nsize = [1, 0.2]\nposition = [-3, 0]\nvelocity = [2, 0]\nmass = 1\n"
        "[[joint]]\nname = \"hook\"\ntype = \"pin\"\nbetween = [{ body = \"a\", local = [0, 0.4] }, "
        "\"room\"]\njoined = false\n"
        "[[when]]\nvalue = \"a.x > 0\"\ndo = [{ join = \"hook\" }]\n");
    const sim::Snapshot now = pin.at(2.5);
    // m v h = (I + m h^2) w
    EXPECT_NEAR(now.bodies[0].spin.z(), 2 * 0.4 / ((1 + 0.04) / 12 + 0.16), 1e-6) << manner.name;
  }
}

TEST(Joining, ARunThatGoesOnIsTheWholeRun) {
  for (const Manner& manner : kManners) {
    const std::string text = plane_without_walls(manner, "gravity = [0, -9]") +
                             disc("a", 1, 0.3, "position = [-2, 0.25]\nvelocity = [3, 0]") +
                             disc("b", 2, 0.3, "position = [0, 0]") + kStick;
    const TextRun whole(text);
    const std::size_t b = number_of(whole, "b");
    const sim::Vec3 at = whole.place(2, b);
    for (const double cut : {0.2, 1.0, 1.7}) {
      const TextRun begun(text);
      begun.at(cut);
      const auto rest = parse(text, "a.toml", {}).run(begun.run->saved());
      ASSERT_TRUE(rest);
      const auto end = rest->at(sim::rational(2));
      ASSERT_TRUE(std::holds_alternative<sim::Snapshot>(end));
      EXPECT_EQ(std::get<sim::Snapshot>(end).bodies[b].position, at) << manner.name << cut;
      EXPECT_EQ(rest->words(), whole.run->words()) << manner.name << cut;
    }
  }
}

// What a mark of it tells is after the impact of the joint, not after a bounce that never comes; so are the
// instants from there to the end of the step. Momentum and energy: u = (m u + M U) / (m + M).
TEST(Joining, FromItsInstantOnBothMoveAsOne) {
  for (const Manner& manner : kManners) {
    for (const int rate : {60, 600}) {
      const TextRun run(plane_without_walls(manner, "gravity = [0, 0]\nelasticity = 1") +
                        fmt::format("rate = {}\n", rate) +
                        disc("a", 1, 0.3, "position = [-0.999, 0]\nvelocity = [2, 0]") +
                        disc("b", 3, 0.3, "position = [0, 0]\nvelocity = [-0.5, 0]") + kStick);
      const double hit = 0.399 / 2.5;
      const sim::Snapshot before = run.at(to_a_microsecond(hit - 2e-6));
      EXPECT_EQ(before.bodies[0].velocity.x(), 2) << manner.name;
      for (const double later : {2e-6, 1e-4, 1e-3, 0.01, 0.2}) {
        const sim::Snapshot now = run.at(to_a_microsecond(hit + later));
        for (const sim::Snapshot::Body& body : now.bodies)
          EXPECT_NEAR(body.velocity.x(), 0.125, 1e-9) << manner.name << rate << later;
        EXPECT_NEAR((now.bodies[1].position - now.bodies[0].position).norm(), 0.6, 1e-5) << manner.name;
      }
      const auto all = sim::events_until(*run.run, sim::rational(1));
      ASSERT_EQ(all.size(), 1u) << manner.name;
      EXPECT_NEAR(sim::value(all[0].time), hit, manner.name == "event" ? 1e-9 : 1e-7);
      // at the instant that a mark means
      const auto again = parse(run.text, "a.toml", {}).run();
      const auto marked = again->at(all[0].time);
      ASSERT_TRUE(std::holds_alternative<sim::Snapshot>(marked));
      for (const sim::Snapshot::Body& body : std::get<sim::Snapshot>(marked).bodies)
        EXPECT_NEAR(body.velocity.x(), 0.125, 1e-9) << manner.name << rate;
    }
  }
}

// A rod made as two rough balls come to touch strikes them alone: friction turns neither, what they had along
// it is one, what they had across it stays.
TEST(Joining, WhatATouchMakesStrikesAlone) {
  for (const Manner& manner : kManners) {
    for (const double s : {1.0, -1.0}) {
      for (const bool space : {false, true}) {
        const std::string z = space ? ", 0" : "", w = space ? "[0, 0, 90]" : "90";
        const auto ball = [&](char name, double mass, double x, double y, double v) {
          return fmt::format(
              "[[ball]]\nname = \"{}\"\nradius = 0.4\nmass = {}\nposition = [{}, {}{}]\n"
              "velocity = [{}, 0{}]\nspin = {}\nfriction = 0.3\nelasticity = 0.8\n",
              name, mass, x, y, z, v, z, w);
        };
        for (const int rate : {60, 600}) {
          const TextRun run((space ? space_without_walls(manner, "gravity = [0, 0, 0]")
                                   : plane_without_walls(manner, "gravity = [0, 0]")) +
                            fmt::format("rate = {}\n", rate) + ball('a', 2, -s, 0, s) +
                            ball('b', 1, s, 0.5, -s) +
                            "[[joint]]\nname = \"rod\"\ntype = \"rod\"\nbetween = [\"a\", \"b\"]\njoined = "
                            "false\n[[when]]\ntouches = [\"a\", \"b\"]\ndo = [{ join = \"rod\" }]\n");
          const sim::Snapshot now = run.at(1.5);
          const double across = 2 * 0.5 / 0.8;  // m/s of b against a
          for (const sim::Snapshot::Body& body : now.bodies)
            EXPECT_NEAR(body.spin.z(), kPi / 2, 1e-9) << manner.name << space << rate;
          EXPECT_NEAR((now.bodies[0].velocity - now.bodies[1].velocity).norm(), across, 2e-5)
              << manner.name << space << rate;
          EXPECT_NEAR((2 * now.bodies[0].velocity + now.bodies[1].velocity - sim::Vec3(s, 0, 0)).norm(), 0,
                      1e-9);
          EXPECT_NEAR((now.bodies[0].position - now.bodies[1].position).norm(), 0.8,
                      manner.name == "iterative" ? 1e-5 : 1e-6)
              << manner.name << rate;
        }
      }
    }
  }
}

// Whatever else waits for the touch of two that are joined by it is told of it, in the order of the file; and
// they may be let go, come back and be joined again.
TEST(Joining, OtherConditionsOfTheTouchAreTold) {
  const std::string joins = "[[when]]\ntouches = [\"a\", \"b\"]\nagain = true\ndo = [{ stick = true }]\n";
  const std::string marks = "[[when]]\ntouches = [\"a\", \"b\"]\nagain = true\ndo = [{ mark = \"met\" }]\n";
  for (const Manner& manner : kManners) {
    for (const bool first : {true, false}) {
      const TextRun run(
          plane_without_walls(manner, "gravity = [0, 0]") +
          disc("a", 1, 0.3, "position = [-1.5, 0]\nvelocity = [1, 0]") +
          disc("b", 1, 0.3, "position = [1.5, 0]\nvelocity = [-1, 0]") +
          (first ? joins + marks : marks + joins) +
          "[[when]]\ntime = 2\ndo = [{ release = \"a+b\" }]\n[[force]]\nof = \"b\"\ncomponents = "
          "[\"if(t < 2, 0, if(t < 2.5, 4, if(t < 3.5, -4, 0)))\", \"0\"]\n");
      for (const double t : {1.1999, 1.20001, 1.3, 3.7503}) run.at(t);  // frames change nothing
      const sim::Snapshot now = run.at(5);
      const auto all = sim::events_until(*run.run, sim::rational(5));
      std::vector<int> order;
      for (const sim::RunEvent& event : all) order.push_back(event.when);
      EXPECT_EQ(order, (std::vector<int>{0, 1, 2, 0, 1})) << manner.name << first;
      ASSERT_EQ(all.size(), 5u);
      EXPECT_NEAR(sim::value(all[1].time), 1.2, manner.name == "event" ? 1e-9 : 1e-7) << manner.name;
      EXPECT_NEAR(sim::value(all[4].time), 3.75, manner.name == "event" ? 1e-9 : 1e-4) << manner.name;
      EXPECT_NEAR((now.bodies[0].position - now.bodies[1].position).norm(), 0.6, 1e-5) << manner.name;
    }
  }
}

// Off the middle of a ball in space, at every rate: momentum, and spin by the angular momentum.
TEST(Joining, InSpaceABulletTurnsABallAsItShould) {
  for (const Manner& manner : kManners) {
    for (const int rate : {60, 300, 1200}) {
      const TextRun run(space_without_walls(manner, "gravity = [0, 0, 0]") +
                        fmt::format("rate = {}\n", rate) + disc("d", 2, 0.5, "position = [0, 0, 0]") +
                        disc("p", 0.1, 0.02, "position = [-2, 0.45, 0]\nvelocity = [20, 0, 0]") +
                        "[[when]]\ntouches = [\"p\", \"d\"]\ndo = [{ stick = true }]\n");
      const sim::Snapshot now = run.at(1);
      const double inertia = 0.4 * (2 * 0.25 + 0.1 * 0.0004) + 2 * 0.1 / 2.1 * 0.52 * 0.52;
      const double w = -0.45 * 20 * 2 * 0.1 / 2.1 / inertia;
      EXPECT_NEAR(now.bodies[0].spin.z(), w, 1e-5) << manner.name << rate;
      EXPECT_NEAR((2 * now.bodies[0].velocity + 0.1 * now.bodies[1].velocity - sim::Vec3(2, 0, 0)).norm(), 0,
                  1e-9);
      EXPECT_NEAR(now.energies.kinetic, 0.5 * 4 / 2.1 + 0.5 * inertia * w * w, 1e-4) << manner.name << rate;
    }
  }
}

// Bodies that do not turn move on side by side.
TEST(Joining, WhatDoesNotTurnIsHeldBesideTheOther) {
  for (const Manner& manner : kManners) {
    const TextRun run(
        plane_without_walls(manner, "gravity = [0, 0]") +
        "[[box]]\nname = \"b\"\nsize = [0.2, 0.4]\nposition = [0, 0]\nmass = 2\nrotation = false\n" +
        disc("a", 1, 0.01, "position = [-2, 0.1]\nvelocity = [4, 0]\nrotation = false") + kStick);
    const sim::Snapshot now = run.at(4);
    for (const sim::Snapshot::Body& body : now.bodies)
      EXPECT_NEAR((body.velocity - sim::Vec3(4 / 3.0, 0, 0)).norm(), 0, 1e-9) << manner.name;
    EXPECT_NEAR((now.bodies[0].position - now.bodies[1].position).y(), number_of(run, "a") == 0 ? 0.1 : -0.1,
                1e-9);
  }
}

// Several in a heap: each two stick once.
TEST(Joining, EachPairSticksOnce) {
  for (const Manner& manner : kManners) {
    const TextRun run("duration = 3\n[room]\nsize = [20, 6]\nwalls = \"ground\"\n" + manner.keys +
                      "\n[[box]]\nname = \"cart\"\nsize = [3, 0.2]\nmass = 2\nfriction = 0\nposition = [3, "
                      "0.1]\nvelocity = [3, 0]\n"
                      "[[box]]\nname = \"gr\"\nsize = [0.1, 0.1]\nmass = 0.5\nelasticity = 0.3\nposition = "
                      "[4, 1]\ncopies = "
                      "{ count = 4, offset = [0.35, 0.5] }\n[[when]]\ntouches = [\"gr[*]\", \"cart\"]\nagain "
                      "= true\ndo = [{ stick "
                      "= true }]\n");
    run.at(1.5);
    std::vector<std::string> names;
    for (const sim::RunEvent& event : sim::events_until(*run.run, sim::rational(3, 2)))
      names.push_back(event.of[1]);
    EXPECT_EQ(names, (std::vector<std::string>{"gr[0]", "gr[1]", "gr[2]", "gr[3]"})) << manner.name;
  }
}

// A rod that breaks has given both of its bodies what it bore until then: under a force of 3 t on one of two
// of a kilogram it bears 1.5 t, and breaks at 4 N.
TEST(Breaking, LosesNoMomentum) {
  for (const Manner& manner : kManners) {
    for (const int rate : {60, 600}) {
      for (const char* kind : {"rod", "rope", "pin", "weld", "slider"}) {
        const bool apart = std::string(kind) == "rod" || std::string(kind) == "rope";
        const TextRun run(
            plane_without_walls(manner, "gravity = [0, 0]") + fmt::format("rate = {}\n", rate) +
            "[[box]]\nname = \"w\"\nsize = [0.6, 0.4]\nmass = 1\nposition = [0, 0]\ncopies = { count = 2, "
            "offset = [1, 0] }\n" +
            fmt::format("[[joint]]\ntype = \"{}\"\nbetween = [\"w[1]\", \"w[0]\"]\nbreaks = 4\n{}\n", kind,
                        apart                           ? ""
                        : kind == std::string("slider") ? "axis = [0, 1]"
                                                        : "at = [0.5, 0]") +
            "[[force]]\nof = \"w[1]\"\ncomponents = [\"3*t\", \"0\"]\n");
        const sim::Snapshot now = run.at(4);
        EXPECT_NEAR(now.bodies[0].velocity.x() + now.bodies[1].velocity.x(), 24, 1e-8)
            << manner.name << kind << rate;
        EXPECT_NEAR(now.bodies[0].velocity.x(), 16 / 3.0, manner.name == "event" ? 1e-8 : 5.0 / rate)
            << manner.name << kind << rate;
      }
    }
  }
}

// One that breaks as soon as it is made has broken; what a moved body gives to what it catches is work.
TEST(Joining, WhatIsMadeMayBreakAndBeGivenWork) {
  for (const Manner& manner : kManners) {
    const TextRun breaks(
        plane_without_walls(manner, "gravity = [0, -9.81]") + disc("bob", 1, 0.1, "position = [0, 0]") +
        "[[joint]]\nname = \"w\"\ntype = \"weld\"\nbetween = [\"bob\", \"room\"]\njoined = false\n"
        "breaks = 5\n[[when]]\ntime = 0.25\ndo = [{ join = \"w\" }]\n[[when]]\nbreaks = \"w\"\ndo = "
        "[{ mark = \"broke\" }]\n");
    breaks.at(1);
    const auto events = breaks.run->events();
    ASSERT_EQ(events.size(), 2u) << manner.name;
    EXPECT_NEAR(sim::value(events[1].time), 0.25, manner.name == "event" ? 1e-9 : 0.004) << manner.name;

    const TextRun caught(
        plane_without_walls(manner, "gravity = [0, 0]") +
        "[[box]]\nname = \"plate\"\nsize = [2, 0.2]\nposition = [-2, 0]\nmotion = { x = \"2*t\" }\n" +
        disc("a", 2, 0.2, "position = [-1, 2]") +
        "[[when]]\ntime = 0.5\ndo = [{ join = [\"a\", \"plate\"] }]\n");
    const sim::Snapshot now = caught.at(0.7);
    EXPECT_NEAR(now.bodies[number_of(caught, "a")].velocity.x(), 2, 1e-9) << manner.name;
    EXPECT_NEAR(now.energies.work, 2 * 2 * 2, 1e-6) << manner.name;
  }
}

TEST(Joining, WhatCannotBeJoinedIsRefused) {
  const std::string room = plane_without_walls(kManners[0]) + disc("a", 1, 0.3, "position = [-2, 0.25]") +
                           disc("b", 1, 0.3, "position = [0, 0]\nfixed = true") +
                           disc("c", 1, 0.3, "position = [2, 0]\nfixed = true");
  const auto when = [&](const std::string& more, const std::string& condition = "time = 1") {
    return refusal(room + "[[when]]\n" + condition + "\ndo = [{ " + more + " }]\n");
  };
  const auto expect = [](const std::string& text, const std::string& part) {
    EXPECT_NE(text.find(part), std::string::npos) << text;
  };
  expect(when("stick = true"), "'stick' holds together what 'touches'");
  expect(when("join = \"hook\""), "no joint or bond is called 'hook'");
  expect(when("join = [\"b\", \"c\"]"), "neither 'b' nor 'c' moves");
  expect(when("join = [\"a\", \"a\"]"), "both are 'a'");
  expect(when("join = [\"a\"]"), "expected two names");
  expect(when("join = [\"a\", \"floor\"]"), "floor");
  const std::string rod = "[[joint]]\nname = \"r\"\ntype = \"rod\"\nbetween = [\"a\", \"b\"]\n";
  expect(refusal(room + rod + "joined = false\n"), "no event makes this joint");
  expect(refusal(room + rod + "[[when]]\ntime = 1\ndo = [{ join = \"r\" }]\n"), "holds from the start");
  EXPECT_EQ(when("join = [\"a\", \"room\"]"), "");
}

// What a joint held apart touches once the joint is gone, let go or broken; what overlapped, when it has been
// apart.
TEST(Joining, WhatAJointHeldTouchesWhenItIsGone) {
  for (const Manner& manner : kManners) {
    for (const bool space : {false, true}) {
      for (const bool breaks : {false, true}) {
        const std::string z = space ? ", 0" : "", w = space ? ", 0.4" : "";
        const auto box = [&](const char* name, double y) {
          return fmt::format(
              "[[box]]\nname = \"{}\"\nsize = [0.4, 0.4{}]\nmass = 1\nelasticity = 0\nposition = [0, {}{}]\n",
              name, w, y, z);
        };
        const std::string room = fmt::format("[room]\nsize = [4, 4{}]\ncorner = [-2, 0{}]\n{}\n",
                                             space ? ", 4" : "", space ? ", -2" : "", manner.keys) +
                                 box("low", 0.2) + box("high", 1.5);
        const std::string joint =
            fmt::format("[[joint]]\nname = \"latch\"\ntype = \"rod\"\nbetween = [\"high\", \"low\"]\n{}\n",
                        breaks ? "breaks = 5" : "");
        const TextRun run(room + joint +
                          (breaks ? "" : "[[when]]\ntime = 0.2\ndo = [{ release = \"latch\" }]\n"));
        const sim::Snapshot now = run.at(2);
        EXPECT_NEAR(now.bodies[1].position.y(), 0.6, 2e-3) << manner.name << space << breaks;
        EXPECT_TRUE(now.joints[0].broken) << manner.name << space << breaks;
      }
    }
    // two discs pinned together in the middle of one another come apart at once, and meet again
    const TextRun pinned(
        empty_room(manner, 2) + disc("a", 1, 0.3, "position = [0, 0]\nvelocity = [1, 0]") +
        disc("b", 1, 0.3, "position = [0.2, 0]\nvelocity = [1, 0]\nelasticity = 1") +
        "[[joint]]\nname = \"pin\"\ntype = \"slider\"\nbetween = [\"a\", \"b\"]\naxis = [0, 1]\n"
        "[[spring]]\nname = \"s\"\nbetween = [\"a\", \"b\"]\nstiffness = 20\nrest_length = 1\n"
        "[[when]]\ntime = 0.5\ndo = [{ release = \"pin\" }]\n");
    double least = 1e9, most = 0;
    bool apart = false;
    for (int i = 0; i < 60; ++i) {
      const sim::Snapshot now = pinned.at(0.5 + 0.02 * i);
      const double far = (now.bodies[1].position - now.bodies[0].position).norm();
      apart = apart || far > 0.7;
      if (apart) least = std::min(least, far), most = std::max(most, far);
    }
    EXPECT_GT(most, 1) << manner.name;
    EXPECT_GT(least, 0.6 - 2e-3) << manner.name;
  }
}

// Two balls that stick to a slab in the same instant, at either end: it turns about its middle, which stays.
TEST(Joining, TwoThatComeToTouchInOneInstantBothStick) {
  for (const Manner& manner : kManners) {
    for (const int rate : {300, 600, 1000, 1200}) {
      for (const double away : {0.0, 1e-4, 1e-7}) {
        const std::string text =
            empty_room(manner, 2) + "[[box]]\nname = \"m\"\nsize = [0.4, 2]\nmass = 2\nposition = [0, 0]\n" +
            disc("p", 1, 0.1, fmt::format("position = [{}, 0.9]\nvelocity = [2, 0]", -1.3 - away)) +
            disc("q", 1, 0.1, fmt::format("position = [{}, -0.9]\nvelocity = [-2, 0]", 1.3 + away)) +
            "[[when]]\ntouches = [\"m\", \"p\"]\ndo = [{ stick = true }]\n"
            "[[when]]\ntouches = [\"m\", \"q\"]\ndo = [{ stick = true }]\n";
        const TextRun run(text, {fmt::format("physics.rate={}", rate)});
        // L = 2 m v 0.9 over all moments about the middle
        const double I = 2 * (0.16 + 4) / 12 + 2 * (0.5 * 0.01 + 0.81 + 0.09), spin = -2 * 2 * 0.9 / I;
        const sim::Snapshot now = run.at(1);
        for (const sim::Snapshot::Body& body : now.bodies)
          if (body.position.norm() < 0.5) {
            EXPECT_NEAR(body.spin.z(), spin, 1e-6) << manner.name << rate << " " << away;
            EXPECT_LT(body.velocity.norm(), 1e-6) << manner.name << rate << " " << away;
          }
        EXPECT_EQ(run.run->events().size(), 2u) << manner.name << rate << " " << away;
      }
    }
  }
}

}  // namespace
}  // namespace obscura::scene

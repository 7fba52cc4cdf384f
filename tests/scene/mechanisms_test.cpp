// Pulleys and gears against closed forms, in every mode and by every solver.

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <string>
#include <vector>

#include "scene/error.h"
#include "scene/text_run.h"
#include "sim/step/archive.h"
#include "sim/step/stepper.h"

namespace obscura::scene {
namespace {

constexpr double kEarth = 9.81;

const std::string kAtwood =
    "[[ball]]\nname = \"wheel\"\nradius = 0.5\nmass = 3\nposition = [0, 4]\n"
    "[[joint]]\ntype = \"pin\"\nbetween = [\"wheel\", \"room\"]\n"
    "[[particle]]\nname = \"left\"\nmass = 1\nposition = [-0.5, 0]\nradius = 0.1\n"
    "[[particle]]\nname = \"right\"\nmass = 2\nposition = [0.5, 1]\nradius = 0.1\n"
    "[[joint]]\nname = \"rope\"\ntype = \"pulley\"\nbetween = [\"left\", \"right\"]\nover = [\"wheel\"]\n";

// Atwood's machine with a wheel: a = (m2 - m1) g / (m1 + m2 + I / R^2), tensions m1 (g + a) and m2 (g - a).
TEST(Pulley, AtwoodsMachineAcceleratesAsItsMassesAndItsWheelSay) {
  const double a = (2 - 1) * kEarth / (1 + 2 + 1.5);  // a disc: I / R^2 = M / 2
  for (const Manner& manner : kManners) {
    TextRun scene(plane_without_walls(manner) + kAtwood);
    const std::size_t left = number_of(scene, "left"), right = number_of(scene, "right"),
                      wheel = number_of(scene, "wheel");
    const double begun = scene.at(0).energies.total();
    for (const double t : {0.3, 0.8}) {
      const sim::Snapshot now = scene.at(t);
      EXPECT_NEAR(now.bodies[right].velocity.y(), -a * t, 1e-9) << manner.name;
      EXPECT_NEAR(now.bodies[left].velocity.y(), a * t, 1e-9) << manner.name;
      EXPECT_NEAR(now.bodies[wheel].spin.z(), -a * t / 0.5, 1e-9) << manner.name;
      EXPECT_NEAR(now.bodies[right].position.y(), 1 - 0.5 * a * t * t, 1e-9) << manner.name;
      EXPECT_NEAR(now.bodies[right].position.x(), 0.5, 1e-9) << manner.name;
      // pieces of the rope, first of the left
      ASSERT_EQ(now.joints.size(), 3u);
      EXPECT_NEAR((now.joints[1].force - sim::Vec3(0, 1 * (kEarth + a), 0)).norm(), 0, 1e-8) << manner.name;
      EXPECT_NEAR(now.joints[2].force.norm(), 2 * (kEarth - a), 1e-8) << manner.name;
      EXPECT_NEAR(now.energies.total(), begun, 1e-8) << manner.name;
    }
  }
}

// A load M on n pieces of rope that a counterweight m pulls: A = (n m - M) g / (M + n^2 m), one tension
// throughout.
TEST(Pulley, ABlockAndTackleLiftsByAsManyPieces) {
  const double M = 7, m = 2;
  const int n = 4;
  const double A = (n * m - M) * kEarth / (M + n * n * m), tension = m * (kEarth - n * A);
  for (const Manner& manner : kManners) {
    TextRun scene(
        plane_without_walls(manner) +
        "[[box]]\nname = \"load\"\nsize = [1, 0.5]\nmass = 7\nposition = [0, 0]\n"
        "[[particle]]\nname = \"weight\"\nmass = 2\nposition = [2, 3]\nradius = 0.1\n"
        "[[joint]]\nname = \"rope\"\ntype = \"pulley\"\nbetween = [[-0.3, 4], \"weight\"]\n"
        "over = [{ body = \"load\", local = [-0.3, 0] }, { body = \"load\", local = [-0.1, 0] }, [-0.1, 4], "
        "[0.1, 4], { body = \"load\", local = [0.1, 0] }, { body = \"load\", local = [0.3, 0] }, [0.3, 4], "
        "[2, 4]]\n");
    const std::size_t load = number_of(scene, "load"), weight = number_of(scene, "weight");
    const sim::Snapshot now = scene.at(0.7);
    EXPECT_NEAR(now.bodies[load].velocity.y(), A * 0.7, 1e-9) << manner.name;
    EXPECT_NEAR(now.bodies[weight].velocity.y(), -n * A * 0.7, 1e-9) << manner.name;
    EXPECT_NEAR(now.bodies[load].angle, 0, 1e-9) << manner.name;
    EXPECT_NEAR(now.joints[0].force.norm(), tension, 1e-8) << manner.name;
  }
}

// A weight swings on a rope that runs over a point to another, which rises and sinks with it: the rope keeps
// its length, and energy stays.
TEST(Pulley, ASwingingAtwoodMachineKeepsItsRopeAndItsEnergy) {
  for (const Manner& manner : kManners) {
    TextRun scene(plane_without_walls(manner) +
                  "[[particle]]\nname = \"bob\"\nmass = 1\nposition = [1.2, 0.5]\nradius = 0.1\n"
                  "[[particle]]\nname = \"weight\"\nmass = 2\nposition = [-2, 0]\nradius = 0.1\n"
                  "[[joint]]\nname = \"rope\"\ntype = \"pulley\"\nbetween = [\"bob\", \"weight\"]\n"
                  "over = [[0, 2], [-2, 2]]\n");
    const std::size_t bob = number_of(scene, "bob"), weight = number_of(scene, "weight");
    const auto length = [&](const sim::Snapshot& now) {
      return (now.bodies[bob].position - sim::Vec3(0, 2, 0)).norm() + 2 +
             (now.bodies[weight].position - sim::Vec3(-2, 2, 0)).norm();
    };
    const sim::Snapshot begun = scene.at(0);
    for (const double t : {0.5, 1.0, 1.7}) {
      const sim::Snapshot now = scene.at(t);
      EXPECT_NEAR(length(now), length(begun), 1e-8) << manner.name << t;
      EXPECT_NEAR(now.energies.total(), begun.energies.total(), 1e-6) << manner.name << t;
    }
  }
}

// Where the wheel's own turn winds the rope up, its place is that of the angle: a bob that swings beneath a
// wheel's rim wraps around it.
TEST(Pulley, ARopeThatSwingsWindsOntoItsWheel) {
  for (const Manner& manner : kManners) {
    TextRun scene(plane_without_walls(manner) +
                  "[[ball]]\nname = \"wheel\"\nradius = 0.4\nmass = 2\nposition = [0, 3]\n"
                  "[[joint]]\ntype = \"pin\"\nbetween = [\"wheel\", \"room\"]\n"
                  "[[particle]]\nname = \"bob\"\nmass = 1\nposition = [-1.4, 1.5]\nradius = 0.1\n"
                  "[[particle]]\nname = \"weight\"\nmass = 1.2\nposition = [0.4, 1]\nradius = 0.1\n"
                  "[[joint]]\nname = \"rope\"\ntype = \"pulley\"\nbetween = [\"bob\", \"weight\"]\n"
                  "over = [\"wheel\"]\n");
    const double begun = scene.at(0).energies.total();
    for (const double t : {0.4, 0.9, 1.4})
      EXPECT_NEAR(scene.at(t).energies.total(), begun, manner.name == "iterative" ? 0.04 : 1e-6)
          << manner.name << t;
  }
}

// It pulls alone: a weight thrown upwards lets it hang, and is caught when it is taut again.
TEST(Pulley, PullsAndNeverPushes) {
  for (const Manner& manner : kManners) {
    TextRun scene(
        plane_without_walls(manner) +
        "[[particle]]\nname = \"left\"\nmass = 1\nposition = [-1, 0]\nradius = 0.1\nvelocity = [0, 3]\n"
        "[[particle]]\nname = \"right\"\nmass = 1\nposition = [1, 0]\nradius = 0.1\n"
        "[[joint]]\nname = \"rope\"\ntype = \"pulley\"\nbetween = [\"left\", \"right\"]\n"
        "over = [[-1, 4], [1, 4]]\n");
    const std::size_t left = number_of(scene, "left"), right = number_of(scene, "right");
    // both fall freely, the left 3 t higher
    sim::Snapshot now = scene.at(0.2);
    EXPECT_NEAR(now.bodies[left].position.y(), 3 * 0.2 - 0.5 * kEarth * 0.04, 1e-6) << manner.name;
    EXPECT_NEAR(now.bodies[right].position.y(), -0.5 * kEarth * 0.04, 1e-6) << manner.name;
    EXPECT_NEAR(now.joints[0].force.norm(), 0, 1e-9) << manner.name;
    EXPECT_NEAR(now.joints[0].slack, 3 * 0.2 - kEarth * 0.04, 1e-6) << manner.name;
    for (const double t : {0.5, 1.0, 1.5}) {
      now = scene.at(t);
      EXPECT_LT(8 - now.bodies[left].position.y() - now.bodies[right].position.y(), 8 + 2 + 1e-3)
          << manner.name << t;
    }
  }
}

// A rope over a point that is lifted with an acceleration has the weight of g + a.
TEST(Pulley, OverABodyThatIsMovedFeelsItsAcceleration) {
  const double lift = 2;
  const double a = (2 - 1) * (kEarth + lift) / 3;
  for (const Manner& manner : kManners) {
    TextRun scene(plane_without_walls(manner) +
                  "[[particle]]\nname = \"hook\"\nposition = [0, 4]\nradius = 0.1\nmotion = { y = \"t^2\" }\n"
                  "[[particle]]\nname = \"left\"\nmass = 1\nposition = [0, 0]\nradius = 0.1\n"
                  "[[particle]]\nname = \"right\"\nmass = 2\nposition = [0, 1]\nradius = 0.1\n"
                  "[[joint]]\nname = \"rope\"\ntype = \"pulley\"\nbetween = [\"left\", \"right\"]\nover = "
                  "[\"hook\"]\n");
    const std::size_t left = number_of(scene, "left"), right = number_of(scene, "right");
    const double begun = scene.at(0).energies.total();
    const sim::Snapshot now = scene.at(0.4);
    EXPECT_NEAR(now.bodies[left].velocity.y(), (a + lift) * 0.4, 1e-6) << manner.name;
    EXPECT_NEAR(now.bodies[right].velocity.y(), (-a + lift) * 0.4, 1e-6) << manner.name;
    EXPECT_NEAR(now.energies.total() - now.energies.work, begun, 1e-5) << manner.name;
  }
}

// As seen from a hand that moves at one velocity, what hangs on its taut rope swings as on one at rest: the
// rope is an equation of the free motion in both.
TEST(Rope, OnAHandThatMovesSwingsAsOnOneAtRest) {
  for (const Manner& manner : kManners) {
    for (const bool space : {false, true}) {
      const auto swing = [&](double speed) {
        const std::string more = space ? ", 0]" : "]";
        TextRun scene(
            (space ? "duration = 1000\n[room]\nsize = [20, 20, 20]\ncorner = [-10, -10, -10]\nwalls = "
                     "\"none\"\n" +
                         manner.keys + "\n"
                   : plane_without_walls(manner)) +
            "[[particle]]\nname = \"hand\"\nposition = [0, 4" + more + "\nradius = 0.1\nmotion = { x = \"" +
            std::to_string(speed) +
            "*t\" }\n"
            "[[particle]]\nname = \"ball\"\nmass = 1\nposition = [0, 3" +
            more + "\nradius = 0.1\nvelocity = [" + std::to_string(8 + speed) + ", 0" + more +
            "\n[[joint]]\ntype = \"rope\"\nbetween = [\"hand\", \"ball\"]\n");
        const sim::Snapshot now = scene.at(1);
        return sim::Vec3(now.bodies[number_of(scene, "ball")].position -
                         now.bodies[number_of(scene, "hand")].position);
      };
      EXPECT_NEAR((swing(3) - swing(0)).norm(), 0, 1e-8) << manner.name << space;
    }
  }
}

TEST(Pulley, InSpaceRunsOverPoints) {
  const double a = kEarth / 3;
  for (const Manner& manner : kManners) {
    TextRun scene(
        "duration = 1000\n[room]\nsize = [20, 20, 20]\ncorner = [-10, -10, -10]\nwalls = \"none\"\n" +
        manner.keys +
        "\n[[particle]]\nname = \"left\"\nmass = 1\nposition = [-1, 0, 1]\nradius = 0.1\n"
        "[[particle]]\nname = \"right\"\nmass = 2\nposition = [1, 0, -1]\nradius = 0.1\n"
        "[[joint]]\nname = \"rope\"\ntype = \"pulley\"\nbetween = [\"left\", \"right\"]\n"
        "over = [[-1, 4, 1], [1, 4, -1]]\n");
    const sim::Snapshot now = scene.at(0.7);
    EXPECT_NEAR(now.bodies[number_of(scene, "left")].velocity.y(), a * 0.7, 1e-9) << manner.name;
    EXPECT_NEAR(now.bodies[number_of(scene, "right")].velocity.y(), -a * 0.7, 1e-9) << manner.name;
    EXPECT_NEAR(now.joints[0].force.norm(), kEarth + a, 1e-8) << manner.name;
  }
}

// --- ropes that wind up

// A bob on a string whose other end a post of radius R holds, at a right angle to it with speed v: it runs
// along the involute of the circle, l^2 = l0^2 - 2 R v t, and the string has turned by (l0 - l) / R. `side`:
// 1 winds clockwise, -1 is its mirror image.
constexpr double kPost = 0.1, kString = 1.5, kBobSpeed = 2;

std::string bob_around_post(const std::string& physics, double side, const std::string& post,
                            const std::string& end) {
  return fmt::format(
      "duration = 1000\n[room]\nsize = [20, 20]\ncorner = [-10, -10]\nwalls = 'none'\ngravity = [0, 0]\n"
      "{}\n[[ball]]\nname = 'post'\nradius = {}\nmass = 1e12\nposition = [0, 0]\n{}"
      "[[particle]]\nname = 'bob'\nmass = 1\nposition = [{}, {}]\nvelocity = [0, {}]\n"
      "[[joint]]\nname = 'string'\ntype = 'pulley'\nbetween = ['bob', {}]\nover = ['post']\n",
      physics, kPost, post, kString, side * kPost, -side * kBobSpeed, end);
}
double string_left(double t) { return std::sqrt(kString * kString - 2 * kPost * kBobSpeed * t); }
sim::Vec3 bob_on_involute(double t, double side) {
  const double l = string_left(t), turn = -(kString - l) / kPost, c = std::cos(turn), s = std::sin(turn);
  return {c * l - s * kPost, side * (s * l + c * kPost), 0};
}

TEST(Pulley, AStringWindsUpAroundAPostAllRoundsCounted) {
  const std::string fixed = "fixed = true\n", pin = "[[joint]]\ntype = 'pin'\nbetween = ['post', 'room']\n";
  for (const Manner& manner : kManners) {
    for (const auto& [rate, close] : {std::pair(60, 2e-4), std::pair(600, 2e-8)}) {
      for (const double side : {-1, 1}) {
        for (const auto& [post, end] :
             {std::pair(fixed, std::string("'post'")), std::pair(pin, std::string("'post'")),
              std::pair(fixed, fmt::format("[-4, {}]", -side))}) {
          const TextRun scene(
              bob_around_post(fmt::format("{}\nrate = {}", manner.keys, rate), side, post, end));
          // at 1.7 s it has gone half a round, at 4.0 s a whole one, at 5 s 1.6
          for (const double t : {1.0, 1.8, 3.0, 4.1, 5.0})
            EXPECT_NEAR((scene.place(t, number_of(scene, "bob")) - bob_on_involute(t, side)).norm(), 0, close)
                << manner.name << " " << rate << " " << side << " " << t << post << end;
        }
      }
    }
  }
}

TEST(Pulley, AStringThatWindsUpGoesOnFromACheckpointWithItsRounds) {
  for (const Manner& manner : kManners) {
    const Scene scene = parse(bob_around_post(manner.keys, 1, "fixed = true\n", "'post'"), "a.toml");
    const auto words_at = [&](sim::Run& run, const char* t) {
      (void)run.at(*sim::parse_rational(t));
      return run.words();
    };
    for (const char* const cut : {"1.65", "1.7", "4.5"}) {
      const auto whole = scene.run(), part = scene.run();
      (void)words_at(*part, cut);
      const auto resumed = scene.run(part->saved());
      ASSERT_TRUE(resumed);
      EXPECT_EQ(words_at(*resumed, "5"), words_at(*whole, "5")) << manner.name << cut;
    }
  }
}

// A screw jack turns and lifts a plate with two boxes on it, which bear in more places than determine their
// forces: where the direct solver meets a limit of its work and goes on by impulses, motors go on. It sagged
// by 16 mm in a second. The way of the motor's start is that by iterations.
TEST(Screw, AMotorGoesOnWhereALimitOfWorkIsMet) {
  const auto run = [](const char* solver) {
    const TextRun scene(fmt::format(
        "duration = 1\n[room]\nsize = [6, 6, 6]\n[physics]\nrate = 60\nsolver = '{}'\n[[box]]\nname = 'p'\n"
        "size = [1, 0.2, 1]\nmass = 2\nposition = [0, 1, 0]\nelasticity = 0\n[[box]]\nsize = [0.4, 0.4, "
        "0.4]\nposition = [-0.2, 1.3, 0.1]\nelasticity = 0\ncopies = {{ count = 2, offset = [0.42, 0, 0] }}\n"
        "[[joint]]\ntype = 'screw'\nbetween = ['p', 'room']\nat = [0, 1, 0]\naxis = [0, 1, 0]\npitch = "
        "0.5\nmotor = {{ speed = 0.3, most = 1000 }}\n",
        solver));
    return scene.at(1).bodies[0].position.y();
  };
  EXPECT_NEAR(run("direct"), run("iterative"), 1e-4);
}

// Atwood's machine whose one weight swings up behind the wheel, where its rope has turned by more than half a
// round: the energy stays.
TEST(Pulley, ASwingingAtwoodMachineWithAWheelKeepsItsEnergyBeyondHalfARound) {
  for (const char* const manner : {"solver = 'direct'", "solver = 'iterative'", "collision = 'event'"}) {
    for (const double side : {-1, 1}) {
      const TextRun scene(fmt::format(
          "duration = 1000\n[room]\nsize = [20, 20]\ncorner = [-10, -10]\nwalls = 'none'\n"
          "[physics]\nrate = 1200\n{}\n"
          "[[ball]]\nname = 'wheel'\nradius = 0.1\nmass = 1\nposition = [0, 2]\n"
          "[[joint]]\ntype = 'pin'\nbetween = ['wheel', 'room']\n"
          "[[particle]]\nname = 'weight'\nmass = 3\nposition = [{}, -1]\n"
          "[[particle]]\nname = 'bob'\nmass = 1\nposition = [{}, 2]\nvelocity = [0, -6]\n"
          "[[joint]]\nname = 'rope'\ntype = 'pulley'\nbetween = ['weight', 'bob']\nover = ['wheel']\n",
          manner, -0.1 * side, 1.8 * side));
      const std::size_t bob = number_of(scene, "bob");
      // the start jerks the weight
      const double begun = scene.at(0.01).energies.total();
      double turned = 0, angle = 0, most = 0;
      for (int i = 1; i <= 60; ++i) {
        const sim::Snapshot now = scene.at(0.05 * i);
        // by iterations to the first order; a round too few or too many would be of 20 J
        EXPECT_NEAR(now.energies.total(), begun, std::string(manner).ends_with("'iterative'") ? 0.3 : 1e-8)
            << manner << side << " " << i;
        const sim::Vec3 far = now.bodies[bob].position - sim::Vec3(0, 2, 0);
        const double next = std::atan2(far.y(), side * far.x());
        turned += std::remainder(next - angle, 2 * std::numbers::pi), angle = next;
        most = std::max(most, std::fabs(turned));
      }
      EXPECT_GT(most, std::numbers::pi) << manner << side;
    }
  }
}

// The bob comes to the rim at t = l0^2 / (2 R v); the run ends in the steps before that, and tells of it.
TEST(Pulley, ARopeThatIsWoundUpToItsEndEndsTheRun) {
  const double when = kString * kString / (2 * kPost * kBobSpeed);
  for (const Manner& manner : kManners) {
    for (const double side : {-1, 1}) {
      const TextRun scene(bob_around_post(manner.keys + "\nrate = 600", side, "fixed = true\n", "'post'"));
      const auto outcome = scene.run->at(*sim::parse_rational("6"));
      const auto* trouble = std::get_if<sim::Trouble>(&outcome);
      ASSERT_TRUE(trouble) << manner.name;
      EXPECT_EQ(trouble->body, "string");
      EXPECT_NE(trouble->what.find("no length left"), std::string::npos) << trouble->what;
      EXPECT_NEAR(trouble->time, when, 0.02) << manner.name;
    }
  }
}

// --- ropes that leave their wheels

// A bob on a string that runs from a place over a post of radius R, so that it hangs straight down beside it
// where it leaves it; `turned`: how far the bob has been swung up, in rad, by which the string is wrapped
// around the post, and l the length of its free piece. `side`: 1 to the right, -1 is its mirror image.
//   on the post   the involute of its circle, a = (-g sin phi + R phi'^2) / l,  l = l_0 - R phi
//   off it        a pendulum about the place, a = -g sin phi / (h + l_0)
// In both phi is the angle of the free piece, so the bob's speed is that times its length.
struct LeavingBob {
  double gravity = 9.81, turned = 1.2, speed = 0;  // the last towards the post, m/s
  static constexpr double kRadius = 0.2, kFree = 1.2, kHeight = 2;

  struct Motion {
    double phi, rate;
    bool on;
  };
  double length(const Motion& at) const { return at.on ? kFree - kRadius * at.phi : kFree + kHeight; }
  Motion begun() const { return {turned, -speed / (kFree - kRadius * turned), true}; }
  sim::Vec3 place(const Motion& at, double side) const {
    const double s = std::sin(at.phi), c = std::cos(at.phi), l = length(at);
    return at.on ? sim::Vec3(side * (l * s - kRadius * c), -l * c - kRadius * s, 0)
                 : sim::Vec3(side * (l * s - kRadius), kHeight - l * c, 0);
  }
  // by Runge and Kutta's fourth order
  Motion after(const Motion& at, double h) const {
    const auto bent = [&](double phi, double rate) {
      return (-gravity * std::sin(phi) + (at.on ? kRadius * rate * rate : 0)) / length({phi, rate, at.on});
    };
    const double a = at.rate, b = bent(at.phi, a), c = a + h / 2 * b, d = bent(at.phi + h / 2 * a, c),
                 e = a + h / 2 * d, f = bent(at.phi + h / 2 * c, e), i = a + h * f,
                 j = bent(at.phi + h * e, i);
    return {at.phi + h / 6 * (a + 2 * c + 2 * e + i), a + h / 6 * (b + 2 * d + 2 * f + j), at.on};
  }
  // at a time t, with each change to the other found exactly
  Motion at(double t) const {
    constexpr double kStep = 1e-3;
    Motion now = begun();
    for (double left = t; left > 0;) {
      double h = std::min(kStep, left);
      const auto stays = [&](double part) { return (after(now, part).phi >= 0) == now.on; };
      if (stays(h)) {
        now = after(now, h), left -= h;
        continue;
      }
      for (double low = 0, part = h; part - low > 1e-17;) {
        const double half = (low + part) / 2;
        if (half == low || half == part) break;
        (stays(half) ? low : part) = half, h = part;
      }
      now = after(now, h), left -= h;
      const double v = length(now) * now.rate;
      now.on = !now.on, now.phi = now.on ? 1e-300 : -1e-300, now.rate = v / length(now);
    }
    return now;
  }
  std::string text(const Manner& manner, int rate, double side, const std::string& post,
                   const std::string& rope) const {
    const sim::Vec3 p = place(begun(), side);
    const double v = begun().rate * length(begun());
    const std::string other = fmt::format("[{}, {}]", -side * kRadius, kHeight);
    return plane_without_walls({manner.name, fmt::format("{}\nrate = {}", manner.keys, rate)},
                               fmt::format("gravity = [0, {}]", -gravity)) +
           fmt::format(
               "[[ball]]\nname = 'post'\nradius = {}\nposition = [0, 0]\n{}[[particle]]\nname = 'bob'\n"
               "mass = 1\nposition = [{}, {}]\nvelocity = [{}, {}]\n[[joint]]\nname = 'string'\n"
               "type = 'pulley'\nbetween = [{}]\nover = ['post']\n{}"
               "[contact]\nignore = [['bob', 'post']]\n",
               kRadius, post, p.x(), p.y(), side * v * std::cos(turned), v * std::sin(turned),
               side > 0 ? other + ", 'bob'" : "'bob', " + other, rope);
  }
};

const std::string kFixedPost = "fixed = true\n",
                  kPinnedPost = "mass = 1e-3\n[[joint]]\ntype = 'pin'\nbetween = ['post', 'room']\n";
struct PostOfBob {
  std::string post, rope;
};
// those that a solver knows
std::vector<PostOfBob> posts_of_bob(const Manner& manner) {
  std::vector<PostOfBob> all = {{kFixedPost, ""}, {kPinnedPost, ""}};
  if (manner.name != "iterative") all.push_back({kFixedPost, "friction = 0.2\n"});
  return all;
}

// It swings beyond the post, as a longer pendulum, and comes back to it twice.
TEST(Pulley, AStringLeavesItsPostAndComesBack) {
  const LeavingBob bob;
  for (const Manner& manner : kManners) {
    for (const double side : {-1, 1}) {
      for (const auto& [post, rope] : posts_of_bob(manner)) {
        const TextRun scene(bob.text(manner, 1200, side, post, rope));
        const std::size_t number = number_of(scene, "bob");
        const double begun = scene.at(0).energies.total();
        // off it at 1 s, 2 s and 4 s
        for (const double t : {0.5, 1.0, 2.0, 3.0, 4.0, 5.6}) {
          SCOPED_TRACE(fmt::format("{} {} {} {}{}", manner.name, t, side, post, rope));
          const sim::Snapshot now = scene.at(t);
          const LeavingBob::Motion right = bob.at(t);
          const bool first_order = manner.name == "iterative";
          EXPECT_NEAR((now.bodies[number].position - bob.place(right, side)).norm(), 0,
                      first_order ? 2e-4 : 1e-6);
          EXPECT_NEAR(now.energies.total(), begun, first_order ? 2e-4 : 1e-6);
          const double pull = bob.gravity * std::cos(right.phi) + bob.length(right) * right.rate * right.rate;
          const std::size_t first = post == kPinnedPost ? 1 : 0;
          EXPECT_NEAR(now.joints[first].force.norm(), pull, first_order ? 2e-2 : 1e-4);
          // one rope with one tension
          if (!right.on) {
            EXPECT_EQ(now.joints.back().force, now.joints[first].force);
          }
        }
      }
    }
  }
}

// The error falls with the square of the step at least: the change is found within it.
TEST(Pulley, AStringThatLeavesItsPostConverges) {
  const LeavingBob bob;
  const sim::Vec3 right = bob.place(bob.at(3), 1);
  for (const Manner& manner : kManners) {
    for (const auto& [post, rope] : posts_of_bob(manner)) {
      const auto error = [&](int rate) {
        const TextRun scene(bob.text(manner, rate, 1, post, rope));
        return (scene.place(3, number_of(scene, "bob")) - right).norm();
      };
      EXPECT_LT(error(960), error(240) / 12) << manner.name << post << rope;
    }
  }
}

// Without gravity a bob unwinds its string, of which l is free and W rad are on the post, at its speed v:
//   (l + R phi) phi' = v,  so the string is straight after  t = (l W + R W^2 / 2) / v
// and from then on the bob runs around the string's other end on a circle of radius h + l + R W, up to where
// the string comes to the other side of the post: at 2 pi - 2 atan(R / h).
TEST(Pulley, AStringThatComesAroundToTheOtherSideOfItsPostEndsTheRun) {
  const LeavingBob bob{.gravity = 0, .speed = 10};
  const double free = bob.kFree - bob.kRadius * bob.turned, far = bob.kHeight + bob.kFree,
               left = (free * bob.turned + 0.5 * bob.kRadius * bob.turned * bob.turned) / bob.speed,
               round = 2 * std::numbers::pi - 2 * std::atan(bob.kRadius / bob.kHeight),
               when = left + round * far / bob.speed;
  for (const Manner& manner : kManners) {
    for (const double side : {-1, 1}) {
      for (const auto& [post, rope] : posts_of_bob(manner)) {
        SCOPED_TRACE(fmt::format("{} {} {}{}", manner.name, side, post, rope));
        const TextRun scene(bob.text(manner, 1200, side, post, rope));
        for (const double t : {0.5, 1.0, 1.5, 1.9}) {
          const double turned = (t - left) * bob.speed / far;
          const sim::Vec3 right(-side * (bob.kRadius + far * std::sin(turned)),
                                bob.kHeight - far * std::cos(turned), 0);
          EXPECT_NEAR((scene.place(t, number_of(scene, "bob")) - right).norm(), 0,
                      manner.name == "iterative" ? 1e-3 : 1e-6);
        }
        const auto outcome = scene.run->at({3, 1});
        const auto* trouble = std::get_if<sim::Trouble>(&outcome);
        ASSERT_TRUE(trouble);
        EXPECT_NE(trouble->what.find("other side"), std::string::npos) << trouble->what;
        EXPECT_NEAR(trouble->time, when, 0.003);
      }
    }
  }
}

// A slack rope over a post, or a wheel, whose ends rise past it side by side is never tight: they go on.
TEST(Pulley, ASlackRopeIsLiftedOffItsWheel) {
  for (const Manner& manner : kManners) {
    for (const double side : {-1, 1}) {
      for (const auto& [post, rope] : posts_of_bob(manner)) {
        SCOPED_TRACE(fmt::format("{} {} {}{}", manner.name, side, post, rope));
        const TextRun scene(
            plane_without_walls(manner, "gravity = [0, 0]") +
            fmt::format("[[ball]]\nname = 'post'\nradius = 0.3\nposition = [0, 0]\n{}"
                        "[[particle]]\nname = 'a'\nmass = 1\nposition = [2, {}]\n"
                        "velocity = [0, {}]\n[[particle]]\nname = 'b'\nmass = 1\n"
                        "position = [-2, {}]\nvelocity = [0, {}]\n[[joint]]\nname = 'string'\n"
                        "type = 'pulley'\nbetween = ['a', 'b']\nover = ['post']\n{}",
                        post, -side, 2 * side, -side, 2 * side, rope));
        for (const double t : {0.4, 0.9, 2.0}) {
          const sim::Snapshot now = scene.at(t);
          for (const char* const name : {"a", "b"})
            EXPECT_NEAR((now.bodies[number_of(scene, name)].velocity - sim::Vec3(0, 2 * side, 0)).norm(), 0,
                        1e-12);
          EXPECT_EQ(now.joints.back().force.norm(), 0);
        }
      }
    }
  }
}

// Of saved words those that say which pieces of a rope are one are right for its wheels, or no state of it.
TEST(Pulley, PiecesThatAreOneFollowEachOther) {
  const Scene scene = parse(
      "[room]\nsize = [8, 8]\nwalls = 'none'\n[[ball]]\nname = 'p'\nradius = 0.2\nposition = [3, 6]\nfixed = "
      "true\n[[ball]]\nname = 'q'\nradius = 0.2\nposition = [5, 6]\nfixed = true\n[[particle]]\nname = "
      "'a'\nposition = [2.5, 3]\n[[particle]]\nname = 'b'\nposition = [5.5, 3]\n[[joint]]\ntype = "
      "'pulley'\nbetween = ['a', 'b']\nover = ['p', [4, 6.1], 'q']\n[[joint]]\ntype = 'pin'\nbetween = ['a', "
      "'room']\n",
      "a.toml");
  const sim::Model<2>& model = scene.plane().model;
  ASSERT_EQ(model.joints.size(), 4u);
  sim::State<2> state = scene.plane().state;
  sim::Stepper<2>(model).begin(state);
  ASSERT_EQ(state.wound.size(), 4u);
  const auto good = [&](std::array<int, 4> with) {
    for (std::size_t i = 0; i < 4; ++i) state.wound[i].with = with[i];
    return sim::fits(state, model);
  };
  EXPECT_TRUE(good({0, 0, 0, 0}));
  EXPECT_TRUE(good({1, -1, 0, 0}));
  EXPECT_TRUE(good({0, 1, -1, 0}));
  EXPECT_TRUE(good({2, -1, -2, 0}));
  EXPECT_FALSE(good({0, -1, -1, 0}));
  EXPECT_FALSE(good({1, 0, 0, 0}));
  EXPECT_FALSE(good({2, -1, -1, 0}));
  EXPECT_FALSE(good({-1, 0, 0, 0}));
  EXPECT_FALSE(good({0, 0, 1, -1}));
  EXPECT_FALSE(good({0, 0, 0, 1}));
  EXPECT_FALSE(good({0, 0, 0, -1}));
}

// A string that a moved ball has swung off its post wakes the box at its other end.
TEST(Pulley, AStringThatHasLeftItsPostWakesWhatSleepsOnIt) {
  for (const char* solver : {"direct", "iterative"}) {
    const TextRun scene(
        "duration = 8\n[room]\nsize = [20, 20]\ncorner = [-10, -10]\nwalls = 'ground'\n[physics]\nsolver = "
        "'" +
        std::string(solver) +
        "'\nrate = 240\n[[ball]]\nname = 'post'\nradius = 0.3\nposition = [0, -6]\nfixed = "
        "true\n[[ball]]\nname = "
        "'carrier'\nradius = 0.1\nmotion = { path = [[0, -1, -3], [1, 1.5, -3.3], [5, 1.5, -3.3], [7, 1.5, "
        "-0.5]] "
        "}\n[[box]]\nname = 'box'\nsize = [0.5, 0.5]\nmass = 1\nposition = [0.3, -9.75]\n[[joint]]\nname = "
        "'string'\ntype = 'pulley'\nbetween = ['carrier', 'box']\nover = ['post']\n[contact]\nignore = "
        "[['carrier', "
        "'post'], ['box', 'post']]\n");
    const std::size_t box = number_of(scene, "box");
    EXPECT_LT(scene.at(4.9).bodies[box].velocity.norm(), 1e-6) << solver;
    EXPECT_GT(scene.at(6.9).bodies[box].position.y(), -9) << solver;
  }
}

// A string that is joined where its ends are past its post runs straight between them: one of two equal bobs
// pulls the other along with half of its speed.
TEST(Pulley, AStringThatIsJoinedPastItsPostIsStraight) {
  for (const Manner& manner : kManners) {
    for (const double side : {-1, 1}) {
      const TextRun scene(
          plane_without_walls(manner, "gravity = [0, 0]") +
          fmt::format("[[ball]]\nname = 'post'\nradius = 0.3\nposition = [0, 0]\nfixed = "
                      "true\n[[particle]]\nname = 'a'\nmass = 1\nposition = [{0}, -1]\nvelocity = "
                      "[{1}, 4]\n[[particle]]\nname = 'b'\nmass = 1\nposition = [{2}, -1]\nvelocity "
                      "= [{3}, 4]\n[[joint]]\nname = 'string'\ntype = 'pulley'\nbetween = ['a', "
                      "'b']\nover = ['post']\njoined = false\n[[when]]\ntime = 0.5\ndo = [{{ join = "
                      "'string' }}, {{ set = 'a.velocity', to = [{0}, 0] }}, {{ set = 'b.velocity', "
                      "to = [0, 0] }}]\n[contact]\nignore = [['a', 'post'], ['b', 'post']]\n",
                      side, 4 * side, -side, -4 * side));
      const sim::Snapshot now = scene.at(0.75);
      for (const char* bob : {"a", "b"})
        EXPECT_NEAR((now.bodies[number_of(scene, bob)].velocity - sim::Vec3(0.5 * side, 0, 0)).norm(), 0,
                    1e-9)
            << manner.name << " " << bob;
    }
  }
}

// A wheel that turns goes on turning while its rope is off it, and a run that is cut there goes on to the
// same bits.
TEST(Pulley, AStringThatHasLeftItsWheelGoesOnFromACheckpoint) {
  const LeavingBob bob;
  for (const Manner& manner : kManners) {
    for (const auto& [post, rope] : posts_of_bob(manner)) {
      const Scene scene = parse(bob.text(manner, 240, 1, post, rope), "a.toml");
      const auto words_at = [&](sim::Run& run, const char* t) {
        (void)run.at(*sim::parse_rational(t));
        return run.words();
      };
      for (const char* const cut : {"0.5", "1.3", "2.5"}) {
        const auto whole = scene.run(), part = scene.run();
        (void)words_at(*part, cut);
        const auto resumed = scene.run(part->saved());
        ASSERT_TRUE(resumed);
        EXPECT_EQ(words_at(*resumed, "4.5"), words_at(*whole, "4.5")) << manner.name << cut << post << rope;
      }
    }
  }
}

// Two posts, of which the string leaves the lower one first, then the other, too, if it lies on the same side
// of that, and comes back: with friction one joint, without it three, whose tension is one all the same, as
// nothing slips where an end is made fast.
TEST(Pulley, AStringLeavesTwoPostsAndComesBackToThem) {
  for (const double side : {-1, 1}) {
    for (const double end : {0.3, -0.05}) {
      SCOPED_TRACE(fmt::format("{} {}", side, end));
      const auto text = [&](const Manner& manner, const char* rope) {
        return plane_without_walls({manner.name, manner.keys + "\nrate = 1200"}) +
               fmt::format(
                   "[[ball]]\nname = 'p'\nradius = 0.2\nposition = [0, 0]\nfixed = true\n[[ball]]\nname = "
                   "'q'\nradius = 0.2\nposition = [{}, 0.9]\nfixed = true\n[[particle]]\nname = 'bob'\n"
                   "mass = 1\nposition = [{}, -0.3]\n[[joint]]\nname = 'string'\ntype = 'pulley'\n"
                   "between = ['bob', [{}, 2]]\nover = ['p', 'q']\n{}[contact]\n"
                   "ignore = [['bob', 'p'], ['bob', 'q']]\n",
                   0.1 * side, 1.2 * side, end * side, rope);
      };
      const TextRun right(text(kManners[0], "friction = 0.1\n"));
      const std::size_t bob = number_of(right, "bob");
      const double begun = right.at(0).energies.total();
      double least = 10;
      std::vector<sim::Vec3> places;
      for (int i = 1; i <= 12; ++i) {
        const sim::Snapshot now = right.at(0.3 * i);
        places.push_back(now.bodies[bob].position);
        least = std::min(least, side * places.back().x());
        EXPECT_NEAR(now.energies.total(), begun, 1e-6) << i;
      }
      EXPECT_LT(least, -0.8);
      for (const Manner& manner : kManners) {
        const TextRun other(text(manner, ""));
        for (int i = 1; i <= 12; ++i)
          EXPECT_NEAR((other.place(0.3 * i, bob) - places[std::size_t(i - 1)]).norm(), 0,
                      manner.name == "iterative" ? 5e-4 : 1e-6)
              << manner.name << i;
      }
    }
  }
}

// The bob of a swinging Atwood machine comes to the rim of its wheel at 0.545 s, on a way that bends: the run
// ends there at every rate, and does not go on through the rim.
TEST(Pulley, ABobThatSwingsOntoTheRimEndsTheRun) {
  for (const Manner& manner : kManners) {
    for (const int rate : {25, 40, 60, 80, 120, 600}) {
      if (manner.name == "event" && rate < 120) continue;  // its steps bend more
      const TextRun scene(plane_without_walls({"", manner.keys + fmt::format("\nrate = {}", rate)}) +
                          "[[ball]]\nname = 'w'\nradius = 0.3\nmass = 1\nposition = [0.3, 0]\n[[joint]]\n"
                          "type = 'pin'\nbetween = ['w', 'room']\n[[particle]]\nname = 'a'\nmass = 1\n"
                          "position = [1.6, 0]\n[[particle]]\nname = 'b'\nmass = 2\nposition = [0, -4]\n"
                          "[[joint]]\ntype = 'pulley'\nbetween = ['b', 'a']\nover = ['w']\n");
      const auto outcome = scene.run->at({2, 1});
      const auto* trouble = std::get_if<sim::Trouble>(&outcome);
      ASSERT_TRUE(trouble) << manner.name << rate;
      EXPECT_NE(trouble->what.find("no length left"), std::string::npos) << trouble->what;
      EXPECT_NEAR(trouble->time, 0.545, 1.0 / rate + 0.004) << manner.name << rate;
    }
  }
}

// Atwood's machine over points, until the lighter end comes to its point: after sqrt(2 l / a), a = g / 3.
// There it would have to turn back at once; the run ends in the step before. A rope that is slack says
// nothing of it, and one that swings by at an arm's length goes on.
TEST(Pulley, AnEndThatComesToItsPointEndsTheRun) {
  const auto ends = [](int dimension, const Manner& manner, int rate, double beside, double slack,
                       const char* pushed) {
    const char* z = dimension == 2 ? "" : ", 0";
    const std::string keys = fmt::format("\nrate = {}", rate);
    return TextRun(
        (dimension == 2 ? plane_without_walls({manner.name, manner.keys + keys})
                        : space_without_walls({manner.name, manner.keys + keys})) +
        fmt::format(
            "[[particle]]\nname = 'a'\nmass = 1\nposition = [{0}, -1{1}]\n{2}[[particle]]\nname = 'b'\n"
            "mass = 2\nposition = [2, -1{1}]\n[[joint]]\nname = 'rope'\ntype = 'pulley'\n"
            "between = ['a', 'b']\nover = [[0, 0{1}], [2, 0{1}]]\n{3}",
            beside, z, pushed, slack > 0 ? fmt::format("length = {}\n", 4 + slack) : ""));
  };
  const double when = std::sqrt(2 * 3 / kEarth);
  for (const int dimension : {2, 3}) {
    for (const Manner& manner : kManners) {
      for (const int rate : {30, 60, 600}) {
        SCOPED_TRACE(fmt::format("{}D by {} at {}", dimension, manner.name, rate));
        const TextRun taut = ends(dimension, manner, rate, 0, 0, "");
        const auto outcome = taut.run->at(*sim::parse_rational("2"));
        const auto* trouble = std::get_if<sim::Trouble>(&outcome);
        ASSERT_TRUE(trouble);
        EXPECT_EQ(trouble->body, "rope");
        EXPECT_NE(trouble->what.find("no length left"), std::string::npos) << trouble->what;
        EXPECT_NEAR(trouble->time, when - 0.5 / rate, 0.6 / rate);

        const char* up = dimension == 2 ? "velocity = [0, 8]\n" : "velocity = [0, 8, 0]\n";
        const TextRun loose = ends(dimension, manner, rate, 0, 40, up);
        EXPECT_NEAR(loose.at(0.5).bodies[number_of(loose, "a")].position.y(), -1 + 4 - kEarth / 8, 1e-6);
        const TextRun beside = ends(dimension, manner, rate, 0.7, 0, "");
        EXPECT_GT(beside.at(2).bodies[number_of(beside, "b")].position.y(), -4);
      }
    }
  }
}

// All pieces of a rope break together, and each side falls.
TEST(Pulley, BreaksWhereItIsLoadedTooMuch) {
  for (const Manner& manner : kManners) {
    TextRun scene(plane_without_walls(manner) + kAtwood + "breaks = 12.5\n");  // 12 and 15.3 N
    const sim::Snapshot now = scene.at(0.5);
    EXPECT_TRUE(now.joints[1].broken && now.joints[2].broken) << manner.name;
    EXPECT_NEAR(now.bodies[number_of(scene, "left")].velocity.y(), -kEarth * 0.5, 0.05) << manner.name;
    TextRun whole(plane_without_walls(manner) + kAtwood + "breaks = 16\n");
    EXPECT_FALSE(whole.at(0.5).joints[2].broken) << manner.name;
  }
}

TEST(Pulley, GoesOnToTheSameBitsFromACheckpoint) {
  for (const Manner& manner : kManners) {
    const Scene scene = parse(plane_without_walls(manner) + kAtwood, "a.toml");
    const auto words_at = [&](sim::Run& run, const char* t) {
      (void)run.at(*sim::parse_rational(t));
      return run.words();
    };
    const auto whole = scene.run(), part = scene.run();
    (void)words_at(*part, "0.31");
    const auto resumed = scene.run(part->saved());
    ASSERT_TRUE(resumed);
    EXPECT_EQ(words_at(*resumed, "0.7"), words_at(*whole, "0.7")) << manner.name;
  }
}

// --- gears

const std::string kTwoWheels =
    "[[ball]]\nname = \"small\"\nradius = 0.5\nmass = 1\nposition = [0, 0]\nspin = 0\n"
    "[[ball]]\nname = \"large\"\nradius = 1.5\nmass = 4\nposition = [2, 0]\n"
    "[[joint]]\nname = \"small_axle\"\ntype = \"pin\"\nbetween = [\"small\", \"room\"]\n"
    "motor = { speed = 100000, most = 3 }\n"
    "[[joint]]\nname = \"large_axle\"\ntype = \"pin\"\nbetween = [\"large\", \"room\"]\n"
    "[[joint]]\nname = \"teeth\"\ntype = \"gear\"\njoints = [\"small_axle\", \"large_axle\"]\nratio = -3\n";

// A motor of torque T turns the small wheel: alpha = T / (I1 + I2 / n^2); the teeth bear I2 alpha2 / r2.
TEST(Gear, TwoWheelsTurnInTheirRatioUnderTheTorqueOfBoth) {
  const double i1 = 0.5 * 1 * 0.25, i2 = 0.5 * 4 * 2.25, n = -3;
  const double alpha = 3 / (i1 + i2 / (n * n));
  for (const Manner& manner : kManners) {
    TextRun scene(plane_without_walls(manner) + kTwoWheels);
    const std::size_t small = number_of(scene, "small"), large = number_of(scene, "large");
    for (const double t : {0.4, 1.1}) {
      const sim::Snapshot now = scene.at(t);
      EXPECT_NEAR(now.bodies[small].spin.z(), alpha * t, 1e-9) << manner.name;
      EXPECT_NEAR(now.bodies[small].spin.z(), n * now.bodies[large].spin.z(), 1e-12 * alpha) << manner.name;
      EXPECT_NEAR(now.bodies[small].angle, n * now.bodies[large].angle, 1e-11 * (1 + alpha * t))
          << manner.name;
      const double tooth = i2 * (alpha / 3) / 1.5;
      EXPECT_NEAR(now.joints[2].force.norm(), tooth, 1e-9) << manner.name;
      EXPECT_NEAR(now.joints[2].force.x(), 0, 1e-9) << manner.name;
    }
  }
}

// A rack falls and turns its pinion: a = m g / (m + I / r^2).
TEST(Gear, ARackTurnsItsPinion) {
  const double a = 2 * kEarth / (2 + 0.5 * 3);
  for (const Manner& manner : kManners) {
    TextRun scene(
        plane_without_walls(manner) +
        "[[ball]]\nname = \"pinion\"\nradius = 0.4\nmass = 3\nposition = [0, 0]\n"
        "[[box]]\nname = \"rack\"\nsize = [0.2, 3]\nmass = 2\nposition = [-0.5, 0]\n"
        "[[joint]]\nname = \"axle\"\ntype = \"pin\"\nbetween = [\"pinion\", \"room\"]\n"
        "[[joint]]\nname = \"guide\"\ntype = \"slider\"\nbetween = [\"rack\", \"room\"]\naxis = [0, 1]\n"
        "[[joint]]\nname = \"teeth\"\ntype = \"gear\"\njoints = [\"guide\", \"axle\"]\nratio = -0.4\n");
    const sim::Snapshot now = scene.at(0.6);
    EXPECT_NEAR(now.bodies[number_of(scene, "rack")].velocity.y(), -a * 0.6, 1e-9) << manner.name;
    EXPECT_NEAR(now.bodies[number_of(scene, "pinion")].spin.z(), a * 0.6 / 0.4, 1e-8) << manner.name;
    EXPECT_NEAR((now.joints[2].force - sim::Vec3(0, 2 * (kEarth - a), 0)).norm(), 0, 1e-8) << manner.name;
  }
}

TEST(Gear, InSpaceHoldsTwoHinges) {
  for (const Manner& manner : kManners) {
    TextRun scene(
        "duration = 1000\n[room]\nsize = [20, 20, 20]\ncorner = [-10, -10, -10]\nwalls = \"none\"\n" +
        manner.keys +
        "\n[[ball]]\nname = \"small\"\nradius = 0.5\nmass = 1\nposition = [0, 0, 0]\n"
        "[[ball]]\nname = \"large\"\nradius = 1\nmass = 4\nposition = [1.5, 0, 0]\n"
        "[[joint]]\nname = \"small_axle\"\ntype = \"hinge\"\nbetween = [\"small\", \"room\"]\n"
        "motor = { speed = 100000, most = 3 }\n"
        "[[joint]]\nname = \"large_axle\"\ntype = \"hinge\"\nbetween = [\"large\", \"room\"]\n"
        "[[joint]]\ntype = \"gear\"\njoints = [\"small_axle\", \"large_axle\"]\nratio = -2\n");
    const double i1 = 0.4 * 0.25, i2 = 0.4 * 4, alpha = 3 / (i1 + i2 / 4);
    const sim::Snapshot now = scene.at(0.9);
    const double small = now.bodies[number_of(scene, "small")].spin.z(),
                 large = now.bodies[number_of(scene, "large")].spin.z();
    EXPECT_NEAR(small, alpha * 0.9, 1e-8) << manner.name;
    EXPECT_NEAR(small, -2 * large, 1e-11 * alpha) << manner.name;
    EXPECT_NEAR(now.joints[2].force.norm(), i2 * alpha / 2 / 1, 1e-8) << manner.name;
  }
}

// A crank that is moved, a rod and a piston on a slider: x = r cos + sqrt(l^2 - r^2 sin^2).
TEST(Gear, ADrivenSliderCrankIsWhereItsAngleSays) {
  for (const Manner& manner : kManners) {
    TextRun scene(
        plane_without_walls(manner) +
        "[[ball]]\nname = \"crank\"\nradius = 0.5\nposition = [0, 0]\nmotion = { angle = \"360*t\" }\n"
        "[[box]]\nname = \"piston\"\nsize = [0.4, 0.3]\nmass = 1\nposition = [2, 0]\n"
        "[[joint]]\ntype = \"slider\"\nbetween = [\"piston\", \"room\"]\n"
        "[[joint]]\ntype = \"rod\"\nbetween = [{ body = \"crank\", local = [0.5, 0] }, \"piston\"]\n");
    const std::size_t piston = number_of(scene, "piston");
    for (const double t : {0.2, 0.65, 1.3}) {
      const double w = 2 * std::numbers::pi * t;
      EXPECT_NEAR(scene.place(t, piston).x(),
                  0.5 * std::cos(w) + std::sqrt(2.25 - 0.25 * std::sin(w) * std::sin(w)), 1e-8)
          << manner.name << t;
    }
  }
}

// --- springs in joints, and motors that follow

// A torsion pendulum: theta = theta0 cos w t about the rest angle, w^2 = k / I.
TEST(JointSpring, ATorsionPendulumSwingsAboutItsRestAngle) {
  const double i = 2.0 / 12 * (1.2 * 1.2 + 0.1 * 0.1), k = 3, w = std::sqrt(k / i),
               rest = 40 * std::numbers::pi / 180;
  for (const Manner& manner : kManners) {
    TextRun scene(plane_without_walls(manner) +
                  "[[box]]\nname = \"bar\"\nsize = [1.2, 0.1]\nmass = 2\nposition = [0, 0]\n"
                  "[[joint]]\ntype = \"pin\"\nbetween = [\"bar\", \"room\"]\n"
                  "spring = { stiffness = 3, rest_angle = 40 }\n");
    EXPECT_NEAR(scene.at(0).energies.springs, 0.5 * k * rest * rest, 1e-12) << manner.name;
    for (const double t : {0.4, 1.1, 2.3}) {
      const sim::Snapshot now = scene.at(t);
      EXPECT_NEAR(now.bodies[0].angle, rest * (1 - std::cos(w * t)), 1e-8) << manner.name << t;
      EXPECT_NEAR(now.energies.total(), 0.5 * k * rest * rest, 1e-8) << manner.name << t;
    }
  }
}

// A weight on a slider with a damped spring: x'' = -k/m (x - rest) - c/m x'.
TEST(JointSpring, ASliderSwingsAndIsDamped) {
  const double m = 2, k = 18, c = 2, rest = 0.3, d = c / (2 * m), w = std::sqrt(k / m - d * d);
  for (const Manner& manner : kManners) {
    TextRun scene(plane_without_walls(manner) +
                  "[[box]]\nname = \"weight\"\nsize = [0.4, 0.4]\nmass = 2\nposition = [0, 0]\n"
                  "[[joint]]\ntype = \"slider\"\nbetween = [\"weight\", \"room\"]\n"
                  "spring = { stiffness = 18, damping = 2, rest_position = 0.3 }\n");
    const double t = 0.9, e = std::exp(-d * t);
    EXPECT_NEAR(scene.place(t, 0).x(), rest - rest * e * (std::cos(w * t) + d / w * std::sin(w * t)), 1e-7)
        << manner.name;
  }
}

// A Chinese windlass: two drums on one axle wind up a rope on different sides of it, with a hook in its loop,
// whose pulley is as wide as both pieces hang apart. The axle turns by
//   th'' = M g (R - r)/2 / (I_drums + I_hook + M (R - r)^2/4)
TEST(Pulley, ARopeIsWoundOnTheSideThatIsNamed) {
  for (const Manner& manner : kManners) {
    for (const bool mirrored : {false, true}) {
      const std::string x = mirrored ? "0.1" : "-0.1", R = mirrored ? "right" : "left",
                        r = mirrored ? "left" : "right";
      const std::string scene =
          plane_without_walls(manner) + disc("big", 2, 0.5, "position = [0, 3]") +
          disc("small", 1, 0.3, "position = [0, 3]") + disc("hook", 6, 0.4, "position = [" + x + ", 0]") +
          "[[joint]]\ntype = \"pin\"\nbetween = [\"big\", \"room\"]\nat = [0, 3]\n"
          "[[joint]]\ntype = \"weld\"\nbetween = [\"big\", \"small\"]\nat = [0, 3]\n"
          "[[joint]]\ntype = \"pulley\"\nbetween = [\"big\", \"small\"]\nover = [\"big\", \"hook\", "
          "\"small\"]\n";
      const TextRun run(scene + "wound = [\"" + R + "\", \"" + r +
                        "\"]\n[contact]\nignore = [[\"big\", \"small\"]]\n");
      const double M = 6, drums = 0.5 * 2 * 0.25 + 0.5 * 0.09, hook = 0.5 * M * 0.16;
      const double a = M * 9.81 * 0.1 / (drums + hook + M * 0.01);
      const sim::Snapshot now = run.at(1);
      EXPECT_NEAR(now.bodies[0].spin.z(), (mirrored ? -1 : 1) * a, 1e-8) << manner.name;
      EXPECT_NEAR(now.bodies[2].position.y(), -0.5 * a * 0.1, 1e-8) << manner.name;
      EXPECT_NEAR(now.bodies[2].position.x(), mirrored ? 0.1 : -0.1, 1e-8) << manner.name;
      EXPECT_NE(refusal(scene + "wound = [\"left\", \"up\"]\n").find("left, right, above, below or auto"),
                std::string::npos);
    }
  }
  EXPECT_NE(refusal(plane_without_walls(kManners[0]) + disc("w", 2, 0.5, "position = [0, 3]") +
                    disc("a", 1, 0.1, "position = [0.5, 0]") +
                    "[[joint]]\ntype = \"pulley\"\nbetween = [\"a\", \"w\"]\nover = [\"w\"]\n"
                    "wound = [\"left\", \"auto\"]\n")
                .find("not wound on a wheel at its first end"),
            std::string::npos);
}

// A motor that follows an angle is there; one that follows a speed has gone as far as its integral.
TEST(JointMotor, FollowsAnAngleOrASpeedOfTime) {
  for (const Manner& manner : kManners) {
    TextRun angle(plane_without_walls(manner) +
                  "[[box]]\nname = \"arm\"\nsize = [1.2, 0.1]\nmass = 2\nposition = [0, 0]\n"
                  "[[joint]]\ntype = \"pin\"\nbetween = [\"arm\", \"room\"]\n"
                  "motor = { angle = \"60*(1 - cos(2*t))\", most = 100 }\n");
    const double bound = manner.name == "iterative" ? 2e-3 : 1e-6;
    EXPECT_NEAR(angle.at(1.3).bodies[0].angle, std::numbers::pi / 3 * (1 - std::cos(2.6)), bound)
        << manner.name;
    TextRun speed(plane_without_walls(manner) +
                  "[[box]]\nname = \"arm\"\nsize = [1.2, 0.1]\nmass = 2\nposition = [0, 0]\n"
                  "[[joint]]\ntype = \"slider\"\nbetween = [\"arm\", \"room\"]\n"
                  "motor = { speed = \"sin(3*t)\", most = 100 }\n");
    EXPECT_NEAR(speed.at(1.3).bodies[0].velocity.x(), std::sin(3.9), manner.name == "iterative" ? 1e-6 : 1e-8)
        << manner.name;
    EXPECT_NEAR(speed.place(1.3, 0).x(), (1 - std::cos(3.9)) / 3, bound) << manner.name;
  }
}

// A lift with a load of m altogether follows s = t from rest. Until it is at its aim its motor gives all that
// it has, F; from there its lag dies away:
//   a t0 = 1 + k e,  e = t0 - a t0^2 / 2,  a = F / m - g        then y = t - e exp(-k (t - t0))
// at whatever rate, and however strong the motor: it is there within a step.
TEST(JointMotor, IsAtItsAimWithinAStepAndHoldsIt) {
  const double m = 180, k = 30;
  for (const Manner& manner : kManners) {
    if (manner.name == "iterative") continue;
    for (const bool space : {false, true}) {
      for (const double most : {3e4, 1e6}) {
        const double a = most / m - kEarth;
        const double t0 = (k - a + std::sqrt((a - k) * (a - k) + 2 * k * a)) / (k * a);
        const double lag = t0 - 0.5 * a * t0 * t0;
        for (const int rate : {30, 60, 600}) {
          const std::string z = space ? ", 0" : "";
          TextRun scene((space ? space_without_walls(manner) : plane_without_walls(manner)) +
                            fmt::format("[[box]]\nname = 'cab'\nsize = [1, 1{0}]\nmass = 100\n"
                                        "position = [0, 0{1}]\n[[ball]]\nname = 'man'\nradius = 0.2\n"
                                        "mass = 80\nposition = [0, 0.7{1}]\nelasticity = 0\n"
                                        "[[joint]]\ntype = 'slider'\nbetween = ['cab', 'room']\n"
                                        "axis = [0, 1{1}]\nmotor = {{ position = '1*t', most = {2} }}\n",
                                        space ? ", 1" : "", z, most),
                        {fmt::format("physics.rate={}", rate)});
          const std::size_t cab = number_of(scene, "cab"), man = number_of(scene, "man");
          for (const double t : {0.1, 0.5, 1.0}) {
            const sim::Snapshot now = scene.at(t);
            const double e = lag * std::exp(-k * (t - t0));
            const std::string where =
                fmt::format("{} {} {} /s, {} N, {} s", manner.name, space ? "space" : "plane", rate, most, t);
            // the scheme's error of the lag
            EXPECT_NEAR(now.bodies[cab].position.y(), t - e, 1e-7) << where;
            EXPECT_NEAR(now.bodies[man].position.y(), t - e + 0.7, 1e-7) << where;
            EXPECT_NEAR(now.joints[0].force.y(), m * (kEarth - k * k * e), 0.02) << where;
          }
        }
      }
    }
  }
}

// Watt's linkage is driven: a torque that hardly depends on the rate, far below what the motor has, by an
// angle of the time and by a speed that it has to come to from rest.
TEST(JointMotor, DrivesALinkageAtAnyRate) {
  for (const Manner& manner : kManners) {
    if (manner.name == "iterative") continue;
    for (const char* motor : {"angle = '20*sin(180*t*deg)', most = 500", "speed = 20, most = 5000"}) {
      const auto torque = [&](int rate, double t) {
        TextRun scene(
            plane_without_walls(manner) +
                fmt::format("[[box]]\nname = 'left'\nsize = [1.5, 0.06]\nmass = 1\nposition = [1.75, 2.3]\n"
                            "[[box]]\nname = 'right'\nsize = [1.5, 0.06]\nmass = 1\nposition = [3.25, 1.7]\n"
                            "[[box]]\nname = 'coupler'\nsize = [0.06, 0.6]\nmass = 0.5\nposition = [2.5, 2]\n"
                            "[[joint]]\ntype = 'pin'\nbetween = ['left', 'room']\nat = [1, 2.3]\n"
                            "motor = {{ {} }}\n"
                            "[[joint]]\ntype = 'pin'\nbetween = ['right', 'room']\nat = [4, 1.7]\n"
                            "[[joint]]\ntype = 'pin'\nbetween = ['left', 'coupler']\nat = [2.5, 2.3]\n"
                            "[[joint]]\ntype = 'pin'\nbetween = ['right', 'coupler']\nat = [2.5, 1.7]\n",
                            motor),
            {fmt::format("physics.rate={}", rate)});
        return scene.at(t).joints[0].torque.z();
      };
      for (const double t : {0.1, 0.5}) {
        const double fine = torque(1200, t);
        EXPECT_GT(std::abs(fine), 10) << motor;
        EXPECT_LT(std::abs(fine), 30) << motor;
        for (const int rate : {30, 60, 600})
          EXPECT_NEAR(torque(rate, t), fine, 1e-4) << manner.name << motor << rate << " " << t;
      }
    }
  }
}

// A motor that is too weak falls behind, and its force is what it has.
TEST(JointMotor, ThatIsTooWeakGivesAllItHas) {
  for (const Manner& manner : kManners) {
    TextRun scene(plane_without_walls(manner, "gravity = [0, 0]") +
                  "[[box]]\nname = \"sled\"\nsize = [0.4, 0.4]\nmass = 2\nposition = [0, 0]\n"
                  "[[joint]]\ntype = \"slider\"\nbetween = [\"sled\", \"room\"]\n"
                  "motor = { speed = \"10*t\", most = 6 }\n");
    EXPECT_NEAR(scene.at(0.8).bodies[0].velocity.x(), 3 * 0.8, 1e-6) << manner.name;
  }
}

// A screw that falls turns: m g = (m + I (2 pi / pitch)^2) a.
TEST(Screw, TurnsAsItGoes) {
  const double pitch = 0.5, r = 2 * std::numbers::pi / pitch, i = 2.0 / 12 * (0.4 * 0.4 + 0.4 * 0.4);
  const double a = 2 * kEarth / (2 + i * r * r);
  for (const Manner& manner : kManners) {
    TextRun scene(
        "duration = 1000\n[room]\nsize = [20, 20, 20]\ncorner = [-10, -10, -10]\nwalls = \"none\"\n" +
        manner.keys +
        "\n[[box]]\nname = \"nut\"\nsize = [0.4, 0.3, 0.4]\nmass = 2\nposition = [0, 0, 0]\n"
        "[[joint]]\ntype = \"screw\"\nbetween = [\"nut\", \"room\"]\naxis = [0, 1, 0]\npitch = 0.5\n");
    for (const double t : {0.5, 1.7}) {
      const sim::Snapshot now = scene.at(t);
      EXPECT_NEAR(now.bodies[0].velocity.y(), -a * t, 1e-7) << manner.name << t;
      EXPECT_NEAR(now.bodies[0].spin.y(), -a * t * r, 1e-6) << manner.name << t;
      EXPECT_NEAR(now.bodies[0].position.y(), -0.5 * a * t * t, manner.name == "iterative" ? 1e-6 : 1e-8)
          << manner.name << t;
    }
  }
}

// --- what is wrong is told

TEST(JointMotor, FaultsAreTold) {
  const std::string room =
      "duration = 1\n[room]\nsize = [8, 8]\n[[box]]\nname = \"b\"\nsize = [1, 1]\nposition = [4, 4]\n"
      "[[joint]]\nbetween = [\"b\", \"room\"]\n";
  using testing::HasSubstr;
  EXPECT_THAT(refusal(room + "type = \"pin\"\nmotor = { speed = \"sinn(t)\", most = 1 }\n"),
              HasSubstr("column 1"));
  EXPECT_THAT(refusal(room + "type = \"pin\"\nmotor = { position = \"t\", most = 1 }\n"),
              HasSubstr("'position' is that of a slider"));
  EXPECT_THAT(refusal(room + "type = \"pin\"\nmotor = { most = 1 }\n"), HasSubstr("a motor needs"));
  EXPECT_THAT(refusal(room + "type = \"slider\"\nspring = { stiffness = 1, rest_angle = 2 }\n"),
              HasSubstr("'rest_angle' is that of a pin"));
  EXPECT_THAT(refusal(room + "type = \"screw\"\n"), HasSubstr("a screw is of space"));
}

TEST(Pulley, FaultsAreTold) {
  const std::string room =
      "duration = 1\n[room]\nsize = [8, 8]\n[[particle]]\nname = \"p\"\nposition = [1, 1]\n"
      "[[ball]]\nname = \"w\"\nradius = 0.5\nposition = [4, 4]\n";
  using testing::HasSubstr;
  const auto pulley = [&](const std::string& keys) { return room + "[[joint]]\ntype = \"pulley\"\n" + keys; };
  EXPECT_THAT(refusal(pulley("between = [\"p\", [2, 2]]\n")), HasSubstr("needs 'over'"));
  EXPECT_THAT(refusal(pulley("over = [[2, 2]]\n")), HasSubstr("needs 'between'"));
  EXPECT_THAT(refusal(pulley("between = [[1, 2], [2, 2]]\nover = [[3, 3]]\n")), HasSubstr("could move"));
  EXPECT_THAT(refusal(pulley("between = [\"p\", [4, 4.2]]\nover = [\"w\"]\n")),
              HasSubstr("inside the other's wheel"));
  EXPECT_THAT(refusal(pulley("between = [\"p\", [6, 1]]\nover = [\"w\"]\nlimits = [0, 1]\n")),
              HasSubstr("a pulley has no 'limits'"));
  EXPECT_THAT(refusal(room + "[[joint]]\ntype = \"rope\"\nbetween = [\"p\", [2, 2]]\nover = [[3, 3]]\n"),
              HasSubstr("'over' is that of a pulley"));
  EXPECT_EQ(refusal(pulley("between = [\"p\", [6, 1]]\nover = [\"w\"]\n")), "");
}

TEST(Gear, FaultsAreTold) {
  const std::string room =
      "duration = 1\n[room]\nsize = [8, 8]\n[[ball]]\nname = \"a\"\nradius = 0.5\nposition = [2, 4]\n"
      "[[ball]]\nname = \"b\"\nradius = 0.5\nposition = [4, 4]\n"
      "[[joint]]\nname = \"p\"\ntype = \"pin\"\nbetween = [\"a\", \"room\"]\n"
      "[[joint]]\nname = \"q\"\ntype = \"rope\"\nbetween = [\"b\", [4, 6]]\n";
  using testing::HasSubstr;
  const auto gear = [&](const std::string& keys) { return room + "[[joint]]\ntype = \"gear\"\n" + keys; };
  EXPECT_THAT(refusal(gear("joints = [\"p\", \"pp\"]\nratio = 2\n")), HasSubstr("no joint is called 'pp'"));
  EXPECT_THAT(refusal(gear("joints = [\"p\", \"q\"]\nratio = 2\n")), HasSubstr("no angle and no way"));
  // one that names itself, or another gear
  EXPECT_THAT(refusal(gear("name = \"g\"\njoints = [\"p\", \"g\"]\nratio = 2\n")),
              HasSubstr("no angle and no way"));
  EXPECT_THAT(refusal(gear("joints = [\"p\", \"p\"]\nratio = 2\n")), HasSubstr("these are one"));
  EXPECT_THAT(refusal(gear("joints = [\"p\", \"p\"]\n")), HasSubstr("needs 'ratio'"));
  EXPECT_THAT(refusal(gear("between = [\"a\", \"b\"]\n")), HasSubstr("leave out 'between'"));
  // wheels about one place have no teeth that meet
  EXPECT_THAT(
      refusal(room + "[[ball]]\nname = \"c\"\nposition = [2, 4]\n[contact]\nignore = [[\"a\", \"c\"]]\n"
                     "[[joint]]\nname = \"r\"\ntype = \"pin\"\nbetween = [\"c\", \"room\"]\n"
                     "[[joint]]\ntype = \"gear\"\njoints = [\"p\", \"r\"]\nratio = 2\nbreaks = 3\n"),
      HasSubstr("no teeth whose force could break it"));
}

// The links of a chain carry gears, springs of pins and ropes as other bodies do: the same motion with the
// chain and without it, by the direct solver to rounding, for there both hold joints exactly.
TEST(Mechanisms, OnTheLinksOfChainsAreAsOnOtherBodies) {
  const std::string text =
      "duration = 2\n[room]\nsize = [8, 6]\nwalls = \"none\"\n[contact]\nignore = [[\"g\", \"g\"]]\n"
      "[[box]]\nname = \"arm\"\ngroup = \"g\"\nsize = [1.2, 0.1]\nposition = [3.6, 4]\nmass = 1\n"
      "[[ball]]\nname = \"sun\"\ngroup = \"g\"\nradius = 0.3\nposition = [3.3, 4]\nmass = 1\n"
      "[[ball]]\nname = \"planet\"\ngroup = \"g\"\nradius = 0.2\nposition = [3.8, 4]\nmass = 0.5\n"
      "[[particle]]\nname = \"weight\"\ngroup = \"g\"\nposition = [5.5, 3]\nmass = 0.4\n"
      "[[joint]]\ntype = \"pin\"\nbetween = [\"arm\", \"room\"]\nat = [3, 4]\n"
      "[[joint]]\nname = \"s\"\ntype = \"pin\"\nbetween = [\"sun\", \"arm\"]\nat = [3.3, 4]\n"
      "[[joint]]\nname = \"p\"\ntype = \"pin\"\nbetween = [\"planet\", \"arm\"]\nat = [3.8, 4]\n"
      "spring = { stiffness = 3, rest_angle = 90 }\n"
      "[[joint]]\nname = \"g\"\ntype = \"gear\"\njoints = [\"s\", \"p\"]\nratio = -0.6666666666666666\n"
      "[[joint]]\nname = \"rope\"\ntype = \"pulley\"\nbetween = [{ body = \"arm\", at = \"right\" }, "
      "\"weight\"]\n"
      "over = [[5.5, 5]]\n";
  TextRun loose(text), linked(text + "[[chain]]\nof = [\"arm\", \"sun\", \"planet\"]\n");
  const double begun = linked.at(0).energies.total();
  for (const double t : {0.3, 0.8}) {
    const sim::Snapshot a = loose.at(t), b = linked.at(t);
    for (std::size_t i = 0; i < a.bodies.size(); ++i) {
      EXPECT_NEAR((a.bodies[i].position - b.bodies[i].position).norm(), 0, 1e-10) << i;
      EXPECT_NEAR(a.bodies[i].angle, b.bodies[i].angle, 1e-10) << i;
    }
    for (std::size_t i = 0; i < a.joints.size(); ++i)
      EXPECT_NEAR((a.joints[i].force - b.joints[i].force).norm(), 0, 1e-9) << i;
    EXPECT_NEAR(b.energies.total(), begun, 1e-9);
  }
}

// Pieces of a rope have their numbers from the end that is written first, whichever end is fast.
// a rope that is wound on a wheel: m g = (m + I/r^2) a of a winch, a = g/(1 + I/(m r^2)) of a yo-yo
TEST(Pulley, ARopeIsWoundOnAWheelAtItsEnd) {
  for (const char* const manner : {"solver = 'direct'", "solver = 'iterative'", "collision = 'event'"}) {
    for (const double side : {-1, 1}) {
      for (const bool turned : {false, true}) {
        const std::string between = turned ? "between = ['drum', 'load']\n" : "between = ['load', 'drum']\n";
        TextRun winch(
            fmt::format("duration = 2\n[room]\nsize = [8, 8]\nwalls = 'none'\n[physics]\n{}\n"
                        "[[ball]]\nname = 'drum'\nradius = 0.3\nmass = 4\nposition = [4, 6]\n"
                        "[[joint]]\ntype = 'pin'\nbetween = ['drum', 'room']\n"
                        "[[particle]]\nname = 'load'\nmass = 1\nposition = [{}, 5]\n"
                        "[[joint]]\nname = 'rope'\ntype = 'pulley'\n{}over = ['drum']\n",
                        manner, 4 + 0.3 * side, between));
        const sim::Snapshot now = winch.at(0.5);
        const double a = 9.81 / (1 + 2);  // I/r^2 = M/2
        EXPECT_NEAR(now.bodies[number_of(winch, "load")].velocity.y(), -0.5 * a, 1e-6) << manner;
        EXPECT_NEAR(now.bodies[number_of(winch, "drum")].spin.z(), -side * 0.5 * a / 0.3, 1e-5) << manner;
        EXPECT_NEAR(now.joints[1].force.norm(), 9.81 - a, 1e-5) << manner;

        TextRun yoyo(
            fmt::format("duration = 2\n[room]\nsize = [8, 8]\nwalls = 'none'\n[physics]\n{}\n"
                        "[[ball]]\nname = 'drum'\nradius = 0.3\nmass = 4\nposition = [4, 5]\n"
                        "[[joint]]\nname = 'rope'\ntype = 'pulley'\nbetween = {}\nover = ['drum']\n",
                        manner,
                        turned ? fmt::format("['drum', [{}, 7]]", 4 + 0.3 * side)
                               : fmt::format("[[{}, 7], 'drum']", 4 + 0.3 * side)));
        const sim::Snapshot then = yoyo.at(0.5);
        EXPECT_NEAR(then.bodies[0].velocity.y(), -0.5 * 9.81 / 1.5, 1e-6) << manner;
        EXPECT_NEAR(then.bodies[0].velocity.x(), 0, 1e-6) << manner;
        EXPECT_NEAR(then.bodies[0].spin.z(), side * -0.5 * 9.81 / 1.5 / 0.3 * -1, 1e-5) << manner;
      }
    }
  }
}

TEST(Pulley, PiecesAreNumberedFromTheFirstEnd) {
  const std::string yoyo =
      "duration = 1\n[room]\nsize = [4, 4]\nwalls = \"none\"\n[[ball]]\nname = \"disc\"\nradius = 0.2\nmass "
      "= 1\n"
      "position = [2, 3.4]\n[[particle]]\nname = \"end\"\nmass = 1e-6\nposition = [2.2, 3]\n"
      "[[joint]]\nname = \"string\"\ntype = \"pulley\"\nover = [\"disc\"]\nbetween = ";
  for (const bool turned : {false, true}) {
    const TextRun run(yoyo + (turned ? "[\"end\", [1.8, 4]]\n" : "[[1.8, 4], \"end\"]\n"));
    const sim::Snapshot now = run.at(0.3);
    // a yo-yo falls with 2/3 g, its string bears m g / 3
    EXPECT_NEAR(now.bodies[number_of(run, "disc")].position.y(), 3.4 - kEarth / 3 * 0.09, 1e-5);
    const auto& joints = run.run->scene_info().joints;
    const auto force = [&](const std::string& name) {
      const auto it =
          std::find_if(joints.begin(), joints.end(), [&](const auto& its) { return its.name == name; });
      return now.joints.at(std::size_t(it - joints.begin())).force.norm();
    };
    EXPECT_NEAR(force(turned ? "string[1]" : "string[0]"), kEarth / 3, 1e-4) << turned;
    EXPECT_LT(force(turned ? "string[0]" : "string[1]"), 1e-4) << turned;
  }
}

// A car whose motors turn light wheels: their work is what it moves with, though within a step they would
// turn the wheels far faster than the road lets them.
TEST(Mechanisms, AMotorsWorkIsWhatTheCarMovesWith) {
  for (const Manner& manner : kManners) {
    for (const int rate : {60, 600}) {
      const TextRun run(
          "duration = 9\n[room]\nsize = [30, 4]\nwalls = \"ground\"\n" + manner.keys +
          fmt::format("\nrate = {}\n", rate) +
          "[[box]]\nname = \"car\"\nsize = [2, 0.3]\nmass = 6\nposition = [5, 0.4]\nelasticity = 0\n"
          "[[ball]]\nname = \"wheel\"\nradius = 0.2\nmass = 0.05\nposition = [4.2, 0.2]\ncopies = { count = "
          "2, offset = "
          "[1.6, 0] }\nfriction = 0.8\nelasticity = 0\n[[joint]]\ntype = \"pin\"\nbetween = [{ body = "
          "\"wheel[0..1]\", at = \"center\" }, \"car\"]\nmotor = { speed = -1e6, most = 0.5 }\n");
      const sim::Snapshot now = run.at(2);
      EXPECT_NEAR(now.energies.work, now.energies.kinetic, 1e-4) << manner.name << rate;
    }
  }
}

// A weight that goes straight up to the rim of its wheel, on either side.
TEST(Mechanisms, ARopeThatEndsAtTheRimEndsTheRun) {
  for (const double side : {1.0, -1.0}) {
    for (const std::string friction : {"", "friction = 0.1\n"}) {
      const TextRun run(
          plane_without_walls(kManners[0]) +
          "[[ball]]\nname = \"w\"\nradius = 0.3\nmass = 1\nposition = [0, 0]\n" +
          (friction.empty() ? "[[joint]]\ntype = \"pin\"\nbetween = [\"w\", \"room\"]\n" : "fixed = true\n") +
          fmt::format("[[particle]]\nname = \"a\"\nmass = 5\nposition = [{}, -1]\n[[particle]]\nname = "
                      "\"b\"\nmass = 1\nposition = [{}, -1]\n",
                      -0.3 * side, 0.3 * side) +
          "[[joint]]\nname = \"rope\"\ntype = \"pulley\"\nbetween = [\"a\", \"b\"]\nover = [\"w\"]\n" +
          friction + "[contact]\nignore = [[\"w\", \"a\"], [\"w\", \"b\"]]\n");
      EXPECT_THROW(run.at(2), std::runtime_error) << side << friction;
    }
  }
}

// A belt from one wheel to a larger one: both turn the same way, and it pushes no axle aside.
TEST(Mechanisms, ABeltTurnsBothWheelsTheSameWay) {
  for (const Manner& manner : kManners) {
    const TextRun run(
        plane_without_walls(manner, "gravity = [0, 0]") +
        "[[ball]]\nname = \"a\"\nradius = 0.2\nmass = 1\nposition = [-1, 0]\n[[ball]]\nname = "
        "\"b\"\nradius = 0.6\nmass = 2\nposition = [1, 0.3]\n[[joint]]\nname = \"p\"\ntype = "
        "\"pin\"\nbetween = [\"a\", \"room\"]\n[[joint]]\nname = \"q\"\ntype = \"pin\"\nbetween = "
        "[\"b\", \"room\"]\n[[joint]]\nname = \"belt\"\ntype = \"gear\"\njoints = [\"p\", "
        "\"q\"]\nratio = 3\n[[force]]\nof = \"a\"\ntorque = \"0.1\"\n");
    const sim::Snapshot now = run.at(2);
    const double alpha = 0.1 / (0.5 * 0.04 + 0.5 * 2 * 0.36 / 9);
    EXPECT_NEAR(now.bodies[0].spin.z(), 2 * alpha, 1e-8) << manner.name;
    EXPECT_NEAR(now.bodies[1].spin.z(), 2 * alpha / 3, 1e-8) << manner.name;
    EXPECT_NEAR(now.bodies[0].held.norm() + now.bodies[1].held.norm(), 0, 1e-8) << manner.name;
  }
}

}  // namespace
}  // namespace obscura::scene

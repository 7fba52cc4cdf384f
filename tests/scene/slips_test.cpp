// Under `event` a slip begins, turns and ends at its own time, however many contacts share a load: scenes
// against closed forms, at few steps a second and many.

#include <cmath>
#include <numbers>

#include "scene/text_run.h"

namespace obscura::scene {
namespace {

constexpr double kRounding = 1e-12;  // m, of some metres and 600 steps

// bodies of a room after some time, g = 10 m/s^2
sim::Snapshot slid_until(double t, bool space, int rate, const std::string& bodies) {
  const std::string room =
      fmt::format("[physics]\ncollision = \"event\"\nrate = {}\n[room]\nsize = {}\ngravity = {}\n", rate,
                  space ? "[40, 8, 40]" : "[40, 8]", space ? "[0, -10, 0]" : "[0, -10]");
  return TextRun(room + bodies).at(t);
}

// A force along x that is 5 N at t0 and grows by 2 N a second, against friction of at most 5 N on 1 kg:
//   x = (t - t0)^3 / 3
// where the slip begins within a step, and where it begins with one.
TEST(Slips, BeginWhereFrictionIsUsedUp) {
  const std::string box = "[[box]]\nname = \"b\"\nsize = [0.4, 0.2{1}]\nposition = [2, {0}{2}]\nmass = 1\n";
  const auto rubbing = [&](bool space) {
    return fmt::format(fmt::runtime(box), 0.1, space ? ", 0.3" : "", space ? ", 0" : "") +
           "friction = 0.5\nelasticity = 0\n";
  };
  const auto held = [&](bool space, const std::string& by) {
    return fmt::format(fmt::runtime(box), 1, space ? ", 0.3" : "", space ? ", 0" : "") +
           fmt::format("[[joint]]\ntype = \"slider\"\nbetween = [\"b\", \"room\"]\naxis = {}\n{}\n",
                       space ? "[1, 0, 0]" : "[1, 0]", by);
  };
  for (const bool space : {false, true}) {
    const std::string point =
        fmt::format("[[particle]]\nname = \"b\"\nposition = {}\nmass = 1\nfriction = 0.5\nelasticity = 0\n",
                    space ? "[2, 0, 0]" : "[2, 0]");
    for (const std::string& body :
         {point, rubbing(space), rubbing(space) + "rotation = false\n", held(space, "friction = 5"),
          held(space, "motor = { speed = 0, most = 5 }")}) {
      for (const int rate : {50, 600}) {
        for (const double t0 : {0.1037, 0.5}) {
          for (const double sign : {1.0, -1.0}) {
            const sim::Snapshot at =
                slid_until(t0 + 1.5, space, rate,
                           body + fmt::format("[[force]]\nof = \"b\"\ncomponents = [\"{}*(5 + "
                                              "2*(t - {})) \", \"0\"{}]\n",
                                              sign, t0, space ? ", \"0\"" : ""));
            EXPECT_NEAR(at.bodies[0].position.x(), 2 + sign * 1.125, kRounding)
                << body << space << " " << rate << " " << t0 << " " << sign;
          }
        }
      }
    }
  }
}

// What flies touches nothing, by every scheme: x = 2 + 3 t, and y = 6 - 5 t^2, to the first order in the
// step.
TEST(Slips, WhatFliesIsHeldByNothingByEveryScheme) {
  for (const bool space : {false, true}) {
    for (const std::string scheme : {"rk4", "midpoint", "semi-implicit", "euler"}) {
      const std::string ball = fmt::format(
          "[[ball]]\nname = \"b\"\nradius = 0.2\nposition = [2, 6{0}]\nvelocity = [3, 0{0}]\nelasticity = "
          "0.8\n",
          space ? ", 0" : "");
      const std::string text = fmt::format(
          "[physics]\ncollision = \"event\"\nintegrator = \"{}\"\nrate = 600\n[room]\nsize = {}\ngravity = "
          "{}\n",
          scheme, space ? "[40, 8, 40]" : "[40, 8]", space ? "[0, -10, 0]" : "[0, -10]");
      const TextRun run(text + ball);
      const sim::Vec3 flying = run.place(0.7);
      EXPECT_NEAR(flying.x(), 4.1, 0.01) << scheme << space;
      EXPECT_NEAR(flying.y(), 6 - 5 * 0.49, 10 * 0.7 / 600) << scheme << space;
      // it has bounced, and rests in the end
      EXPECT_GT(run.place(1.5).y(), 0.3) << scheme << space;
      EXPECT_NEAR(run.place(12).y(), 0.2, 1e-3) << scheme << space;
    }
  }
}

// A load on a rope that is lifted by 20 N a second is weightless after half a second, and then free:
//   y = y0 + 20 (t - 0.5)^3 / 6
TEST(Slips, ARopeLetsGoWhereItNoLongerPulls) {
  for (const bool space : {false, true}) {
    for (const int rate : {60, 70, 600}) {
      const char* z = space ? ", 0" : "";
      const sim::Snapshot at =
          slid_until(1.1, space, rate,
                     fmt::format("[[ball]]\nname = \"b\"\nradius = 0.1\nmass = 1\nposition = [2, 1{0}]\n"
                                 "[[joint]]\ntype = \"rope\"\nbetween = [\"b\", [2, 3{0}]]\n"
                                 "[[force]]\nof = \"b\"\ncomponents = [\"0\", \"20*t\"{1}]\n",
                                 z, space ? ", \"0\"" : ""));
      EXPECT_NEAR(at.bodies[0].position.y(), 1 + 20 * 0.6 * 0.6 * 0.6 / 6, kRounding) << space << rate;
    }
  }
}

// A spring whose far end goes at 0.3 m/s pulls a block of 1 kg by jerks: it sticks until k v t is what
// friction bears, and then x = v t - v/w sin(w t), w^2 = k/m, which has no speed once a period and at once
// goes on.
TEST(Slips, AStopAtTheLimitOfFrictionIsNone) {
  const double k = 20, v = 0.3, w = std::sqrt(k), begins = 0.4 * 10 / (k * v), t = 3.9 - begins;
  const std::string bodies =
      "[[box]]\nname = \"b\"\nsize = [0.4, 0.2]\nmass = 1\nposition = [3, 0.1]\nfriction = 0.4\nelasticity = "
      "0\n"
      "[[particle]]\nname = \"hand\"\nposition = [5, 0.1]\nmotion = { x = \"0.3*t\" }\n"
      "[[spring]]\nbetween = [\"b\", \"hand\"]\nstiffness = 20\n";
  const auto off = [&](int rate) {
    return slid_until(3.9, false, rate, bodies).bodies[1].position.x() -
           (3 + v * t - v / w * std::sin(w * t));
  };
  EXPECT_NEAR(off(60), 0, 1e-7);
  EXPECT_NEAR(off(600), 0, 1e-11);  // 1e-7 less four powers of ten
}

// A puck that is pushed across a slope steeper for it than friction allows, by n = mu/tan(slope) times: with
// a the pull along the slope, v its speed and u what of it goes down,
//   n v + u = n v0 - (n^2 - 1) a t
// until it stops. It turns downhill ever faster as it gets slower.
TEST(Slips, APuckAcrossASlopeTurnsAsItStops) {
  const double n = 2, a = 2, v0 = 3;
  for (const std::string shape : {"[[particle]]\nposition = [0, 0, 0]\n",
                                  "[[box]]\nsize = [0.4, 0.2, 0.3]\nposition = [0, 0.1, 0]\n"}) {
    for (const int rate : {60, 600}) {
      const std::string bodies = shape +
                                 "velocity = [0, 0, 3]\nmass = 1\nfriction = 0.4\nelasticity = 0\n"
                                 "[[force]]\ncomponents = [\"2\", \"0\", \"0\"]\n";
      for (const double t : {0.5, 0.9, 0.99, 0.999}) {
        const sim::Vec3 v = slid_until(t, true, rate, bodies).bodies[0].velocity;
        EXPECT_NEAR(n * v.norm() + v.x(), n * v0 - (n * n - 1) * a * t, 1e-6) << shape << rate << " " << t;
      }
      const sim::Vec3 v = slid_until(1.01, true, rate, bodies).bodies[0].velocity;
      EXPECT_NEAR(v.norm(), 0, 1e-12) << shape << rate;
    }
  }
}

// A wheel whose dry friction is just what drives it, and a bead on a wire that nothing presses, go on.
TEST(Slips, WhatNothingAcceleratesGoesOn) {
  for (const std::string mode : {"contact", "event"}) {
    const std::string room =
        "duration = 9\n[room]\nsize = [4, 4]\nwalls = \"none\"\ngravity = [0, 0]\n[physics]\ncollision = \"" +
        mode + "\"\n";
    const TextRun wheel(
        room +
        "[[ball]]\nname = \"w\"\nposition = [2, 2]\nradius = 0.5\nspin = 90\n[[joint]]\ntype = "
        "\"pin\"\nbetween = [\"w\", \"room\"]\nfriction = 1\n[[force]]\nof = \"w\"\ntorque = "
        "\"1\"\n");
    EXPECT_NEAR(wheel.at(2).bodies[0].spin.z(), std::acos(0.0), 1e-12) << mode;
    const TextRun bead(
        room +
        "[[particle]]\nname = \"w\"\nposition = [1, 2]\nvelocity = [0.5, 0]\n[[track]]\npoints = [[0, "
        "2], [4, 2]]\nthread = [\"w\"]\nfriction = 0.3\n");
    EXPECT_NEAR(bead.place(2).x(), 2, 1e-12) << mode;
  }
}

// Where a slip would jam (its 1/m + r_x^2/I - mu |r_x r_y|/I is near or below zero), a contact that sticks
// has other forces beside its own, without bounds: it goes on sticking, whatever taking back the step's error
// of energy does to its velocities. A disc that rolls about a centre beside its own, and a top on a sharp
// tip.
TEST(Slips, WhatSticksWhereASlipWouldJamGoesOnSticking) {
  const auto run = [](const char* mode, int rate, const std::string& rest) {
    return TextRun(fmt::format("duration = 1\n[physics]\nrate = {}\n{}\n[room]\nwalls = \"ground\"\n{}", rate,
                               mode, rest));
  };
  const std::string disc =
      "size = [9, 4]\n[[ball]]\nname = \"b\"\nradius = 0.2\nmass = 1\ninertia = 0.003\ncenter_of_mass = "
      "[-0.08196887957447481, -0.08096695335710483]\nfriction = 0.7\nelasticity = 0\nposition = [0, "
      "0.2]\nangle = -96\nspin = -825.3305652896119\nvelocity = [4.177131329372834, 1.036497472036564]\n";
  const std::string top =
      "size = [4, 4, 4]\n[[body]]\nname = \"t\"\nshapes = [{ points = [[0, -0.2, 0], [0.05, 0, 0.05], "
      "[-0.05, "
      "0, 0.05], [0.05, 0, -0.05], [-0.05, 0, -0.05]] }]\nmass = 0.5\ninertia = [0.002, 0.004, "
      "0.002]\ncenter_of_mass = [0, 0, 0]\nfriction = 1.0\nelasticity = 0\norientation = [0, 0, "
      "-10]\nposition = [0.034729635533386066, 0.1969615506024416, 0]\nspin = [1193.9169240543583, "
      "6771.039345523381, 0]\n";
  for (const char* mode : {"solver = \"direct\"", "collision = \"event\"", "solver = \"iterative\""})
    for (const int rate : {60, 240, 600}) {
      const TextRun rolls = run(mode, rate, disc);
      EXPECT_NEAR(rolls.at(0.4).bodies[0].spin.z(), -8.0311119, 1e-4) << mode << rate;
      EXPECT_NEAR(rolls.at(1).energies.total(), 4.0015166, 1e-4) << mode << rate;
      // Euler's equations of a top about a point that stays, by Runge and Kutta's scheme at small steps
      const TextRun turns = run(mode, rate, top);
      const double begun = turns.at(0).energies.total();
      const sim::Snapshot end = turns.at(1);
      EXPECT_LT((end.bodies[0].position - sim::Vec3(-0.0285919, 0.1961467, -0.0266290)).norm(), 1e-5)
          << mode << rate;
      EXPECT_NEAR(end.energies.total(), begun, 3e-6) << mode << rate;
    }
}

// A force that begins at zero, or sets in within a step, moves what lies there without friction from then on.
//   v = 2 (1 - cos 5 t)
TEST(Slips, WhatNothingRubsFeelsAForceFromItsFirstInstant) {
  for (const char* mode : {"solver = \"direct\"", "collision = \"event\"", "solver = \"iterative\""})
    for (const bool space : {false, true})
      for (const int rate : {30, 60, 600}) {
        const TextRun scene(fmt::format(
            "duration = 1\n[physics]\nrate = {}\n{}\n[room]\nsize = {}\n[[box]]\nname = \"b\"\nsize = "
            "{}\nmass = "
            "1\nfriction = 0\nelasticity = 0\nposition = {}\n[[force]]\nof = \"b\"\ncomponents = {}\n",
            rate, mode, space ? "[40, 8, 40]" : "[40, 8]", space ? "[0.4, 0.2, 0.4]" : "[0.4, 0.2]",
            space ? "[4, 0.1, 4]" : "[4, 0.1]",
            space ? "[\"10*sin(5*t)\", \"0\", \"0\"]" : "[\"10*sin(5*t)\", \"0\"]"));
        EXPECT_NEAR(scene.at(1).bodies[0].velocity.x(), 2 * (1 - std::cos(5.0)), 5e-7)
            << mode << space << rate;
      }
}

// A ball that slides on a plate that turns: its slip turns as it comes to where the plate goes another way.
// Friction is against the way it slides, which is that of the middle of a substep.
TEST(Slips, OnAPlateThatTurnsFrictionTurnsWithTheSlip) {
  const auto ended = [](const std::string& physics) {
    const TextRun scene(
        "duration = 1\n[room]\nsize = [20, 6, 20]\nfriction = 0\n[physics]\n" + physics +
        "\n[[box]]\nname = 'table'\nposition = [0, 0.1, 0]\nsize = [8, 0.2, 8]\nmass = 1000\nspin = [0, 100, "
        "0]\nfriction = 0.05\nelasticity = 0\n" +
        disc("r", 1, 0.1, "position = [0, 0.3, 0]\nvelocity = [0.5, 0, 0]\nfriction = 0.05\nelasticity = 0"));
    return scene.at(0.3).bodies[number_of(scene, "r")];
  };
  const sim::Snapshot::Body right = ended("collision = 'event'\nrate = 1920");
  for (const int rate : {60, 240, 960}) {
    const sim::Snapshot::Body now = ended(fmt::format("solver = 'iterative'\nrate = {}", rate));
    EXPECT_LT((now.velocity - right.velocity).norm(), 3e-6 * right.velocity.norm()) << rate;
    EXPECT_LT((now.spin - right.spin).norm(), 3e-6 * right.spin.norm()) << rate;
  }
}

// A crate that does not turn, on a table that turns ever faster beneath it: its corners share the load, and
// each rubs against where the table goes there. Place after 1.769468 s by a quarter of the weight on each
// corner and Coulomb's law at each, integrated by Runge and Kutta.
TEST(Slips, OnATableThatTurnsCornersOfWhatDoesNotShareTheLoad) {
  for (const char* solver : {"direct", "iterative"}) {
    for (const int rate : {60, 240}) {
      const TextRun scene(fmt::format(
          "duration = 2\n[room]\nsize = [40, 20, 40]\nwalls = 'none'\n[physics]\nsolver = '{}'\nrate = {}\n"
          "[[box]]\nsize = [10, 0.2, 10]\nposition = [0, 4.9, 0]\nmotion = {{ angle = "
          "'42.97183463481174 * t^2' }}\nfriction = 0.4\n[[box]]\nname = 'crate'\nsize = [0.02, 0.02, "
          "0.02]\nmass = 1\nposition = [1, 5.01, 0]\nfriction = 0.4\nelasticity = 0\nrotation = false\n",
          solver, rate));
      const sim::Vec3 there = scene.at(1.769468).bodies[number_of(scene, "crate")].position;
      EXPECT_NEAR(there.x(), -0.73189, 2e-3 * 60 / rate) << solver << rate;
      EXPECT_NEAR(there.z(), -0.89586, 2e-3 * 60 / rate) << solver << rate;
    }
  }
}

// A box on a free box under a push that grows: it begins to slide where the push is mu m g, and goes faster
// by what is more. While it is slow, its friction as a whole brings it to rest within a substep, though that
// of each of its corners does not, and no guess says which way it goes.
TEST(Slips, OnAFreeBoxAGrowingPushMovesWhatItShould) {
  const double begins = 0.3 * 9.81 / 2, t = 1.8;
  const double right = t * t - begins * begins - 2 * begins * (t - begins);
  for (const auto& [rate, within] : {std::pair(60, 2e-4), std::pair(600, 3e-5), std::pair(2400, 3e-6)}) {
    const TextRun scene(fmt::format(
        "duration = 4\n[room]\nwalls = 'ground'\n[physics]\nsolver = 'iterative'\nrate = {}\n[[box]]\nname = "
        "'b0'\nsize = [0.4, 0.2, 0.5]\nmass = 1\nposition = [0, 0.1, 0]\nelasticity = 0\nfriction = "
        "0.3\n[[box]]\nname = 'b1'\nsize = [0.4, 0.2, 0.5]\nmass = 1\nposition = [0, 0.3, 0]\nelasticity = "
        "0\nfriction = 0.3\n[[force]]\nof = 'b1'\ncomponents = ['2*t', '0', '0']\n",
        rate));
    const sim::Snapshot::Body now = scene.at(t).bodies[number_of(scene, "b1")];
    EXPECT_NEAR(now.velocity.x(), right, within) << rate;
    EXPECT_LT(now.spin.norm(), within) << rate;
  }
}

// A capsule that slides askew: it begins to roll across its axis, so that its friction turns its own slip.
TEST(Slips, OfACapsuleAskewIsTurnedByItsFriction) {
  const auto ended = [](const std::string& physics) {
    const TextRun scene(
        "duration = 1\n[room]\nsize = [20, 6, 20]\nfriction = 0\n[physics]\n" + physics +
        "\n[[box]]\nname = 'p'\nposition = [0, 0.1, 0]\nsize = [8, 0.2, 8]\nmass = 1000\nfriction = "
        "0.3\nelasticity = 0\n[[capsule]]\nname = 'r'\nposition = [0, 0.325, 0]\norientation = [90, 0, "
        "0]\nvelocity = [0.5, 0, 1]\nradius = 0.125\nlength = 0.7\nmass = 1\nfriction = 0.3\nelasticity = "
        "0\n");
    return scene.at(0.1).bodies[number_of(scene, "r")];
  };
  const sim::Snapshot::Body right = ended("collision = 'event'\nrate = 1920");
  for (const int rate : {240, 960}) {
    const sim::Snapshot::Body now = ended(fmt::format("solver = 'iterative'\nrate = {}", rate));
    const double within = 3e-4 * 240 * 240 / (rate * rate);
    EXPECT_LT((now.velocity - right.velocity).norm(), within * right.velocity.norm()) << rate;
    EXPECT_LT((now.spin - right.spin).norm(), within * right.spin.norm()) << rate;
  }
}

// A box slides off another, tips over its edge and lands on one of its own. Where its corners are held by
// other features than before, what they bore in the last substep says nothing of how its slip turns, for some
// of it is missing: it was pushed out of its plane, and landed on one corner after the other.
TEST(Slips, OffAnotherBoxStayInTheirPlane) {
  for (const int rate : {60, 240, 480}) {
    const std::string manner = "mass = 1\nfriction = 0.4\nelasticity = 0\nsize = [0.4, 0.2, 0.4]\n";
    const TextRun run(
        fmt::format("[room]\nsize = [10, 4, 6]\n[physics]\nsolver = 'iterative'\nrate = {}\n", rate) +
        "[[box]]\nname = 'b'\nposition = [0, 0.1, 0]\n" + manner +
        "[[box]]\nname = 'c'\nposition = [0, 0.3, 0]\nvelocity = [2, 0, 0]\n" + manner);
    const sim::Snapshot::Body now = run.at(0.316).bodies[number_of(run, "c")];
    EXPECT_NEAR(now.velocity.z(), 0, 1e-9) << rate;
    EXPECT_LT(now.spin.head<2>().norm(), 1e-8) << rate;
    // by the direct solver and by events
    EXPECT_NEAR(now.velocity.x(), 0.906, 1e-3) << rate;
    EXPECT_NEAR(now.spin.z(), 2.15, 5e-3) << rate;
  }
}

// A ball slides off the end of a plank so fast that it leaves the corner at once, v^2/R > g.
TEST(Slips, OffAnEdgeEndThere) {
  for (const int dimension : {2, 3}) {
    for (const int rate : {60, 240, 960}) {
      const char *z = dimension == 3 ? ", 0" : "", *deep = dimension == 3 ? ", 2" : "";
      const std::string smooth = "friction = 0\nelasticity = 0\n";
      const TextRun run(
          fmt::format("[room]\nwalls = 'ground'\nsize = [20, 10{}]\ngravity = [0, -9.81{}]\n"
                      "[physics]\nsolver = 'direct'\nrate = {}\n",
                      dimension == 3 ? ", 20" : "", z, rate) +
          fmt::format("[[box]]\nname = 'plank'\nposition = [0, 0.5{}]\nsize = [2, 1{}]\nmass = 100\n{}", z,
                      deep, smooth) +
          disc("b", 1, 0.1,
               fmt::format("position = [0.4967, 1.1{}]\nvelocity = [2, 0{}]\n{}", z, z, smooth)));
      const double t = 0.3 - (1 - 0.4967) / 2;
      EXPECT_NEAR(run.at(0.3).bodies[number_of(run, "b")].velocity.y(), -9.81 * t, 1e-6)
          << dimension << " at " << rate;
    }
  }
}

// A crate with a load slides over planks that lie end to end, in the middle of a crowd or not, and however
// all of it is turned: none of its faces meets the end of the next plank. A belt hands it on likewise.
TEST(Slips, OverTheSeamsOfPlanksMeetNothing) {
  for (const int dimension : {2, 3}) {
    const char *size = dimension == 3 ? ", 0.6" : "", *z = dimension == 3 ? ", 0" : "";
    for (const double degrees : {0.0, 30.0}) {
      const double c = std::cos(degrees * std::numbers::pi / 180),
                   s = std::sin(degrees * std::numbers::pi / 180);
      const auto turned = [&](double x, double y) {
        return fmt::format("[{:.17g}, {:.17g}{}]", c * x - s * y, s * x + c * y, z);
      };
      const auto box = [&](const std::string& name, double wide, double high, double x, double y) {
        return fmt::format("[[box]]\nname = '{}'\nsize = [{}, {}{}]\nposition = {}\n", name, wide, high, size,
                           turned(x, y)) +
               (dimension == 3 ? fmt::format("orientation = [0, 0, {}]\n", degrees)
                               : fmt::format("angle = {}\n", degrees));
      };
      for (const double gap : {0.0, 0.01}) {
        for (const bool crowded : {false, true}) {
          std::string bodies;
          for (int i = 0; i < 4; ++i)
            bodies +=
                box(fmt::format("plank{}", i), 0.5, 0.2, -1 + i * (0.5 + gap), -0.1) +
                "fixed = true\nfriction = 0.5\nsurface_speed = " + (dimension == 3 ? "[1, 0, 0]" : "1") +
                "\n";
          const std::string moves = fmt::format("velocity = {}\nmass = 1\n", turned(1, 0));
          bodies += box("crate", 0.4, 0.3, -1, 0.15) + moves + box("load", 0.2, 0.2, -1, 0.4) + moves;
          for (int i = 0; crowded && i < 100; ++i)
            bodies += box(fmt::format("other{}", i), 0.1, 0.1, 4 + 0.2 * (i % 10), 4 - 0.2 * (i / 10));
          for (const int rate : {60, 600}) {
            const TextRun run(
                fmt::format("[room]\nwalls = 'none'\nsize = [20, 20{0}]\ncorner = [-10, -10{1}]\ngravity = "
                            "{2}\n[physics]\nsolver = 'iterative'\nrate = {3}\n",
                            dimension == 3 ? ", 20" : "", dimension == 3 ? ", -10" : "", turned(0, -9.81),
                            rate) +
                bodies);
            const sim::Vec3 at = run.at(1.5).bodies[number_of(run, "crate")].position;
            EXPECT_NEAR(c * at.x() + s * at.y(), 0.5, 1e-6) << dimension << " " << degrees << " " << gap;
            EXPECT_NEAR(c * at.y() - s * at.x(), 0.15, 1e-6) << dimension << " " << degrees << " " << gap;
          }
        }
      }
    }
  }
}

// A box slides off a table and tips about its edge, which its bottom leaves at its rear corner, wherever that
// falls in a step: nothing strikes it then. Where it was seen to leave from too far it was stopped before,
// and its corner met the table's top.
TEST(Slips, OverAnEdgeThatABoxTipsAboutStrikeNothing) {
  for (const int rate : {50, 60}) {
    for (int i = 0; i < 12; ++i) {
      const auto spin = [&](const char* manner) {
        const TextRun run(
            fmt::format("duration = 1\n[room]\nsize = [8, 4]\n[physics]\n{}\nrate = {}\n", manner, rate) +
            "[[box]]\nfixed = true\nsize = [3, 0.2]\nposition = [2, 1]\nfriction = 0.1\nelasticity = "
            "0\n[[box]]\nname = 'b'\nsize = [0.4, 0.4]\nmass = 1\nfriction = 0.1\nelasticity = 0\n"
            "velocity = [2, 0]\n" +
            fmt::format("position = [{:.15g}, 1.3]\n", 3.3 + i * 2.0 / rate / 12));
        return run.at(0.35).bodies[std::size_t(number_of(run, "b"))].spin.z();
      };
      EXPECT_NEAR(spin("solver = 'direct'"), spin("collision = 'event'"), 1e-5) << rate << " " << i;
    }
  }
}

}  // namespace
}  // namespace obscura::scene

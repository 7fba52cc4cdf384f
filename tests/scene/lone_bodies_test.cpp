// Bodies that the exact solver moves beside the iterative one, as they meet nothing but walls and fixed
// bodies: their contacts are reported like all others.

#include <gtest/gtest.h>

#include <string>

#include "text_run.h"

namespace obscura::scene {
namespace {

using sim::Snapshot;
using sim::Vec3;

constexpr double kGravity = 10, kMass = 2, kRate = 200;

// `rest` after a box 'lone' in a room where two other boxes lie on each other far away; `z`: of space
std::string room(bool space, const std::string& rest) {
  const std::string z = space ? ", 0" : "", side = space ? ", 1" : "";
  return "[room]\nsize = [40, 6" + std::string(space ? ", 6" : "") + "]\ngravity = [0, -10" + z +
         "]\n[physics]\nsolver = \"iterative\"\nrate = 200\n" + rest +
         "[[box]]\nname = \"under\"\nposition = [16, 0.5" + z + "]\nsize = [1, 1" + side +
         "]\n[[box]]\nname = \"over\"\nposition = [16, 1.5" + z + "]\nsize = [1, 1" + side + "]\n";
}
std::string box(bool space, const std::string& name, const std::string& at, const std::string& size,
                const std::string& keys) {
  return "[[box]]\nname = \"" + name + "\"\nposition = [" + at + (space ? ", 0" : "") + "]\nsize = [" + size +
         (space ? ", 0.5" : "") + "]\n" + keys;
}

struct Sums {
  Vec3 force = Vec3::Zero(), impulse = Vec3::Zero();
};
// of all contacts of a body, on it
Sums contacts_of(const Snapshot& now, int body) {
  Sums sums;
  for (const Snapshot::Contact& contact : now.contacts) {
    if (contact.body != body && contact.other != body) continue;
    const double sign = contact.body == body ? 1 : -1;
    sums.force += sign * contact.force, sums.impulse += sign * contact.impulse;
  }
  return sums;
}

// m (v' - v - g h) = p of every step, until `end`; returns how many steps had an impact
int expect_momentum_balance(const TextRun& run, double end, const std::string& what) {
  int impacts = 0;
  Vec3 v = run.at(0).bodies[0].velocity;
  for (int step = 1; step <= int(end * kRate); ++step) {
    const Snapshot now = run.at(step / kRate);
    const Vec3 gain = now.bodies[0].velocity - v - Vec3(0, -kGravity / kRate, 0);
    v = now.bodies[0].velocity;
    const Vec3 p = contacts_of(now, 0).impulse;
    // both are exact but for rounding, some 1e-16 of 20 N s
    EXPECT_NEAR((kMass * gain - p).norm(), 0, 1e-9) << what << " step " << step << " p " << p.transpose();
    impacts += p.norm() > 0;
  }
  return impacts;
}

TEST(LoneBodies, ImpulseOfABoxThatBouncesIsItsChangeOfMomentum) {
  for (const bool space : {false, true}) {
    // on every side, and on a corner: it tumbles on
    for (const int angle : {0, 90, 180, 270, 25, 115, 205, 295}) {
      const std::string turn = space ? "orientation = [0, 0, " + std::to_string(angle) + "]\n"
                                     : "angle = " + std::to_string(angle) + "\n";
      const std::string keys = "mass = 2\nelasticity = 0.5\nfriction = 0.3\nvelocity = [0.5, 0" +
                               std::string(space ? ", 0" : "") + "]\n" + turn;
      const std::string what = std::string(space ? "space " : "plane ") + std::to_string(angle);
      const TextRun run(room(space, box(space, "lone", "4, 3", "0.6, 0.4", keys)));
      EXPECT_GE(expect_momentum_balance(run, 0.95, what), 1) << what;
    }
  }
}

TEST(LoneBodies, ImpulseOfABoxThatFallsFlatIsThatOfTheClosedForm) {
  // p = m (1 + e) sqrt(2 g H), on the floor and on a fixed box
  for (const bool space : {false, true}) {
    for (const bool table : {false, true}) {
      const std::string keys = "mass = 2\nelasticity = 0.5\n";
      const double H = table ? 1.8 : 2.8;
      const TextRun run(
          room(space,
               box(space, "lone", "4, 3", "0.6, 0.4", keys) +
                   (table ? box(space, "table", "4, 0.5", "3, 1", "fixed = true\nelasticity = 0.5\n") : "")));
      const int step = int(std::ceil(std::sqrt(2 * H / kGravity) * kRate));
      const Vec3 p = contacts_of(run.at(step / kRate), 0).impulse;
      EXPECT_NEAR(p[1], kMass * 1.5 * std::sqrt(2 * kGravity * H), 1e-6) << space << table;
      EXPECT_NEAR(p[0], 0, 1e-9) << space << table;
      EXPECT_NEAR(contacts_of(run.at((step + 1) / kRate), 0).impulse.norm(), 0, 0) << space << table;
    }
  }
}

TEST(LoneBodies, ForceOfABoxThatSlidesOnAFixedBoxIsItsWeightAndFriction) {
  for (const bool space : {false, true}) {
    // the table before it and after it, for both signs of a contact
    for (const bool first : {false, true}) {
      const std::string v = "velocity = [4, 0" + std::string(space ? ", 0" : "") + "]\n";
      const std::string lone = box(space, "lone", "2, 1.2", "0.6, 0.4", "mass = 2\nfriction = 0.2\n" + v),
                        table = box(space, "table", "6, 0.5", "10, 1", "fixed = true\nfriction = 0.2\n");
      const TextRun run(room(space, first ? lone + table : table + lone));
      for (const double t : {0.1, 0.3, 0.5}) {
        const Vec3 f = contacts_of(run.at(t), first ? 0 : 1).force;
        EXPECT_NEAR(f[0], -0.2 * kMass * kGravity, 1e-9) << space << first << t;
        EXPECT_NEAR(f[1], kMass * kGravity, 1e-9) << space << first << t;
      }
    }
  }
}

TEST(LoneBodies, ForceOfABoxThatHasComeToRestIsItsWeight) {
  for (const bool space : {false, true}) {
    const TextRun run(room(space, box(space, "lone", "4, 1", "0.6, 0.4", "mass = 2\nelasticity = 0.3\n")));
    const Snapshot now = run.at(3);
    EXPECT_TRUE(now.bodies[0].at_rest) << space;
    // what rests accelerates by less than g / 1e6
    EXPECT_NEAR(contacts_of(now, 0).force[1], kMass * kGravity, 1e-6 * kMass * kGravity) << space;
  }
}

// A roly-poly that the iterative solver is named for, and one among bodies that it moves: it keeps its swing.
TEST(LoneBodies, ARolyPolyKeepsItsSwing) {
  for (const double radius : {0.3, 0.05}) {
    const TextRun run(fmt::format(
        "duration = 99\n[room]\nsize = [4, 2]\nfriction = 0.8\nelasticity = 0\n[physics]\ncollision = "
        "\"contact\"\nsolver = \"iterative\"\nrate = 60\n[[ball]]\nposition = [2, {0}]\nradius = "
        "{0}\nmass = 1\nangle = 20\ncenter_of_mass = [0, {1}]\n",
        radius, -radius / 3));
    const double begun = run.at(0).energies.total(),
                 least = 9.81 * radius * 2 / 3;  // upright: all of the swing is above that
    EXPECT_NEAR(run.at(30).energies.total() - least, begun - least, 0.01 * (begun - least)) << radius;
  }
}

}  // namespace
}  // namespace obscura::scene

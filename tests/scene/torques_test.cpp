// [[force]] with a torque, or a potential of the angle: closed forms in every manner, in the plane and in
// space.

#include "scene/text_run.h"

namespace obscura::scene {
namespace {

std::string dial(const Manner& manner, const std::string& more, const std::string& body = "") {
  return plane_without_walls(manner, "gravity = [0, 0]") +
         "[[box]]\nname = \"b\"\nsize = [0.4, 0.2]\nposition = [1, 2]\nmass = 3\ninertia = 0.5\n" + body +
         "\n" + more;
}

// I w' = -c w: w = w0 exp(-c t / I), and the angle that it has turned (w0 - w) I / c
TEST(Torques, ABrakeOfASpinFallsOffExponentially) {
  for (const Manner& manner : kManners) {
    const TextRun run(dial(manner, "[[force]]\nof = \"b\"\ntorque = \"-0.3*spin\"\n", "spin = 90"));
    const double w0 = std::acos(-1.0) / 2, w = w0 * std::exp(-0.3 * 2 / 0.5);
    const sim::Snapshot now = run.at(2);
    EXPECT_NEAR(now.bodies[0].spin.z(), w, 1e-12) << manner.name;
    EXPECT_NEAR(now.energies.total() - now.energies.work, 0.25 * w0 * w0, 1e-12) << manner.name;
    EXPECT_EQ(now.bodies[0].position.x(), 1) << manner.name;
  }
}

// A needle in a field, V = -m B cos(angle): small swings have w^2 = m B / I, and energy is kept. So is that
// of a potential of angle and place, V = k (x - r angle)^2 / 2: a spring between a shift and a turn, w^2 = k
// (1/m + r^2/I)
TEST(Torques, APotentialOfTheAngleTurnsWhatItHolds) {
  for (const Manner& manner : kManners) {
    const TextRun needle(
        dial(manner, "[[force]]\nof = \"b\"\npotential = \"-8*cos(angle)\"\n", "angle = 60"));
    const double begins = -8 * 0.5;
    for (const double t : {0.5, 1.0, 3.0}) {
      const sim::Snapshot now = needle.at(t);
      EXPECT_NEAR(now.energies.total(), begins, 1e-10) << manner.name;
      const double fast = now.bodies[0].spin.z();
      EXPECT_NEAR(0.25 * fast * fast - 8 * std::cos(now.bodies[0].angle), begins, 1e-10) << manner.name;
    }
    const TextRun both(
        dial(manner, "[[force]]\nof = \"b\"\npotential = \"6*(x - 1 - 0.5*angle)^2\"\n", "angle = 10"));
    const double k = 12, r = 0.5, w = std::sqrt(k * (1 / 3.0 + r * r / 0.5));
    const double stretch = -r * std::acos(-1.0) / 18;  // x - r angle
    const sim::Snapshot now = both.at(1);
    EXPECT_NEAR(now.bodies[0].position.x(), 1 + k * -stretch / (3 * w * w) * (1 - std::cos(w)), 1e-9)
        << manner.name;
  }
}

// In space about each axis of the room, beside a force.
TEST(Torques, OfSpaceAreAboutTheAxesOfTheRoom) {
  for (const Manner& manner : kManners) {
    for (int axis = 0; axis < 3; ++axis) {
      const char* on[] = {"\"0\"", "\"0\"", "\"0\""};
      on[axis] = axis == 0 ? "\"2 - 0.4*spinx\"" : axis == 1 ? "\"2 - 0.4*spiny\"" : "\"2 - 0.4*spinz\"";
      const TextRun run(space_without_walls(manner, "gravity = [0, 0, 0]") +
                        "[[ball]]\nname = \"b\"\nradius = 0.5\nposition = [1, 2, 0]\nmass = 2\n"
                        "[[force]]\ncomponents = [\"1\", \"0\", \"0\"]\n" +
                        fmt::format("torque = [{}, {}, {}]\n", on[0], on[1], on[2]));
      const double inertia = 0.4 * 2 * 0.25;
      const sim::Snapshot now = run.at(1);
      EXPECT_NEAR(now.bodies[0].spin[axis], 5 * (1 - std::exp(-0.4 / inertia)), 1e-9) << manner.name << axis;
      EXPECT_NEAR(now.bodies[0].position.x(), 1.25, 1e-12) << manner.name;
    }
  }
}

// A force at a point of a body is the same force and its moment: at the rim of a disc that a pin holds,
// always along the room's x, it swings as a pendulum whose weight lies aside; and energy is kept where it has
// a potential
TEST(Torques, OfForcesAtAPointAreTheirMoments) {
  for (const Manner& manner : kManners) {
    const std::string pin = "[[joint]]\ntype = \"pin\"\nbetween = [\"b\", \"room\"]\n";
    const TextRun pushed(dial(
        manner, pin + "[[force]]\nof = \"b\"\nat = [0, -0.4]\ncomponents = [\"0\", \"-5\"]\n", "angle = 60"));
    const TextRun held(
        dial(manner, pin + "[[force]]\nof = \"b\"\nat = [0, -0.4]\npotential = \"5*y\"\n", "angle = 60"));
    const TextRun turned(
        dial(manner, pin + "[[force]]\nof = \"b\"\ntorque = \"-5*0.4*sin(angle)\"\n", "angle = 60"));
    const double begun = held.at(0).energies.total();
    for (const double t : {0.4, 2.0}) {
      const sim::Snapshot::Body now = turned.at(t).bodies[0];
      EXPECT_NEAR(pushed.at(t).bodies[0].angle, now.angle, 1e-9) << manner.name;
      EXPECT_NEAR(held.at(t).bodies[0].angle, now.angle, 1e-9) << manner.name;
      EXPECT_NEAR(held.at(t).energies.total(), begun, 1e-9) << manner.name;
    }
  }
}

// what a tumbling box gives a brake is in the books to the fourth order
TEST(Torques, ABrakeOfWhatTumblesIsInTheBooks) {
  for (const Manner& manner : kManners) {
    double off[2];
    for (const int i : {0, 1}) {
      const TextRun run(
          space_without_walls(manner, "gravity = [0, 0, 0]") +
              "[[box]]\nname = \"b\"\nsize = [0.5, 0.3, 0.2]\nmass = 2\nspin = [400, 300, -200]\n"
              "[[force]]\ntorque = [\"-0.02*spinx\", \"-0.02*spiny\", \"-0.02*spinz\"]\n",
          {i == 0 ? "physics.rate=150" : "physics.rate=300"});
      const double begun = run.at(0).energies.total();
      const sim::Energies now = run.at(1).energies;
      off[i] = std::fabs(now.total() - now.work - begun);
      EXPECT_LE(off[i], 1e-8) << manner.name;
    }
    // iterations take finer steps at 150 steps a second
    if (manner.name != "iterative") {
      EXPECT_GT(off[0], 12 * off[1]) << manner.name << off[0] << " " << off[1];
    }
  }
}

// A wheel whose axis bears -c sign(spin) rolls on with (m + I/r^2) a = -c/r: rolling resistance
TEST(Torques, ResistRolling) {
  for (const Manner& manner : {kManners[0], kManners[1]}) {
    const TextRun run("duration = 10\n[room]\nsize = [20, 4]\ngravity = [0, -10]\n" + manner.keys +
                      "\n[[ball]]\nname = \"b\"\nradius = 0.5\nposition = [1, 0.5]\nvelocity = [2, 0]\n"
                      "spin = -229.18311805232929\nmass = 2\nfriction = 0.5\nelasticity = 0\n"
                      "[[force]]\nof = \"b\"\ntorque = \"-0.3*sign(spin)\"\n");
    const double a = 0.3 / 0.5 / (2 + 0.5 * 2);
    EXPECT_NEAR(run.place(2).x(), 1 + 2 * 2 - a * 2, 1e-9) << manner.name;
  }
}

TEST(Torques, AreRefusedWhereNothingTurns) {
  const auto says = [](const std::string& text, const std::string& what) {
    EXPECT_NE(refusal(text).find(what), std::string::npos) << refusal(text);
  };
  const std::string ball = "[[ball]]\nname = \"b\"\nradius = 0.1\n";
  says("[[particle]]\nname = \"p\"\n[[force]]\nof = \"p\"\ntorque = \"1\"\n",
       "a.toml:5:10: 'p' does not turn");
  says(ball + "[[force]]\npotential = \"x\"\ntorque = \"1\"\n",
       "a 'potential' is all of its force and torque");
  says(ball + "[[force]]\ntorque = \"1 + spinn\"\n",
       "a.toml:5:15: 'torque', column 5: nothing is called 'spinn' here; did you mean 'spin'?");
  says(ball + "[[force]]\ntorque = \"spinx\"\n", "it has 'spin'");
  says(ball + ball.substr(0, 8) +
           "\nname = \"c\"\nradius = 0.1\n[[force]]\nof = \"b\"\ncenter = \"c\"\ntorque = \"1\"\n",
       "no body would feel the opposite");
}

// At the start, where no step has been taken, it is that of the start.
TEST(Torques, AreThoseOfTheStartThere) {
  for (const int rate : {30, 600}) {
    const TextRun run(
        plane_without_walls(kManners[0], "gravity = [0, 0]") + fmt::format("rate = {}\n", rate) +
        "[[ball]]\nname = \"b\"\nmass = 2\ninertia = 0.1\nspin = 180\nposition = [0, 0]\n[[force]]\nof = "
        "\"b\"\ntorque = \"-2*spin\"\n");
    EXPECT_NEAR(run.at(0).bodies[0].torque.z(), -2 * std::acos(-1.0), 1e-12) << rate;
  }
}

}  // namespace
}  // namespace obscura::scene

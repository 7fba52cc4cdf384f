// Joints by iterations: ropes that become taut and limits that are reached, momenta and books of bodies that
// nothing else holds, forces at an instant, and what rolls on a turntable. All against closed forms; where a
// tolerance is not that of rounding it is the error of Runge-Kutta's scheme, of (w h)^4.

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <string>
#include <tuple>
#include <vector>

#include "scene/text_run.h"

namespace obscura::scene {
namespace {

using sim::Vec3;

constexpr double kPulledDown = 9.81;

// A scene is of the plane or of space; all of it is turned about the third axis.
struct View {
  bool space = false;
  double turn = 0;  // rad
  int rate = 600;   // steps a second
};
std::vector<View> views() {
  std::vector<View> all;
  for (const bool space : {false, true})
    for (const double turn : {0.0, 2.2})
      for (const int rate : {60, 600}) all.push_back({space, turn, rate});
  return all;
}
std::string name_of(const View& view) {
  return fmt::format("{} turned by {} at {}/s", view.space ? "space" : "plane", view.turn, view.rate);
}
std::string vec(const View& view, double x, double y) {
  const double c = std::cos(view.turn), s = std::sin(view.turn);
  return fmt::format("[{:.17g}, {:.17g}{}]", c * x - s * y, s * x + c * y, view.space ? ", 0" : "");
}
Vec3 turned(const View& view, double x, double y) {
  const double c = std::cos(view.turn), s = std::sin(view.turn);
  return {c * x - s * y, s * x + c * y, 0};
}
std::string room(const View& view, double gravity = 0) {
  const std::string physics =
      fmt::format("[physics]\ncollision = \"contact\"\nsolver = \"iterative\"\nrate = {}", view.rate);
  const std::string pull = "gravity = " + vec(view, 0, -gravity);
  return view.space ? space_without_walls({"", physics}, pull) : plane_without_walls({"", physics}, pull);
}
std::string particle(const View& view, const std::string& name, double mass, double x, double y, double vx,
                     double vy) {
  return fmt::format("[[particle]]\nname = \"{}\"\nmass = {}\nposition = {}\nvelocity = {}\n", name, mass,
                     vec(view, x, y), vec(view, vx, vy));
}
std::string spin(const View& view, double w) {
  const double degrees = w * 180 / std::numbers::pi;
  return view.space ? fmt::format("spin = [0, 0, {:.17g}]\n", degrees)
                    : fmt::format("spin = {:.17g}\n", degrees);
}
// a point of the moment of inertia I about the third axis, nearly
std::string wheel(const View& view, const std::string& name, double mass, double inertia, double w) {
  const double radius = std::sqrt(inertia / ((view.space ? 0.4 : 0.5) * mass));
  return fmt::format("[[ball]]\nname = \"{}\"\nmass = {:.17g}\nradius = {:.17g}\nposition = {}\n", name, mass,
                     radius, vec(view, 0, 0)) +
         spin(view, w);
}
double less_work(const sim::Snapshot& now) { return now.energies.total() - now.energies.work; }

// 2 kg at rest and 3 kg with 2 m/s on a slack rope: from the jerk on both have 6/5 m/s.
TEST(JointEnds, AJerkAlongARopeLeavesTheVelocityOfTheCentre) {
  for (const View& view : views()) {
    const TextRun scene(room(view) + particle(view, "a", 2, -1, 0, 0, 0) +
                        particle(view, "b", 3, -0.8, 0, 2, 0) +
                        "[[joint]]\ntype = \"rope\"\nbetween = [\"a\", \"b\"]\nlength = 1\n");
    for (const double t : {0.41, 1.0}) {
      const sim::Snapshot now = scene.at(t);
      for (const int i : {0, 1})
        EXPECT_LE((now.bodies[std::size_t(i)].velocity - turned(view, 1.2, 0)).norm(), 1e-12)
            << name_of(view);
      EXPECT_LE((now.bodies[1].position - turned(view, 1.2 * (t - 0.4), 0)).norm(), 1e-11) << name_of(view);
    }
  }
}

// b passes a on a line half a metre aside. When the rope is taut, along n, it takes what b has along n from
// the two, and they go on about their centre with what b has across.
TEST(JointEnds, AnObliqueJerkKeepsWhatIsAcrossTheRope) {
  const double m = 2, M = 3, v = 2, aside = 0.5, length = 1;
  const double from = -0.8, met = (std::sqrt(length * length - aside * aside) - from) / v;
  const double start = std::asin(aside / length), across = -v * std::sin(start);  // of n, and of b
  for (const View& view : views()) {
    const TextRun scene(room(view) + particle(view, "a", m, 0, 0, 0, 0) +
                        particle(view, "b", M, from, aside, v, 0) +
                        "[[joint]]\ntype = \"rope\"\nbetween = [\"a\", \"b\"]\nlength = 1\n");
    const double t = 3, angle = start + across / length * (t - met), u = M / (m + M) * v;
    const Vec3 centre = turned(view, M / (m + M) * (from + v * met) + u * (t - met), M / (m + M) * aside);
    const Vec3 arm =
        turned(view, m / (m + M) * length * std::cos(angle), m / (m + M) * length * std::sin(angle));
    EXPECT_LE((scene.place(t, 1) - centre - arm).norm(), 2e-10) << name_of(view);
  }
}

// The same on a rope to the room.
TEST(JointEnds, ARopeToTheRoomTurnsWhatFliesOut) {
  const double v = 2, aside = 0.5, length = 1, met = std::sqrt(length * length - aside * aside) / v;
  const double start = std::asin(aside / length), w = -v * std::sin(start) / length;
  for (const View& view : views()) {
    const TextRun scene(room(view) + particle(view, "b", 3, 0, aside, v, 0) +
                        "[[joint]]\nname = \"rope\"\ntype = \"rope\"\nbetween = [\"b\", " + vec(view, 0, 0) +
                        "]\nlength = 1\n");
    const double t = 3, angle = start + w * (t - met);
    const sim::Snapshot now = scene.at(t);
    EXPECT_LE((now.bodies[0].position - turned(view, std::cos(angle), std::sin(angle))).norm(), 2e-10)
        << name_of(view);
    EXPECT_NEAR(now.joints[0].force.norm(), 3 * w * w * length, 1e-8) << name_of(view);
  }
}

// Two fall on a slack rope over two pulleys: 2 g t^2 / 2 = slack. Then they go on as Atwood's machine.
TEST(JointEnds, AJerkOverAPulleyIsShared) {
  const double m = 1, M = 3, slack = 0.5, met = std::sqrt(slack / kPulledDown), v = kPulledDown * met;
  const double after = v * (M - m) / (M + m), a = kPulledDown * (M - m) / (M + m);
  for (const View& view : views()) {
    const TextRun scene(room(view, kPulledDown) + particle(view, "a", m, -0.5, 0, 0, 0) +
                        particle(view, "b", M, 0.5, 0, 0, 0) +
                        "[[joint]]\ntype = \"pulley\"\nbetween = [\"a\", \"b\"]\nlength = 13.5\nover = [" +
                        vec(view, -0.5, 6) + ", " + vec(view, 0.5, 6) + "]\n");
    const double t = 0.8,
                 fell = 0.5 * kPulledDown * met * met + after * (t - met) + 0.5 * a * (t - met) * (t - met);
    EXPECT_LE((scene.place(t, 1) - turned(view, 0.5, -fell)).norm(), 1e-10) << name_of(view);
  }
}

// A wheel turns on an axle that another bears. At the limit of their angle both go on with one spin.
TEST(JointEnds, ALimitOfAnAngleLeavesTheAngularMomentum) {
  const double I = 0.3, J = 0.2, w = 3, limit = 0.5 * std::numbers::pi, met = limit / w;
  for (const double side : {1.0, -1.0}) {
    for (const View& view : views()) {
      const TextRun scene(room(view) + wheel(view, "a", 2, I, side * w) + wheel(view, "b", 1, J, 0) +
                          "[[joint]]\ntype = \"hinge\"\nbetween = [\"a\", \"b\"]\nlimits = [-90, 90]\n" +
                          (view.space ? "axis = [0, 0, 1]\n" : ""));
      const double t = 1.5, both = side * I * w / (I + J);
      const sim::Snapshot now = scene.at(t);
      for (const int i : {0, 1})
        EXPECT_LE((now.bodies[std::size_t(i)].spin - Vec3(0, 0, both)).norm(), 1e-10) << name_of(view);
      if (view.space) continue;
      EXPECT_NEAR(now.bodies[1].angle, both * (t - met), 1e-10) << name_of(view);
    }
  }
}

// A sleeve of m slides along a rod of M to its end, and takes it along.
TEST(JointEnds, ALimitOfAWayLeavesTheVelocityOfTheCentre) {
  const double m = 1, M = 4, v = 2;
  for (const double side : {1.0, -1.0}) {
    for (const View& view : views()) {
      const auto box = [&](const char* name, double mass, double u) {
        return fmt::format("[[box]]\nname = \"{}\"\nmass = {}\nsize = {}\nposition = {}\nvelocity = {}\n",
                           name, mass, view.space ? "[0.2, 0.2, 0.2]" : "[0.2, 0.2]", vec(view, 0, 0),
                           vec(view, u, 0));
      };
      const TextRun scene(
          room(view) + box("sleeve", m, side * v) + box("rod", M, 0) +
          "[[joint]]\ntype = \"slider\"\nbetween = [\"sleeve\", \"rod\"]\nlimits = [-0.5, 0.5]\naxis = " +
          vec(view, 1, 0) + "\n");
      const double t = 1.5, u = side * m * v / (m + M);
      const sim::Snapshot now = scene.at(t);
      for (const int i : {0, 1})
        EXPECT_LE((now.bodies[std::size_t(i)].velocity - turned(view, u, 0)).norm(), 1e-11) << name_of(view);
      EXPECT_LE((now.bodies[1].position - turned(view, u * (t - 0.25), 0)).norm(), 1e-11) << name_of(view);
    }
  }
}

// A pendulum falls to the stop of its angle and lies there: the force of its axle and the torque of the stop
// are those of its weight.
TEST(JointEnds, AStopBearsWhatLiesOnIt) {
  for (const View& view : views()) {
    const TextRun scene(
        room(view, kPulledDown) +
        fmt::format("[[box]]\nname = \"flap\"\nmass = 2\nsize = {}\nposition = {}\n{}",
                    view.space ? "[1, 0.1, 0.1]" : "[1, 0.1]", vec(view, 0.5, 0),
                    view.space
                        ? fmt::format("orientation = [0, 0, {:.17g}]\n", view.turn * 180 / std::numbers::pi)
                        : fmt::format("angle = {:.17g}\n", view.turn * 180 / std::numbers::pi)) +
        "[[joint]]\ntype = \"hinge\"\nbetween = [\"flap\", \"room\"]\nlimits = [-60, 10]\nat = " +
        vec(view, 0, 0) + (view.space ? "\naxis = [0, 0, 1]\n" : "\n"));
    const sim::Snapshot now = scene.at(2);
    const double angle = -std::numbers::pi / 3;
    EXPECT_LE((now.bodies[0].position - turned(view, 0.5 * std::cos(angle), 0.5 * std::sin(angle))).norm(),
              1e-9)
        << name_of(view);
    EXPECT_LE((now.joints[0].force - turned(view, 0, 2 * kPulledDown)).norm(), 1e-7) << name_of(view);
    EXPECT_NEAR(now.joints[0].torque.norm(), 2 * kPulledDown * 0.5 * 0.5, 1e-7) << name_of(view);
  }
}

// A skater turns on no ice at all: a body with two arms on sliders, of motors, with friction or free.
std::string skater(const View& view, const std::string& arms) {
  std::string text = room(view) + wheel(view, "body", 2, 0.5, 3);
  for (const double side : {1.0, -1.0}) {
    const char* name = side > 0 ? "right" : "left";
    text +=
        fmt::format("[[box]]\nname = \"{}\"\nmass = 1\nsize = {}\nposition = {}\nvelocity = {}\n", name,
                    view.space ? "[0.1, 0.1, 0.1]" : "[0.1, 0.1]", vec(view, side, 0),
                    vec(view, 0, 3 * side)) +
        spin(view, 3) +
        fmt::format("[[joint]]\ntype = \"slider\"\nbetween = [\"{}\", \"body\"]\naxis = {}\nat = {}\n{}\n",
                    name, vec(view, side, 0), vec(view, side, 0), arms);
  }
  return text;
}
void expect_kept(const std::string& arms, double near) {
  for (const View& view : views()) {
    const TextRun scene(skater(view, arms));
    const sim::Snapshot begun = scene.at(0);
    for (const double t : {0.31, 1.0, 1.9}) {
      const sim::Snapshot now = scene.at(t);
      EXPECT_LE((now.angular_momentum - begun.angular_momentum).norm(), near) << t << " " << name_of(view);
      EXPECT_LE(now.momentum.norm(), 1e-11) << t << " " << name_of(view);
      EXPECT_NEAR(less_work(now), less_work(begun), view.rate < 100 ? 4e-7 : 1e-8)
          << t << " " << name_of(view);
    }
  }
}
TEST(JointEnds, ArmsThatAreDrawnInKeepTheAngularMomentum) {
  expect_kept("motor = { position = \"-0.25*(1 - cos(2*pi*t))\", most = 10000 }", 2e-8);
}
TEST(JointEnds, ArmsThatAreTooWeakKeepTheAngularMomentum) {
  expect_kept("motor = { position = \"-0.25*(1 - cos(2*pi*t))\", most = 3 }", 2e-8);
}
TEST(JointEnds, ArmsThatRubKeepTheAngularMomentum) {
  for (const View& view : views()) {
    const TextRun scene(skater(view, "friction = 2"));
    const sim::Snapshot begun = scene.at(0), now = scene.at(1.9);
    EXPECT_LE((now.angular_momentum - begun.angular_momentum).norm(), 1e-8) << name_of(view);
    EXPECT_LT(now.energies.total(), begun.energies.total()) << name_of(view);
  }
}

// A motor turns a crank at w: the piston's rod bears what the piston's acceleration takes,
//   x = r cos w t + sqrt(l^2 - r^2 sin^2 w t)
TEST(JointEnds, ACrankBearsWhatItsPistonTakes) {
  const double w = 2, r = 0.3, l = 1;
  const auto place = [&](double t) {
    const double s = r * std::sin(w * t);
    return r * std::cos(w * t) + std::sqrt(l * l - s * s);
  };
  for (const View& view : views()) {
    const std::string axis = view.space ? "axis = [0, 0, 1]\n" : "";
    const TextRun scene(
        room(view) + wheel(view, "crank", 1, 0.08, w) +
        "[[joint]]\ntype = \"hinge\"\nbetween = [\"crank\", \"room\"]\nmotor = { speed = 114.59155902616465, "
        "most = 100 }\n" +
        axis + "[[box]]\nname = \"piston\"\nmass = 1.5\nsize = " +
        (view.space ? "[0.2, 0.2, 0.2]" : "[0.2, 0.2]") + "\nposition = " + vec(view, r + l, 0) +
        "\n[[joint]]\ntype = \"slider\"\nbetween = [\"piston\", \"room\"]\naxis = " + vec(view, 1, 0) +
        "\n[[joint]]\ntype = \"rod\"\nbetween = [{ body = \"crank\", local = " + vec(view, r, 0) +
        " }, \"piston\"]\n");
    for (const double t : {0.25, 1.0, 2.3}) {
      const sim::Snapshot now = scene.at(t);
      EXPECT_NEAR(now.bodies[1].position.dot(turned(view, 1, 0)), place(t), 1e-9) << name_of(view);
      // the second difference of five points
      const double d = 1e-3, a = (-place(t - 2 * d) + 16 * place(t - d) - 30 * place(t) + 16 * place(t + d) -
                                  place(t + 2 * d)) /
                                 (12 * d * d);
      const double sine = r * std::sin(w * t) / l, along = 1.5 * std::fabs(a) / std::sqrt(1 - sine * sine);
      EXPECT_NEAR(now.joints[2].force.norm(), along, 2e-8) << t << " " << name_of(view);
      EXPECT_NEAR(now.joints[1].force.norm(), along * std::fabs(sine), 2e-8) << t << " " << name_of(view);
    }
  }
}

// The rod of a pendulum bears m v^2 / l + m g cos of its angle, of one instant.
TEST(JointEnds, APendulumsRodBearsWhatItsInstantTakes) {
  for (const View& view : views()) {
    const TextRun scene(room(view, kPulledDown) + particle(view, "bob", 2, 1, 0, 0, 0.3) +
                        "[[joint]]\ntype = \"rod\"\nbetween = [\"bob\", " + vec(view, 0, 0) + "]\n");
    for (const double t : {0.1, 0.35, 1.0}) {
      const sim::Snapshot now = scene.at(t);
      const double falls = now.bodies[0].position.dot(turned(view, 0, -1));
      const double tension = 2 * now.bodies[0].velocity.squaredNorm() + 2 * kPulledDown * falls;
      EXPECT_NEAR(now.joints[0].force.norm(), std::fabs(tension), 1e-8) << t << " " << name_of(view);
    }
  }
}

// A ball that rolls on a turntable goes round with 2/7 of its turns, and stays in its ring (Weckesser 1997).
TEST(JointEnds, ABallOnATurntableGoesRoundWithTwoSeventhsOfItsTurns) {
  const double W = std::numbers::pi, k = 2.0 / 7 * W, radius = 0.05, x0 = 0.4, u = -0.2;
  // rolls: v = W x r + w x (-radius y), about y
  const double about_x = (u + W * x0) / radius;
  for (const int rate : {60, 600}) {
    const TextRun scene(
        space_without_walls(
            {"",
             fmt::format("[physics]\ncollision = \"contact\"\nsolver = \"iterative\"\nrate = {}", rate)}) +
        "[[box]]\nname = \"table\"\nsize = [3, 0.1, 3]\nposition = [0, 0, 0]\nfriction = 10\n"
        "motion = { angle = \"pi*t/deg\", axis = [0, 1, 0] }\n" +
        fmt::format(
            "[[ball]]\nname = \"ball\"\nradius = {}\nposition = [{}, 0.1, 0]\nvelocity = [0, 0, {}]\nspin = "
            "[{:.17g}, 0, 0]\nfriction = 10\nelasticity = 0\n",
            radius, x0, u, about_x * 180 / std::numbers::pi));
    // v turns about y by k: x = x0 + (u / k) (1 - cos k t), z = (u / k) sin k t
    for (const double t : {1.0, 4.0}) {
      const Vec3 want(x0 + u / k * (1 - std::cos(k * t)), 0.1, u / k * std::sin(k * t));
      EXPECT_LE((scene.place(t, number_of(scene, "ball")) - want).norm(), 1e-6) << rate << " " << t;
    }
  }
}

// Rows of lengths and of angles have other units: what a weld, a hinge or a slider holds does not hang on the
// size of its body. In 10 ms at 600 steps a second nothing moves, and the joint bears m g and its moment.
TEST(JointEnds, BodiesOfAllSizesAreHeld) {
  for (const bool space : {false, true})
    for (const char* type : {"weld", "slider", "hinge"})
      for (const double size : {1e-6, 1e-4, 1.0, 1e3, 1e5}) {
        if (!space && std::string(type) == "hinge") continue;
        const auto vector = [&](double x, double y, double z) {
          return fmt::format("[{:.17g}, {:.17g}{}]", x * size, y * size,
                             space ? fmt::format(", {:.17g}", z * size) : "");
        };
        std::string text = fmt::format(
            "duration = 1\n[room]\nwalls = \"none\"\nsize = {0}\n[physics]\nsolver = \"iterative\"\n"
            "[[box]]\nname = \"held\"\nmass = 1\nsize = {1}\nposition = {2}\n"
            "[[joint]]\ntype = \"{3}\"\nbetween = [\"held\", \"room\"]\n",
            vector(80, 80, 80), vector(6, 1, 1), vector(30, 20, 0), type);
        if (std::string(type) != "slider") text += "at = " + vector(27, 20, 0) + "\n";
        if (std::string(type) == "slider")
          text += std::string("axis = ") + (space ? "[1, 0, 0]\n" : "[1, 0]\n");
        if (std::string(type) == "hinge") text += "axis = [0, 1, 0]\n";
        const TextRun scene(text);
        const sim::Snapshot now = scene.at(0.01);
        const std::string what = fmt::format("{} of {} in {}", type, size, space ? "space" : "the plane");
        EXPECT_LE((now.bodies[0].position - size * Vec3(30, 20, 0)).norm(), 1e-9 * size) << what;
        EXPECT_NEAR(now.joints[0].force.y(), 9.81, 1e-8) << what;
        if (std::string(type) != "slider") {
          EXPECT_NEAR(std::fabs(now.joints[0].torque.z()), 3 * size * 9.81, 1e-7 * size) << what;
        }
      }
}

// A light knot between two ropes with a load: both are put back at once, or each would slacken the other. The
// energy stays but for the error of Runge-Kutta's scheme, which a chain of rods has too.
TEST(JointEnds, RopesOnALightKnotStayTaut) {
  const auto lost = [](const char* type, double knot, int rate) {
    const TextRun scene(
        fmt::format("duration = 2\n[room]\nsize = [8, 8]\nwalls = \"none\"\n[physics]\nsolver = "
                    "\"iterative\"\nrate = {}\n"
                    "[[box]]\nname = \"knot\"\nposition = [0.5, 3]\nsize = [0.4, 0.4]\nmass = {}\n"
                    "[[ball]]\nname = \"load\"\nposition = [1.5, 3]\nradius = 0.2\nmass = 40\n"
                    "[[joint]]\ntype = \"{}\"\nbetween = [[0, 3.5], \"knot\"]\n"
                    "[[joint]]\ntype = \"{}\"\nbetween = [\"knot\", \"load\"]\n",
                    rate, knot, type, type));
    const double begun = scene.at(0).energies.total();
    return std::fabs(scene.at(1).energies.total() - begun);
  };
  for (const auto& [knot, rate, most] : {std::tuple(1.0, 600, 2e-2), std::tuple(1.0, 1200, 2e-3),
                                         std::tuple(0.3, 1200, 0.5), std::tuple(5.0, 240, 0.1)}) {
    EXPECT_LE(lost("rope", knot, rate), most) << knot << " " << rate;
    EXPECT_LE(lost("rod", knot, rate), most) << knot << " " << rate;
  }
  // lighter than a thousandth of the load: in a row with it the knot passes its ropes at forty metres a
  // second
  EXPECT_LE(lost("rod", 0.03, 6000), 1);
  EXPECT_LE(lost("rope", 0.03, 6000), 2);
}

// The whip of a knot too light for the step is said, by either solver.
TEST(JointEnds, AKnotThatStepsDoNotFollowIsTold) {
  for (const char* solver : {"direct", "iterative"})
    for (const char* type : {"rod", "rope"}) {
      const TextRun scene(fmt::format(
          "duration = 2\n[room]\nsize = [8, 8]\nwalls = \"none\"\n[physics]\nsolver = \"{}\"\nrate = 600\n"
          "[[box]]\nname = \"knot\"\nposition = [0.5, 3]\nsize = [0.4, 0.4]\nmass = 0.03\n"
          "[[ball]]\nname = \"load\"\nposition = [1.5, 3]\nradius = 0.2\nmass = 40\n"
          "[[joint]]\ntype = \"{}\"\nbetween = [[0, 3.5], \"knot\"]\n"
          "[[joint]]\ntype = \"{}\"\nbetween = [\"knot\", \"load\"]\n",
          solver, type, type));
      scene.at(2);
      EXPECT_GT(scene.run->limits_met().rough.steps, 0) << solver << " " << type;
      EXPECT_GE(scene.run->limits_met().wildest.step, 0) << solver << " " << type;
    }
}

// Links that a heavy load pulls taut swing faster than the steps follow: that is said, or they go by parts of
// a step.
TEST(JointEnds, ATautChainThatStepsDoNotFollowIsToldOrFollowed) {
  const auto rough = [](const char* solver, double load) {
    std::string text = fmt::format(
        "duration = 2\n[room]\nsize = [8, 8]\nwalls = \"none\"\n[contact]\nignore = [[\"g\", \"g\"]]\n"
        "[physics]\nsolver = \"{}\"\n",
        solver);
    std::string joints, before = "room";
    for (int i = 0; i < 24; ++i) {
      text += fmt::format(
          "[[box]]\nname = \"l{}\"\nmass = 0.1\ngroup = \"g\"\nposition = [{:.17g}, 6]\nsize = "
          "[0.1, 0.03]\n",
          i, 4.05 + 0.1 * i);
      joints += fmt::format("[[joint]]\ntype = \"pin\"\nbetween = [\"l{}\", \"{}\"]\nat = [{:.17g}, 6]\n", i,
                            before, 4 + 0.1 * i);
      before = fmt::format("l{}", i);
    }
    text += fmt::format(
        "[[ball]]\nname = \"load\"\nradius = 0.08\nmass = {}\ngroup = \"g\"\nposition = [6.5, 6]\n{}"
        "[[joint]]\ntype = \"pin\"\nbetween = [\"load\", \"{}\"]\nat = [6.4, 6]\n",
        load, joints, before);
    const TextRun scene(text);
    const double begun = scene.at(0).energies.total(), lost = begun - scene.at(1.5).energies.total();
    return std::pair(scene.run->limits_met().rough.steps, lost / (load * kPulledDown * 2.5));
  };
  EXPECT_GT(rough("direct", 50).first, 300);
  EXPECT_EQ(rough("iterative", 100).first, 0);
  EXPECT_LT(std::fabs(rough("iterative", 100).second), 1e-4);
  for (const char* solver : {"direct", "iterative"}) EXPECT_LT(rough(solver, 1).first, 90) << solver;
}

}  // namespace
}  // namespace obscura::scene

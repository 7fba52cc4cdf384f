// What joints bear and give, as is reported of them: force and torque against closed forms, against what the
// bodies do, and the work of motors and drag.

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <string>
#include <vector>

#include "scene/text_run.h"

namespace obscura::scene {
namespace {

constexpr double kFreeFall = 9.81;
constexpr double kSmall = 1e-9;

// A motor of 0.3 N m turns a wheel, and by a gear another until that comes to its limit: 0.3 / 0.2 N at the
// teeth, also once all is at rest.
TEST(JointLoads, AMotorAgainstAStopIsBorneAtRest) {
  for (const Manner& way : kManners) {
    const TextRun run("[room]\nsize = [4, 4]\n" + way.keys +
                      "\n[[ball]]\nname = 'a'\nradius = 0.2\nposition = [2, 2]\nmass = 1\n"
                      "[[ball]]\nname = 'b'\nradius = 0.4\nposition = [2.6, 2]\nmass = 1\n"
                      "[[joint]]\nname = 'axle'\ntype = 'pin'\nbetween = ['a', 'room']\nmotor = { speed = "
                      "360, most = 0.3 }\n"
                      "[[joint]]\nname = 'stop'\ntype = 'pin'\nbetween = ['b', 'room']\nlimits = [-90, 90]\n"
                      "[[joint]]\nname = 'teeth'\ntype = 'gear'\njoints = ['stop', 'axle']\nratio = -0.5\n"
                      "[contact]\nignore = [['a', 'b']]\n");
    for (const double t : {1.0, 3.0}) {
      const sim::Snapshot now = run.at(t);
      EXPECT_NEAR(now.joints[0].torque.norm(), 0.3, 1e-6) << way.name << t;
      EXPECT_NEAR(now.joints[0].force.y(), kFreeFall + 1.5, 1e-6) << way.name << t;
      EXPECT_NEAR(now.joints[2].force.norm(), 1.5, 1e-6) << way.name << t;
    }
  }
}

// A pinion lifts a rack to its limit by a motor that then stands still, and dry friction holds it as the
// limit does: what the teeth do not bear of the rack's weight the limit does. Of 8.3 N it told a half.
TEST(JointLoads, ALimitBearsWhatAStalledMotorAndFrictionLeaveIt) {
  for (const Manner& way : kManners) {
    const TextRun run("[room]\nsize = [8, 8]\nwalls = 'none'\n" + way.keys +
                      "\n[[ball]]\nname = 'pinion'\nradius = 0.9\nmass = 2\nposition = [2.2, 4]\n"
                      "[[box]]\nname = 'rack'\nsize = [0.2, 2]\nmass = 3\nposition = [3.2, 4]\n"
                      "[[joint]]\nname = 'axle'\ntype = 'pin'\nbetween = ['pinion', 'room']\nfriction = 2\n"
                      "motor = { speed = 100, most = 36 }\n"
                      "[[joint]]\nname = 'rail'\ntype = 'slider'\nbetween = ['rack', 'room']\naxis = [0, 1]\n"
                      "limits = [-0.5, 0.7]\n"
                      "[[joint]]\nname = 'teeth'\ntype = 'gear'\njoints = ['rail', 'axle']\nratio = 0.9\n");
    const sim::Snapshot now = run.at(3);
    EXPECT_NEAR(now.bodies[1].position.y(), 4.7, 1e-9) << way.name;
    EXPECT_NEAR(now.joints[1].force.y() + now.joints[2].force.y(), 3 * kFreeFall, 1e-6) << way.name;
  }
}

// What is heavy stands on light wheels, or hangs from light links over a post, by the solver for many bodies
// too: from the first step on they bear it. In turns with the joints, contacts that saw the light body alone
// found what it bears by its share of all the mass: 154 to 6008 N instead of 4905, and weights fell at first.
TEST(JointLoads, LightWheelsAndLinksBearWhatIsHeavy) {
  for (const bool space : {false, true}) {
    for (const int rate : {60, 240, 600}) {
      const auto room = [&](const char* size) {
        return fmt::format(
            "[room]\nsize = {}\nwalls = 'ground'\n[physics]\nsolver = 'iterative'\nrate = {}\n", size, rate);
      };
      const char* z = space ? ", 0" : "";
      const auto box = [&](const char* name, double mass, const char* size, double x, double y) {
        return fmt::format(
            "[[box]]\nname = '{}'\nmass = {}\nelasticity = 0\nsize = [{}{}]\nposition = [{}, {}{}]\n", name,
            mass, size, space ? ", 0.4" : "", x, y, z);
      };
      // a car of a ton on wheels of a kilogram, in space on axles of two
      std::string car = room(space ? "[20, 4, 20]" : "[20, 4]") + box("car", 1000, "2, 0.3", 0, 0.5);
      for (const double x : {-0.7, 0.7}) {
        for (const double side : {-0.3, 0.3}) {
          if (!space && side > 0) continue;
          const std::string name = fmt::format("w{}{}", x > 0 ? 1 : 0, side > 0 ? 1 : 0),
                            at =
                                space ? fmt::format("[{}, 0.25, {}]", x, side) : fmt::format("[{}, 0.25]", x);
          car += fmt::format(
              "[[ball]]\nname = '{0}'\nradius = 0.25\nmass = 1\nfriction = 0.8\nelasticity = 0\n"
              "position = {1}\n[[joint]]\ntype = '{2}'\nbetween = ['{0}', 'car']\nat = {1}\n{3}",
              name, at, space ? "hinge" : "pin", space ? "axis = [0, 0, 1]\n" : "");
        }
      }
      const TextRun stands(car);
      for (const double t : {1.0 / 60, 0.1, 1.0}) {
        const sim::Snapshot now = stands.at(t);
        for (const auto& joint : now.joints)
          EXPECT_NEAR(joint.force.norm(), 1000 * kFreeFall / (space ? 4 : 2), 0.01) << space << rate << t;
        EXPECT_NEAR(now.bodies[std::size_t(number_of(stands, "car"))].position.y(), 0.5, 1e-8)
            << space << rate;
      }
      if (space) continue;
      // weights of a kilogram on links of 20 g over a post without friction, and a heavier one on one side
      for (const double more : {0.0, 0.2}) {
        const TextRun hangs(room("[20, 8]") +
                            "[[ball]]\nname = 'post'\nfixed = true\nradius = 0.3\nposition = [4, "
                            "4]\nfriction = 0\nelasticity = 0\n"
                            "[[ball]]\nname = 'k'\nradius = 0.03\nmass = 0.02\nfriction = 0\nelasticity = 0\n"
                            "copies = { at = [[3.67, 4], [4, 4.33], [4.33, 4]] }\n"
                            "[[joint]]\ntype = 'rod'\nbetween = ['k[0..1]', 'k[1..2]']\n" +
                            box("l", 1, "0.2, 0.2", 3.67, 3) + box("r", 1 + more, "0.2, 0.2", 4.33, 3) +
                            "[[joint]]\ntype = 'rod'\nbetween = ['k[0]', { body = 'l', at = 'top' }]\n"
                            "[[joint]]\ntype = 'rod'\nbetween = ['k[2]', { body = 'r', at = 'top' }]\n");
        // of masses m and m' and three links: a = (m' - m) g / (m + m' + 0.06)
        const double a = more * kFreeFall / (2 + more + 0.06);
        for (const double t : {1.0 / 60, 0.1}) {
          const sim::Snapshot now = hangs.at(t);
          EXPECT_NEAR(now.bodies[std::size_t(number_of(hangs, "l"))].velocity.y(), a * t, 2e-3 * a * t + 1e-9)
              << rate << " " << more;
        }
      }
    }
  }
}

// A beam of 2 kg and 3 m that a wall holds at one end: m g, and m g l / 2 about that end.
TEST(JointLoads, AWeldBearsTheBendingMomentOfABeam) {
  for (const Manner& way : kManners) {
    for (const bool space : {false, true}) {
      TextRun scene((space ? space_without_walls(way) : plane_without_walls(way)) +
                    fmt::format("[[box]]\nname = 'beam'\nsize = [3, 0.2{0}]\nmass = 2\nposition = [1.5, "
                                "0{1}]\n[[joint]]\nname = 'wall'\ntype = 'weld'\nbetween = ['beam', "
                                "'room']\nat = [0, 0{1}]\n",
                                space ? ", 0.2" : "", space ? ", 0" : ""));
      const sim::Snapshot now = scene.at(0.5);
      EXPECT_NEAR((now.joints[0].force - sim::Vec3(0, 2 * kFreeFall, 0)).norm(), 0, 1e-8)
          << way.name << space;
      EXPECT_NEAR((now.joints[0].torque - sim::Vec3(0, 0, 2 * kFreeFall * 1.5)).norm(), 0, 1e-8)
          << way.name << space;
    }
  }
}

// and the other way round: what is a and what is b changes its sign alone
TEST(JointLoads, TheRoomAsTheFirstEndBearsTheOpposite) {
  for (const Manner& way : kManners) {
    TextRun scene(plane_without_walls(way) +
                  "[[box]]\nname = 'beam'\nsize = [3, 0.2]\nmass = 2\nposition = [1.5, 0]\n[[joint]]\ntype = "
                  "'weld'\nbetween = ['room', 'beam']\nat = [0, 0]\n");
    const sim::Snapshot now = scene.at(0.5);
    const double sign = scene.run->scene_info().joints[0].a < 0 ? -1 : 1;
    EXPECT_NEAR(now.joints[0].force.y(), sign * 2 * kFreeFall, 1e-8) << way.name;
    EXPECT_NEAR(now.joints[0].torque.z(), sign * 2 * kFreeFall * 1.5, 1e-8) << way.name;
  }
}

// A motor that gives its most all the time: that torque, and its work is torque times angle.
TEST(JointLoads, AMotorAtItsMostGivesThatAndItsWorkIsTorqueTimesAngle) {
  for (const Manner& way : kManners) {
    for (const bool space : {false, true}) {
      TextRun scene(
          (space ? space_without_walls(way, "gravity = [0, 0, 0]\n")
                 : plane_without_walls(way, "gravity = [0, 0]\n")) +
          fmt::format("[[ball]]\nname = 'wheel'\nradius = 0.5\nmass = 4\nposition = [0, 0{}]\n"
                      "[[joint]]\ntype = 'hinge'\nbetween = ['wheel', 'room']\n{}motor = {{ speed = "
                      "1e6, most = 0.3 }}\n",
                      space ? ", 0" : "", space ? "axis = [0, 0, 1]\n" : ""));
      const double inertia = space ? 0.4 * 4 * 0.25 : 0.5 * 4 * 0.25, t = 1.5;
      const sim::Snapshot now = scene.at(t);
      const double w = 0.3 / inertia * t;
      EXPECT_NEAR(now.bodies[0].spin.z(), w, kSmall) << way.name << space;
      EXPECT_NEAR(now.joints[0].torque.z(), 0.3, kSmall) << way.name << space;
      EXPECT_NEAR(now.bodies[0].torque.z(), 0.3, kSmall) << way.name << space;
      EXPECT_NEAR(now.energies.work, 0.3 * 0.5 * w * t, 1e-8) << way.name << space;
      EXPECT_NEAR(now.energies.total() - now.energies.work, 0, 1e-8) << way.name << space;
    }
  }
}

// A motor that lifts a weight on an arm at its speed: m g l cos(theta) at each angle, and its work is what
// the weight gains.
TEST(JointLoads, AMotorThatHoldsItsSpeedBearsWhatHangsOnIt) {
  for (const Manner& way : kManners) {
    TextRun scene(
        plane_without_walls(way) +
        "[[ball]]\nname = 'bob'\nradius = 0.1\nmass = 2\nposition = [1, 0]\nvelocity = [0, 0.7]\nspin = "
        "40.107045659157625\n[[joint]]\ntype = 'pin'\nbetween = ['bob', 'room']\nat = [0, 0]\nmotor = { "
        "speed = "
        "40.107045659157625, most = 1000 }\n");
    const double begun = scene.at(0).energies.total();
    for (const double t : {0.5, 1.25, 3.0}) {
      const sim::Snapshot now = scene.at(t);
      const double angle = 0.7 * t;
      EXPECT_NEAR(now.bodies[0].angle, angle, 1e-7) << way.name;
      EXPECT_NEAR(now.joints[0].torque.z(), 2 * kFreeFall * std::cos(angle), 0.03) << way.name;
      EXPECT_NEAR(now.energies.total() - begun, 2 * kFreeFall * std::sin(angle), 1e-6) << way.name;
      EXPECT_NEAR(now.energies.work, 2 * kFreeFall * std::sin(angle), way.name == "iterative" ? 2e-4 : 1e-6)
          << way.name;
    }
  }
}

// A torsion spring: -k theta; a slider's: -k x along its axis.
TEST(JointLoads, SpringsOfJointsAreReportedWithThem) {
  for (const Manner& way : kManners) {
    TextRun turned(plane_without_walls(way, "gravity = [0, 0]\n") +
                   "[[box]]\nname = 'bar'\nsize = [1, 0.1]\nmass = 1\nposition = [0, 0]\nspin = "
                   "114.59155902616465\n[[joint]]\n"
                   "type = 'pin'\nbetween = ['bar', 'room']\nspring = { stiffness = 3 }\n");
    TextRun slid(
        plane_without_walls(way, "gravity = [0, 0]\n") +
        "[[box]]\nname = 'cart'\nsize = [1, 0.2]\nmass = 1\nposition = [0, 0]\nvelocity = [2, 0]\n"
        "[[joint]]\ntype = 'slider'\nbetween = ['cart', 'room']\naxis = [1, 0]\nspring = { stiffness = "
        "3 }\n");
    for (const double t : {0.1, 0.4, 0.9}) {
      const sim::Snapshot turn = turned.at(t), slide = slid.at(t);
      EXPECT_NEAR(turn.joints[0].torque.z(), -3 * turn.bodies[0].angle, 1e-8) << way.name;
      EXPECT_NEAR(slide.joints[0].force.x(), -3 * slide.bodies[0].position.x(), 1e-8) << way.name;
      EXPECT_GT(std::fabs(turn.joints[0].torque.z()), 0.1);
    }
  }
}

// Two wheels on one axle, geared 2 to 1: no teeth, but a torque. A torque M on the first: its wheel has
// M - tau, the other gets n tau.
TEST(JointLoads, CoaxialGearsReportTheirTorque) {
  for (const Manner& way : kManners) {
    TextRun scene(
        plane_without_walls(way, "gravity = [0, 0]\n") +
        "[[ball]]\nname = 'p'\nradius = 0.5\nmass = 2\nposition = [0, 0]\ngroup = 'g'\n"
        "[[ball]]\nname = 'q'\nradius = 0.4\nmass = 1\nposition = [0, 0]\ngroup = 'g'\n"
        "[[joint]]\nname = 'one'\ntype = 'pin'\nbetween = ['p', 'room']\nmotor = { speed = 1e6, most = "
        "0.5 }\n[[joint]]\nname = 'two'\ntype = 'pin'\nbetween = ['q', 'room']\n[[joint]]\nname = "
        "'box'\ntype = 'gear'\njoints = ['one', 'two']\nratio = 2\n");
    const sim::Snapshot now = scene.at(0.5);
    const double I = 0.5 * 2 * 0.25, J = 0.5 * 1 * 0.16;
    const double alpha = 0.5 / (I + J / 4);  // of p; q turns half as fast
    EXPECT_NEAR(now.bodies[0].spin.z(), alpha * 0.5, kSmall) << way.name;
    EXPECT_NEAR(now.bodies[1].spin.z(), alpha * 0.25, kSmall) << way.name;
    EXPECT_NEAR(now.joints[2].torque.z(), -J * alpha / 4, kSmall) << way.name;
    EXPECT_NEAR(now.bodies[1].torque.z(), J * alpha / 2, kSmall) << way.name;
    EXPECT_NEAR(now.energies.total(), now.energies.work, 1e-8) << way.name;
  }
}

// A gear's joints hold both wheels: what turns the one turns the other back, by the ratio; its teeth push
// both.
TEST(JointLoads, AGearReportsWhatItPutsOnBothItsWheels) {
  for (const Manner& way : kManners) {
    TextRun scene(
        plane_without_walls(way, "gravity = [0, 0]\n") +
        "[[ball]]\nname = 'p'\nradius = 0.5\nmass = 2\nposition = [0, 0]\n"
        "[[ball]]\nname = 'q'\nradius = 1\nmass = 1\nposition = [1.5, 0]\n"
        "[[joint]]\nname = 'one'\ntype = 'pin'\nbetween = ['p', 'room']\nmotor = { speed = 1e6, most = "
        "0.5 }\n[[joint]]\nname = 'two'\ntype = 'pin'\nbetween = ['q', 'room']\n[[joint]]\nname = "
        "'teeth'\ntype = 'gear'\njoints = ['one', 'two']\nratio = -2\n");
    const sim::Snapshot now = scene.at(0.5);
    const double J = 0.5, alpha = 0.5 / (0.25 + J / 4),
                 tooth = J * alpha / 2;  // q's rim is 1 m from its axle
    ASSERT_EQ(now.joints[2].holds.size(), 2u);
    EXPECT_NEAR(now.joints[2].holds[0].torque.z(), -tooth * 0.5, kSmall) << way.name;
    EXPECT_NEAR(now.joints[2].holds[1].torque.z(), -tooth, kSmall) << way.name;
    EXPECT_NEAR((now.joints[2].holds[0].force + now.joints[2].holds[1].force).norm(), 0, kSmall) << way.name;
    EXPECT_NEAR(now.joints[2].holds[0].force.norm(), tooth, kSmall) << way.name;
    EXPECT_NEAR(now.bodies[1].torque.z(), -tooth, kSmall) << way.name;
    EXPECT_NEAR(now.bodies[0].torque.z(), 0.5 - tooth * 0.5, kSmall) << way.name;
    EXPECT_NEAR(now.bodies[0].held.norm(), 0, kSmall) << way.name;
    // which the axles bear
    EXPECT_NEAR((now.joints[0].force + now.joints[2].holds[0].force).norm(), 0, kSmall) << way.name;
    EXPECT_NEAR((now.joints[1].force + now.joints[2].holds[1].force).norm(), 0, kSmall) << way.name;
    for (const auto& hold : now.joints[2].holds)
      EXPECT_NEAR((hold.at - sim::Vec3(0.5, 0, 0)).norm(), 0, kSmall) << way.name;
  }
}

// A lecturer's gears and rack, in the plane and in space: weight, teeth and axle are in balance on each
// wheel.
TEST(JointLoads, AxlesBearTheTeethAndTheWeight) {
  for (const Manner& way : kManners) {
    for (const bool space : {false, true}) {
      const std::string z = space ? ", 0" : "", pin = space ? "hinge" : "pin",
                        axis = space ? "axis = [0, 0, 1]\n" : "";
      const std::string wheels =
          (space ? space_without_walls(way) : plane_without_walls(way)) +
          fmt::format(
              "[[ball]]\nname = 's'\nradius = 0.3\nmass = 1\nposition = [2, 2.5{0}]\n[[ball]]\nname = "
              "'b'\nradius = 0.9\nmass = 4\nposition = [3.2, 2.5{0}]\n[[box]]\nname = 'rack'\nsize = "
              "[0.2, 3{1}]\nmass = 0.5\nposition = [4.2, 2.5{0}]\n[[joint]]\nname = 'sa'\ntype = "
              "'{2}'\n{3}between = ['s', 'room']\nmotor = {{ speed = 100000, most = 2 }}\nbreaks = "
              "1000\n[[joint]]\nname = 'ba'\ntype = '{2}'\n{3}between = ['b', 'room']\n[[joint]]\nname = "
              "'guide'\ntype = 'slider'\naxis = [0, 1{0}]\nbetween = ['rack', 'room']\n[[joint]]\nname = "
              "'teeth'\ntype = 'gear'\njoints = ['sa', 'ba']\nratio = -3\n[[joint]]\nname = "
              "'mesh'\ntype = 'gear'\njoints = ['guide', 'ba']\nratio = 0.9\n",
              z, space ? ", 0.2" : "", pin, axis);
      TextRun scene(wheels);
      const sim::Snapshot now = scene.at(0.5);
      const double s = space ? 0.4 : 0.5, Is = s * 0.09, Ib = s * 4 * 0.81;
      // the rack sinks by 0.9 m a radian of b, which turns clockwise, a third as fast as s
      const double alpha = -(3 * 2 + 0.9 * 0.5 * kFreeFall) / (9 * Is + Ib + 0.5 * 0.81);
      EXPECT_NEAR(now.bodies[1].spin.z(), 0.5 * alpha, 1e-8) << way.name << space;
      for (const std::size_t wheel : {0u, 1u}) {
        const double mass = wheel == 0 ? 1 : 4;
        EXPECT_NEAR((now.bodies[wheel].held - sim::Vec3(0, mass * kFreeFall, 0)).norm(), 0, 1e-8)
            << way.name << space;
      }
      const double tooth = (2 + 3 * Is * alpha) / 0.3;
      EXPECT_NEAR(now.joints[3].force.norm(), tooth, 1e-7) << way.name << space;
      EXPECT_NEAR((now.joints[0].force + now.joints[3].force - sim::Vec3(0, kFreeFall, 0)).norm(), 0, 1e-7)
          << way.name << space;
      // 9.81 N alone are borne, with the teeth they are not; then the gear is off as well
      TextRun weak(wheels, {"sa.breaks=12"});
      const sim::Snapshot off = weak.at(0.5);
      EXPECT_TRUE(off.joints[0].broken && off.joints[3].broken && !off.joints[1].broken) << way.name << space;
    }
  }
}

// The rope of a block and tackle pulls at each place that it runs over.
TEST(JointLoads, ARopePullsWhereItRunsOver) {
  for (const Manner& way : kManners) {
    TextRun scene(plane_without_walls(way) +
                  "[[box]]\nname = 'load'\nsize = [1, 0.5]\nmass = 4\nposition = [0, 0]\n"
                  "[[particle]]\nname = 'weight'\nmass = 2\nposition = [2, 3]\nradius = 0.1\n"
                  "[[joint]]\ntype = 'pulley'\nbetween = [[-0.2, 4], 'weight']\n"
                  "over = [{ body = 'load', local = [0, 0] }, [0.2, 4], [2, 4]]\n");
    const std::size_t load = number_of(scene, "load");
    const sim::Snapshot now = scene.at(0.3);
    std::vector<sim::Snapshot::Joint::Hold> on;
    for (const auto& hold : now.joints[0].holds)
      if (hold.body == int(load)) on.push_back(hold);
    ASSERT_EQ(on.size(), 1u) << way.name;
    EXPECT_NEAR((on[0].place - now.bodies[load].position).norm(), 0, kSmall) << way.name;
    EXPECT_NEAR((on[0].force - now.bodies[load].held).norm(), 0, kSmall) << way.name;
    EXPECT_GT(on[0].force.y(), 1.9 * now.joints[0].force.norm()) << way.name;
  }
}

// Of a wheel that turns with its rope each piece pulls where it leaves the rim, so that arrows of the two are
// apart.
TEST(JointLoads, ARopePullsAtAWheelWhereItLeavesIt) {
  for (const Manner& way : kManners) {
    TextRun scene(plane_without_walls(way) +
                  "[[ball]]\nname = 'wheel'\nradius = 0.5\nmass = 4\nposition = [0, 3]\n"
                  "[[joint]]\ntype = 'pin'\nbetween = ['wheel', 'room']\n"
                  "[[particle]]\nname = 'left'\nmass = 1\nposition = [-0.5, 0]\n"
                  "[[particle]]\nname = 'right'\nmass = 2\nposition = [0.5, 1]\n"
                  "[[joint]]\ntype = 'pulley'\nbetween = ['left', 'right']\nover = ['wheel']\n");
    const std::size_t wheel = number_of(scene, "wheel");
    const sim::Snapshot now = scene.at(0.2);
    std::vector<sim::Vec3> at;
    for (std::size_t i = 1; i < now.joints.size(); ++i)
      for (const auto& hold : now.joints[i].holds)
        if (hold.body == int(wheel)) at.push_back(hold.at - now.bodies[wheel].position);
    ASSERT_EQ(at.size(), 2u) << way.name;
    if (at[0].x() > at[1].x()) std::swap(at[0], at[1]);
    EXPECT_LT((at[0] - sim::Vec3(-0.5, 0, 0)).norm(), 1e-9) << way.name;
    EXPECT_LT((at[1] - sim::Vec3(0.5, 0, 0)).norm(), 1e-9) << way.name;
  }
}

// What is reported makes each body's acceleration: m a and I alpha from differences of velocities.
TEST(JointLoads, TogetherMakeTheAccelerationOfEachBody) {
  const std::string linkage =
      "[[box]]\nname = 'base'\nsize = [0.6, 0.3]\nmass = 3\nposition = [0, 0]\n"
      "[[box]]\nname = 'arm'\nsize = [1, 0.1]\nmass = 1\nposition = [0.5, 0]\nspin = 1\nvelocity = [0, 0.5]\n"
      "[[ball]]\nname = 'tip'\nradius = 0.2\nmass = 0.5\nposition = [1, 0]\nvelocity = [0, 1]\nspin = 3\n"
      "[[ball]]\nname = 'load'\nradius = 0.1\nmass = 2\nposition = [-2, -1]\n"
      "[[box]]\nname = 'block'\nsize = [0.5, 0.4]\nmass = 2\nposition = [-3, -2]\n"
      "[[joint]]\ntype = 'slider'\nbetween = ['base', 'room']\naxis = [1, 0.2]\nspring = { stiffness = 20, "
      "damping "
      "= 1 }\n"
      "[[joint]]\ntype = 'pin'\nbetween = ['arm', 'base']\nat = [0, 0]\nmotor = { speed = 500, most = 1.5 }\n"
      "[[joint]]\ntype = 'pin'\nbetween = ['tip', 'arm']\nat = [1, 0]\nfriction = 0.2\nspring = { stiffness "
      "= 0.7 }\n"
      "[[joint]]\ntype = 'pulley'\nbetween = ['load', [-4, 2]]\nover = [[-2, 2], { body = 'block', local = "
      "[0.2, "
      "0.1] }, [-3.5, 2], { body = 'block', local = [-0.2, 0.1] }]\n";
  for (const Manner& way : kManners) {
    for (const double t : {0.12, 0.3, 0.55}) {
      TextRun scene(plane_without_walls(way) + linkage, {"physics.rate=6000"});
      const double h = 1e-3, bound = way.name == "iterative" ? 1e-2 : 5e-4;
      const sim::Snapshot before = scene.at(t - h), now = scene.at(t), after = scene.at(t + h);
      const auto& cast = scene.run->scene_info();
      for (std::size_t i = 0; i < now.bodies.size(); ++i) {
        const sim::SceneInfo::Body& its = cast.bodies[i];
        const double inertia = its.kind == sim::ShapeKind::box ? its.mass / 3 * its.half.squaredNorm()
                                                               : 0.5 * its.mass * its.radius * its.radius;
        const sim::Vec3 ma = its.mass / (2 * h) * (after.bodies[i].velocity - before.bodies[i].velocity);
        const double rate = inertia / (2 * h) * (after.bodies[i].spin - before.bodies[i].spin).z();
        // differences err by h^2 / 6 of the third derivative; by iterations forces are means of a step of
        // 1/6000 s, half of it late, and change by up to 100 N/s
        EXPECT_NEAR((its.mass * cast.gravity + now.bodies[i].held - ma).norm(), 0, bound)
            << way.name << " " << its.name << " " << t;
        EXPECT_NEAR(now.bodies[i].torque.z(), rate, bound) << way.name << " " << its.name << " " << t;
      }
    }
  }
}

// A chain's joints report theirs, too.
TEST(JointLoads, AChainsWeldBearsTheBendingMoment) {
  TextRun scene(
      "duration = 1000\n[room]\nsize = [20, 20]\ncorner = [-10, -10]\nwalls = 'none'\n[physics]\n"
      "collision = 'contact'\n[[box]]\nname = 'one'\nsize = [1, 0.2]\nmass = 2\nposition = [0.5, 0]\n"
      "[[box]]\nname = 'two'\nsize = [1, 0.2]\nmass = 3\nposition = [1.5, 0]\n"
      "[[joint]]\nname = 'wall'\ntype = 'weld'\nbetween = ['one', 'room']\nat = [0, 0]\n"
      "[[joint]]\nname = 'middle'\ntype = 'weld'\nbetween = ['two', 'one']\nat = [1, 0]\n"
      "[[chain]]\nof = ['one', 'two']\n");
  const sim::Snapshot now = scene.at(0.5);
  EXPECT_NEAR(now.joints[0].torque.z(), (2 * 0.5 + 3 * 1.5) * kFreeFall, 1e-8);
  EXPECT_NEAR(now.joints[1].torque.z(), 3 * 0.5 * kFreeFall, 1e-8);
}

// A beam whose weld bears a thousandth more than its bending moment, or less.
TEST(JointLoads, ATorqueAboveItsMostBreaksAJoint) {
  for (const Manner& way : kManners) {
    const auto held = [&](double most) {
      TextRun scene(plane_without_walls(way) +
                    fmt::format("[[box]]\nname = 'beam'\nsize = [3, 0.2]\nmass = 2\nposition = [1.5, 0]\n"
                                "[[joint]]\ntype = 'weld'\nbetween = ['beam', 'room']\nat = [0, "
                                "0]\nbreaks_torque = {}\n",
                                most));
      return !scene.at(0.5).joints[0].broken;
    };
    EXPECT_TRUE(held(2 * kFreeFall * 1.5 * 1.001)) << way.name;
    EXPECT_FALSE(held(2 * kFreeFall * 1.5 * 0.999)) << way.name;
  }
}

// The torque of a torsion spring that is wound up by a turning body passes its strength at a known time:
// theta = w0 / W sin(W t), k theta = most. Under `event` at that time, else at the end of the step.
TEST(JointLoads, ATorsionSpringBreaksItsPinWhenItIsWoundSoFar) {
  const double k = 3, I = 1.0 / 12 * (1 + 0.01), W = std::sqrt(k / I), most = 0.5;
  const double when = std::asin(most / k * W / 2) / W;
  for (const Manner& way : kManners) {
    const std::string text =
        plane_without_walls(way, "gravity = [0, 0]\n") +
        fmt::format(
            "[[box]]\nname = 'bar'\nsize = [1, 0.1]\nmass = 1\nposition = [0, 0]\nspin = "
            "114.59155902616465\n[[joint]]\nname "
            "= 'pin'\ntype = 'pin'\nbetween = ['bar', 'room']\nspring = {{ stiffness = {} }}\nbreaks_torque "
            "= {}\n[[when]]\nbreaks = 'pin'\ndo = [{{ mark = 'off' }}]\n[[when]]\nvalue = 'pin.torque > "
            "0.25'\ndo = [{{ mark = 'half' }}]\n",
            k, most);
    TextRun scene(text);
    scene.at(0.5);
    const auto events = scene.run->events();
    ASSERT_EQ(events.size(), 2u) << way.name;
    const double half = std::asin(0.25 / k * W / 2) / W;
    const double exact = way.name == "event" ? 1e-8 : 2.0 / 600;
    EXPECT_NEAR(sim::value(events[0].time), half, exact) << way.name;
    EXPECT_NEAR(sim::value(events[1].time), when, exact) << way.name;
    // the instant of the break has what broke it, the next step nothing
    TextRun again(text);
    const auto at = again.run->at(events[1].time);
    EXPECT_NEAR(std::fabs(std::get<sim::Snapshot>(at).joints[0].torque.z()), most,
                way.name == "event" ? 1e-8 : 0.1)
        << way.name;
    EXPECT_EQ(scene.at(0.5).joints[0].torque.z(), 0) << way.name;
  }
}

TEST(JointLoads, WhatBearsNoTorqueIsNotBrokenByOne) {
  const std::string two =
      plane_without_walls(kManners[0]) + "[[ball]]\nname = 'a'\nradius = 0.1\nposition = [0, 0]\n";
  EXPECT_THAT(refusal(two + "[[joint]]\ntype = 'rope'\nbetween = ['a', [0, 1]]\nbreaks_torque = 2\n"),
              testing::HasSubstr("bears no torque"));
}

// The room's drag: (1 - exp(-2 c t / m)) of the kinetic energy, alone, among forces, and where bodies touch.
TEST(Books, DragIsBookedAsWork) {
  const double c = 0.7, m = 2, v = 3, t = 1.5;
  const double left = 0.5 * m * v * v * std::exp(-2 * c * t / m);
  for (const std::string mode : {"handout", "contact", "event"}) {
    for (const std::string& force : {std::string(), std::string("[[force]]\ncomponents = ['0', '0']\n")}) {
      TextRun scene(
          fmt::format("duration = 1000\n[room]\nsize = [20, 20]\ncorner = [-10, -10]\nwalls = "
                      "'none'\ngravity = [0, 0]\n[physics]\nrate = 600\ncollision = '{}'\n"
                      "[[particle]]\nradius = 0.1\nmass = {}\nposition = [0, 0]\nvelocity = [{}, "
                      "0]\ndrag = {}\n{}",
                      mode, m, v, c, force));
      const sim::Snapshot now = scene.at(t);
      EXPECT_NEAR(now.energies.kinetic, left, 1e-9) << mode;
      EXPECT_NEAR(now.energies.work, left - 0.5 * m * v * v, 1e-9) << mode << force;
    }
  }
}

// A hand that stirs a dragged ball for ever takes and gives many times what there is: no divergence.
TEST(Books, AHandThatStirsAgainstDragIsNoDivergence) {
  std::string path;
  for (int i = 0; i <= 400; ++i)
    path += fmt::format("{}[{:.2f}, {:.6f}, {:.6f}]", i ? ", " : "", 0.05 * i, 2 + std::cos(0.6 * i),
                        2 + std::sin(0.6 * i));
  TextRun scene(
      fmt::format("duration = 30\n[room]\nsize = [4, 4]\ngravity = [0, 0]\n[physics]\nrate = 600\n"
                  "[[particle]]\nradius = 0.1\nmass = 0.01\nposition = [3, 2]\ndrag = "
                  "2\n[[mouse]]\nstiffness = 50\npath = [{}]\n",
                  path));
  EXPECT_LT(scene.at(19).energies.work, -100);
}

}  // namespace
}  // namespace obscura::scene

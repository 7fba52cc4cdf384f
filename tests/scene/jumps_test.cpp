// Formulas of the time that jump: the step is cut there, against closed forms.

#include <numbers>

#include "scene/text_run.h"

namespace obscura::scene {
namespace {

constexpr double kAroundJump = 1e-10;  // m: 1e-9 of a step at 60 steps a second, times some m/s

// a body of 1 kg at rest at x = 1 that nothing but `force` moves
std::string pushed(bool space, const std::string& mode, int rate, const std::string& force) {
  const char* z = space ? ", 0" : "";
  return fmt::format(
      "[physics]\nrate = {}\n{}\n[room]\nsize = [8, 8{}]\nwalls = \"none\"\ngravity = [0, 0{}]\n"
      "[[particle]]\nname = \"b\"\nposition = [1, 1{}]\nmass = 1\n"
      "[[force]]\nof = \"b\"\ncomponents = [\"{}\", \"0\"{}]\n",
      rate, mode, space ? ", 8" : "", z, z, force, space ? ", \"0\"" : "");
}

constexpr const char* kJumpModes[] = {"collision = \"contact\"", "collision = \"event\"",
                                      "collision = \"handout\"", "solver = \"iterative\"",
                                      "integrator = \"midpoint\""};

TEST(Jumps, APushEndsAtItsTime) {
  for (const char* mode : kJumpModes) {
    for (const bool space : {false, true}) {
      for (const int rate : {60, 600}) {
        // within a step, where one begins, and not at all
        for (const double ends : {0.5037, 0.5, 7.0}) {
          const double to = std::min(ends, 2.0);
          const sim::Snapshot at =
              TextRun(pushed(space, mode, rate, fmt::format("if(t < {}, 3, 0)", ends))).at(2);
          EXPECT_NEAR(at.bodies[0].position.x(), 1 + 1.5 * to * to + 3 * to * (2 - to), kAroundJump)
              << mode << space << rate << " " << ends;
        }
      }
    }
  }
}

// Stairs, 0, 1, 2 ... N for a third of a second each; a square wave; and two jumps within one step.
TEST(Jumps, EachOfManyIsAtItsTime) {
  for (const char* mode : kJumpModes) {
    for (const int rate : {60, 600}) {
      const auto speed = [&](const char* force) {
        return TextRun(pushed(false, mode, rate, force)).at(2).bodies[0].velocity.x();
      };
      EXPECT_NEAR(speed("floor(3*t)"), 15.0 / 3, kAroundJump) << mode << rate;
      // the scheme's own order is left: 4, of the midpoint 2
      EXPECT_NEAR(speed("(sin(7*t) > 0) * sin(7*t)"), (4 + 1 - std::cos(7 * 2 - 4 * std::numbers::pi)) / 7,
                  std::string(mode).ends_with("midpoint\"") ? 4e-4 * 60 * 60 / (rate * rate) : 1e-6)
          << mode << rate;
      EXPECT_NEAR(speed("100*((t > 0.7512) - (t > 0.7514))"), 0.02, 1e-7) << mode << rate;
    }
  }
}

// A blow of 1000 N for .4 ms, which no stage of a step need see, however it is written; and a light that
// flashes where cos(40 t) > c, 6.5 times in a second, for 2 acos(c) / 40 each.
TEST(Jumps, ABlowWithinAStepIsWhole) {
  const double around = 2 * 1000 * 1e-9 / 60;  // N s: the pieces about both jumps
  for (const char* mode : kJumpModes) {
    for (const bool space : {false, true}) {
      for (const int rate : {60, 600}) {
        const auto speed = [&](const char* force) {
          return TextRun(pushed(space, mode, rate, force)).at(1).bodies[0].velocity.x();
        };
        for (const char* blow :
             {"if(abs(t-0.5008)<0.0002,1000,0)", "if((t-0.5008)^2<0.0002^2,1000,0)",
              "1000*(sign(0.0002-abs(t-0.5008))>0)", "1000*(cos(10*(t-0.5008))>cos(0.002))",
              "1000*(exp(abs(t-0.5008))<exp(0.0002))"})
          EXPECT_NEAR(speed(blow), 0.4, around) << blow << mode << space << rate;
        EXPECT_NEAR(speed("100*(cos(40*t)>0.9999)"), 100 * 6.5 * 2 * std::acos(0.9999) / 40, 1e-8)
            << mode << space << rate;
      }
    }
  }
}

// A force whose jumps rounding alone decides, and one that is no number for a second: runs end, and a blow in
// the same scene is whole.
TEST(Jumps, OfOneFormulaDoNotHideThoseOfAnother) {
  for (const char* beside : {"if(sin(t)^2+cos(t)^2<=1,1,0)", "if(t < 1, 0, floor(sqrt(t - 1)))"}) {
    const sim::Snapshot at =
        TextRun(pushed(false, "collision = \"contact\"", 60, beside) +
                "[[particle]]\nname = \"c\"\nposition = [1, 3]\nmass = 1\n"
                "[[force]]\nof = \"c\"\ncomponents = [\"if(abs(t-0.1008)<0.0002,1000,0)\", \"0\"]\n")
            .at(0.2);
    EXPECT_NEAR(at.bodies[1].velocity.x(), 0.4, 2 * 1000 * 1e-9 / 60) << beside;
    EXPECT_GE(at.bodies[0].velocity.x(), 0) << beside;
    EXPECT_LE(at.bodies[0].velocity.x(), 0.2) << beside;
  }
}

// Half a turn of a belt, a motor whose speed jumps, and a hand that stops: all meet a jump in the midst of a
// step.
TEST(Jumps, MotorsAndMotionsHaveThem) {
  for (const int rate : {60, 600}) {
    const std::string room = fmt::format(
        "[physics]\nrate = {}\n[room]\nsize = [8, 8]\nwalls = \"none\"\ngravity = [0, 0]\n", rate);
    // 5 N until the motor has its speed, which changes in the midst of that
    const sim::Snapshot driven =
        TextRun(room +
                "[[box]]\nname = \"b\"\nsize = [0.2, 0.2]\nposition = [1, 1]\nmass = 1\n"
                "[[joint]]\ntype = \"slider\"\nbetween = [\"b\", \"room\"]\naxis = [1, 0]\n"
                "motor = { speed = \"if(t < 0.2037, 9, -9)\", most = 5 }\n")
            .at(1);
    const double v = 5 * 0.2037;
    EXPECT_NEAR(driven.bodies[0].velocity.x(), v - 5 * (1 - 0.2037), 1e-8) << rate;
    const sim::Snapshot pulled =
        TextRun(room +
                "[[particle]]\nname = \"hand\"\nposition = [2, 1]\nmotion = { x = \"if(t < 0.2037, t, "
                "0.2037)\" }\n"
                "[[particle]]\nname = \"b\"\nposition = [1, 1]\nmass = 1\n"
                "[[spring]]\nbetween = [\"b\", \"hand\"]\nstiffness = 9\nrest_length = 1\n")
            .at(1);
    // x'' = 9 (s - x): x = t - sin(3 t)/3 until then, and swings about where the hand stands after
    const double s = 0.2037, x = s - std::sin(3 * s) / 3, u = 1 - std::cos(3 * s), t = 1 - s;
    EXPECT_NEAR(pulled.bodies[1].position.x(), 1 + s + (x - s) * std::cos(3 * t) + u / 3 * std::sin(3 * t),
                rate == 600 ? 1e-9 : 1e-6);
  }
}

// A jump at the end of a step, up to rounding: no stage reads what is beyond it.
TEST(Jumps, AtTheEndOfAStepAreOnTheirSide) {
  for (int k = 1; k <= 40; ++k) {
    for (const char* force : {"if(t <= {0}, 0, 6)", "if(t > {0}, 6, 0)", "if(t < {0}, 0, 6)"}) {
      const TextRun run(pushed(false, kJumpModes[0], 600, fmt::format(fmt::runtime(force), 0.05 * k)));
      EXPECT_NEAR(run.at(3).bodies[0].velocity.x(), 6 * (3 - 0.05 * k), kAroundJump) << force << k;
    }
  }
}

// --- what is moved at once gives what it holds, bears or drives no more than laws allow

std::string held(const Manner& manner, bool space, const std::string& gravity, const std::string& things) {
  return fmt::format("{}\n[room]\nsize = [8, 8{}]\nwalls = \"none\"\ngravity = [0, {}{}]\n{}", manner.keys,
                     space ? ", 8" : "", gravity, space ? ", 0" : "", things);
}

// a glass of 1 kg on a table that jumps to a velocity at half a second
std::string set_table(const Manner& manner, bool space, const std::string& motion, double elasticity = 0) {
  const char *depth = space ? ", 0.6" : "", *z = space ? ", 4" : "";
  return held(
      manner, space, "-9.81",
      fmt::format("[[box]]\nname = \"table\"\nsize = [3, 0.2{0}]\nposition = [3, 0.5{1}]\nmotion = {{ "
                  "{2} }}\nfriction = 0.2\n[[box]]\nname = \"glass\"\nsize = [0.2, 0.3{3}]\n"
                  "position = [3, 0.75{1}]\nmass = 1\nfriction = 0.2\nelasticity = {4}\n",
                  depth, z, motion, space ? ", 0.2" : "", elasticity));
}

TEST(Jumps, OfATableLeaveAGlassToFrictionAndGravity) {
  for (const Manner& manner : kManners) {
    for (const bool space : {false, true}) {
      const auto at = [&](const std::string& motion, double t, double elasticity = 0) {
        return TextRun(set_table(manner, space, motion, elasticity)).at(t);
      };
      const std::string said = manner.name + (space ? " in space" : "");
      // pulled away, and a lorry that stops: mu g t
      EXPECT_NEAR(at("x = \"if(t < 0.5, 0, 2*(t - 0.5))\"", 0.6).bodies[1].velocity.x(), 0.1962, 1e-8)
          << said;
      EXPECT_NEAR(at("x = \"max(0, 2*(t - 0.5))\"", 0.6).bodies[1].velocity.x(), 0.1962, 1e-8) << said;
      EXPECT_NEAR(at("x = \"if(t < 0.5, 0.5*t^2, 0.125)\"", 0.51).bodies[1].velocity.x(), 0.5 - 0.01962, 1e-7)
          << said;
      // it falls faster than the glass
      EXPECT_NEAR(at("y = \"if(t < 0.5, 0, 0.5 - t)\"", 0.51).bodies[1].velocity.y(), -0.0981, 1e-8) << said;
      // it strikes the glass: Newton's law
      const double e = std::sqrt(0.25 * 0.8);
      const sim::Snapshot struck = at("y = \"if(t < 0.5, 0, t - 0.5)\"", 0.51, 0.25);
      EXPECT_NEAR(struck.bodies[1].velocity.y(), 1 + e - 0.0981, 1e-8) << said;
      // the blow gave p times the table's velocity
      const double weight = 9.81 * (struck.bodies[1].position.y() - 0.75);
      EXPECT_NEAR(struck.energies.work, 1 + e, 1e-6) << said << weight;
    }
  }
}

TEST(Jumps, GoThroughJointsByWhatTheyCanGive) {
  for (const Manner& manner : kManners) {
    const auto spin = [&](const std::string& things, double t, std::size_t body) {
      return TextRun(held(manner, false, "0", things)).at(t).bodies[body].spin.z();
    };
    const std::string wheel =
        "[[ball]]\nname = \"w\"\nradius = 0.5\nmass = 4\nposition = [4, 4]\n"
        "[[joint]]\nname = \"m\"\ntype = \"pin\"\nbetween = [\"w\", \"room\"]\n";
    const double deg = std::numbers::pi / 180;
    // a motor of 2 N m at its aim, which jumps, or is bent; I = 0.5 kg m^2
    EXPECT_NEAR(spin(wheel + "motor = { speed = \"if(t < 2, 360, -180)\", most = 2 }\n", 2.5, 0),
                360 * deg - 2, 1e-8)
        << manner.name;
    EXPECT_NEAR(spin(wheel + "motor = { angle = \"if(t < 1, 0, 90)\", most = 2 }\n", 1.5, 0), 2, 1e-8)
        << manner.name;
    EXPECT_NEAR(spin(wheel + "motor = { angle = \"720*t*(1 - t)*(t < 1)\", most = 100 }\n", 1.01, 0),
                -720 * deg + 2, 1e-8)
        << manner.name;
    // a rotor whose pin rubs, on a base that begins to turn
    EXPECT_NEAR(
        spin("[[ball]]\nname = \"base\"\nradius = 0.2\nposition = [4, 4]\nmotion = { angle = \"if(t < 1, 0, "
             "90*(t - 1))\" }\n[[ball]]\nname = \"rotor\"\nradius = 0.5\nmass = 4\nposition = [4, 4]\n"
             "[[joint]]\ntype = \"pin\"\nbetween = [\"rotor\", \"base\"]\nfriction = 0.1\n[contact]\n"
             "ignore = [[\"rotor\", \"base\"]]\n",
             1.1, 1),
        0.1 / 0.5 * 0.1, 1e-8)
        << manner.name;
  }
}

}  // namespace
}  // namespace obscura::scene

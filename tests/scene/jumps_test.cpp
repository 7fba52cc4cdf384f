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

}  // namespace
}  // namespace obscura::scene

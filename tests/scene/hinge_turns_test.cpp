// Hinges beyond half a turn: motors go on, and what counts whole turns in the plane alone says so in space.

#include <gmock/gmock.h>

#include <numbers>

#include "scene/text_run.h"

namespace obscura::scene {
namespace {

using testing::HasSubstr;

constexpr double kRightAngle = std::numbers::pi / 2;

// a ball on an axle along z, which turns at 90 degrees a second at first
std::string hinged(bool space, const std::string& physics, const std::string& joint) {
  const char* z = space ? ", 0" : "";
  return fmt::format(
      "[physics]\n{}\n[room]\nsize = [8, 8{}]\nwalls = \"none\"\ngravity = [0, 0{}]\n"
      "[[ball]]\nname = \"b\"\nradius = 0.2\nposition = [1, 1{}]\nmass = 1\nspin = {}\n"
      "[[joint]]\nname = \"axle\"\ntype = \"{}\"\nbetween = [\"b\", \"room\"]\nat = [1, 1{}]\n{}\n",
      physics, space ? ", 8" : "", z, z, space ? "[0, 0, 90]" : "90", space ? "hinge" : "pin", z, joint);
}

// An angle of 90 t degrees for six seconds, one and a half turns; and one that is ever faster.
TEST(HingeTurns, AMotorFollowsItsAngleThroughWholeTurns) {
  for (const bool space : {false, true}) {
    for (const char* physics : {"collision = \"event\"\nrate = 60", "rate = 60", "rate = 600"}) {
      const auto spin = [&](const char* angle, double t) {
        const std::string motor = fmt::format("motor = {{ angle = \"{}\", most = 100 }}", angle);
        return TextRun(hinged(space, physics, motor)).at(t).bodies[0].spin.norm();
      };
      EXPECT_NEAR(spin("90*t", 6), kRightAngle, 1e-9) << space << physics;
      EXPECT_NEAR(spin("90*t + 250*t^2", 2.5), (90 + 500 * 2.5) / 90 * kRightAngle, 1e-9) << space << physics;
    }
  }
}

TEST(HingeTurns, InSpaceLimitsLieWithinHalfATurn) {
  EXPECT_EQ(refusal(hinged(false, "", "limits = [-10, 800]")), "");
  EXPECT_EQ(refusal(hinged(true, "", "limits = [-180, 180]")), "");
  EXPECT_THAT(refusal(hinged(true, "", "limits = [-10, 800]")), HasSubstr("from -180 to 180 degrees"));
}

// A spring so weak that the ball turns on: k = 1e-3 N m a radian against 90 degrees a second.
TEST(HingeTurns, InSpaceASpringEndsTheRunAtHalfATurn) {
  for (const char* physics : {"collision = \"event\"", "", "solver = \"iterative\""}) {
    const auto after = [&](bool space, int t) {
      return TextRun(hinged(space, physics, "spring = { stiffness = 1e-3 }")).run->at({t, 1});
    };
    EXPECT_TRUE(std::holds_alternative<sim::Snapshot>(after(false, 4)));
    EXPECT_TRUE(std::holds_alternative<sim::Snapshot>(after(true, 1)));
    const auto ended = after(true, 4);
    ASSERT_TRUE(std::holds_alternative<sim::Trouble>(ended)) << physics;
    EXPECT_EQ(std::get<sim::Trouble>(ended).body, "axle");
    EXPECT_NEAR(std::get<sim::Trouble>(ended).time, 2, 0.2);
  }
}

}  // namespace
}  // namespace obscura::scene

// Hinges beyond half a turn: motors go on, and what counts whole turns in the plane alone says so in space.

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>
#include <variant>

#include "scene/error.h"
#include "scene/scene.h"
#include "sim/step/run.h"

namespace obscura::scene {
namespace {

using testing::HasSubstr;

std::variant<sim::Snapshot, sim::Trouble> hinged(bool space, const std::string& physics,
                                                 const std::string& joint, double t) {
  const char* z = space ? ", 0" : "";
  const std::string text = fmt::format(
      "[physics]\n{}\n[room]\nsize = [8, 8{}]\nwalls = \"none\"\ngravity = [0, 0{}]\n"
      "[[ball]]\nname = \"b\"\nradius = 0.2\nposition = [1, 1{}]\nmass = 1\nspin = {}\n"
      "[[joint]]\nname = \"axle\"\ntype = \"{}\"\nbetween = [\"b\", \"room\"]\nat = [1, 1{}]\n{}\n",
      physics, space ? ", 8" : "", z, z, space ? "[0, 0, 90]" : "90", space ? "hinge" : "pin", z, joint);
  const auto run = parse(text, "a.toml").run();
  auto found = run->at(*sim::from_double(t));
  if (auto* trouble = std::get_if<sim::Trouble>(&found)) return std::move(*trouble);
  return std::get<sim::Snapshot>(found);
}

// An angle of 90 t degrees for six seconds, one and a half turns; and one that is ever faster.
TEST(HingeTurns, AMotorFollowsItsAngleThroughWholeTurns) {
  for (const bool space : {false, true}) {
    for (const char* physics : {"collision = \"event\"\nrate = 60", "rate = 60", "rate = 600"}) {
      const auto steady = hinged(space, physics, "motor = { angle = \"90*t\", most = 100 }", 6);
      ASSERT_TRUE(std::holds_alternative<sim::Snapshot>(steady));
      const auto spin = [&](const auto& found) {
        const sim::Vec3 w = std::get<sim::Snapshot>(found).bodies[0].spin;
        return w.norm();
      };
      EXPECT_NEAR(spin(steady), 1.5707963267948966, 1e-9) << space << physics;
      const auto faster = hinged(space, physics, "motor = { angle = \"90*t + 250*t^2\", most = 100 }", 2.5);
      EXPECT_NEAR(spin(faster), (90 + 500 * 2.5) * 0.017453292519943295, 1e-9) << space << physics;
    }
  }
}

TEST(HingeTurns, InSpaceLimitsLieWithinHalfATurn) {
  EXPECT_TRUE(std::holds_alternative<sim::Snapshot>(hinged(false, "", "limits = [-10, 800]", 0.1)));
  EXPECT_TRUE(std::holds_alternative<sim::Snapshot>(hinged(true, "", "limits = [-180, 180]", 0.1)));
  try {
    hinged(true, "", "limits = [-10, 800]", 0.1);
    ADD_FAILURE();
  } catch (const Error& error) {
    EXPECT_THAT(error.what(), HasSubstr("from -180 to 180 degrees"));
  }
}

// A spring so weak that the ball turns on: k = 1e-3 N m a radian against 90 degrees a second.
TEST(HingeTurns, InSpaceASpringEndsTheRunAtHalfATurn) {
  const char* spring = "spring = { stiffness = 1e-3 }";
  for (const char* physics : {"collision = \"event\"", "", "solver = \"iterative\""}) {
    EXPECT_TRUE(std::holds_alternative<sim::Snapshot>(hinged(false, physics, spring, 4)));
    EXPECT_TRUE(std::holds_alternative<sim::Snapshot>(hinged(true, physics, spring, 1.9)));
    const auto ended = hinged(true, physics, spring, 4);
    ASSERT_TRUE(std::holds_alternative<sim::Trouble>(ended)) << physics;
    EXPECT_EQ(std::get<sim::Trouble>(ended).body, "axle");
    EXPECT_NEAR(std::get<sim::Trouble>(ended).time, 2, 0.2);
  }
}

}  // namespace
}  // namespace obscura::scene

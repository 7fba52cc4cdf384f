// Inertia and centre of mass that a table gives, places of copies as a list, colours by name and in between.

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <string>
#include <variant>

#include "draw/picture/color.h"
#include "scene/error.h"
#include "scene/scene.h"
#include "scene/text_run.h"
#include "sim/step/run.h"

namespace obscura::scene {
namespace {

using testing::HasSubstr;

std::string complaint_about(const std::string& text) {
  try {
    parse(text, "a.toml");
  } catch (const Error& error) {
    return error.what();
  }
  return "";
}

template <int D>
const sim::Model<D>& model_of(const Scene& scene) {
  return std::get<sim::World<D>>(scene.world).model;
}

TEST(OwnMasses, InertiaIsThatOfTheTable) {
  const Scene plane = parse("[[box]]\nmass = 2\ninertia = 0.2\n", "a.toml");
  EXPECT_EQ(model_of<2>(plane).bodies[0].inertia[0], 0.2);
  EXPECT_EQ(model_of<2>(plane).bodies[0].mass, 2);
  const Scene space =
      parse("[room]\nsize = [8, 4, 4]\n[[box]]\nsize = [1, 1, 1]\ninertia = [1, 2, 2.5]\n", "a.toml");
  EXPECT_EQ(model_of<3>(space).bodies[0].inertia, sim::Vec3(1, 2, 2.5));
  EXPECT_THAT(complaint_about("[[box]]\ninertia = 0\n"), HasSubstr("must be positive"));
  EXPECT_THAT(complaint_about("[room]\nsize = [8, 4, 4]\n[[box]]\nsize = [1, 1, 1]\ninertia = [1, 2, 3.5]\n"),
              HasSubstr("sum of the other two"));
}

// A disc whose centre of mass lies d below its centre rocks: w^2 = m g d / (I + m (R - d)^2).
TEST(OwnMasses, ADiscWithALowCentreOfMassRocksAsItShould) {
  const double R = 0.3, d = 0.1, I = 0.5 * R * R;  // m = 1
  const double w = std::sqrt(9.81 * d / (I + (R - d) * (R - d)));
  const TextRun run(
      fmt::format("duration = 9\n[room]\nwalls = \"ground\"\n[[ball]]\nmass = 1\nradius = {}\n"
                  "position = [4, {}]\ncenter_of_mass = [0, -0.1]\nangle = 0.5\n"
                  "friction = 2\nelasticity = 0\n",
                  R, R));
  // through the middle after a quarter, at the other side after a half
  const auto angle = [&](double t) { return run.at(t).bodies[0].angle; };
  const double period = 2 * std::numbers::pi / w, tilt = 0.5 * std::numbers::pi / 180;
  EXPECT_NEAR(angle(period / 4), 0, 1e-3 * tilt);
  EXPECT_NEAR(angle(period / 2), -tilt, 1e-3 * tilt);
}

TEST(OwnMasses, CopiesStandWhereTheListSays) {
  const Scene scene =
      parse("[[ball]]\nradius = 0.1\ncopies = { at = [[1, 2], [3, 2.5], [2, 1]] }\n", "a.toml");
  const auto& x = std::get<sim::World<2>>(scene.world).state.x;
  ASSERT_EQ(x.size(), 3u);
  EXPECT_EQ(x[1], sim::Vec<2>(3, 2.5));
  EXPECT_EQ(x[2], sim::Vec<2>(2, 1));
  EXPECT_THAT(complaint_about("[[ball]]\ncopies = { at = [[1, 2], [3, 2]], count = 3 }\n"),
              HasSubstr("leave 'count' out"));
  EXPECT_THAT(complaint_about("[[ball]]\nposition = [1, 1]\ncopies = { at = [[1, 2], [3, 2]] }\n"),
              HasSubstr("leave 'position' out"));
  EXPECT_THAT(complaint_about("[[ball]]\ncopies = { offset = [1, 0] }\n"),
              HasSubstr("needs 'count' or 'at'"));
}

TEST(OwnMasses, CopiesHaveVelocitiesAndInertiaOfTheirOwn) {
  const std::string two = "copies = { at = [[1, 2], [3, 2]] }\n";
  const Scene scene = parse("[[ball]]\nvelocity = [[1, 0], [0, 2]]\ninertia = [0.5, 0.25]\n" + two, "a.toml");
  EXPECT_EQ(std::get<sim::World<2>>(scene.world).state.v[1], sim::Vec<2>(0, 2));
  EXPECT_EQ(model_of<2>(scene).bodies[0].inertia[0], 0.5);
  EXPECT_EQ(model_of<2>(scene).bodies[1].inertia[0], 0.25);
  const Scene space = parse(
      "[room]\nsize = [8, 4, 4]\n[[ball]]\nvelocity = [[1, 0, 0], [0, 0, 2]]\n"
      "inertia = [[1, 1, 1], [2, 2, 2]]\ncopies = { at = [[1, 2, 0], [3, 2, 0]] }\n",
      "a.toml");
  EXPECT_EQ(std::get<sim::World<3>>(space.world).state.v[1], sim::Vec3(0, 0, 2));
  EXPECT_EQ(model_of<3>(space).bodies[1].inertia, sim::Vec3(2, 2, 2));
  // and of one copy, where --set changes another key of it
  const Scene set =
      parse("[[ball]]\nname = \"b\"\nvelocity = [[1, 0], [0, 2]]\ninertia = [0.5, 0.25]\n" + two, "a.toml",
            {"b[1].mass=3"});
  EXPECT_EQ(std::get<sim::World<2>>(set.world).state.v[1], sim::Vec<2>(0, 2));
  EXPECT_EQ(model_of<2>(set).bodies[1].inertia[0], 0.25);
  EXPECT_THAT(complaint_about("[[ball]]\nvelocity = [[1, 0], [0, 2], [0, 0]]\n" + two),
              HasSubstr("expected one for each of the 2 copies, got 3"));
  EXPECT_THAT(complaint_about("[[ball]]\nvelocity = [[1, 0], [0, 2]]\n"), HasSubstr("there are none"));
  EXPECT_THAT(complaint_about("[[ball]]\nposition = [[1, 1], [2, 2]]\n"), HasSubstr("copies = { at ="));
}

// Sides are those of the form, wherever its centre of mass is.
TEST(OwnMasses, SidesOfABoxStayWithItsForm) {
  const Scene scene = parse(
      "[[box]]\nname = \"b\"\nsize = [2, 0.2]\nposition = [3, 2]\ncenter_of_mass = [0.5, 0]\n"
      "[[joint]]\ntype = \"pin\"\nbetween = [{ body = \"b\", at = \"left\" }, \"room\"]\n",
      "a.toml");
  const sim::Joint<2>& joint = model_of<2>(scene).joints[0];
  EXPECT_EQ(joint.a.local, sim::Vec<2>(-1.5, 0));
  EXPECT_EQ(joint.b.local, sim::Vec<2>(2, 2));
}

TEST(OwnMasses, ColoursHaveTheNamesThatPeopleType) {
  for (const char* name : {"red", "brown", "pink", "cyan", "gray", "gold"})
    EXPECT_EQ(complaint_about(fmt::format("[[box]]\ncolor = \"{}\"\n", name)), "") << name;
  const Scene scene = parse(
      "[[ball]]\nradius = 0.1\nposition = [1, 1]\ncolor = { from = \"blue\", to = \"red\" }\n"
      "copies = { count = 3, offset = [1, 0] }\n",
      "a.toml");
  EXPECT_EQ(scene.look.bodies[0].color, draw::color("blue"));
  EXPECT_EQ(scene.look.bodies[1].color, draw::mix(*draw::color("blue"), *draw::color("red"), 0.5));
  EXPECT_EQ(scene.look.bodies[2].color, draw::color("red"));
  EXPECT_THAT(complaint_about("[[box]]\ncolor = { from = \"blue\" }\n"), HasSubstr("two colours"));
}

}  // namespace
}  // namespace obscura::scene

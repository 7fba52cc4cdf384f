// Bodies that turn, what holds them together, and what they do to each other: as the model has them.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <numbers>

#include "scene/error.h"
#include "scene/scene.h"
#include "sim/math/trig.h"
#include "sim/shape/shape.h"

namespace obscura::scene {
namespace {

using testing::ElementsAre;
using Vec = sim::Vec<2>;

constexpr double kRounded = 1e-15;  // a few roundings of numbers about one

Scene contact_scene(const std::string& text, const std::vector<std::string>& sets = {}) {
  return parse("[physics]\ncollision = \"contact\"\n" + text, "a.toml", sets);
}

const sim::Body<2>& only(const Scene& it) { return it.plane().model.bodies.front(); }

TEST(Ball, IsADiscThatTurns) {
  const Scene it = contact_scene("[[ball]]\nradius = 0.3\ndensity = 2\nspin = 180\nangle = 90");
  EXPECT_TRUE(sim::form<sim::Ball<2>>(only(it).shape));
  EXPECT_TRUE(only(it).turns());
  EXPECT_NEAR(only(it).mass, 2 * std::numbers::pi * 0.09, kRounded);
  EXPECT_NEAR(only(it).inertia[0], only(it).mass * 0.09 / 2, kRounded);
  EXPECT_DOUBLE_EQ(it.plane().state.spin[0][0], std::numbers::pi);
  EXPECT_DOUBLE_EQ(it.plane().state.turn[0][0], std::numbers::pi / 2);
  EXPECT_EQ(sim::round_radius(only(contact_scene("[[ball]]")).shape), 0.2);
}

TEST(Polygon, IsKeptAboutItsCentreOfMass) {
  // a right triangle of sides 0.6 and 0.3: its centre a third along each, I = m (a^2 + b^2) / 18
  for (const char* points : {"[[0, 0], [0.6, 0], [0, 0.3]]", "[[0, 0.3], [0.6, 0], [0, 0]]"}) {
    const Scene it = contact_scene(
        std::string("[[polygon]]\nposition = [1, 2]\nangle = 90\nmass = 3\npoints = ") + points);
    EXPECT_NEAR((it.plane().state.x[0] - Vec(1 - 0.1, 2 + 0.2)).norm(), 0, kRounded);
    EXPECT_NEAR(only(it).inertia[0], 3 * (0.36 + 0.09) / 18, kRounded);
    const sim::Polygon* shape = sim::form<sim::Polygon>(only(it).shape);
    ASSERT_TRUE(shape);
    ASSERT_EQ(shape->vertices.size(), 3u);
    double twice = 0;
    Vec sum = Vec::Zero();
    for (int i = 0; i < 3; ++i) {
      const Vec a = shape->vertices[i], b = shape->vertices[(i + 1) % 3];
      twice += a.x() * b.y() - a.y() * b.x(), sum += a;
    }
    EXPECT_NEAR(twice, 0.18, kRounded) << "counter-clockwise, whichever way it was written";
    EXPECT_NEAR(sum.norm(), 0, kRounded);
  }
}

TEST(Polygon, ASquareIsABox) {
  const Scene it = contact_scene(
      "[[polygon]]\npoints = [[0, 0], [0.8, 0], [0.8, 0.5], [0, 0.5]]\nposition = [3.6, 2]\n"
      "group = \"one\"\n[[box]]\ngroup = \"one\"\n[contact]\nignore = [[\"one\", \"one\"]]");
  const auto& bodies = it.plane().model.bodies;
  EXPECT_EQ(bodies[0].name, "box[0]");
  EXPECT_NEAR(bodies[0].mass, bodies[1].mass, kRounded);
  EXPECT_NEAR(bodies[0].inertia[0], bodies[1].inertia[0], kRounded);
  EXPECT_NEAR((it.plane().state.x[0] - it.plane().state.x[1]).norm(), 0, kRounded);
}

TEST(Body, ItsPartsAreOne) {
  // two balls of 1 kg (density 1 / pi r^2) at +-0.5 about a point 0.25 to the right of the origin
  const Scene it = contact_scene(
      "[[body]]\nmass = 2\nposition = [1, 1]\nshapes = [{ radius = 0.1, position = [-0.25, 0] }, "
      "{ radius = 0.1, position = [0.75, 0] }]");
  ASSERT_TRUE(sim::form<sim::Compound<2>>(only(it).shape));
  EXPECT_NEAR((it.plane().state.x[0] - Vec(1.25, 1)).norm(), 0, kRounded);
  EXPECT_NEAR(only(it).inertia[0], 2 * (0.005 + 0.25), kRounded);
  EXPECT_NEAR((sim::form<sim::Ball<2>>(sim::part(only(it).shape, 0))->center - Vec(-0.5, 0)).norm(), 0,
              kRounded);
}

TEST(Body, ATurnedBoxIsAPolygon) {
  const Scene it = contact_scene(
      "[[body]]\nshapes = [{ size = [0.4, 0.2] }, { size = [0.4, 0.2], angle = 90, position = [0.4, 0] }]");
  const auto* upright = sim::form<sim::Box<2>>(sim::part(only(it).shape, 0));
  const auto* turned = sim::form<sim::Polygon>(sim::part(only(it).shape, 1));
  ASSERT_TRUE(upright && turned);
  EXPECT_NEAR((upright->center - Vec(-0.2, 0)).norm(), 0, kRounded);
  // its lower left corner comes to the lower right
  EXPECT_NEAR((turned->vertices[0] - Vec(0.3, -0.2)).norm(), 0, kRounded);
  const double box = 0.08 * (0.16 + 0.04) / 12;
  EXPECT_NEAR(only(it).inertia[0], 2 * (box + 0.08 * 0.04), kRounded);
}

TEST(Bodies, ThoseThatDoNotTurnComeFirst) {
  const Scene it = contact_scene(
      "[[polygon]]\nname = \"stone\"\npoints = [[0, 0], [1, 0], [0, 1]]\n[[box]]\nposition = [1, 1]\n"
      "[[ball]]\nposition = [2, 3]\n[[particle]]\nradius = 0.1\nposition = [6, 2]");
  std::vector<std::string> names;
  for (const auto& body : it.plane().model.bodies) names.push_back(body.name);
  EXPECT_THAT(names, ElementsAre("particle[0]", "ball[0]", "box[0]", "stone"));
  EXPECT_EQ(it.plane().model.particles(), 1);
  EXPECT_EQ(it.plane().state.turn.size(), 3u);
}

TEST(Bodies, CopiesOfAPolygonTurnAboutAPlace) {
  // the stones of a ring: each the one before, turned by 90 degrees about the same place
  const Scene it = contact_scene(
      "[[polygon]]\nname = \"stone\"\npoints = [[1, -0.1], [1.3, -0.1], [1.3, 0.1], [1, 0.1]]\n"
      "position = [4, 2]\ncopies = { count = 3, turn = 90, around = [4, 2] }");
  EXPECT_NEAR((it.plane().state.x[0] - Vec(5.15, 2)).norm(), 0, kRounded);
  EXPECT_NEAR((it.plane().state.x[1] - Vec(4, 3.15)).norm(), 0, kRounded);
  EXPECT_NEAR((it.plane().state.x[2] - Vec(2.85, 2)).norm(), 0, kRounded);
}

TEST(Bodies, FrictionIsTheirsAndTheWallsOnlyWhereTheySay) {
  const Scene it = contact_scene(
      "[room]\nsize = [4, 3]\nfriction = 0.8\nwalls = [{ point = [0, 0], normal = [1, 1], friction = 0 }]\n"
      "[[box]]\n[[ball]]\nposition = [1, 1]\nfriction = 0.1");
  EXPECT_EQ(it.plane().model.walls[0].friction, 0.8);
  EXPECT_EQ(it.plane().model.walls[4].friction, 0.0);
  EXPECT_EQ(it.plane().model.bodies[0].friction, 0.1);
  EXPECT_EQ(it.plane().model.bodies[1].friction, 0.5);
  EXPECT_FALSE(contact_scene("[[box]]").plane().model.walls[0].friction);
}

TEST(Groups, ThatIgnoreEachOtherAreNumbered) {
  const Scene it = contact_scene(
      "[[box]]\ngroup = \"a\"\n[[box]]\nposition = [1, 1]\ngroup = \"b\"\n[[box]]\nposition = [7, 3]\n"
      "[contact]\nignore = [[\"b\", \"a\"], [\"a\", \"a\"]]");
  EXPECT_EQ(it.plane().model.bodies[0].group, 1);
  EXPECT_EQ(it.plane().model.bodies[1].group, 2);
  EXPECT_EQ(it.plane().model.bodies[2].group, 0);
  EXPECT_THAT(it.plane().model.ignore, ElementsAre(std::pair(2, 1), std::pair(1, 1)));
}

// Names of bodies will do, where these have no group: then one is made for them.
TEST(Groups, AreMadeForBodiesThatAreNamed) {
  const Scene it = contact_scene(
      "[[ball]]\nname = \"b\"\nradius = 0.1\ncopies = { count = 2, offset = [1, 0] }\nposition = [1, "
      "1]\n[[box]]\n"
      "name = \"c\"\nposition = [6, 3]\n[[box]]\nposition = [7, 1]\ngroup = \"d\"\n"
      "[contact]\nignore = [[\"b\", \"c\"], [\"c\", \"d\"], [\"b\", \"b\"]]");
  const auto& bodies = it.plane().model.bodies;
  const auto ignored = [&](int a, int b) {
    const std::pair pair(bodies[std::size_t(a)].group, bodies[std::size_t(b)].group);
    const auto& all = it.plane().model.ignore;
    return std::find(all.begin(), all.end(), pair) != all.end() ||
           std::find(all.begin(), all.end(), std::pair(pair.second, pair.first)) != all.end();
  };
  EXPECT_TRUE(ignored(0, 1));
  EXPECT_TRUE(ignored(0, 2) && ignored(1, 2));
  EXPECT_TRUE(ignored(2, 3));
  EXPECT_FALSE(ignored(0, 3));
  const Scene one = contact_scene(
      "[[ball]]\nname = \"b\"\nradius = 0.1\ncopies = { count = 3, offset = [1, 0] }\nposition = [1, 1]\n"
      "[contact]\nignore = [[\"b[0]\", \"b[2]\"]]");
  EXPECT_NE(one.plane().model.bodies[0].group, one.plane().model.bodies[2].group);
  EXPECT_EQ(one.plane().model.bodies[1].group, 0);
}

TEST(Physics, ABodyMayKeepTheHandoutsLaw) {
  const Scene it = contact_scene(
      "[[box]]\ncollision = \"handout\"\n[[box]]\nposition = [4.1, 2.2]\n[[particle]]\ncollision = "
      "\"handout\"");
  EXPECT_TRUE(it.plane().model.bodies[0].handout);
  EXPECT_TRUE(it.plane().model.bodies[1].handout);
  EXPECT_FALSE(it.plane().model.bodies[2].handout);
}

TEST(Physics, WordsChooseItsWays) {
  const Scene it = parse(
      "[physics]\ncollision = \"event\"\nsolver = \"direct\"\nimpacts = \"sequential\"\noverlap = "
      "\"separate\"\n[[box]]",
      "a.toml");
  EXPECT_EQ(it.plane().model.collision, sim::Collision::event);
  EXPECT_EQ(it.plane().model.solver, sim::Solver::direct);
  EXPECT_EQ(it.plane().model.impacts, sim::Impacts::sequential);
  EXPECT_EQ(it.plane().model.overlap, sim::Overlap::separate);
}

TEST(Joints, APinIsAPointOfBoth) {
  const Scene it = contact_scene(
      "[[box]]\nname = \"a\"\nposition = [2, 2]\nangle = 90\n[[ball]]\nname = \"b\"\nposition = [3, 2]\n"
      "[[joint]]\nname = \"hinge\"\ntype = \"pin\"\nbetween = [\"a\", \"b\"]\nat = [2.5, 2.25]\n"
      "limits = [-90, 45]\nmotor = { speed = 180, most = 3 }\nbreaks = 50\ntouching = true");
  const sim::Joint<2>& joint = it.plane().model.joints[0];
  EXPECT_EQ(joint.name, "hinge");
  EXPECT_EQ(joint.a.body, 1);  // balls come before boxes
  EXPECT_EQ(joint.b.body, 0);
  EXPECT_NEAR((joint.a.local - Vec(0.25, -0.5)).norm(), 0, kRounded);
  EXPECT_NEAR((joint.b.local - Vec(-0.5, 0.25)).norm(), 0, kRounded);
  EXPECT_NEAR(joint.turn[0], std::numbers::pi / 2, kRounded);
  EXPECT_NEAR(joint.lower, -std::numbers::pi / 2, kRounded);
  EXPECT_NEAR(joint.upper, std::numbers::pi / 4, kRounded);
  EXPECT_NEAR(joint.motor->speed, std::numbers::pi, kRounded);
  EXPECT_EQ(joint.motor->most, 3);
  EXPECT_EQ(joint.breaks, 50);
  EXPECT_TRUE(joint.touching);
  EXPECT_EQ(it.plane().state.broken.size(), 1u);
}

TEST(Joints, ManyJoinEachToTheNext) {
  const Scene it = contact_scene(
      "[[box]]\nname = \"plank\"\nsize = [0.5, 0.1]\nposition = [2, 2]\ncopies = { count = 4, offset = [0.5, "
      "0] }\n"
      "[[joint]]\ntype = \"pin\"\nbetween = [{ body = \"plank[0..2]\", at = \"right\" }, "
      "{ body = \"plank[1..3]\", at = \"left\" }]");
  ASSERT_EQ(it.plane().model.joints.size(), 3u);
  EXPECT_EQ(it.plane().model.joints[2].name, "joint[0][2]");
  EXPECT_EQ(it.plane().model.joints[2].a.body, 2);
  EXPECT_EQ(it.plane().model.joints[2].b.body, 3);
  EXPECT_EQ(it.plane().model.joints[2].b.local, Vec(-0.25, 0));
}

TEST(Joints, AgainstTheRoomTheBodyIsTheFirst) {
  const Scene it = contact_scene(
      "[[ball]]\nname = \"bob\"\nposition = [2, 1]\n[[joint]]\ntype = \"rod\"\nbetween = [[2, 3], \"bob\"]\n"
      "[[joint]]\ntype = \"rope\"\nlength = 3\nbetween = [\"bob\", [2, 3]]\n"
      "[[joint]]\ntype = \"pin\"\nbetween = [\"room\", \"bob\"]");
  const auto& joints = it.plane().model.joints;
  EXPECT_EQ(joints[0].a.body, 0);
  EXPECT_EQ(joints[0].b.local, Vec(2, 3));
  EXPECT_EQ(joints[0].length, 2);
  EXPECT_EQ(joints[1].length, 3);
  EXPECT_EQ(joints[2].b.local, Vec(2, 1));
}

TEST(Joints, ASliderGoesWithItsSecondEnd) {
  const Scene it = contact_scene(
      "[[box]]\nname = \"cart\"\nposition = [2, 1]\n[[box]]\nname = \"rail\"\nposition = [4, 3]\nangle = 90\n"
      "[[joint]]\ntype = \"slider\"\nbetween = [\"cart\", \"rail\"]\naxis = [0, 2]\nlimits = [-1, 2]");
  const sim::Joint<2>& joint = it.plane().model.joints[0];
  EXPECT_NEAR((joint.axis - Vec(1, 0)).norm(), 0, kRounded);
  EXPECT_EQ(joint.a.local, Vec(0, 0));
  EXPECT_EQ(joint.upper, 2);
}

TEST(Ends, CountFromAPolygonsOwnOrigin) {
  const Scene it = contact_scene(
      "[[polygon]]\nname = \"p\"\npoints = [[0, 0], [0.6, 0], [0, 0.3]]\nposition = [1, 2]\n"
      "[[spring]]\nbetween = [[1, 4], { body = \"p\", local = [0, 0.3] }]\n"
      "[[spring]]\nbetween = [[1, 4], { body = \"p\", at = \"center\" }]");
  EXPECT_NEAR(it.plane().model.springs[0].rest_length, 4 - 2.3, kRounded);
  EXPECT_EQ(it.plane().model.springs[1].b.local, Vec(0, 0));
}

TEST(Overrides, ReachWhatIsNew) {
  const Scene it = contact_scene(
      "[[ball]]\nname = \"ball\"\nposition = [1, 1]\ncopies = { count = 2, offset = [1, 0] }",
      {"ball[1].radius=0.4", "ball.friction=0.1", "ball[1].angle=90", "physics.solver=iterative"});
  EXPECT_EQ(sim::round_radius(it.plane().model.bodies[0].shape), 0.2);
  EXPECT_EQ(sim::round_radius(it.plane().model.bodies[1].shape), 0.4);
  EXPECT_EQ(it.plane().model.bodies[1].friction, 0.1);
  EXPECT_DOUBLE_EQ(it.plane().state.turn[1][0], std::numbers::pi / 2);
  EXPECT_EQ(it.plane().model.solver, sim::Solver::iterative);
}

}  // namespace
}  // namespace obscura::scene

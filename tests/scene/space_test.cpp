// Scenes in space: three numbers tell it, and what was typed lies where it should.

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "scene/error.h"
#include "scene/hull.h"
#include "scene/scene.h"
#include "scene/text_run.h"
#include "sim/math/exponential.h"
#include "sim/shape/shape.h"

namespace obscura::scene {
namespace {

using testing::EndsWith;
using testing::HasSubstr;

using Vec3 = sim::Vec<3>;

constexpr double kExact = 1e-14;  // a few roundings of numbers near one

Scene room_scene(const std::string& text, const std::vector<std::string>& sets = {}) {
  return parse(text, "a.toml", sets);
}

std::string complaint(const std::string& text, const std::vector<std::string>& sets = {}) {
  try {
    room_scene(text, sets);
  } catch (const Error& error) {
    return error.complaints.front().text();
  }
  return "no complaint";
}

const std::string kRoom = "[room]\nsize = [4, 3, 2]\n";

TEST(Space, ThreeNumbersTellIt) {
  EXPECT_EQ(room_scene(kRoom + "[[box]]").dimension(), 3);
  EXPECT_EQ(room_scene("[[particle]]\nposition = [1, 1, 1]").dimension(), 3);
  EXPECT_EQ(room_scene("[[particle]]\n[[spring]]\nbetween = [\"particle[0]\", [1, 1, 1]]").dimension(), 3);
  EXPECT_EQ(room_scene("[[particle]]\n[[mouse]]\npath = [[0, 1, 1, 1], [1, 2, 2, 2]]").dimension(), 3);
  EXPECT_EQ(room_scene("[[box]]").dimension(), 2);
  // a list with one for each copy is no vector
  EXPECT_EQ(room_scene("[[box]]\nspin = [1, 2, 3]\ncopies = { count = 3, offset = [1, 0] }").dimension(), 2);
}

TEST(Space, DefaultsHaveAThirdNumber) {
  const Scene it = room_scene(kRoom + "[[box]]");
  EXPECT_EQ(it.space().model.gravity, Vec3(0, -9.81, 0));
  EXPECT_EQ(it.space().state.x[0], Vec3(0, 1.5, 0));  // the middle of the room
  EXPECT_EQ(it.space().state.v[0], Vec3(0, 0, 0));
  EXPECT_EQ(it.space().state.spin[0], Vec3(0, 0, 0));
  EXPECT_EQ(it.space().state.turn[0], sim::no_rotation<3>());
  EXPECT_EQ(it.space().model.scale, 3);
  EXPECT_EQ(it.extent.low, sim::Vec3(-2, 0, -1));
  EXPECT_EQ(it.extent.high, sim::Vec3(2, 3, 1));
}

TEST(Space, SixWallsInTheirOrderOrTheGroundAlone) {
  const auto walls = room_scene(kRoom + "[[box]]").space().model.walls;
  ASSERT_EQ(walls.size(), 6u);
  const Vec3 normals[] = {{0, 1, 0}, {1, 0, 0}, {-1, 0, 0}, {0, -1, 0}, {0, 0, 1}, {0, 0, -1}};
  for (int i = 0; i < 6; ++i) EXPECT_EQ(walls[std::size_t(i)].normal, normals[i]) << i;
  EXPECT_EQ(walls[0].point, Vec3(-2, 0, -1));
  EXPECT_EQ(walls[5].point, Vec3(2, 3, 1));

  const Scene ground = room_scene(kRoom + "walls = \"ground\"\n[[box]]\nposition = [9, 2, 0]");
  ASSERT_EQ(ground.space().model.walls.size(), 1u);
  EXPECT_EQ(ground.space().model.walls[0].normal, Vec3(0, 1, 0));
  EXPECT_EQ(ground.extent.high, sim::Vec3(2, 3, 1));
  EXPECT_TRUE(room_scene(kRoom + "walls = \"none\"\n[[box]]").space().model.walls.empty());
  EXPECT_EQ(room_scene("[room]\nsize = [4, 3]\nwalls = \"ground\"\n[[box]]").plane().model.walls.size(), 1u);
}

TEST(Space, SlantedWallsBoundTheRoom) {
  const Scene it =
      room_scene("[room]\nsize = [4, 4, 4]\nwalls = [{ point = [0, 3, 0], normal = [0, -1, 0] }]\n[[box]]");
  EXPECT_NEAR(it.extent.high.y(), 3, 1e-9);  // corners by Cramer's rule: far walls round off 1e-10
  EXPECT_THAT(
      complaint("[room]\nsize = [4, 4, 4]\nwalls = [{ point = [0, 5, 0], normal = [0, 1, 0] }]\n[[box]]"),
      EndsWith("room.walls[0] leaves no room: it lies on the outside of the walls before it"));
}

TEST(Space, OrientationIsThreeTurnsOrAnAxisAndAnAngle) {
  // a quarter turn about y, as either
  const double half = std::sqrt(0.5);
  for (const char* words : {"[0, 90, 0]", "{ axis = [0, 3, 0], angle = 90 }"}) {
    const auto turn = room_scene(kRoom + "[[box]]\norientation = " + words).space().state.turn[0];
    EXPECT_NEAR((turn - sim::Orientation<3>(0, half, 0, half)).norm(), 0, kExact) << words;
  }
  // about x, then about z of the room: the box's y goes to z and stays there
  const auto turn = room_scene(kRoom + "[[box]]\norientation = [90, 0, 90]").space().state.turn[0];
  EXPECT_NEAR((sim::matrix(turn) * Vec3(0, 1, 0) - Vec3(0, 0, 1)).norm(), 0, kExact);
  EXPECT_NEAR((sim::matrix(turn) * Vec3(1, 0, 0) - Vec3(0, 1, 0)).norm(), 0, kExact);
}

TEST(Space, SpinIsAVectorInDegrees) {
  const Scene it = room_scene(kRoom + "[[box]]\nspin = [0, 180, 90]");
  EXPECT_NEAR((it.space().state.spin[0] - Vec3(0, std::numbers::pi, std::numbers::pi / 2)).norm(), 0, kExact);
}

TEST(Space, DensityIsMassForVolume) {
  const Scene it = room_scene(kRoom + "[[box]]\nsize = [0.5, 0.4, 0.2]\ndensity = 100");
  const auto& body = it.space().model.bodies[0];
  EXPECT_DOUBLE_EQ(body.mass, 4);
  // m (y^2 + z^2) / 12 about x
  EXPECT_NEAR(body.inertia[0], 4 * (0.16 + 0.04) / 12, kExact);
  EXPECT_NEAR(body.inertia[1], 4 * (0.25 + 0.04) / 12, kExact);
  const auto ball = room_scene(kRoom + "[[ball]]\nradius = 0.5\nmass = 2").space().model.bodies[0];
  EXPECT_NEAR(ball.inertia[0], 0.4 * 2 * 0.25, kExact);
}

TEST(Space, ACapsuleIsAsLongAsItSays) {
  const Scene it = room_scene(kRoom + "[[capsule]]\nlength = 1\nradius = 0.2");
  const sim::Capsule* shape = sim::form<sim::Capsule>(it.space().model.bodies[0].shape);
  ASSERT_TRUE(shape);
  EXPECT_NEAR(shape->half, 0.3, kExact);
  EXPECT_THAT(complaint(kRoom + "[[capsule]]\nlength = 0.4\nradius = 0.2"),
              HasSubstr("more than twice the radius"));
}

TEST(Space, AHullStandsOnItsPrincipalAxesWhereItWasTyped) {
  // a slanted bar: where a typed corner lies in the room does not depend on the axes the body has
  const std::string points =
      "points = [[0,0,0],[1,0,0],[1,1,0],[0,1,0],[0.5,0,2],[1.5,0,2],[1.5,1,2],[0.5,1,2]]\n";
  const Scene it =
      room_scene("[room]\nsize = [9, 9, 9]\n[[hull]]\nname = \"bar\"\n" + points +
                 "position = [0.25, 1, 0]\norientation = [0, 90, 0]\n[[spring]]\nbetween = [[0, 9, 0], "
                 "{ body = \"bar\", local = [1.5, 1, 2] }]");
  const auto& world = it.space();
  const auto& body = world.model.bodies[0];
  const sim::Hull* hull = sim::form<sim::Hull>(body.shape);
  ASSERT_TRUE(hull);
  ASSERT_EQ(hull->vertices.size(), 8u);
  EXPECT_EQ(hull->faces.size(), 6u);
  EXPECT_NEAR(body.mass, 2, 1e-12);
  const Eigen::Matrix3d axes = sim::matrix(world.state.turn[0]);
  // turned a quarter about y, x goes to -z and z to x
  const Vec3 corner = Vec3(0.25, 1, 0) + Vec3(2, 1, -1.5);
  EXPECT_NEAR((world.state.x[0] + axes * world.model.springs[0].b.local - corner).norm(), 0, 1e-13);
  const Eigen::Quaterniond typed = Eigen::Quaterniond(world.state.turn[0][3], world.state.turn[0][0],
                                                      world.state.turn[0][1], world.state.turn[0][2]) *
                                   it.axes[0].conjugate();
  EXPECT_NEAR(std::abs(typed.dot(Eigen::Quaterniond(Eigen::AngleAxisd(std::numbers::pi / 2, Vec3::UnitY())))),
              1, kExact);
  double nearest = 1;
  for (const Vec3& v : hull->vertices)
    nearest = std::min(nearest, (world.state.x[0] + axes * v - corner).norm());
  EXPECT_NEAR(nearest, 0, 1e-13);
}

TEST(Space, HullsHaveWholeFacesAndNoInnerPoints) {
  std::vector<sim::Vec3> points;
  for (int i = 0; i < 27; ++i) points.push_back({double(i % 3), double(i / 3 % 3), double(i / 9)});
  const sim::Hull cube = hull(points);  // 27 points of a grid: the corners and faces of a cube
  EXPECT_EQ(cube.vertices.size(), 8u);
  ASSERT_EQ(cube.faces.size(), 6u);
  for (const auto& face : cube.faces) EXPECT_EQ(face.size(), 4u);
  EXPECT_NEAR(sim::mass_properties<3>(cube).content, 8,
              1e-12);  // of loops that go around the other way it is negative

  // points on a ball: Euler's 2 n - 4 triangles, each with all others on its inner side
  points.clear();
  for (int i = 0; i < 60; ++i) {
    const double z = -1 + (2 * i + 1) / 60.0, r = std::sqrt(1 - z * z), turn = 2.4 * i;
    points.push_back({r * std::cos(turn), r * std::sin(turn), z});
  }
  const sim::Hull ball = hull(points);
  EXPECT_EQ(ball.vertices.size(), 60u);
  EXPECT_EQ(ball.faces.size(), 116u);
  for (const auto& face : ball.faces) {
    ASSERT_EQ(face.size(), 3u);
    const auto at = [&](std::size_t k) { return ball.vertices[std::size_t(face[k])]; };
    const Vec3 normal = (at(1) - at(0)).cross(at(2) - at(0));
    for (const Vec3& v : ball.vertices) EXPECT_LE((v - at(0)).dot(normal), 1e-12);
  }
  EXPECT_TRUE(hull({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {1, 1, 0}}).faces.empty());
}

TEST(Space, WhatDoesNotTurnComesFirstAndKeepsItsForm) {
  const Scene it = room_scene(
      kRoom +
      "[[box]]\nname = \"free\"\n[[box]]\nname = \"stiff\"\nrotation = false\nposition = [1, 1, 0]\n"
      "size = [0.2, 0.4, 0.6]\norientation = [0, 0, 90]\n[physics]\noverlap = \"separate\"");
  const auto& world = it.space();
  EXPECT_EQ(world.model.bodies[0].name, "stiff");
  EXPECT_EQ(world.model.particles(), 1);
  EXPECT_EQ(world.state.turn.size(), 1u);
  EXPECT_FALSE(world.model.bodies[0].turns());
  // it stands as it was turned: its x side is 0.4 m long
  double widest = 0;
  for (const auto& tip : sim::support_vertices(world.model.bodies[0].shape))
    widest = std::max(widest, tip.at.x());
  EXPECT_NEAR(widest, 0.2, kExact);
  EXPECT_THAT(complaint(kRoom + "[physics]\nrotation = false\n[[box]]\nspin = [0, 1, 0]"),
              HasSubstr("'spin' of a body that does not turn"));
  const Scene plane = room_scene("[[box]]\nangle = 90\nsize = [1, 0.5]\nrotation = false");
  EXPECT_EQ(plane.plane().model.particles(), 1);
  EXPECT_TRUE(sim::form<sim::Polygon>(plane.plane().model.bodies[0].shape));
}

TEST(Space, CopiesGoThreeWaysAndTurnAboutAnAxis) {
  const Scene grid = room_scene(
      "[room]\nsize = [20, 20, 20]\n[[particle]]\nposition = [0, 1, 0]\ncopies = { count = [2, 2, 2], offset "
      "= "
      "[[1, 0, 0], [0, 1, 0], [0, 0, 1]] }");
  ASSERT_EQ(grid.space().state.x.size(), 8u);
  EXPECT_EQ(grid.space().state.x[7], Vec3(1, 2, 1));
  EXPECT_EQ(grid.space().state.x[4], Vec3(0, 1, 1));
  const Scene ring = room_scene(
      "[room]\nsize = [20, 20, 20]\n[[box]]\nposition = [2, 1, 0]\nsize = [0.1, 0.1, 0.3]\n"
      "copies = { count = 4, turn = 90, around = [0, 0, 0] }");
  EXPECT_NEAR((ring.space().state.x[1] - Vec3(0, 1, -2)).norm(), 0, kExact);
  const Vec3 side = sim::matrix(ring.space().state.turn[1]) * Vec3(0, 0, 1);
  EXPECT_NEAR((side - Vec3(1, 0, 0)).norm(), 0, kExact);
}

TEST(Space, JointsKnowTheirAxisAndHowTheyStand) {
  const Scene it = room_scene(
      "[room]\nsize = [9, 9, 9]\n[[box]]\nname = \"door\"\nsize = [1, 2, 0.1]\nposition = [0.5, 2, 0]\n"
      "[[box]]\nname = \"post\"\nsize = [0.1, 2, 0.1]\nposition = [-0.1, 2, 0]\norientation = [0, 30, 0]\n"
      "[[joint]]\ntype = \"hinge\"\nbetween = [\"door\", \"post\"]\nat = [0, 2, 0]\naxis = [0, 1, 0]\nlimits "
      "= [-90, 0]\n"
      "[[joint]]\ntype = \"ball\"\nbetween = [\"door\", \"room\"]");
  const auto& joints = it.space().model.joints;
  ASSERT_EQ(joints.size(), 2u);
  EXPECT_EQ(joints[0].kind, sim::JointKind::hinge);
  EXPECT_EQ(joints[1].kind, sim::JointKind::pin);
  EXPECT_NEAR((joints[0].axis - Vec3(0, 1, 0)).norm(), 0, kExact);
  EXPECT_NEAR((joints[0].turn - Vec3(0, -std::numbers::pi / 6, 0)).norm(), 0, kExact);
  EXPECT_NEAR(joints[0].lower, -std::numbers::pi / 2, kExact);
  EXPECT_NEAR((joints[0].a.local - Vec3(-0.5, 0, 0)).norm(), 0, kExact);
}

TEST(Space, SidesOfThingsHaveNames) {
  const Scene it =
      room_scene(kRoom +
                 "[[box]]\nname = \"crate\"\nsize = [0.2, 0.4, 0.6]\n[[spring]]\nbetween = [[0, 3, 0], "
                 "{ body = \"crate\", at = \"top left front\" }]");
  EXPECT_EQ(it.space().model.springs[0].b.local, Vec3(-0.1, 0.2, 0.3));
  EXPECT_THAT(complaint("[[box]]\nposition = [1, 1]\n[[spring]]\nbetween = [[0, 3], { body = \"box[0]\", at "
                        "= \"front\" }]"),
              HasSubstr("expected a corner or side"));
}

TEST(Space, WhatIsOfTheOtherDimensionIsNamed) {
  EXPECT_EQ(
      complaint(kRoom + "[[box]]\nangle = 30"),
      "a.toml:4:1: 'angle' is of the plane, and 'size' at a.toml:2:8 has 3; in space it is 'orientation'");
  EXPECT_EQ(
      complaint("[room]\nsize = [4, 3]\n[[box]]\norientation = [0, 0, 30]"),
      "a.toml:4:1: 'orientation' is of space, and 'size' at a.toml:2:8 has 2; in the plane it is 'angle'");
  EXPECT_EQ(complaint("[[hull]]\npoints = 3"),
            "a.toml:1:3: [[hull]] is of space, and no position in this scene has three numbers; in the plane "
            "it is a "
            "[[polygon]]");
  EXPECT_EQ(
      complaint(kRoom + "[[box]]\nspin = 90"),
      "a.toml:4:8: 'spin' is one number, as in the plane, and 'size' at a.toml:2:8 has 3: expected three "
      "numbers [x, y, z] in degrees per second");
  EXPECT_EQ(
      complaint(kRoom + "[[box]]\nposition = [1, 1]"),
      "a.toml:4:12: 'position' has 2 numbers and 'size' at a.toml:2:8 has 3: a scene is planar or in space, "
      "not both");
}

TEST(Space, AnExplosionThrowsAParticleAsTheTableSays) {
  // the far end of tests/reference/explosion_radial_free.csv: F = 10 / r^2 for a second, from rest at r = 1.
  // Its error by RK4 at 1/600 s is 1e-9
  const Scene it = room_scene(
      "duration = 2\n[room]\nsize = [40, 40, 40]\nwalls = \"none\"\ngravity = [0, 0, 0]\n[[particle]]\n"
      "position = [1, 0, 0]\n[[explosion]]\nstrength = 10\n");
  ASSERT_EQ(it.space().model.explosions.size(), 1u);
  const auto run = it.run();
  const auto now = std::get<sim::Snapshot>(run->at(sim::rational(1)));
  EXPECT_NEAR(now.bodies[0].position.x(), 3.7340253024638946617, 1e-8);
  const Scene paper = room_scene(
      "[[explosion]]\nname = \"bomb\"\ncenter = [1, 2]\nstrength = 3\nstart = 0.5\nduration = 0.2\ninterval "
      "= 0.02\n"
      "softening = 0.1\nscheme = \"paper\"\n[[particle]]\nground_drag = 0.25",
      {"bomb.strength=4"});
  const auto& blast = paper.plane().model.explosions[0];
  EXPECT_EQ(blast.strength, 4);
  EXPECT_EQ(blast.interval, sim::rational(1, 50));
  EXPECT_EQ(blast.start, sim::rational(1, 2));
  EXPECT_EQ(blast.softening, 0.1);
  EXPECT_EQ(blast.scheme, sim::Explosion<2>::Scheme::paper);
  EXPECT_EQ(paper.plane().model.bodies[0].ground_drag, 0.25);
}

TEST(Space, BondsHoldNeighbours) {
  // three in a row touch, the fourth stands apart
  const std::string row = kRoom +
                          "[[box]]\nname = \"piece\"\nsize = [0.2, 0.2, 0.2]\nposition = [-0.5, 1, 0]\n"
                          "copies = { count = 3, offset = [0.2, 0, 0] }\n"
                          "[[box]]\nname = \"far\"\nsize = [0.2, 0.2, 0.2]\nposition = [1, 1, 0]\n";
  const Scene it = room_scene(row + "[[bond]]\nof = [\"piece[*]\", \"far\"]\nbreaks = 50");
  const auto& bonds = it.space().model.bonds;
  ASSERT_EQ(bonds.size(), 2u);
  EXPECT_EQ(std::pair(bonds[0].a, bonds[0].b), std::pair(0, 1));
  EXPECT_EQ(std::pair(bonds[1].a, bonds[1].b), std::pair(1, 2));
  EXPECT_EQ(bonds[0].strength, 50);
  EXPECT_THAT(complaint(row + "[[bond]]\nof = [\"piece[0]\", \"far\"]"),
              EndsWith("no two of these 2 bodies lie within 0.001 m of each other"));
}

TEST(Space, CamerasStandBesideEachOther) {
  const Scene it =
      room_scene(kRoom +
                 "[[box]]\n[[camera]]\nview = \"side\"\n[[camera]]\nname = \"bird\"\nazimuth = 90\n"
                 "projection = \"orthographic\"\norbit = 36\nfollow = \"box[0]\"\n");
  ASSERT_EQ(it.cameras.size(), 2u);
  EXPECT_EQ(it.cameras[0].name, "side");
  EXPECT_EQ(it.cameras[1].name, "bird");
  EXPECT_NEAR(it.cameras[1].azimuth, std::numbers::pi / 2, kExact);
  EXPECT_NEAR(it.cameras[1].orbit, std::numbers::pi / 5, kExact);
  EXPECT_EQ(it.cameras[1].projection, draw::Camera::Projection::orthographic);
  EXPECT_EQ(it.cameras[1].follow, std::vector<int>{0});
  const Scene eye = room_scene(kRoom + "[[box]]\n[camera]\neye = [1, 2, 3]\ncenter = [0, 1, 0]");
  ASSERT_EQ(eye.cameras.size(), 1u);
  EXPECT_EQ(eye.cameras[0].keys[0].eye, sim::Vec3(1, 2, 3));
  EXPECT_THAT(complaint(kRoom + "[[box]]\n[[camera]]\n[[camera]]"),
              HasSubstr("two cameras are called 'slant'"));
  EXPECT_THAT(complaint("[room]\nsize = [4, 3]\n[[box]]\n[[camera]]\nwidth = 3"),
              HasSubstr("in the plane it is one [camera]"));
  EXPECT_THAT(complaint("[room]\nsize = [4, 3]\n[[box]]\n[camera]\nazimuth = 3"),
              HasSubstr("'azimuth' is of space"));
}

TEST(Space, SetWritesTheThirdNumber) {
  const Scene it =
      room_scene(kRoom + "[[particle]]\nname = \"ball\"", {"room.gravity.z=-1", "ball.velocity=[1,2,3]"});
  EXPECT_EQ(it.space().model.gravity, Vec3(0, -9.81, -1));
  EXPECT_EQ(it.space().state.v[0], Vec3(1, 2, 3));
  const Scene copies =
      room_scene(kRoom +
                     "[[box]]\nname = \"b\"\nsize = [0.1, 0.1, 0.1]\norientation = [0, 30, 0]\n"
                     "copies = { count = 2, offset = [0.5, 0, 0] }",
                 {"b[1].position.z=0.5", "b[0].orientation=[0,0,0]"});
  EXPECT_EQ(copies.space().state.x[1], Vec3(0.5, 1.5, 0.5));
  EXPECT_EQ(copies.space().state.turn[0], sim::no_rotation<3>());
  EXPECT_NE(copies.space().state.turn[1], sim::no_rotation<3>());
}

// A spin along a contact's normal brings no corner nearer to the ground: what spins so, upright on a small
// foot, needs no more substeps than there are, and nothing says so; what spins across it does.
TEST(Tops, ThatSpinUprightAreNotSaidToMeetTheGroundTooFast) {
  const auto told = [](const char* spin) {
    const TextRun top(fmt::format(
        "duration = 1\n[room]\nwalls = \"ground\"\nsize = [2, 1, 2]\n[physics]\nsolver = "
        "\"iterative\"\n[[body]]\nname = \"top\"\nposition = [0, 0.006, 0]\nshapes = [{{ radius = "
        "0.006 }}, {{ size = [0.05, 0.01, 0.05], position = [0, 0.04, 0] }}]\nspin = {}\n",
        spin));
    top.at(0.02);
    return top.run->limits_met().substeps.steps;
  };
  EXPECT_EQ(told("[0, 9000, 0]"), 0);
  EXPECT_GT(told("[0, 0, 20000]"), 0);
}

}  // namespace
}  // namespace obscura::scene

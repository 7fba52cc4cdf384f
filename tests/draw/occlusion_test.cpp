// Darkness where bodies are near: against distances by hand, and what must not be dark.

#include "draw/space/occlusion.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <set>

#include "draw/compose/depict.h"
#include "draw/picture/solids.h"
#include "draw/space/camera.h"
#include "draw/space/outmost_places.h"
#include "draw/space/space.h"

namespace obscura::draw {
namespace {

using sim::Vec3;

Occlusion::Body solid(const Polyhedron& flat, double reach) {
  Occlusion::Body body;
  body.flat = &flat, body.reach = reach;
  for (const Vec3& v : flat.vertices) body.center += v / double(flat.vertices.size());
  for (const Vec3& v : flat.vertices) body.around = std::max(body.around, (v - body.center).norm());
  return body;
}

/// Over faces and edges the distance to a polyhedron is exact, at corners not less than to the next edge.
TEST(Distance, OfABoxIsThatByHand) {
  const Eigen::Matrix3d turn = Eigen::AngleAxisd(0.7, Vec3(1, 2, 3).normalized()).toRotationMatrix();
  const Vec3 half(0.5, 0.2, 0.3), at(1, 2, 3);
  const Polyhedron body = box(half).placed(turn, at);
  int faces = 0, corners = 0;
  for (int i = 0; i < 1000; ++i) {
    const Vec3 local(std::sin(1.0 + i * 1.7), std::sin(2.0 + i * 2.3), std::sin(3.0 + i * 3.1));
    const Vec3 over = local.cwiseAbs() - half;
    const double exact = over.maxCoeff() > 0 ? over.cwiseMax(0.0).norm() : over.maxCoeff();
    const double found = distance(body, at + turn * local);
    const bool corner = (over.array() > 0).count() == 3;
    EXPECT_LE(found, exact + 1e-12);
    (corner ? corners : faces) += 1;
    EXPECT_GT(found, exact - (corner ? 0.2 * exact : 1e-12));
  }
  EXPECT_GT(faces, 100);
  EXPECT_GT(corners, 100);
}

/// The floor before a box's side is darkest at its foot and as bright as ever beyond the reach.
TEST(Occlusion, FallsWithTheDistanceToABox) {
  const Polyhedron floor = box({5, 0.1, 5}),
                   block = box({0.5, 0.5, 0.5}).placed(Eigen::Matrix3d::Identity(), {0, 0.6, 0});
  const Occlusion light({solid(floor, 0.4), solid(block, 0.4)}, {});
  ASSERT_EQ(light.near(0).size(), 1u);
  double before = 1;
  for (double x = 0.5; x < 0.9; x += 0.02) {
    const double dark = light.at(0, light.near(0), {x, 0.1, 0}, Vec3::UnitY());
    EXPECT_LT(dark, before) << x;
    EXPECT_GT(dark, 0) << x;
    before = dark;
  }
  EXPECT_GT(light.at(0, light.near(0), {0.5, 0.1, 0}, Vec3::UnitY()), 0.3);
  EXPECT_EQ(light.at(0, light.near(0), {0.91, 0.1, 0}, Vec3::UnitY()), 0);
}

/// Two bricks side by side are one wall: no shade at their seam; nor has what lies behind a face one.
TEST(Occlusion, LeavesAFaceThatAnotherGoesOnWith) {
  const Polyhedron left = box({0.5, 0.2, 0.2}),
                   right = box({0.5, 0.2, 0.2}).placed(Eigen::Matrix3d::Identity(), {1, 0, 0});
  const Occlusion light({solid(left, 0.3), solid(right, 0.3)}, {});
  for (double x = -0.5; x <= 0.5; x += 0.1)
    EXPECT_LT(light.at(0, light.near(0), {x, 0.1, 0.2}, Vec3::UnitZ()), 1e-12) << x;
  std::vector<int> found{7};
  const std::array<Vec3, 3> face{Vec3(-0.5, -0.2, 0.2), Vec3(0.5, -0.2, 0.2), Vec3(0.5, 0.2, 0.2)};
  light.near(0, face, Vec3::UnitZ(), found);
  EXPECT_TRUE(found.empty());
}

TEST(Occlusion, DoesNotDependOnTheOrderOfBodies) {
  std::vector<Polyhedron> flats;
  for (int i = 0; i < 6; ++i)
    flats.push_back(box({0.2, 0.2, 0.2})
                        .placed(Eigen::AngleAxisd(i, Vec3(1, 1, 0).normalized()).toRotationMatrix(),
                                {0.35 * std::cos(i), 0.2 * i, 0.35 * std::sin(i)}));
  std::vector<Occlusion::Body> there, back;
  for (const Polyhedron& flat : flats)
    there.push_back(solid(flat, 0.3)), back.insert(back.begin(), solid(flat, 0.3));
  const Ground ground{{0, -0.3, 0}, Vec3::UnitY()};
  const Occlusion a(there, ground), b(back, ground);
  int dark = 0;
  for (int i = 0; i < 6; ++i)
    for (const Vec3& v : flats[std::size_t(i)].vertices) {
      const Vec3 normal = (v - there[std::size_t(i)].center).normalized();
      const double one = a.at(i, a.near(i), v, normal), other = b.at(5 - i, b.near(5 - i), v, normal);
      EXPECT_NEAR(one, other, 1e-15);
      dark += one > 0.05;
    }
  EXPECT_GT(dark, 5);
}

/// A run in space made by hand.
struct BoxesInSpace {
  sim::SceneInfo cast;
  sim::Snapshot now;
  Look look;
  std::vector<Camera> cameras{slant()};
  Extent extent{{-2, 0, -2}, {2, 2, 2}};

  BoxesInSpace() {
    cast.dimension = 3, cast.scale = 2, look.caption = false;
    cast.walls.push_back({{0, 0, 0}, {0, 1, 0}});
  }
  void box(const Vec3& at, const Vec3& half, Material material = Material::matte) {
    sim::SceneInfo::Body body;
    body.kind = sim::ShapeKind::box, body.half = half, body.turns = true, body.mass = 1;
    cast.bodies.push_back(body);
    now.bodies.emplace_back().position = at;
    look.bodies.emplace_back().material = material;
  }
  Illustrator artist(double aspect = 16.0 / 9) const { return {cast, look, cameras, extent, aspect}; }
  Picture picture() const { return artist().depict(now, {}); }
};

// how many colours lit surfaces have
std::size_t colours(const Solids& solids) {
  std::set<std::array<int, 3>> all;
  for (const Solids::Vertex& v : solids.vertices) all.insert({v.lit.r, v.lit.g, v.lit.b});
  return all.size();
}

TEST(Darkness, IsThereOnlyWhereBodiesAreNear) {
  BoxesInSpace apart, near;
  apart.look.ground = near.look.ground = false;
  apart.box({-1, 1, 0}, {0.3, 0.3, 0.3}), apart.box({1, 1, 0}, {0.3, 0.3, 0.3});
  near.box({0, 1, 0}, {0.3, 0.3, 0.3}), near.box({0.1, 1.6, 0.15}, {0.3, 0.3, 0.3});
  const Picture far = apart.picture(), close = near.picture();
  EXPECT_EQ(far.solids[0]->vertices.size(), 24u);
  EXPECT_GT(close.solids[0]->vertices.size(), 60u);
  // three faces of two bodies have a colour each; a shade has many
  EXPECT_LE(colours(*far.solids[0]), 6u);
  EXPECT_GT(colours(*close.solids[0]), 12u);
  // the same twice
  const Picture again = near.picture();
  ASSERT_EQ(again.solids[0]->vertices.size(), close.solids[0]->vertices.size());
  for (std::size_t i = 0; i < again.solids[0]->vertices.size(); ++i)
    EXPECT_EQ(again.solids[0]->vertices[i].lit, close.solids[0]->vertices[i].lit);
}

/// Where a body with a trail has left the picture, an arrow at the edge says where it went; also where it is
/// behind the eye.
TEST(SpaceTrails, OfABodyThatLeftEndInAnArrowAtTheEdge) {
  BoxesInSpace made;
  made.box({0, 0.2, 0}, {0.2, 0.2, 0.2});
  made.look.bodies.resize(made.cast.bodies.size());
  made.look.bodies[0].trail = 1;
  const CameraProjection lens = made.artist().lens(made.now);
  const Rect& w = lens.window;
  const Point half = Point(w.width, w.height) / 2, middle = Point(w.x, w.y) + half;
  const auto tip = [&](const Vec3& at) -> std::optional<Point> {
    made.now.bodies[0].position = at;
    const Picture picture = made.picture();
    if (picture.moving.polygons.empty()) return {};
    return picture.moving.points[std::size_t(picture.moving.polygons.back().begin)];
  };
  EXPECT_FALSE(tip({0, 0.2, 0}));
  for (const Vec3& side : {Vec3(lens.right), Vec3(-lens.right), Vec3(lens.up + 0.2 * lens.right)})
    for (const double back : {0.0, 0.5, 2.0}) {
      // beside the target, nearer to the eye, behind it
      const Vec3 far = lens.target + back / lens.per_distance * lens.back + 40 / lens.per_distance * side;
      const auto found = tip(far);
      ASSERT_TRUE(found) << back;
      EXPECT_GT((*found - middle).dot(Point(side.dot(lens.right), -side.dot(lens.up))), 0);
      const Point from_edge = half - (*found - middle).cwiseAbs();
      EXPECT_GT(from_edge.minCoeff(), 0);
      EXPECT_LT(from_edge.minCoeff(), 20);
    }
  made.look.bodies[0].trail = 0;
  EXPECT_FALSE(tip({40, 0.2, 0})) << "without a trail";
}

/// From what flies a dashed line leads to the point of the ground under it, where a cross lies.
TEST(DropLines, LeadFromWhatFliesToTheGround) {
  BoxesInSpace made;
  made.box({0.3, 1.2, -0.2}, {0.2, 0.2, 0.2});
  made.box({-0.8, 0.2, 0}, {0.2, 0.2, 0.2});
  const auto strokes = [&] { return made.picture().moving.strokes.size(); };
  const std::size_t without = strokes();
  made.look.drop_lines = true;
  const Picture picture = made.picture();
  ASSERT_GT(strokes(), without + 5);
  const Point foot = made.artist().lens(made.now).page({0.3, 0, -0.2}),
              top = made.artist().lens(made.now).page({0.3, 1, -0.2});
  double nearest = 1e300, highest = 1e300;
  for (const Stroke& stroke : picture.moving.strokes) {
    if (stroke.cap != Cap::butt || stroke.end - stroke.begin != 2) continue;
    const Point a = picture.moving.nodes[std::size_t(stroke.begin)].at,
                b = picture.moving.nodes[std::size_t(stroke.end - 1)].at;
    const auto off = [&](const Point& p) {
      const Point way = (top - foot).normalized();
      return std::abs(way.x() * (p - foot).y() - way.y() * (p - foot).x());
    };
    if (off(a) > 0.5 || off(b) > 0.5) continue;
    nearest = std::min({nearest, (a - foot).norm(), (b - foot).norm()});
    highest = std::min({highest, a.y(), b.y()});
  }
  EXPECT_LT(nearest, 0.5);
  // it comes out of the body, whose edge hides a little more from above
  EXPECT_GT(highest, top.y() - 1);
  EXPECT_LT(highest, top.y() + 30);
}

TEST(Materials, OfWoodAndChecksHaveAPatternAndOthersNone) {
  BoxesInSpace plain;
  plain.box({0, 0.5, 0}, {0.3, 0.2, 0.4});
  EXPECT_FALSE(plain.picture().solids[0]->grained);
  for (const auto& [material, kind] : {std::pair(Material::wood, 1.0f), std::pair(Material::checks, 2.0f)}) {
    BoxesInSpace made;
    made.look.ground = false;
    made.box({0, 0.5, 0}, {0.3, 0.2, 0.4}, material);
    const Picture picture = made.picture();
    EXPECT_TRUE(picture.solids[0]->grained);
    for (const Solids::Vertex& v : picture.solids[0]->vertices) {
      EXPECT_EQ(v.grain[3], kind);
      // the longest side first; checks in whole cells
      EXPECT_LE(std::abs(v.grain[0]), 2.0f);
      if (material == Material::checks) {
        EXPECT_NEAR(std::abs(v.grain[0]), 2, 0.03);
      }
    }
  }
  BoxesInSpace metal;
  metal.box({0, 0.5, 0}, {0.3, 0.2, 0.4}, Material::metal);
  const Picture picture = metal.picture();
  EXPECT_FALSE(picture.solids[0]->grained);
  EXPECT_FALSE(picture.solids[0]->vertices[0].lit == plain.picture().solids[0]->vertices[0].lit);
}

/// A view by its height shows as much above and below whatever the width of its window.
TEST(Camera, ShowsItsHeightInAnyWindow) {
  BoxesInSpace made;
  CameraKey key;
  key.height = 3;
  made.cameras[0].keys = {key};
  for (const double aspect : {1.0, 16.0 / 9, 3.0})
    EXPECT_NEAR(made.artist(aspect).lens(made.now).scale, 1080.0 / 3, 1e-9) << aspect;
}

/// What a run reaches is in the picture of a camera that fits it.
TEST(Camera, FitsWhatARunReaches) {
  BoxesInSpace made;
  for (int i = 0; i < 8; ++i)
    made.cameras[0].reached.push_back({i & 1 ? 5.0 : -7.0, i & 2 ? 2.0 : 0.0, i & 4 ? 9.0 : -3.0});
  const CameraProjection lens = made.artist().lens(made.now);
  double outmost = 0;
  for (int i = 0; i < 8; ++i) {
    const Point p = lens.page({i & 1 ? 5.0 : -7.0, i & 2 ? 2.0 : 0.0, i & 4 ? 9.0 : -3.0});
    EXPECT_TRUE(p.x() > 0 && p.x() < 1920 && p.y() > 0 && p.y() < 1080) << p.transpose();
    outmost = std::max({outmost, std::abs(p.x() / 960 - 1), std::abs(p.y() / 540 - 1)});
  }
  EXPECT_GT(outmost, 0.8);
}

/// The outmost places of a run are those of its bodies' own forms: of a long box that stands aslant not of a
/// ball around it, of a ball not of a box.
TEST(OutmostPlaces, AreOfTheBodiesOwnForms) {
  BoxesInSpace made;
  made.box({1, 2, 3}, {2, 0.1, 0.1});
  sim::SceneInfo::Body ball;
  ball.kind = sim::ShapeKind::ball, ball.radius = 0.5;
  made.cast.bodies.push_back(ball);
  made.now.bodies.emplace_back().position = {-1, 0, 0};
  made.now.bodies[0].orientation = Eigen::AngleAxisd(0.5, Vec3::UnitZ());
  OutmostPlaces reach, both;
  reach.add(made.cast, made.now);
  made.now.bodies[1].position = {-3, 0, 0};
  both.add(reach), both.add(made.cast, made.now);
  const auto low_high = [](const OutmostPlaces& it) {
    Vec3 low = Vec3::Constant(1e300), high = -low;
    for (const Vec3& at : it.places()) low = low.cwiseMin(at), high = high.cwiseMax(at);
    return std::pair(low, high);
  };
  const double x = 2 * std::cos(0.5) + 0.1 * std::sin(0.5), y = 2 * std::sin(0.5) + 0.1 * std::cos(0.5);
  const auto [low, high] = low_high(reach);
  EXPECT_NEAR((low - Vec3(-1.5, -0.5, -0.5)).norm(), 0, 1e-12) << low.transpose();
  EXPECT_NEAR((high - Vec3(1 + x, 2 + y, 3.1)).norm(), 0, 1e-12) << high.transpose();
  EXPECT_NEAR(low_high(both).first.x(), -3.5, 1e-12);
  EXPECT_NEAR(low_high(both).second.x(), 1 + x, 1e-12);
  EXPECT_TRUE(OutmostPlaces().places().empty());

  // with their drop-lines they reach down to the ground: not to what leans more, nor to what lies under it
  sim::SceneInfo::Wall floor, slope, deeper;
  floor.point = {5, -2, 0}, floor.normal = {0, 1, 0};
  slope.point = {0, -9, 0}, slope.normal = {0.6, 0.8, 0};
  deeper.point = {0, -5, 0}, deeper.normal = {0, 2, 0};
  made.cast.walls = {slope, deeper, floor};
  both.add_feet(made.cast, made.now);
  EXPECT_NEAR(low_high(both).first.y(), -2, 1e-12);
  EXPECT_NEAR(low_high(both).second.y(), 2 + y, 1e-12);
}

/// A joint lies within the limbs that it holds together: it does not stick out of them.
TEST(Joints, OfSlenderLimbsAreWithinThem) {
  for (const double radius : {0.01, 0.5}) {
    BoxesInSpace made;
    for (const double side : {-1.0, 1.0}) {
      made.box({side, 1, 0}, {1, radius, radius});
      made.cast.bodies.back().kind = sim::ShapeKind::capsule;
      made.cast.bodies.back().half = {0, 1 - radius, 0}, made.cast.bodies.back().radius = radius;
    }
    sim::SceneInfo::Joint joint;
    joint.kind = sim::JointKind::pin, joint.a = 0, joint.b = 1;
    made.cast.joints.push_back(joint);
    made.now.joints.push_back({{0, 1, 0}, {0, 1, 0}});
    const Picture picture = made.picture();
    ASSERT_EQ(picture.solids[0]->balls.size(), 1u);
    EXPECT_GT(picture.solids[0]->balls[0].radius, 0);
    EXPECT_LT(picture.solids[0]->balls[0].radius, 0.75 * radius);
  }
}

/// Between two panels there is a line, and none at the edges of the page.
TEST(Panels, HaveALineBetweenThem) {
  BoxesInSpace made;
  const auto lines = [&] {
    const Picture picture = made.picture();
    std::vector<double> at;
    for (const Stroke& stroke : picture.still->strokes) {
      const Node& a = picture.still->nodes[std::size_t(stroke.begin)];
      const Node& b = picture.still->nodes[std::size_t(stroke.end) - 1];
      if (a.at.x() == b.at.x() && std::abs(a.at.y() - b.at.y()) > 900) at.push_back(a.at.x());
    }
    return at;
  };
  made.look.ground = false;
  EXPECT_TRUE(lines().empty());
  made.cameras.push_back(side());
  ASSERT_EQ(lines().size(), 1u);
  EXPECT_NEAR(lines()[0], 960, 1e-9);
}

}  // namespace
}  // namespace obscura::draw

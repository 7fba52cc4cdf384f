#include "draw/compose/depict.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>

#include "draw/made.h"
#include "draw/page/layout.h"

namespace obscura::draw {
namespace {

using sim::ShapeKind;

/// A way at `rate` points a second, thrown and bouncing once.
std::shared_ptr<const sim::Track> thrown(int body, double until, double rate) {
  auto track = std::make_shared<sim::Track>();
  track->bodies = {body};
  track->points.emplace_back();
  for (int i = 0; i <= int(until * rate); ++i) {
    const double t = i / rate, bounce = 0.6, u = t < bounce ? t - bounce : t - bounce;
    track->points[0].push_back({t, {1 + 2 * t, 0.1 + 2.5 * std::abs(u) - 1.5 * u * u, 0}});
  }
  return track;
}

Made with_trail(double rate = 600, double until = 1.2, double lasting = 1) {
  Made made = room(8, 4.5);
  made.body(ShapeKind::ball, {0, 0, 0}, 0.1);
  made.look.bodies[0].trail = lasting;
  made.ways = {thrown(0, until, rate)};
  made.now.time = until;
  made.now.bodies[0].position = made.ways[0]->points[0].back().place;
  return made;
}

TEST(Trails, EndAtTheBodyAndUnderIt) {
  const Made made = with_trail();
  const Picture picture = made.picture();
  const List& list = picture.moving;
  ASSERT_FALSE(list.strokes.empty());
  const Point body = made.depictor().view(0).page(made.now.bodies[0].position);
  EXPECT_NEAR((list.nodes[list.strokes.back().end - 1].at - body).norm(), 0, 1e-9);
  EXPECT_EQ(list.batches.front().kind, Kind::stroke) << "drawn before the body";
  EXPECT_EQ(list.batches[1].kind, Kind::disc);
}

// along the upper side to the right, along the lower to the left, as far as the surface
TEST(Belts, HaveMarksThatGoAroundWithTheSurface) {
  Made made = room(8, 4.5);
  made.body(ShapeKind::box, {4, 1, 0}, 0.5);
  const auto marks = [&](double time, double speed) {
    made.now.time = time, made.now.bodies[0].surface = speed;
    const Picture picture = made.picture();
    std::vector<Point> all;
    for (const Stroke& stroke : picture.moving.strokes)
      all.push_back(picture.moving.nodes[std::size_t(stroke.begin)].at);
    return all;
  };
  EXPECT_TRUE(marks(1, 0).empty());
  const View view = made.depictor().view(0);
  const Point upper = view.page({4, 1.5, 0}), lower = view.page({4, 0.5, 0});
  for (const double speed : {0.4, -0.4}) {
    const std::vector<Point> before = marks(1, speed), after = marks(1.1, speed);
    EXPECT_GE(before.size(), 8u);
    EXPECT_EQ(before.size(), after.size());
    const double way = 0.04 * view.scale * (speed > 0 ? 1 : -1);
    int seen = 0;
    for (const Point& mark : before) {
      if (std::abs(mark.x() - upper.x()) > 0.4 * view.scale) continue;
      const bool above = std::abs(mark.y() - upper.y()) < 1e-9;
      if (!above && std::abs(mark.y() - lower.y()) > 1e-9) continue;
      ++seen;
      EXPECT_TRUE(std::any_of(after.begin(), after.end(), [&](const Point& it) {
        return (it - mark - Point(above ? way : -way, 0)).norm() < 1e-6;
      }));
    }
    EXPECT_GE(seen, 4);
  }
  // of one much longer than the picture those that are seen
  made.cast.bodies[0].half = {1e9, 0.5, 0};
  const std::size_t seen = marks(1, 0.4).size();
  EXPECT_GT(seen, 20u);
  EXPECT_LT(seen, 300u);
  // no longer than its form allows
  made.cast.bodies[0].half = {0.5, 0.01, 0};
  made.now.bodies[0].surface = 1;
  const Picture thin = made.picture();
  for (const Stroke& stroke : thin.moving.strokes)
    EXPECT_LT(
        (thin.moving.nodes[std::size_t(stroke.begin)].at - thin.moving.nodes[std::size_t(stroke.end - 1)].at)
            .norm(),
        0.01 * view.scale);
}

/// It crossed walls, hatching and plots.
TEST(Rails, WithoutLimitsEndAtTheWalls) {
  Made made = room(8, 4.5);
  made.body(ShapeKind::box, {2, 1, 0}, 0.3);
  sim::SceneInfo::Joint slider;
  slider.kind = sim::JointKind::slider, slider.a = 0, slider.axis = sim::Vec3(0.6, 0.8, 0);
  made.cast.joints.push_back(slider);
  sim::Snapshot::Joint at;
  at.a = at.b = {2, 1, 0};
  made.now.joints.push_back(at);
  for (const double upper : {1e300, 20.0}) {
    made.cast.joints[0].upper = upper;
    const Picture picture = made.picture();
    const auto view = made.depictor().view(0);
    double lowest = 1e300, highest = -1e300;
    for (const Node& node : picture.moving.nodes)
      lowest = std::min(lowest, (view.origin.y() - node.at.y()) / view.scale),
      highest = std::max(highest, (view.origin.y() - node.at.y()) / view.scale);
    EXPECT_NEAR(lowest, 0, 1e-9);
    // limits are shown where they are
    if (upper > 1e299) {
      EXPECT_NEAR(highest, 4.5, 1e-9);
    } else {
      EXPECT_GT(highest, 1 + 0.8 * 20 - 1e-9);
    }
  }
}

/// LOOK: never paler than 15 % of the ink. Contrast as in WCAG 2: (a + 0.05) / (b + 0.05).
TEST(Trails, TaperAndFadeButAreSeenToTheirEnds) {
  for (Theme theme : {Theme::paper, Theme::screen}) {
    Made made = with_trail();
    made.look.theme = theme;
    const Picture picture = made.picture();
    const std::vector<Node>& nodes = picture.moving.nodes;
    for (std::size_t i = 1; i < nodes.size(); ++i) EXPECT_GE(nodes[i].width, nodes[i - 1].width - 1e-12);
    EXPECT_LT(nodes.front().width, 0.3 * nodes.back().width);
    const Palette colours = palette(theme);
    for (const char* name : {"orange", "sky", "green", "blue", "purple", "yellow", "grey"}) {
      made.look.bodies[0].color = *color(name);
      const Picture own = made.picture();
      const double old = contrast(own.moving.nodes.front().color, colours.room),
                   now = contrast(own.moving.nodes[std::size_t(own.moving.strokes.back().end) - 1].color,
                                  colours.room);
      EXPECT_GE(old, contrast(mix(colours.room, colours.ink, 0.15), colours.room)) << name;
      EXPECT_GT(now, 1.05 * old) << name;
    }
    for (const Stroke& stroke : picture.moving.strokes) {
      EXPECT_EQ(stroke.blend, theme == Theme::paper ? Blend::darken : Blend::lighten);
    }
  }
}

TEST(Trails, KeepTheCuspOfABounce) {
  const Made made = with_trail();
  const Picture picture = made.picture();
  ASSERT_EQ(picture.moving.strokes.size(), 2u) << "broken at the bounce";
  const Point cusp = made.depictor().view(0).page({1 + 2 * 0.6, 0.1, 0});
  EXPECT_NEAR((picture.moving.nodes[picture.moving.strokes[1].begin].at - cusp).norm(), 0, 1e-6);
  EXPECT_NEAR((picture.moving.nodes[picture.moving.strokes[0].end - 1].at - cusp).norm(), 0, 1e-6);
}

TEST(Trails, AreAFewHundredNodesHoweverFineTheWay) {
  EXPECT_LT(with_trail(600).picture().moving.nodes.size(), 260u);
  EXPECT_LT(with_trail(24000).picture().moving.nodes.size(), 260u);
  EXPECT_GT(with_trail(600).picture().moving.nodes.size(), 150u);
}

TEST(Trails, DoNotWanderFromFrameToFrame) {
  // a frame later the nodes inside are the same places
  const Made before = with_trail(600, 1.2), after = with_trail(600, 1.2 + 1.0 / 60);
  const Picture a = before.picture(), b = after.picture();
  int same = 0, looked = 0;
  for (std::size_t i = 20; i + 1 < a.moving.nodes.size(); ++i) {
    ++looked;
    for (const Node& node : b.moving.nodes) {
      if ((node.at - a.moving.nodes[i].at).norm() < 1e-9) {
        ++same;
        break;
      }
    }
  }
  // all but the last, which was where the body was
  EXPECT_GE(same, looked - 1);
}

TEST(Trails, JoinOverSeveralTracksAndBeginOnTime) {
  Made whole = with_trail(600, 1.2, 0.9);
  Made parts = whole;
  auto first = std::make_shared<sim::Track>(), second = std::make_shared<sim::Track>();
  first->bodies = second->bodies = {0};
  first->points.resize(1), second->points.resize(1);
  for (const auto& p : whole.ways[0]->points[0]) (p.time < 0.7 ? first : second)->points[0].push_back(p);
  parts.ways = {first, second};
  const Picture a = whole.picture(), b = parts.picture();
  ASSERT_EQ(a.moving.nodes.size(), b.moving.nodes.size());
  for (std::size_t i = 0; i < a.moving.nodes.size(); ++i) {
    EXPECT_EQ(a.moving.nodes[i].at, b.moving.nodes[i].at);
  }
  // it begins 0.9 s ago, at x = 1 + 2 (1.2 - 0.9)
  EXPECT_NEAR(a.moving.nodes[0].at.x(), whole.depictor().view(0).page({1.6, 0, 0}).x(), 1e-6);
}

/// Where a body with a trail has left the picture, an arrow at the edge, where that is nearest to it, says
/// where it went.
TEST(Trails, OfABodyThatLeftEndInAnArrowAtTheEdge) {
  Made made = with_trail();
  made.cast.walls.clear();
  const View view = made.depictor().view(0);
  const Point middle(view.window.x + view.window.width / 2, view.window.y + view.window.height / 2);
  const auto tip = [&](const sim::Vec3& at) -> std::optional<Point> {
    made.now.bodies[0].position = at;
    const Picture picture = made.picture();
    if (picture.moving.polygons.size() != 2) return {};  // halo and head
    return picture.moving.points[std::size_t(picture.moving.polygons[1].begin)];
  };
  EXPECT_FALSE(tip({4, 2, 0}));
  for (const sim::Vec3& far : {sim::Vec3(30, 2, 0), sim::Vec3(-9, -20, 0), sim::Vec3(4, 1e9, 0)}) {
    const auto found = tip(far);
    ASSERT_TRUE(found) << far.transpose();
    const Point away = view.page(far) - middle;
    for (int axis = 0; axis < 2; ++axis) {
      const double half = (axis ? view.window.height : view.window.width) / 2, at = (*found - middle)[axis];
      if (std::abs(away[axis]) < half - 20) {
        EXPECT_NEAR(at, away[axis], 1e-9) << "straight beside it";
      } else {
        EXPECT_GT(at * away[axis], 0);
      }
    }
    const Point from_edge = Point(view.window.width, view.window.height) / 2 - (*found - middle).cwiseAbs();
    EXPECT_GT(from_edge.minCoeff(), 0);
    EXPECT_LT(from_edge.minCoeff(), 20);
  }
  made.look.bodies[0].trail = 0;
  EXPECT_FALSE(tip({30, 2, 0})) << "without a trail";
}

TEST(Trails, OfABodyAtRestAreNoTrouble) {
  Made made = with_trail();
  auto track = std::make_shared<sim::Track>();
  track->bodies = {0};
  track->points.resize(1);
  for (int i = 0; i < 600; ++i) track->points[0].push_back({i / 600.0, {1, 1, 0}});
  made.ways = {track};
  made.now.bodies[0].position = {1, 1, 0};
  EXPECT_TRUE(made.picture().moving.strokes.empty());
}

TEST(Depict, SaysWhatToTrack) {
  Made made = room(8, 4.5);
  for (int i = 0; i < 3; ++i) made.body(ShapeKind::ball, {1, 1, 0}, 0.1);
  made.look.bodies[1].trail = 1.5;
  made.look.bodies[2].trail = 0.5;
  EXPECT_EQ(made.depictor().trailed(), (std::vector<int>{1, 2}));
  EXPECT_EQ(made.depictor().longest_trail(), 1.5);
}

TEST(Depict, BodiesAreWhereAndAsLargeAsTheyAre) {
  Made made = room(8, 4.5);
  made.body(ShapeKind::ball, {3, 2, 0}, 0.25);
  const int box = made.body(ShapeKind::box, {5, 1, 0}, 0.5);
  made.now.bodies[box].angle = std::numbers::pi / 6;
  const View view = made.depictor().view(0);
  const Picture picture = made.picture();
  ASSERT_EQ(picture.moving.discs.size(), 1u);
  EXPECT_NEAR(picture.moving.discs[0].radius, 0.25 * view.scale, 1e-9);
  EXPECT_NEAR((picture.moving.discs[0].center - view.page({3, 2, 0})).norm(), 0, 1e-9);
  ASSERT_EQ(picture.moving.boxes.size(), 1u);
  const Box& drawn = picture.moving.boxes[0];
  EXPECT_NEAR((drawn.half - Point(0.5, 0.5) * view.scale).norm(), 0, 1e-9);
  // counter-clockwise in the world is counter-clockwise on the page, where y runs down
  const Point corner = drawn.center + drawn.x_axis * drawn.half.x();
  EXPECT_NEAR((corner - view.page({5 + 0.5 * std::cos(std::numbers::pi / 6), 1.25, 0})).norm(), 0, 1e-9);
  EXPECT_EQ(picture.moving.batches[0].kind, Kind::box) << "boxes below balls";
}

TEST(Depict, PointsAreDotsOfOneSizeThatShrinkInACrowd) {
  auto radius = [](int count) {
    Made made = room(8, 4.5);
    for (int i = 0; i < count; ++i) made.body(ShapeKind::point, {0.01 + 7.9 * i / count, 1, 0});
    return made.picture().moving.discs[0].radius;
  };
  EXPECT_EQ(radius(1), 8);
  EXPECT_EQ(radius(50), 8);
  EXPECT_LT(radius(1000), 4);
  EXPECT_GE(radius(20000), 1.6);
}

/// In a crowd of small boxes their fills are seen, not a net of outlines.
TEST(Depict, SmallBoxesHaveThinOutlinesAndDarkerFills) {
  const auto box = [](double half) {
    Made made = room(8, 4.5);
    made.body(sim::ShapeKind::box, {4, 2, 0}, 1);
    const View view = made.depictor().view(0);
    made.cast.bodies[0].half = {half / view.scale, half / view.scale, 0};
    return made.picture().moving.boxes.at(0);
  };
  const Box large = box(40), limit = box(14), small = box(5);
  EXPECT_NEAR(limit.line, large.line, 1e-9);
  // thin, but wide enough to tell a box from its neighbours
  EXPECT_NEAR(small.line, 0.2 * 5, 1e-9);
  EXPECT_EQ(limit.fill, large.fill);
  EXPECT_LT(small.fill.r + small.fill.g + small.fill.b, large.fill.r + large.fill.g + large.fill.b);
}

/// The fills of all that is small are strong, whatever its form, and those of its ghosts pale.
TEST(Depict, WhatIsSmallHasAStrongFillAndItsGhostHasNot) {
  Made made = room(8, 4.5);
  made.body(sim::ShapeKind::box, {2, 2, 0}, 1);
  made.body(sim::ShapeKind::ball, {4, 2, 0});
  made.body(sim::ShapeKind::polygon, {6, 2, 0});
  const double half = 4 / made.depictor().view(0).scale;  // page units
  made.cast.bodies[0].half = {half, half, 0};
  made.cast.bodies[1].radius = half;
  made.cast.bodies[2].vertices = {{-half, -half, 0}, {half, -half, 0}, {half, half, 0}, {-half, half, 0}};
  made.look.bodies.assign(3, {});
  for (BodyLook& body : made.look.bodies) body.color = color("sky");
  const Color strong = mix(*color("sky"), {255, 255, 255}, 0.2);
  const Picture picture = made.picture();
  EXPECT_EQ(picture.moving.boxes.at(0).fill, strong);
  EXPECT_EQ(picture.moving.discs.at(0).fill, strong);
  EXPECT_EQ(picture.moving.polygons.back().fill, strong);
  List ghosts;
  made.depictor().ghosts(made.now, 0.3, ghosts);
  EXPECT_LT(contrast(ghosts.boxes.at(0).fill, palette(Theme::paper).room),
            contrast(strong, palette(Theme::paper).room));
}

TEST(Depict, AxesReadOnTheFill) {
  // the contrast of WCAG 2: 3 is enough for graphics
  auto luminance = [](Color c) {
    auto decode = [](double s) { return s <= 0.04045 ? s / 12.92 : std::pow((s + 0.055) / 1.055, 2.4); };
    return 0.2126 * decode(c.r / 255.0) + 0.7152 * decode(c.g / 255.0) + 0.0722 * decode(c.b / 255.0);
  };
  for (Theme theme : {Theme::paper, Theme::screen}) {
    for (const char* name : {"orange", "sky", "green", "blue", "vermilion", "purple", "yellow", "grey"}) {
      Made made = room(8, 4.5);
      made.look.theme = theme;
      made.body(ShapeKind::box, {3, 2, 0}, 0.5);
      made.look.bodies[0].color = color(name);
      const Picture picture = made.picture();
      const Box& box = picture.moving.boxes[0];
      const double a = luminance(box.fill), b = luminance(box.axis_color);
      EXPECT_GT((std::max(a, b) + 0.05) / (std::min(a, b) + 0.05), 2.4) << name << " " << int(theme);
    }
  }
}

TEST(Depict, VelocityArrowEndsWhereItsScaleSays) {
  Made made = room(8, 4.5);
  made.body(ShapeKind::ball, {3, 2, 0}, 0.1);
  made.now.bodies[0].velocity = {4, 3, 0};
  made.look.bodies[0].velocity = true;
  const Picture picture = made.picture();
  ASSERT_EQ(picture.moving.polygons.size(), 2u) << "halo and head";
  const Point tip = picture.moving.points[picture.moving.polygons[1].begin];
  EXPECT_NEAR((tip - made.depictor().view(0).page({3.4, 2.3, 0})).norm(), 0, 1e-9);

  made.now.bodies[0].velocity = {0.01, 0, 0};
  EXPECT_TRUE(made.picture().moving.polygons.empty()) << "too short to have a head";
}

TEST(Depict, AnArrowThatWouldLeaveThePageEndsAtItsEdgeOnTheSameWay) {
  Made made = room(8, 4.5);
  made.body(ShapeKind::ball, {3, 2, 0}, 0.1);
  made.now.bodies[0].velocity = {400, 300, 0};
  made.look.bodies[0].velocity = true;
  const Picture picture = made.picture();
  const View view = made.depictor().view(0);
  const Point tip = picture.moving.points[picture.moving.polygons[1].begin], tail = view.page({3, 2, 0});
  const Rect& w = view.window;
  EXPECT_FALSE(outside(w, tip, 0));
  EXPECT_TRUE(outside(w, tip + 14 * Point(0.8, -0.6), 0));
  EXPECT_NEAR((tip - tail).normalized().dot(Point(0.8, -0.6)), 1, 1e-12);
}

TEST(Depict, HandIsShownFromJustBeforeThePressToJustAfterTheRelease) {
  Made made = room(8, 4.5);
  made.body(ShapeKind::box, {3, 2, 0}, 0.3);
  sim::SceneInfo::Mouse mouse;
  mouse.press = 1, mouse.release = 2, mouse.rest_length = 0.2;
  for (int i = 0; i <= 100; ++i) mouse.path.push_back({2 + 0.03 * i, 3, 0});
  made.cast.mice = {mouse};
  made.now.mice = {{true, {3.5, 3, 0}, 0, {3.3, 2.3, 0}}};
  auto pointers = [&](double t, bool pressed) {
    made.now.time = t;
    made.now.mice[0].pressed = pressed;
    return made.picture().moving.polygons.size();
  };
  EXPECT_EQ(pointers(0.5, false), 0u);
  EXPECT_GT(pointers(0.9, false), 0u);
  EXPECT_GT(pointers(1.5, true), 0u);
  EXPECT_GT(pointers(2.2, false), 0u);
  EXPECT_EQ(pointers(2.5, false), 0u);

  // its spring is there while it holds, from the point held to the pointer
  made.now.time = 1.5;
  made.now.mice[0].pressed = true;
  const Picture picture = made.picture();
  const View view = made.depictor().view(0);
  const Stroke& coil = picture.moving.strokes.front();
  EXPECT_NEAR((picture.moving.nodes[coil.begin].at - view.page({3.3, 2.3, 0})).norm(), 0, 1e-9);
  EXPECT_NEAR((picture.moving.nodes[coil.end - 1].at - view.page({3.5, 3, 0})).norm(), 0, 1e-9);
  made.look.pointer = false;
  EXPECT_TRUE(made.picture().moving.strokes.empty());
}

/// The hand's way is dotted behind it, for 0.7 s; where it comes back over itself once.
TEST(Depict, WayThatComesBackIsDottedOnce) {
  Made made = room(8, 4.5);
  sim::SceneInfo::Mouse there, back;
  there.press = back.press = 0, there.release = back.release = 1;
  for (int i = 0; i <= 100; ++i) there.path.push_back({2 + 0.0317 * i, 3, 0});
  back.path = there.path;
  for (int i = 100; i >= 0; --i) back.path.push_back({2 + 0.0317 * i, 3, 0});
  made.now.mice.resize(1);
  made.now.time = 1;
  const double all = 3.17 * made.depictor().view(0).scale / 14;
  made.cast.mice = {there};
  EXPECT_NEAR(double(made.picture().moving.discs.size()), 0.7 * all, 1.5);
  made.cast.mice = {back};
  EXPECT_NEAR(double(made.picture().moving.discs.size()), all, 1.5);
  // nothing of what is to come
  made.now.time = 0;
  EXPECT_LE(made.picture().moving.discs.size(), 1u);
}

/// The teeth of wheels are their edge: the disc ends at their feet and has no outline, the teeth have its
/// fill; a body that reaches farther than its pitch circle has them as a line.
TEST(Depict, TeethAreTheEdgeOfTheirWheels) {
  const double pi = 3.14159265358979323846;
  for (const bool wider : {false, true}) {
    Made made = room(8, 4.5);
    const int small = made.body(ShapeKind::ball, {2, 2, 0}, wider ? 0.5 : 0.4),
              large = made.body(ShapeKind::ball, {3.2, 2, 0}, 0.8);
    sim::SceneInfo::Joint gear;
    gear.kind = sim::JointKind::gear, gear.a = small, gear.b = large;
    gear.places = {{small, {0, 0, 0}}, {-1, {2, 2, 0}}, {large, {0, 0, 0}}, {-1, {3.2, 2, 0}}};
    gear.offset_a = 0.4, gear.offset_b = 0.8;
    gear.tooth_a = {1, 0, 0}, gear.tooth_b = {-1, 0, 0};
    made.cast.joints.push_back(gear);
    made.now.joints.resize(1);
    const List list = made.picture().moving;
    const View view = made.depictor().view(0);
    const double high = 0.2 * 2 * pi * 0.4 / 12;  // a fifth of the distance of two teeth, of twelve

    std::vector<double> radii, lines;
    for (const Disc& disc : list.discs)
      if (disc.radius > 0.3 * view.scale)
        radii.push_back(disc.radius / view.scale), lines.push_back(disc.line);
    ASSERT_EQ(radii.size(), 2u);
    EXPECT_NEAR(radii[0], wider ? 0.5 : 0.4 - high, 1e-9);
    EXPECT_EQ(lines[0] > 0, wider);
    EXPECT_NEAR(radii[1], 0.8 - high, 1e-9);
    EXPECT_EQ(lines[1], 0);

    // the crests of the one lie before the feet of the other
    int teeth[2] = {0, 0};
    for (const Polygon& polygon : list.polygons) {
      if (polygon.end - polygon.begin != 6) continue;
      const bool second = polygon.fill == list.discs[1].fill;
      ++teeth[second];
      const Point center = view.page(second ? sim::Vec3(3.2, 2, 0) : sim::Vec3(2, 2, 0)),
                  other = view.page(second ? sim::Vec3(2, 2, 0) : sim::Vec3(3.2, 2, 0));
      for (int k = polygon.begin; k < polygon.end; ++k) {
        const Point& p = list.points[std::size_t(k)];
        EXPECT_LT((p - center).norm() / view.scale, (second ? 0.8 : 0.4) + high + 1e-9);
        EXPECT_GT((p - other).norm() / view.scale, (second ? 0.4 : 0.8) - high - 1e-9);
      }
    }
    EXPECT_EQ(teeth[0], wider ? 0 : 12);
    EXPECT_EQ(teeth[1], 24);

    // an earlier instant has them too, of the bodies that it shows
    List ghosts;
    made.depictor().ghosts(made.now, 0.5, ghosts, {large});
    EXPECT_EQ(ghosts.discs.size(), 1u);
    EXPECT_EQ(std::count_if(ghosts.polygons.begin(), ghosts.polygons.end(),
                            [](const Polygon& each) { return each.end - each.begin == 6; }),
              24);
  }
}

TEST(Depict, ManyParticlesAreOneBatch) {
  Made made = room(8, 4.5);
  for (int i = 0; i < 20000; ++i) made.body(ShapeKind::point, {4, 2, 0});
  const Picture picture = made.picture();
  EXPECT_EQ(picture.moving.discs.size(), 20000u);
  EXPECT_EQ(picture.moving.batches.size(), 2u) << "discs and the time";
}

TEST(Depict, LooksMayBeLeftOut) {
  Made made = room(8, 4.5);
  made.body(ShapeKind::ball, {3, 2, 0}, 0.1);
  made.look.bodies.clear();
  EXPECT_EQ(made.picture().moving.discs.size(), 1u);
}

}  // namespace
}  // namespace obscura::draw

// Polygons, bodies of several parts, balls that turn, joints, forces: where they are on the page.

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <set>

#include "draw/compose/annotate.h"
#include "draw/compose/annotations.h"
#include "draw/made.h"
#include "draw/page/sheet.h"
#include "draw/picture/type.h"
#include "draw/picture/upright.h"
#include "draw/plane/stage.h"

namespace obscura::draw {
namespace {

using sim::JointKind;
using sim::ShapeKind;
using sim::Vec3;

constexpr double kExact = 1e-9;  // page units: rounding of numbers about a thousand

int polygon(Made& made, const sim::Vec3& position, std::vector<sim::Vec3> vertices) {
  const int it = made.body(ShapeKind::polygon, position);
  made.cast.bodies[it].vertices = std::move(vertices);
  made.cast.bodies[it].turns = true;
  return it;
}

sim::SceneInfo::Part bar(double x, double y, double half_x, double half_y) {
  return {.kind = ShapeKind::box, .half = {half_x, half_y, 0}, .center = {x, y, 0}, .vertices = {}};
}

// what is on top at a point of the page, of polygons alone
Color on_top(const List& list, const Point& p) {
  Color top = {0, 0, 0, 0};
  for (const Polygon& polygon : list.polygons) {
    int left = 0, right = 0;
    const int n = polygon.end - polygon.begin;
    for (int i = 0; i < n; ++i) {
      const Point& a = list.points[polygon.begin + i];
      const Point& b = list.points[polygon.begin + (i + 1) % n];
      ((b - a).x() * (p - a).y() - (b - a).y() * (p - a).x() > 0 ? left : right) += 1;
    }
    const bool within = left == 0 || right == 0;
    if (within) top = polygon.fill;
  }
  return top;
}

void joint(Made& made, JointKind kind, int a, int b, const sim::Vec3& at, const sim::Vec3& to,
           double length = 0) {
  sim::SceneInfo::Joint who;
  who.kind = kind, who.a = a, who.b = b, who.length = length;
  made.cast.joints.push_back(who);
  made.now.joints.push_back({at, to});
}

double length(const List& list, const Stroke& stroke) {
  double sum = 0;
  for (int i = stroke.begin; i + 1 < stroke.end; ++i) sum += (list.nodes[i + 1].at - list.nodes[i].at).norm();
  return sum;
}

TEST(Polygons, LieWhereTheirCornersAreWithTheirOutlineInside) {
  Made made = room(8, 4.5);
  const int it = polygon(made, {3, 2, 0}, {{-0.3, -0.2, 0}, {0.6, -0.2, 0}, {-0.3, 0.4, 0}});
  made.now.bodies[it].angle = std::numbers::pi / 2;
  const View view = made.depictor().view(0);
  const Picture picture = made.picture();
  const List& list = picture.moving;
  ASSERT_EQ(list.polygons.size(), 2u);
  EXPECT_NEAR((list.points[0] - view.page({3.2, 1.7, 0})).norm(), 0, kExact);
  EXPECT_NEAR((list.points[1] - view.page({3.2, 2.6, 0})).norm(), 0, kExact);

  // each inner corner is a line's width from two edges, and no nearer to the third
  ASSERT_EQ(list.polygons[1].end - list.polygons[1].begin, 3);
  for (int i = 3; i < 6; ++i) {
    int near = 0;
    for (int e = 0; e < 3; ++e) {
      const Point a = list.points[e], along = (list.points[(e + 1) % 3] - a).normalized();
      const double inside = (list.points[i] - a).dot(Point(along.y(), -along.x()));
      EXPECT_GT(inside, 2.8 - kExact);
      near += std::abs(inside - 2.8) < 1e-6;
    }
    EXPECT_EQ(near, 2);
  }
}

TEST(Polygons, PartsOfOneBodyAreDrawnAsOne) {
  // a T: the stem's upper edge lies on the bar's lower one
  Made made = room(8, 4.5);
  const int it = made.body(ShapeKind::compound, {3, 2, 0});
  made.cast.bodies[it].parts = {bar(0, 0.3, 0.6, 0.1), bar(0, -0.2, 0.1, 0.4)};
  const View view = made.depictor().view(0);
  const Picture picture = made.picture();
  const List& list = picture.moving;
  ASSERT_EQ(list.polygons.size(), 4u);
  const Color outline = list.polygons[0].fill, fill = list.polygons[3].fill;
  EXPECT_NE(outline, fill);
  const double line = 2.8 / view.scale;
  // across the joint there is no line, beside it and around the whole there is
  for (const double y : {0.2 - 0.9 * line, 0.2, 0.2 + 0.9 * line})
    EXPECT_EQ(on_top(list, view.page({3, 2 + y, 0})), fill) << y;
  EXPECT_EQ(on_top(list, view.page({3.3, 2 + 0.2 + 0.5 * line, 0})), outline);
  EXPECT_EQ(on_top(list, view.page({3 + 0.1 - 0.5 * line, 2, 0})), outline);
  EXPECT_EQ(on_top(list, view.page({3, 2 + 0.4 - 0.5 * line, 0})), outline);
  EXPECT_EQ(on_top(list, view.page({3, 2 - 0.6 + 0.5 * line, 0})), outline);
}

TEST(Balls, ThatTurnShowHowTheyStand) {
  Made made = room(8, 4.5);
  const int ball = made.body(ShapeKind::ball, {3, 2, 0}, 0.25);
  EXPECT_TRUE(made.picture().moving.strokes.empty()) << "a particle has no way up";
  made.cast.bodies[ball].turns = true;
  made.now.bodies[ball].angle = std::numbers::pi / 2;
  const Picture picture = made.picture();
  ASSERT_EQ(picture.moving.strokes.size(), 1u);
  const Point way = picture.moving.nodes[1].at - picture.moving.nodes[0].at;
  EXPECT_NEAR(way.x(), 0, kExact);
  EXPECT_LT(way.y(), -0.8 * 0.25 * made.depictor().view(0).scale);
}

TEST(Ropes, SagByTheirLengthAndAreStraightWhereTaut) {
  Made made = room(8, 4.5);
  made.cast.gravity = {0, -9.81, 0};
  const int ball = made.body(ShapeKind::ball, {3, 2, 0}, 0.1);
  joint(made, JointKind::rope, ball, -1, {3, 2, 0}, {4, 3, 0}, 2);
  joint(made, JointKind::rope, ball, -1, {3, 2, 0}, {3, 4, 0}, 2);
  const double scale = made.depictor().view(0).scale;
  const Picture picture = made.picture();
  const List& list = picture.moving;
  // before them the pieces of ceiling from which they hang
  ASSERT_GT(list.strokes.size(), 2u);
  const Stroke &slack = list.strokes[list.strokes.size() - 2], &taut = list.strokes.back();
  EXPECT_NEAR(length(list, slack), 2 * scale, 1e-6);
  EXPECT_GT(slack.end - slack.begin, 10);
  EXPECT_EQ(taut.end - taut.begin, 2);
  // below the straight line: y runs down
  const int middle = (slack.begin + slack.end) / 2;
  EXPECT_GT(list.nodes[middle].at.y(), made.depictor().view(0).page({3.5, 2.5, 0}).y() + 0.2 * scale);
}

/// What hangs in the open hangs from a piece of ceiling; not at a wall or at a body that is held fast, and
/// not without gravity.
TEST(Brackets, AreWhereSomethingIsMadeFastInTheOpen) {
  const auto strokes = [](double y, double gravity, bool held, double anchor) {
    Made made = room(8, 4.5);
    made.cast.gravity = {0, gravity, 0};
    const int ball = made.body(ShapeKind::ball, {3, y, 0}, 0.1);
    if (held) made.cast.bodies[std::size_t(made.body(ShapeKind::box, {3, anchor, 0}, 0.3))].fixed = true;
    joint(made, JointKind::rod, ball, -1, {3, y, 0}, {3, anchor, 0}, std::abs(y - anchor));
    return made.picture().moving.strokes.size();
  };
  EXPECT_GT(strokes(2, -9.81, false, 3), 3u);
  EXPECT_EQ(strokes(2, 0, false, 3), 1u);
  EXPECT_EQ(strokes(2, -9.81, true, 3), 1u);
  EXPECT_EQ(strokes(2, -9.81, false, 4.5), 1u);
}

/// It is modest against what hangs there: no wider than that by a third, nor too small to see.
TEST(Brackets, AreNotLargerThanWhatHangsThere) {
  const auto width = [](double radius) {
    Made made = room(8, 4.5);
    made.cast.gravity = {0, -9.81, 0};
    const int ball = made.body(ShapeKind::ball, {3, 1.5, 0}, radius);
    joint(made, JointKind::rod, ball, -1, {3, 1.5, 0}, {3, 3, 0}, 1.5);
    const Picture picture = made.picture();
    const View view = made.depictor().view(0);
    double widest = 0;
    for (const Stroke& stroke : picture.moving.strokes) {
      const Point a = picture.moving.nodes[std::size_t(stroke.begin)].at,
                  b = picture.moving.nodes[std::size_t(stroke.end) - 1].at;
      if (std::abs(a.y() - b.y()) < 1e-9 && std::abs(a.y() - view.page({3, 3, 0}).y()) < 1e-9)
        widest = std::max(widest, std::abs(a.x() - b.x()));
    }
    return std::pair(widest, 2 * radius * view.scale);
  };
  const auto [small, bob] = width(0.07);
  EXPECT_NEAR(small, 1.3 * bob, 1e-9);
  EXPECT_NEAR(width(0.5).first, 48, 1e-9);
  EXPECT_NEAR(width(0.01).first, 0.45 * 48, 1e-9);
}

/// The arm of a planetary gear lies over its wheels, a plate that carries them under them.
TEST(Gears, HaveTheirArmOverThem) {
  const auto order = [](double thick, bool fixed) {
    Made made = room(8, 4.5);
    const int sun = made.body(ShapeKind::ball, {3, 2, 0}, 0.5),
              planet = made.body(ShapeKind::ball, {4, 2, 0}, 0.5),
              arm = made.body(ShapeKind::box, {3.5, 2, 0}, thick);
    made.cast.bodies[std::size_t(arm)].fixed = fixed;
    sim::SceneInfo::Joint gear;
    gear.kind = JointKind::gear, gear.offset_a = gear.offset_b = 0.5;
    gear.places = {{sun}, {arm}, {planet}, {arm}};
    made.cast.joints.push_back(gear);
    made.now.joints.emplace_back();
    const Picture picture = made.picture();
    int box = -1, disc = -1;
    for (std::size_t k = 0; k < picture.moving.batches.size(); ++k) {
      if (picture.moving.batches[k].kind == Kind::box) box = int(k);
      if (picture.moving.batches[k].kind == Kind::disc) disc = int(k);
    }
    return box > disc;
  };
  EXPECT_TRUE(order(0.1, false));
  EXPECT_FALSE(order(0.4, false));
  EXPECT_FALSE(order(0.1, true));
}

/// A bracket is where the run began with it, wherever what it holds swings: over it, under what stood on it,
/// and beside a spring that lay.
TEST(Brackets, StayOnOneSideThroughARun) {
  const Vec3 anchor(3, 3, 0);
  // the middle of its hatching from the anchor, in page units, y up
  const auto side = [&](const Vec3& start, const Vec3& now, bool spring) {
    Made made = room(8, 4.5);
    made.cast.gravity = {0, -9.81, 0};
    const int ball = made.body(ShapeKind::ball, anchor + now, 0.1);
    if (spring) {
      made.spring(-1, ball, anchor, anchor + now, 0.5);
      made.cast.springs.back().start = start;
    } else {
      joint(made, JointKind::rod, -1, ball, anchor, anchor + now, start.norm());
      made.cast.joints.back().start = start;
    }
    const Picture picture = made.picture();
    const Point at = made.depictor().view(0).page(anchor);
    Point sum(0, 0);
    int count = 0;
    for (const Stroke& stroke : picture.moving.strokes) {
      if (stroke.end - stroke.begin != 2) continue;
      const Point middle = (picture.moving.nodes[std::size_t(stroke.begin)].at +
                            picture.moving.nodes[std::size_t(stroke.begin) + 1].at) /
                               2 -
                           at;
      // the rod itself, and the bracket's own line, which is through the anchor
      if (middle.norm() > 40 || middle.norm() < 1e-6) continue;
      sum += Point(middle.x(), -middle.y()), ++count;
    }
    EXPECT_GT(count, 2);
    return count > 0 ? Point(sum / count) : sum;
  };
  for (const double turn : {-90., -20., 20., 90., 150.}) {
    const Vec3 now(std::cos(turn * std::numbers::pi / 180), std::sin(turn * std::numbers::pi / 180), 0);
    EXPECT_GT(side({0, -1, 0}, now, false).y(), 3) << turn;
    EXPECT_GT(side({0.9, 0.4, 0}, now, false).y(), 3) << turn;
    EXPECT_LT(side({0, 1, 0}, now, false).y(), -3) << turn;
    EXPECT_LT(side({1, 0, 0}, now, true).x(), -3) << turn;
    EXPECT_GT(side({-1, 0, 0}, now, true).x(), 3) << turn;
  }
}

TEST(Joints, ThatBrokeAreGone) {
  Made made = room(8, 4.5);
  const int a = made.body(ShapeKind::box, {3, 2, 0}, 0.2), b = made.body(ShapeKind::box, {3.4, 2, 0}, 0.2);
  const std::size_t bare = made.picture().moving.discs.size();
  joint(made, JointKind::pin, a, b, {3.2, 2, 0}, {3.2, 2, 0});
  joint(made, JointKind::rod, a, b, {3, 2, 0}, {3.4, 2, 0}, 0.4);
  EXPECT_EQ(made.picture().moving.discs.size(), bare + 3) << "a ring, and the rod's two ends";
  EXPECT_EQ(made.picture().moving.strokes.size(), 1u);
  for (auto& each : made.now.joints) each.broken = true;
  EXPECT_EQ(made.picture().moving.discs.size(), bare);
  EXPECT_TRUE(made.picture().moving.strokes.empty());
}

TEST(Contacts, ArrowsAreTheForceOnWhatIsCarried) {
  Made made = room(8, 4.5);
  made.cast.gravity = {0, -9.81, 0};
  made.body(ShapeKind::box, {3, 0.2, 0}, 0.2);
  made.body(ShapeKind::box, {3, 0.6, 0}, 0.2);
  made.look.force_scale = 0.1;
  sim::Snapshot::Contact contact;
  contact.body = 0, contact.other = 1;
  contact.point = {3, 0.4, 0}, contact.normal = {0, -1, 0}, contact.force = {1, -5, 0};
  made.now.contacts = {contact};
  EXPECT_TRUE(made.picture().moving.polygons.empty()) << "nobody asked";

  const auto tip = [&] {
    const Picture picture = made.picture();
    EXPECT_EQ(picture.moving.polygons.size(), 2u) << "halo and head";
    return picture.moving.polygons.size() == 2 ? picture.moving.points[picture.moving.polygons[1].begin]
                                               : Point(0, 0);
  };
  const View view = made.depictor().view(0);
  for (const auto& [lower, upper] : {std::pair(true, true), std::pair(false, true)}) {
    made.look.bodies[0].contact = lower, made.look.bodies[1].contact = upper;
    EXPECT_NEAR((tip() - view.page({2.9, 0.9, 0})).norm(), 0, kExact);
  }
  made.look.bodies[0].contact = true, made.look.bodies[1].contact = false;
  EXPECT_NEAR((tip() - view.page({3.1, -0.1, 0})).norm(), 0, kExact);
}

TEST(Contacts, OneArrowForTwoThatTouchAtTheirCentreOfPressure) {
  Made made = room(8, 4.5);
  made.body(ShapeKind::box, {3, 0.2, 0}, 0.2);
  made.look.bodies[0].contact = true;
  made.look.force_scale = 0.1;
  sim::Snapshot::Contact contact;
  contact.body = 0, contact.wall = 0, contact.normal = {0, 1, 0};
  contact.point = {2.8, 0, 0}, contact.force = {0.5, 6, 0};
  made.now.contacts = {contact};
  contact.point = {3.2, 0, 0}, contact.force = {0.5, 2, 0};
  made.now.contacts.push_back(contact);
  const Picture picture = made.picture();
  ASSERT_EQ(picture.moving.polygons.size(), 2u) << "halo and head";
  const Point tip = picture.moving.points[picture.moving.polygons[1].begin];
  // three times the force on the left: a quarter of the way to the right
  EXPECT_NEAR((tip - made.depictor().view(0).page({2.9 + 0.1, 0.8, 0})).norm(), 0, kExact);
}

/// An arrow's halo takes nothing from a small disc, be it where it begins or where it ends; on a large one it
/// keeps the arrow apart from the fill.
TEST(Arrows, HaveNoHaloOnSmallDiscs) {
  const double weight = 1;
  const auto covered = [&](double tail_radius, double tip_radius) {
    List list;
    const std::vector<Disc> discs{{{100, 100}, tail_radius, 2.8, {}, {}},
                                  {{400, 100}, tip_radius, 2.8, {}, {}}};
    for (const Disc& disc : discs) list.add(disc);
    const Color room{255, 255, 255}, ink{200, 80, 0};
    draw_arrows({{{100, 100}, {395, 100}}}, weight, room, ink, list);
    std::array<bool, 2> found{false, false};
    for (std::size_t i = 0; i < discs.size(); ++i) {
      for (const Stroke& stroke : list.strokes) {
        const Node &a = list.nodes[std::size_t(stroke.begin)], &b = list.nodes[std::size_t(stroke.end) - 1];
        const bool within = std::min(a.at.x(), b.at.x()) < discs[i].center.x() + discs[i].radius - 0.5 &&
                            std::max(a.at.x(), b.at.x()) > discs[i].center.x() - discs[i].radius + 0.5;
        found[i] = found[i] || (a.color == room && within);
      }
      for (const Polygon& polygon : list.polygons)
        for (int k = polygon.begin; k < polygon.end; ++k)
          found[i] =
              found[i] || (polygon.fill == room &&
                           (list.points[std::size_t(k)] - discs[i].center).norm() < discs[i].radius - 0.5);
    }
    // the rest of its way has one
    EXPECT_TRUE(std::any_of(list.strokes.begin(), list.strokes.end(), [&](const Stroke& stroke) {
      return list.nodes[std::size_t(stroke.begin)].color == room;
    }));
    return found;
  };
  EXPECT_EQ(covered(14, 14), (std::array{false, false}));
  EXPECT_EQ(covered(80, 14), (std::array{true, false}));
  EXPECT_EQ(covered(14, 80), (std::array{false, true}));
}

/// Two arrows over each other on one line read as one with two heads: dots show where they begin; elsewhere
/// there are none.
TEST(Arrows, InLineShowWhereTheyBegin) {
  const auto dots = [](const Vec3& second_tail, const Vec3& second) {
    Made made = room(8, 4.5);
    made.body(ShapeKind::box, {4, 2, 0}, 0.4);
    Marks marks;
    marks.vectors.push_back({.quantity = Quantity::position,
                             .at = Site{-1, {4, 1.6, 0}},
                             .to = Site{-1, {4, 2.6, 0}},
                             .label = ""});
    marks.vectors.push_back({.quantity = Quantity::position,
                             .at = Site{-1, second_tail},
                             .to = Site{-1, second_tail + second},
                             .label = ""});
    List list;
    const Illustrator artist = made.depictor();
    annotate(marks, {}, made.cast, artist.colours(), artist.projection(0, made.now), made.now, list);
    return list.discs.size();
  };
  EXPECT_EQ(dots({4, 2, 0}, {0, -1, 0}), 2u) << "over each other";
  EXPECT_EQ(dots({4, 2, 0}, {0, 1, 0}), 2u) << "one after another";
  EXPECT_EQ(dots({4, 1.6, 0}, {0, -1, 0}), 0u) << "from one place";
  EXPECT_EQ(dots({4, 2, 0}, {0.5, -1, 0}), 0u) << "aslant";
  EXPECT_EQ(dots({4.5, 2, 0}, {0, -1, 0}), 0u) << "beside each other";
  EXPECT_EQ(dots({4, 3, 0}, {0, 1, 0}), 0u) << "apart";
}

/// Two arrows that begin together and go one way are beside each other, and so are those over each other.
TEST(Arrows, InLineAreBesideEachOther) {
  const auto apart = [](const Vec3& second_tail, const Vec3& second) {
    Made made = room(8, 4.5);
    made.body(ShapeKind::box, {4, 2, 0}, 0.4);
    Marks marks;
    for (const auto& [tail, way] :
         {std::pair(Vec3(4, 1.6, 0), Vec3(0, 1, 0)), std::pair(second_tail, second)})
      marks.vectors.push_back(
          {.quantity = Quantity::position, .at = Site{-1, tail}, .to = Site{-1, tail + way}, .label = ""});
    List list;
    const Illustrator artist = made.depictor();
    annotate(marks, {}, made.cast, artist.colours(), artist.projection(0, made.now), made.now, list);
    // of each the halo, and the shaft
    EXPECT_EQ(list.strokes.size(), 4u);
    const auto x = [&](std::size_t i) { return list.nodes[std::size_t(list.strokes[i].begin)].at.x(); };
    return std::abs(x(3) - x(1));
  };
  EXPECT_GT(apart({4, 1.6, 0}, {0, 0.5, 0}), 2 * kArrowLine * film_lettering(1, 1).arrow) << "together";
  EXPECT_GT(apart({4, 2, 0}, {0, -1, 0}), 2 * kArrowLine * film_lettering(1, 1).arrow) << "over each other";
  EXPECT_NEAR(apart({4, 1.6, 0}, {0, -1, 0}), 0, 1e-9) << "from one place to both sides";
}

/// The arrows of a film end below the ceiling, over which its title stands, where that costs less than two
/// fifths of their length.
TEST(Arrows, OfFilmsEndBelowTheTitle) {
  const auto scale = [](double height) {
    Made made = room(8, 4.5);
    made.body(ShapeKind::ball, {4, height, 0}, 0.1);
    made.now.bodies[0].velocity = {0, 2, 0};
    Marks marks;
    marks.vectors.push_back({.quantity = Quantity::velocity, .body = 0, .label = ""});
    RunAhead ahead;
    ahead.moments.push_back(made.now), ahead.films.push_back(0);
    const Illustrator artist = made.depictor();
    const Annotations all(marks, artist, std::move(ahead), {}, 60, 1080);
    return std::pair(all.scales().velocity, (4.5 - height) / 2);
  };
  const double free = scale(1).first;
  EXPECT_GT(free, 0.5);
  const auto [near, reaches] = scale(4.5 - 1.6 * free);
  EXPECT_NEAR(near, reaches, 1e-9);
  EXPECT_NEAR(scale(4.4).first, 0.15 * free, 1e-9) << "no shorter than that: it is cut";
}

// The weight of what lies on the floor is as long as the force that bears it, and both are seen whole. Where
// bodies go out of the picture, arrows that would be much shorter do not shorten the others.
TEST(Arrows, OfFilmsAreSeenWhole) {
  const auto scale = [](bool goes_out) {
    Made made = room(8, 4.5);
    if (goes_out) made.cast.walls.clear();
    made.body(ShapeKind::ball, {4, 2, 0}, 0.1);
    made.now.bodies[0].velocity = {0, -2, 0};
    Marks marks;
    marks.vectors.push_back({.quantity = Quantity::velocity, .body = 0, .label = ""});
    RunAhead ahead;
    ahead.moments.push_back(made.now), ahead.films.push_back(0);
    for (const double y : {0.2, goes_out ? -1 : 0.2}) {
      ahead.between.push_back(made.now);
      ahead.between.back().bodies[0].position.y() = y;
    }
    const Illustrator artist = made.depictor();
    const Annotations all(marks, artist, std::move(ahead), {}, 60, 1080);
    made.now.bodies[0].position.y() = 0.2;
    const Projection view = artist.projection(0, made.now);
    const double tip = view.page({4, 0.2 - 2 * all.scales().velocity, 0}).y();
    return std::pair(all.scales().velocity, view.window().y + view.window().height - tip);
  };
  EXPECT_GT(scale(false).second, 0) << "the head is in the picture";
  EXPECT_LT(scale(false).first, 0.5 * scale(true).first);
}

TEST(Arrows, ThatWouldBeLongerAreBroken) {
  const Rect window{0, 0, 400, 300};
  for (const auto& [tip, cut] : {std::pair(Point(390, 100), false), std::pair(Point(420, 100), true),
                                 std::pair(Point(100, -500), true)}) {
    std::vector<Arrow> arrows;
    offer({100, 100}, tip, window, 1, arrows);
    ASSERT_EQ(arrows.size(), 1u);
    EXPECT_EQ(arrows[0].cut, cut) << tip.transpose();
    List list;
    draw_arrows(arrows, 1, {255, 255, 255}, {0, 0, 0}, list);
    const auto strokes = std::count_if(list.strokes.begin(), list.strokes.end(), [&](const Stroke& it) {
      return list.nodes[std::size_t(it.begin)].color.r == 0;
    });
    EXPECT_EQ(strokes, cut ? 3 : 1) << "the shaft, and two across it";
  }
}

/// Numbers of a ruler are all there and on the page; its name takes the place of none.
TEST(Rulers, HaveAllTheirNumbersAndTheirNameBelow) {
  Made made = room(8, 4.5);
  made.cast.walls.clear();
  const Sheet sheet{.region = Extent{{0, 0, 0}, {6, 3, 0}}, .below = kRulerBelow, .left = kRulerLeft};
  const Illustrator artist(made.cast, made.look, made.extent, sheet);
  List list;
  draw_rulers(artist.layout(), artist.view(0), artist.colours(), 1, list);
  double numbers = 0, name = 0;
  for (const Text& text : list.texts) {
    std::string said;
    for (const Span& span : text.spans) said += span.text;
    if (said == "6" && text.at.y() > artist.layout().window.y + artist.layout().window.height)
      numbers = text.at.y();
    if (said.find('x') != std::string::npos) name = text.at.y();
    EXPECT_LT(text.at.x(), artist.layout().width);
  }
  EXPECT_GT(numbers, 0) << "the last one is there";
  EXPECT_GT(name, numbers + 6 * kPoint);
  EXPECT_LT(name, artist.layout().height);
}

/// Far from the room's origin, and at heights with powers of ten: on the page, apart, each its own.
TEST(Rulers, LongNumbersAreWholeAndApart) {
  for (const auto& [low, high] : {std::pair(Vec3(100000, 0, 0), Vec3(100004, 3, 0)),
                                  std::pair(Vec3(-2e8, -1.6e8, 0), Vec3(2e8, 1.6e8, 0)),
                                  std::pair(Vec3(0, 123456, 0), Vec3(4, 123459, 0))}) {
    Made made = room(8, 4.5);
    made.cast.walls.clear();
    Sheet sheet{.region = Extent{low, high}, .below = kRulerBelow, .left = kRulerLeft};
    sheet.left = ruler_left(lay_out(made.cast, made.look, made.extent, sheet), 1);
    const Illustrator artist(made.cast, made.look, made.extent, sheet);
    List list;
    draw_rulers(artist.layout(), artist.view(0), artist.colours(), 1, list);
    std::vector<std::pair<double, double>> below;  // from where to where those under the picture reach
    std::set<std::string> names;
    for (const Text& text : list.texts) {
      std::string said;
      for (const Span& span : text.spans) said += span.text;
      const double width = shape(text).width;
      EXPECT_GE(text.at.x(), 0) << said;
      EXPECT_LE(text.at.x() + width, artist.layout().width) << said;
      const double under = text.at.y() - artist.layout().window.y - artist.layout().window.height;
      if (under > 0 && under < 18 * kPoint) {
        below.emplace_back(text.at.x(), text.at.x() + width);
        EXPECT_TRUE(names.insert(said).second) << said;
      }
    }
    std::sort(below.begin(), below.end());
    EXPECT_GE(below.size(), 2u);
    for (std::size_t i = 1; i < below.size(); ++i) EXPECT_GT(below[i].first, below[i - 1].second + 2);
  }
}

TEST(Contacts, TheScaleSuitsTheWeights) {
  Made made = room(8, 4.5);
  made.cast.gravity = {0, -9.81, 0};
  made.body(ShapeKind::box, {3, 0.2, 0}, 0.2);
  made.look.bodies[0].contact = true;
  sim::Snapshot::Contact contact;
  contact.body = 0, contact.wall = 0, contact.point = {3, 0, 0}, contact.normal = {0, 1, 0};
  for (const double mass : {1e-3, 1.0, 1e3}) {
    made.cast.bodies[0].mass = mass;
    contact.force = {0, 9.81 * mass, 0};
    made.now.contacts = {contact};
    const Picture picture = made.picture();
    ASSERT_EQ(picture.moving.polygons.size(), 2u);
    const Point tip = picture.moving.points[picture.moving.polygons[1].begin];
    // a tenth of the room's height or so
    EXPECT_NEAR((tip - made.depictor().view(0).page({3, 0.1 * 4.5, 0})).norm(), 0, 1e-6);
  }
}

TEST(Camera, KeepsWhomItFollowsInTheMiddle) {
  Made made = room(8, 4.5);
  made.body(ShapeKind::ball, {3, 2, 0}, 0.1);
  made.camera.follow = {0};
  made.camera.keys.push_back({.time = 0, .center = {}, .width = 4});
  const Picture one = made.picture();
  made.now.bodies[0].position = {7, 1, 0};
  const Picture two = made.picture();
  EXPECT_NEAR((one.moving.discs[0].center - two.moving.discs[0].center).norm(), 0, kExact);
  EXPECT_NEAR(one.moving.discs[0].center.x(), 960, kExact);
  EXPECT_NE(one.still, two.still) << "the walls move instead";
}

// Of several bodies the camera keeps their common centre of mass: two that meet do so in its frame.
TEST(Camera, KeepsTheCentreOfMassOfThoseItFollowsInTheMiddle) {
  Made made = room(8, 4.5);
  const int light = made.body(ShapeKind::ball, {2, 2, 0}, 0.1),
            heavy = made.body(ShapeKind::ball, {6, 2, 0}, 0.2);
  made.cast.bodies[std::size_t(light)].mass = 1, made.cast.bodies[std::size_t(heavy)].mass = 3;
  made.camera.follow = {light, heavy};
  made.camera.keys.push_back({.time = 0, .center = {}, .width = 4});
  const sim::Vec3 middle = *followed(made.camera, made.cast, made.now);
  EXPECT_NEAR((middle - sim::Vec3(5, 2, 0)).norm(), 0, kExact);
  EXPECT_NEAR(made.depictor().projection(0, made.now).page(middle).x(), 960, kExact);
  made.now.bodies[std::size_t(light)].position.x() += 3,
      made.now.bodies[std::size_t(heavy)].position.x() -= 1;
  EXPECT_NEAR(made.depictor().projection(0, made.now).page(middle).x(), 960, kExact);
  EXPECT_EQ(followed(draw::Camera{}, made.cast, made.now), std::nullopt);
}

// The turn that takes +y to a direction, also where that is all but straight down: a unit quaternion whose
// axis is across both.
TEST(Upright, TurnsYToAnyDirection) {
  for (const double off : {0.0, 1e-12, 1e-9, 1e-6, 1e-3, 0.5, 2.0})
    for (const double y : {1.0, 0.0, -1.0})
      for (const double round : {0.3, 2.0, 4.5}) {
        const sim::Vec3 way(off * std::cos(round), y, off * std::sin(round));
        if (!(way.norm() > 0)) continue;
        const Eigen::Quaterniond turn = turn_from_y(3 * way);
        EXPECT_NEAR(turn.norm(), 1, 1e-15);
        EXPECT_NEAR((turn * sim::Vec3::UnitY() - way.normalized()).norm(), 0, 2e-15) << way.transpose();
        EXPECT_NEAR(turn.vec().dot(way.normalized()), 0, 1e-15) << way.transpose();
      }
}

}  // namespace
}  // namespace obscura::draw

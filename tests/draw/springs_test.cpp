#include "draw/plane/springs.h"

#include <gtest/gtest.h>

#include <cmath>

#include "draw/made.h"

namespace obscura::draw {
namespace {

double across(const std::vector<Point>& line) {
  const Point a = line.front(), u = (line.back() - a).normalized(), v(-u.y(), u.x());
  double most = 0;
  for (const Point& p : line) most = std::max(most, std::abs((p - a).dot(v)));
  return most;
}

int crossings(const std::vector<Point>& line) {
  const Point a = line.front(), u = (line.back() - a).normalized(), v(-u.y(), u.x());
  int count = 0;
  double before = 0;
  for (const Point& p : line) {
    const double now = (p - a).dot(v);
    if (std::abs(now) < 1e-9) continue;
    if (before * now < 0) ++count;
    before = now;
  }
  return count;
}

TEST(Springs, CoilRunsFromEndToEndAndNeverTurnsBack) {
  const Point a(300, 400);
  for (double rest : {20.0, 100.0, 300.0, 900.0}) {
    const Coil form = coil(rest, 1);
    for (double length : {1.0, 5.0, 30.0, 0.5 * rest, rest, 2 * rest, 5 * rest}) {
      const Point b = a + length * Point(std::cos(1.1), std::sin(1.1)), u = (b - a).normalized();
      const std::vector<Point> line = coil_line(form, a, b, 1);
      EXPECT_EQ(line.front(), a);
      EXPECT_EQ(line.back(), b);
      double before = -1e-9;
      for (const Point& p : line) {
        EXPECT_GE((p - a).dot(u), before - 1e-9) << rest << " " << length;
        before = (p - a).dot(u);
      }
    }
  }
}

TEST(Springs, EndsOfNoDistanceAreNoTrouble) {
  const std::vector<Point> line = coil_line(coil(100, 1), {5, 5}, {5, 5}, 1);
  for (const Point& p : line) EXPECT_TRUE(p.allFinite());
}

TEST(Springs, TurnsStayAndAmplitudeShrinksAsItIsStretched) {
  const Coil form = coil(300, 1);
  double thick = 1e9, wide = 1e9;
  for (double length = 150; length < 1500; length += 10) {
    const std::vector<Point> line = coil_line(form, {0, 0}, {length, 0}, 1);
    EXPECT_EQ(crossings(line), 2 * form.turns - 1) << length;
    EXPECT_LE(across(line), thick + 1e-9) << length;
    EXPECT_LE(across(line), amplitude(form, length, 1) + 1e-9);
    EXPECT_GT(across(line), 0.9 * amplitude(form, length, 1)) << "the crests are sampled";
    thick = across(line);
    if (length >= 300) {
      EXPECT_LE(line_width(form, length, 1), wide + 1e-9);
      wide = line_width(form, length, 1);
    }
  }
  EXPECT_NEAR(line_width(form, 300, 1), 3.2, 1e-9);
  EXPECT_NEAR(line_width(form, 1500, 1), 2.2, 1e-9);
}

TEST(Springs, PressedTurnsDoNotRunTogether) {
  const Coil form = coil(300, 1);
  for (double length : {60.0, 90.0, 120.0}) {
    // each turn has two flanks: between them as much ground as line
    EXPECT_LT(line_width(form, length, 1), 0.5 * length / form.turns);
  }
  EXPECT_LE(amplitude(form, 4, 1), 2);
}

/// Flanks that are nearly parallel make a patch with a moire in it: a spring that is pressed to a tenth is
/// narrow instead.
TEST(Springs, FlanksAreNeverSteeperThanTwoPitches) {
  for (const double rest : {100.0, 300.0, 900.0}) {
    const Coil form = coil(rest, 1);
    for (const double part : {0.05, 0.1, 0.2, 0.4, 1.0}) {
      const double length = part * rest, pitch = length / form.turns;
      EXPECT_LE(across(coil_line(form, {0, 0}, {length, 0}, 1)), 2 * pitch + 1e-9) << rest << " " << part;
    }
  }
}

TEST(Springs, LeadsAreStraight) {
  const std::vector<Point> line = coil_line(coil(300, 1), {0, 0}, {300, 0}, 1);
  for (const Point& p : line) {
    if (p.x() < 20 || p.x() > 280) {
      EXPECT_NEAR(p.y(), 0, 0.05);
    }
  }
}

TEST(Springs, LongerAtRestHasMoreTurns) {
  EXPECT_LT(coil(100, 1).turns, coil(200, 1).turns);
  EXPECT_LT(coil(200, 1).turns, coil(400, 1).turns);
  EXPECT_GE(coil(0, 1).turns, 3);
}

Made net() {
  Made made = room(8, 4.5);
  int id[4][4];
  for (int i = 0; i < 4; ++i) {
    for (int j = 0; j < 4; ++j) id[i][j] = made.body(sim::ShapeKind::point, {2 + 0.4 * i, 2 + 0.4 * j, 0});
  }
  auto at = [&](int b) { return made.now.bodies[b].position; };
  for (int i = 0; i < 4; ++i) {
    for (int j = 0; j < 4; ++j) {
      if (i < 3) made.spring(id[i][j], id[i + 1][j], at(id[i][j]), at(id[i + 1][j]), 0.4);
      if (j < 3) made.spring(id[i][j], id[i][j + 1], at(id[i][j]), at(id[i][j + 1]), 0.4);
    }
  }
  return made;
}

TEST(Springs, NetIsPlainLinesAndGreyAndALoneSpringBesideItACoil) {
  Made made = net();
  const int ball = made.body(sim::ShapeKind::ball, {6, 2, 0}, 0.1);
  made.spring(-1, ball, {6, 4.5, 0}, {6, 2, 0}, 1.5);
  const Picture picture = made.picture();
  const List& list = picture.moving;
  int lines = 0, coils = 0;
  for (const Stroke& stroke : list.strokes) ++(stroke.end - stroke.begin == 2 ? lines : coils);
  EXPECT_EQ(lines, 24);
  EXPECT_EQ(coils, 1);
  // 16 grey knots, corners too, then a ball that is not
  std::vector<Disc> bodies;
  for (const Disc& disc : list.discs) {
    if (disc.line > 0) bodies.push_back(disc);
  }
  ASSERT_EQ(bodies.size(), 17u);
  for (int i = 0; i < 16; ++i) EXPECT_EQ(bodies[i].fill, bodies[0].fill);
  EXPECT_FALSE(bodies[16].fill == bodies[0].fill);
}

TEST(Springs, LookDecides) {
  Made made = net();
  made.look.springs = Look::Springs::coils;
  const Picture coils = made.picture();
  for (const Stroke& stroke : coils.moving.strokes) EXPECT_GT(stroke.end - stroke.begin, 10);
  Made lone = room(8, 4.5);
  lone.body(sim::ShapeKind::ball, {6, 2, 0}, 0.1);
  lone.spring(-1, 0, {6, 4.5, 0}, {6, 2, 0}, 1.5);
  lone.look.springs = Look::Springs::lines;
  EXPECT_EQ(lone.picture().moving.nodes.size(), 2u);
}

TEST(Springs, HaveADotWhereTheRoomHoldsThem) {
  Made made = room(8, 4.5);
  made.body(sim::ShapeKind::ball, {6, 2, 0}, 0.1);
  made.spring(-1, 0, {6, 4.5, 0}, {6, 2, 0}, 1.5);
  const Picture picture = made.picture();
  ASSERT_EQ(picture.moving.discs.size(), 2u);
  EXPECT_NEAR((picture.moving.discs[0].center - made.depictor().view(0).page({6, 4.5, 0})).norm(), 0, 1e-9);
}

}  // namespace
}  // namespace obscura::draw

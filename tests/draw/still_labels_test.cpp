// Labels of a picture that stands still: each is nearer to what it names than to others of its kind, or has a
// leader, and what lies outside of the picture is left out.

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <optional>
#include <string>

#include "draw/compose/annotate.h"
#include "draw/made.h"
#include "draw/page/sheet.h"
#include "draw/picture/type.h"

namespace obscura::draw {
namespace {

/// A figure's marks on a sheet.
struct StillPicture {
  Made made;
  Marks marks{};
  Annotating how{};
  Sheet sheet{};

  Illustrator artist() const { return {made.cast, made.look, made.extent, sheet}; }
  Projection projection() const { return artist().projection(0, made.now); }
  List list(const Scales& scales = {}) const {
    List all;
    Annotating its = how;
    its.look = &made.look;
    annotate(marks, scales, made.cast, artist().colours(), projection(), made.now, all, its);
    return all;
  }
};

/// The rectangle of words in a list.
struct WordsBox {
  Point center, size;
  double off(const Point& p) const { return ((p - center).cwiseAbs() - size / 2).cwiseMax(0.0).norm(); }
};
std::optional<WordsBox> box_of(const List& list, const std::string& words) {
  for (const Text& text : list.texts) {
    std::string said;
    for (const Span& span : text.spans) said += span.text;
    if (said != words) continue;
    const double width = shape(text).width, em = text.spans[0].size;
    return WordsBox{text.at + Point(width / 2, -0.3 * em), {width, 0.7 * em}};
  }
  return std::nullopt;
}

/// The end of the leader of words that is farther from them.
std::optional<Point> leader_end(const List& list, const WordsBox& words) {
  for (const Stroke& stroke : list.strokes) {
    const Node &a = list.nodes[std::size_t(stroke.begin)], &b = list.nodes[std::size_t(stroke.begin) + 1];
    if (stroke.end - stroke.begin != 2 || std::abs(a.width - 0.4 * kPoint) > 1e-9) continue;
    if (std::min(words.off(a.at), words.off(b.at)) < 4 * kPoint)
      return words.off(a.at) < words.off(b.at) ? b.at : a.at;
  }
  return std::nullopt;
}

/// Three balls in a row, the first with two more labels that take the room over it.
TEST(StillLabels, OfABodyStandNearerToItThanToItsNeighbour) {
  StillPicture picture{room(4, 3)};
  for (int i = 0; i < 3; ++i) {
    picture.made.body(sim::ShapeKind::ball, {2 + 0.31 * i, 0.15, 0}, 0.15);
    picture.marks.names.push_back({i, "\"ball" + std::to_string(i) + "\""});
  }
  for (const char* more : {"\"text one beside it\"", "\"text two beside it\""})
    picture.marks.labels.push_back({{0, {0, 0, 0}}, more, {}, -1, {}});
  const List list = picture.list();
  const Projection seen = picture.projection();
  for (int i = 0; i < 3; ++i) {
    const auto words = box_of(list, "ball" + std::to_string(i));
    ASSERT_TRUE(words) << i;
    const auto end = leader_end(list, *words);
    const auto off = [&](int body) {
      const Point at = seen.page(picture.made.now.bodies[std::size_t(body)].position);
      return end ? (*end - at).norm() : words->off(at);
    };
    for (int j = 0; j < 3; ++j)
      EXPECT_TRUE(j == i || off(i) < off(j)) << i << " " << j << (end ? " with a leader" : "");
  }
}

/// Two arrows on one line, against each other and over each other, stand side by side: each has its words on
/// its own side.
TEST(StillLabels, OfArrowsOnOneLineStandOnTheirOwnSide) {
  for (const double x : {1.8, 2.0, 2.2}) {
    StillPicture picture{room(4, 3)};
    picture.made.body(sim::ShapeKind::box, {x, 0.3, 0}, 0.3);
    const auto arrow = [&](double from, double to, const char* label) {
      Marks::Vector vector;
      vector.quantity = Quantity::position, vector.label = label;
      vector.at = Site{-1, {x, from, 0}}, vector.to = Site{-1, {x, to, 0}};
      picture.marks.vectors.push_back(vector);
    };
    arrow(0.3, -0.05, "\"down = 19.6 N\""), arrow(0.02, 0.5, "\"up = 19.6 N\"");
    const List list = picture.list();
    const Projection seen = picture.projection();
    // the shafts: the two longest strokes
    std::vector<double> shafts;
    for (const Stroke& stroke : list.strokes) {
      const Point a = list.nodes[std::size_t(stroke.begin)].at,
                  b = list.nodes[std::size_t(stroke.end) - 1].at;
      if (std::abs(a.x() - b.x()) < 1e-6 && std::abs(a.x() - seen.page({x, 0, 0}).x()) > 1)
        shafts.push_back(a.x());
    }
    ASSERT_GE(shafts.size(), 2u);
    const auto words_down = box_of(list, "down = 19.6 N"), words_up = box_of(list, "up = 19.6 N");
    ASSERT_TRUE(words_down && words_up);
    const double middle = seen.page({x, 0, 0}).x();
    // the first one goes to the left of its way: down, that is to the right
    EXPECT_GT(words_down->center.x(), middle) << x;
    EXPECT_LT(words_up->center.x(), middle) << x;
    for (const auto& [words, side] : {std::pair(*words_down, 1.0), std::pair(*words_up, -1.0)})
      EXPECT_GT(side * (leader_end(list, words).value_or(words.center).x() - middle), 0) << x;
  }
}

/// A throw with a ghost and a time for each tenth of a second, as a handout shows it.
TEST(StillLabels, TimesStandOnTheOuterSideOfAThrowEachNearestToItsOwn) {
  for (const double right : {1.0, -1.0}) {
    StillPicture picture{room(6, 3)};
    picture.made.cast.walls.resize(1);
    const int ball = picture.made.body(sim::ShapeKind::ball, {0, 0, 0}, 0.12);
    const auto at = [&](double t) {
      return sim::Vec3(3 + right * (3 * t - 2.5), 0.5 + 5 * t - 4.905 * t * t, 0);
    };
    std::vector<sim::Snapshot> then(9, picture.made.now);
    std::vector<Timed> times;
    std::vector<SpaceGhost> ghosts;
    const std::vector<int> all;
    for (std::size_t k = 0; k < then.size(); ++k) {
      then[k].bodies[std::size_t(ball)].position = at(0.1 * double(k));
      times.push_back({&then[k], "0." + std::to_string(k) + " \"s\""});
      ghosts.push_back({&then[k], &all, 0.5});
    }
    picture.made.now.bodies[std::size_t(ball)].position = at(0.9);
    picture.how.times = times, picture.how.times_of = ball, picture.how.ghosts = ghosts;
    const List list = picture.list();
    const Projection seen = picture.projection();
    std::vector<WordsBox> words;
    for (std::size_t k = 0; k < then.size(); ++k) {
      const auto its = box_of(list, "0." + std::to_string(k) + " s");
      ASSERT_TRUE(its) << k;
      const double radius = 0.12 * seen.scale_at({0, 0, 0});
      const auto end = leader_end(list, *its);
      const auto off = [&](double n) {
        return end ? (*end - seen.page(at(0.1 * n))).norm() : its->off(seen.page(at(0.1 * n)));
      };
      for (std::size_t j = 0; j <= then.size(); ++j) {
        EXPECT_GT(its->off(seen.page(at(0.1 * double(j)))), radius) << k << " lies on " << j;
        EXPECT_TRUE(j == k || off(double(k)) < off(double(j))) << k << " " << j;
      }
      // above the curve: off it by as much as there is from where it is as high
      const double x = (its->center.x() - seen.page(at(0)).x()) / (right * 3 * seen.scale_at({0, 0, 0}));
      EXPECT_LT(its->center.y(), seen.page(at(x)).y()) << k;
      for (const WordsBox& other : words) {
        const Point apart = (other.center - its->center).cwiseAbs() - (other.size + its->size) / 2;
        EXPECT_GT(apart.maxCoeff(), 0) << k;
      }
      words.push_back(*its);
    }
  }
}

/// Points and labels outside of the picture are left out, and named; an arrow that begins outside is named
/// where it is seen.
TEST(StillLabels, WhatLiesOutsideIsLeftOut) {
  StillPicture picture{room(4, 3)};
  picture.made.cast.walls.clear();
  picture.sheet.region = Extent{{0, 0, 0}, {1.5, 1.5, 0}};
  picture.marks.points = {{{-1, {3.5, 0.5, 0}}, "\"outside\""}, {{-1, {0.5, 0.5, 0}}, "\"inside\""}};
  picture.marks.labels = {{{-1, {0.5, -2, 0}}, "\"below\"", {}, -1, {}}};
  Marks::Vector vector;
  vector.quantity = Quantity::position;
  vector.at = Site{-1, {-2, 1, 0}}, vector.to = Site{-1, {1, 1, 0}}, vector.label = "\"enters\"";
  picture.marks.vectors = {vector};
  vector.at = Site{-1, {-2, 2, 0}}, vector.to = Site{-1, {1, 3, 0}}, vector.label = "\"passes\"";
  picture.marks.vectors.push_back(vector);
  std::vector<WordKey> unseen;
  picture.how.unseen = &unseen;
  const List list = picture.list();
  EXPECT_TRUE(box_of(list, "inside"));
  for (const char* out : {"outside", "below", "passes"}) EXPECT_FALSE(box_of(list, out)) << out;
  EXPECT_EQ(unseen, (std::vector<WordKey>{{WordKey::point, 0}, {WordKey::label, 0}}));
  const auto enters = box_of(list, "enters");
  ASSERT_TRUE(enters);
  const Rect window = picture.projection().window();
  EXPECT_GE(enters->center.x() - enters->size.x() / 2, window.x);
}

}  // namespace
}  // namespace obscura::draw

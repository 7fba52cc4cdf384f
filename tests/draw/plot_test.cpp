// Plots: ranges that use their room, axes that say quantity over unit, lines
// that are told apart without their colours, words that keep off each other.

#include "draw/page/plot.h"
#include "draw/page/chart.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "draw/compose/comparison.h"
#include "draw/page/layout.h"
#include "draw/page/measure.h"
#include "draw/page/names_around.h"
#include "draw/page/names_beside.h"
#include "draw/page/readings.h"
#include "draw/page/sheet.h"
#include "draw/picture/formula.h"

namespace obscura::draw {
namespace {

Plot plot_of(const std::vector<double>& values) {
  Plot plot;
  plot.title = over_unit("E", "J");
  for (std::size_t i = 0; i < values.size(); ++i) plot.times.push_back(double(i));
  plot.lines.push_back({"a", values});
  return plot;
}

std::string said(const Text& text) {
  std::string all;
  for (const Span& span : text.spans) all += span.text;
  return all;
}

/// From where to where a line of type reaches.
std::pair<double, double> width_from(const Text& text) {
  double width = 0;
  for (const Span& span : text.spans)
    width += span.lead + width_of(span.text, span.face, span.size, span.tabular);
  return {text.at.x(), text.at.x() + width};
}

constexpr Rect kRect{0, 0, 1000, 300};

/// An exponent in the title of an axis is within the plot's rectangle, by a third of a point.
TEST(Plot, TitlesStayBelowItsUpperEdge) {
  Plot plot = plot_of({1, 2});
  plot.title = over_unit("\\omega", "rad/s");
  for (const double point : {2.0, 4.0}) {
    const PlotArea area = plot_area(plot, {0, 50, 1000, 300}, point);
    List list;
    draw_axes(plot, area, palette(Theme::paper), list);
    double highest = 1e300;
    for (const Text& text : list.texts)
      for (const Span& span : text.spans)
        highest = std::min(highest, text.at.y() - span.rise - 0.66 * span.size);  // digits' height
    EXPECT_GT(highest, 50 + 0.3 * point) << point;
  }
}

/// A dot's halo keeps it off lines; on an axis it would eat the axis and the tick.
TEST(Plot, ADotOnAnAxisHasNoHalo) {
  Plot plot = plot_of({1, 2, 3});
  const PlotArea area = plot_area(plot, kRect, 2);
  const auto discs = [&](double along, double value) {
    plot.dots = {{along, value, ""}};
    List list;
    draw_dots(plot, area, palette(Theme::paper), list);
    return list.discs.size();
  };
  EXPECT_EQ(discs(1, 2), 2u);
  EXPECT_EQ(discs(0, 2), 1u);
  EXPECT_EQ(discs(1, area.low), 1u);
}

TEST(Plot, ItsAxisBeginsAtZeroWhereThatCostsLittleRoom) {
  const PlotArea high = plot_area(plot_of({2.2, 2.9, 2.4}), kRect, 2);
  EXPECT_GT(high.low, 2.1);
  EXPECT_LT(high.high, 3);
  const PlotArea wide = plot_area(plot_of({1, 10, 4}), kRect, 2);
  EXPECT_EQ(wide.low, 0);
  EXPECT_LT(wide.high, 10.6);
  const PlotArea below = plot_area(plot_of({-4, 0, -1}), kRect, 2);
  EXPECT_EQ(below.high, 0);
  // a constant is no noise
  const PlotArea same = plot_area(plot_of({5, 5 + 1e-9, 5 - 1e-9}), kRect, 2);
  EXPECT_EQ(same.low, 0);
  for (const PlotArea& area : {high, wide, below, same}) {
    EXPECT_GE(area.ticks.size(), 2u);
    for (const double tick : area.ticks) {
      EXPECT_GE(tick, area.low - 1e-12);
      EXPECT_LE(tick, area.high + 1e-12);
    }
  }
}

/// What is rounding is zero, not an axis of 1e-13; and zero is not drawn on the axis. Places have no zero of
/// their own: one that changes by little is seen to.
TEST(Plot, RoundingIsNotSpreadOverTheAxis) {
  Plot plot = plot_of({0, 2e-13, -4e-13});
  plot.negligible = 1e-9;
  const PlotArea none = plot_area(plot, kRect, 2);
  EXPECT_EQ(std::pair(none.low, none.high), std::pair(-1.1, 1.1));
  plot = plot_of({100000.5, 100001, 100002});
  EXPECT_EQ(plot_area(plot, kRect, 2).low, 0);
  plot.placed = true;
  const PlotArea place = plot_area(plot, kRect, 2);
  EXPECT_GT(place.low, 100000);
  EXPECT_LT(place.high, 100003);
}

/// A body of a kilogram that creeps, at a ten-millionth of a metre a second, has a speed and an energy.
TEST(Plot, WhatIsSlowIsNoRounding) {
  sim::SceneInfo cast;
  cast.scale = 4;
  cast.bodies.push_back({}), cast.bodies[0].mass = 1;
  for (const auto& [name, value] :
       {std::pair("speed", 1e-7), std::pair("kinetic", 0.5e-14), std::pair("angle", 1e-11)}) {
    Measured measured;
    measured.quantities = {name}, measured.bodies = {0};
    const Plot plot = empty_plot(measured, palette(Theme::paper), cast, [](int) { return Color{}; });
    EXPECT_LT(plot.negligible, value) << name;
    EXPECT_GT(plot.negligible, 1e-5 * value) << name;
  }
}

/// A plot over a key with one value has that in its middle.
TEST(Plot, OnePointIsInTheMiddle) {
  for (const bool log : {false, true}) {
    Plot plot = plot_of({3});
    plot.times.clear(), plot.lines[0].along = {2}, plot.dotted = true, plot.log = log;
    List list;
    draw_plots({plot}, palette(Theme::paper), {kRect}, 1, list);
    ASSERT_EQ(list.discs.size(), 1u);
    const PlotArea area = plot_area(plot, kRect, kPoint);
    EXPECT_NEAR(list.discs[0].center.x(), (area.left + area.right) / 2, 1);
  }
}

/// In a narrow rectangle type is smaller, and no axis runs backwards.
TEST(Plot, ANarrowPlotHasSmallerTypeAndAWideAxis) {
  Plot plot = plot_of({0.25, 1.25, 0.75});
  plot.title = "\"height\" / \"m\"";
  for (const double width : {160.0, 250.0, 400.0}) {
    Chart chart;
    chart.place = Chart::Place::right, chart.share = width / 1080;
    const PlotArea area = Charts({chart}, {plot}, palette(Theme::paper), 1, 2, {}, 0, 1).shown().front().area;
    EXPECT_GT(area.right - area.left, 0.2 * width) << width;
    List list;
    draw_plots({plot}, palette(Theme::paper), {{0, 0, width, 300}}, 3, list);
    double left = 1e300, right = -1e300;
    for (const Stroke& stroke : list.strokes)
      for (int i = stroke.begin; i < stroke.end; ++i) {
        left = std::min(left, list.nodes[std::size_t(i)].at.x());
        right = std::max(right, list.nodes[std::size_t(i)].at.x());
      }
    EXPECT_GE(left, 0) << width;
    EXPECT_LE(right, width) << width;
    EXPECT_GT(right - left, 0.4 * width) << width;
  }
}

/// With a range the axis has its ends, a line is cut off there, and is named where it leaves.
TEST(Plot, ARangeCutsLinesOffAndNamesThemWhereTheyLeave) {
  Plot plot = plot_of({2, 3, 4, 40, 50});
  plot.lines[0].label = "\"away\"";
  plot.lines.push_back({"\"here\"", {2, 2, 2, 2, 2}});
  plot.range = {0, 5};
  const PlotArea area = plot_area(plot, kRect, 2);
  EXPECT_EQ(area.low, 0);
  EXPECT_EQ(area.high, 5);
  List list;
  draw_lines(plot, area, list);
  ASSERT_FALSE(list.batches.empty());
  for (const Batch& batch : list.batches) {
    ASSERT_GE(batch.clip, 0);
    const Rect& clip = list.clips[std::size_t(batch.clip)];
    EXPECT_NEAR(clip.y, area.top, 2);
    EXPECT_NEAR(clip.y + clip.height, area.bottom, 2);
  }
  List names;
  draw_names(plot, area, palette(Theme::paper), names);
  for (const Text& text : names.texts) {
    // at the right end, and beside its last value in the range
    const double x = said(text) == "here" ? area.right : area.at(2, 4).x();
    EXPECT_NEAR(text.at.x(), x + 4 * area.point, 1) << said(text);
  }
  EXPECT_EQ(names.texts.size(), 2u);
}

/// The leaders of a plot for print: strokes between the right end of the axis and the edge.
std::vector<std::pair<Point, Point>> leaders_of(const Plot& plot) {
  List list;
  draw_plots({plot}, palette(Theme::paper), {kRect}, 1, list);
  double axis = 0;  // the right end of the axis of times
  for (const Stroke& stroke : list.strokes)
    if (stroke.end - stroke.begin == 2) {
      const Point a = list.nodes[std::size_t(stroke.begin)].at,
                  b = list.nodes[std::size_t(stroke.begin) + 1].at;
      if (a.y() == b.y() && a.x() < b.x() && b.x() - a.x() > kRect.width / 2) axis = std::max(axis, b.x());
    }
  std::vector<std::pair<Point, Point>> found;
  for (const Stroke& stroke : list.strokes) {
    const Point a = list.nodes[std::size_t(stroke.begin)].at, b = list.nodes[std::size_t(stroke.end) - 1].at;
    if (a.x() > axis && b.x() > axis) found.emplace_back(a, b);
  }
  return found;
}

/// Names that stand far off the ends of their lines have leaders from there; where all stand beside them
/// there are none, nor of lines that end before.
TEST(Plot, NamesOffTheEndsOfTheirLinesHaveLeaders) {
  Plot plot = plot_of({1, 1, 1, 1, 0});
  plot.lines[0].label = "a";
  plot.lines.push_back({"b", {1, 0.5, 0.2, 0.1, 0}});
  plot.lines.push_back({"c", {1, 0.5, 0.2, 0.1, 0.01}});
  const auto found = leaders_of(plot);
  ASSERT_EQ(found.size(), 3u);
  double lowest = -1e9, highest = 1e9;
  for (const auto& [end, name] : found) {
    EXPECT_LT(end.x(), name.x());
    lowest = std::max(lowest, end.y()), highest = std::min(highest, end.y());
  }
  EXPECT_NEAR(highest, lowest, 0.02 * kRect.height) << "they begin where the lines end";
  plot.lines[1].values.back() = 0.5, plot.lines[2].values.back() = 1;
  EXPECT_TRUE(leaders_of(plot).empty());
  plot.lines[1].values = {1, 0.5, 0}, plot.lines[2].values.back() = 0;
  EXPECT_EQ(leaders_of(plot).size(), 2u) << "one ends in the middle";
}

TEST(Plot, AnAxisSaysQuantityOverUnit) {
  EXPECT_EQ(over_unit("g_y", "m/s^2"), over_unit("g_y", "m/s²"));
  EXPECT_EQ(over_unit("E", "J"), "E / \"J\"");
  EXPECT_EQ(over_unit("v", "m/s"), "v / \"m s\"^{-1}");
  EXPECT_EQ(over_unit("a", "m/s²"), "a / \"m s\"^{-2}");
  EXPECT_EQ(over_unit("rate", "1/s"), "rate / \"s\"^{-1}");
  EXPECT_EQ(over_unit("\\theta", "°"), "\\theta / \"deg\"");
  EXPECT_EQ(over_unit("n", ""), "n");
}

TEST(Plot, WordsOfTheAxesKeepOffEachOther) {
  for (const double last : {1.0, 2.0, 9.7, 100.0}) {
    Plot plot = plot_of({0, 1e-3, 123});
    plot.times = {0, last / 2, last};
    const PlotArea area = plot_area(plot, kRect, 2);
    List list;
    draw_axes(plot, area, palette(Theme::paper), list);
    for (std::size_t i = 0; i < list.texts.size(); ++i)
      for (std::size_t k = 0; k < i; ++k) {
        const Text &a = list.texts[i], &b = list.texts[k];
        if (std::abs(a.at.y() - b.at.y()) > 0.8 * 8.5 * 2) continue;
        const auto [a0, a1] = width_from(a);
        const auto [b0, b1] = width_from(b);
        EXPECT_TRUE(a1 < b0 || b1 < a0) << said(a) << " and " << said(b);
      }
    for (const Text& text : list.texts) EXPECT_LE(width_from(text).second, kRect.width) << said(text);
  }
}

/// How a line is drawn but for its colour: its dashes' lengths, and how many corners its markers have.
std::vector<double> look_of(int style) {
  Plot plot = plot_of({0, 0, 0});
  plot.lines.resize(16, plot.lines[0]);
  tell_apart(plot);
  plot.lines = {plot.lines[std::size_t(style)]};
  List list;
  draw_lines(plot, plot_area(plot, kRect, 2), list);
  std::vector<double> lengths;
  for (std::size_t k = 0; k < std::min<std::size_t>(list.strokes.size(), 4); ++k) {
    const Node &a = list.nodes[std::size_t(list.strokes[k].begin)],
               &b = list.nodes[std::size_t(list.strokes[k].end) - 1];
    lengths.push_back(std::round((b.at - a.at).norm())), lengths.push_back(std::round(a.at.x()));
  }
  // and the corners of its markers
  lengths.push_back(list.polygons.empty() ? 0 : list.polygons[0].end - list.polygons[0].begin);
  return lengths;
}

// a column beside the picture: few ticks, but not two
TEST(Plot, ANarrowAxisHasThreeTicksWhereTheirNumbersFindRoom) {
  for (const int last : {5, 7, 9, 12, 14, 18, 25, 30, 45, 90}) {
    for (const double wide : {100.0, 120.0, 150.0}) {
      Plot plot = plot_of({0, 1});
      plot.times = {0, double(last)};
      const PlotArea area = plot_area(plot, {0, 0, wide, 100}, 1);
      List list;
      draw_axes(plot, area, palette(Theme::paper), list);
      int numbers = 0;
      std::pair<double, double> before{-1e9, -1e9};
      for (const Text& text : list.texts) {
        if (text.at.y() < area.bottom + 5 || said(text).find('t') != std::string::npos) continue;
        ++numbers;
        EXPECT_GT(width_from(text).first, before.second + 2) << last << " " << wide;
        before = width_from(text);
      }
      EXPECT_GE(numbers, 3) << last << " " << wide;
    }
  }
}

TEST(Plot, LinesAreToldApartWithoutTheirColours) {
  for (int a = 0; a < 16; ++a)
    for (int b = 0; b < a; ++b) EXPECT_NE(look_of(a), look_of(b)) << a << " and " << b;
}

TEST(Plot, LinesOfDotsAreToldApartWithoutTheirColours) {
  const auto look = [](int style) {
    Plot plot = plot_of({0, 0, 0});
    plot.dotted = true, plot.lines[0].style = style;
    List list;
    draw_lines(plot, plot_area(plot, kRect, 2), list);
    // of its markers: corners and where the first is
    std::vector<double> all = look_of(style % 6);
    for (const Polygon& polygon : list.polygons) {
      all.push_back(polygon.end - polygon.begin);
      all.push_back(std::round(list.points[std::size_t(polygon.begin)].y()));
    }
    return all;
  };
  for (int a = 0; a < 16; ++a)
    for (int b = 0; b < a; ++b) EXPECT_NE(look(a), look(b)) << a << " and " << b;
}

Plot plot_of_many(int count, const std::string& name) {
  Plot plot = plot_of({1, 2, 3});
  plot.lines.clear();
  for (int i = 0; i < count; ++i)
    plot.lines.push_back({"\"" + name + "\"_{" + std::to_string(i) + "}", {1, 2, 3 + 0.01 * i}});
  tell_apart(plot);
  return plot;
}

/// Names beside their lines get smaller where there are many; of more there is a key. Neither lie on each
/// other, nor leave the plot's rectangle.
TEST(Plot, NamesOfManyLinesNeverLieOnEachOther) {
  for (const std::string name : {"a", "a long name of a ball"}) {
    for (int count = 2; count <= (name.size() > 1 ? 12 : 16); ++count) {
      for (const Rect& rect : {Rect{0, 0, 1700, 220}, Rect{0, 0, 400, 600}}) {
        constexpr double kPoint = 3.9;
        const Plot plot = plot_of_many(count, name);
        const PlotArea area = plot_area(plot, rect, kPoint);
        List list;
        draw_names(plot, area, palette(Theme::paper), list);
        if (!area.key.empty()) {
          EXPECT_TRUE(list.texts.empty());
          draw_axes(plot, area, palette(Theme::paper), list);
        }
        std::vector<Rect> boxes;
        for (const Text& text : list.texts) {
          if (text.at.y() > area.top + (area.key.empty() ? 1e9 : 0)) continue;  // numbers of the axes
          const double em = text.spans.front().size;
          EXPECT_GE(em, 20);  // 1/54 of the picture
          const auto [left, right] = width_from(text);
          EXPECT_LE(right, rect.width + 1) << said(text);
          EXPECT_GE(text.at.y() - 0.68 * em, 0) << said(text);
          boxes.push_back({left, text.at.y() - 0.68 * em, right - left, 0.68 * em});
        }
        EXPECT_GE(int(boxes.size()), count);
        for (std::size_t i = 0; i < boxes.size(); ++i)
          for (std::size_t k = 0; k < i; ++k) {
            const Rect &a = boxes[i], &b = boxes[k];
            EXPECT_TRUE(a.x + a.width < b.x || b.x + b.width < a.x || a.y + a.height < b.y ||
                        b.y + b.height < a.y)
                << i << " and " << k << " of " << count << " in " << rect.width;
          }
        EXPECT_GE(area.bottom - area.top, 0.2 * rect.height) << count;
      }
    }
  }
}

TEST(Plot, TallNamesTakeTheirOwnHeight) {
  Plot plot = plot_of_many(3, "a");
  plot.lines[1].label = "\\frac{m_1}{2}";
  const PlotArea area = plot_area(plot, kRect, 2);
  EXPECT_GT(area.heights[1], 1.2 * area.heights[0]);
  EXPECT_GE(std::abs(area.names[1] - area.names[0]), (area.heights[0] + area.heights[1]) / 2 - 1e-9);
  EXPECT_GE(std::abs(area.names[2] - area.names[1]), (area.heights[2] + area.heights[1]) / 2 - 1e-9);
}

/// However low the axis, its numbers do not touch: digits are 0.7 em high.
TEST(Plot, NumbersOfTheValuesNeverTouch) {
  for (const double top : {10.0, 1500.0, 7.3, 0.02}) {
    for (const bool log : {false, true}) {
      for (double height = 65; height < 400; height += 7) {
        Plot plot = plot_of({0.004 * top, 0.3 * top, top});
        if (log) plot.times = {1, 2, 3};
        plot.log = log;
        const PlotArea area = plot_area(plot, {0, 0, 500, height}, 2);
        List list;
        draw_axes(plot, area, palette(Theme::paper), list);
        std::vector<double> middles;
        for (const Text& text : list.texts)
          if (width_from(text).second < area.left && text.at.y() > area.top - 5 &&
              said(text).find('E') == std::string::npos)
            middles.push_back(text.at.y());
        std::sort(middles.begin(), middles.end());
        EXPECT_GE(middles.size(), 1u);
        for (std::size_t i = 1; i < middles.size(); ++i)
          EXPECT_GT(middles[i] - middles[i - 1], 0.8 * 8.5 * 2) << top << " in " << height << " log " << log;
      }
    }
  }
}

/// What is not positive has no place on a logarithmic axis, and no line leads across it.
TEST(Plot, LogarithmicLinesHaveAGapWhereValuesAreNotPositive) {
  Plot plot = plot_of({3, 2, 1, 0, -1, 1, 2, 0});
  plot.times = {1, 2, 3, 4, 5, 6, 7, 8};
  plot.log = true;
  const PlotArea area = plot_area(plot, kRect, 2);
  List list;
  draw_lines(plot, area, list);
  ASSERT_EQ(list.strokes.size(), 2u);
  std::vector<std::size_t> nodes;
  for (const Stroke& stroke : list.strokes) nodes.push_back(std::size_t(stroke.end - stroke.begin));
  EXPECT_THAT(nodes, testing::ElementsAre(3, 2));
}

/// What is to be looked at lies over what is quiet.
TEST(Plot, QuietLinesLieUnderTheOthers) {
  Plot plot = plot_of_many(3, "a");
  plot.lines[1].quiet = plot.lines[2].quiet = true;
  EXPECT_THAT(painters_order(plot), testing::ElementsAre(1, 2, 0));
  for (std::size_t i = 0; i < 3; ++i) plot.lines[i].color = {std::uint8_t(i), 0, 0}, plot.lines[i].style = 0;
  List list;
  draw_lines(plot, plot_area(plot, kRect, 2), list);
  ASSERT_EQ(list.strokes.size(), 3u);
  EXPECT_EQ(list.nodes[std::size_t(list.strokes.back().begin)].color, plot.lines[0].color);
}

/// Dashes do not crawl while a line grows: the first ones stay.
TEST(Plot, DashesStayWhereTheyAreWhileALineGrows) {
  Plot plot = plot_of({0, 3, 1, 5, 2, 2});
  plot.lines[0].style = 1;
  const PlotArea area = plot_area(plot, kRect, 2);
  List whole, half;
  draw_lines(plot, area, whole);
  plot.times.resize(4), plot.lines[0].values.resize(4);
  draw_lines(plot, area, half);
  ASSERT_GT(half.strokes.size(), 5u);
  for (std::size_t k = 0; k + 1 < half.strokes.size(); ++k)
    EXPECT_EQ(whole.nodes[std::size_t(whole.strokes[k].end) - 1].at,
              half.nodes[std::size_t(half.strokes[k].end) - 1].at);
}

// A plot of orbits of these radii, each of so many rounds.
Plot orbits(const std::vector<double>& radii, double rounds) {
  Plot plot;
  plot.title = "v";
  for (const double radius : radii) {
    Series line;
    line.label = radius == radii.front() ? "a" : "b";
    for (int k = 0; k <= 97 * rounds; ++k) {
      const double angle = 2 * std::numbers::pi * k / 97.3;
      line.along.push_back(radius * std::cos(angle)), line.values.push_back(radius * std::sin(angle));
    }
    plot.times.resize(line.values.size());
    plot.lines.push_back(std::move(line));
  }
  tell_apart(plot);
  return plot;
}

double drawn(const List& list) {
  double all = 0;
  for (const Stroke& stroke : list.strokes)
    for (int i = stroke.begin; i + 1 < stroke.end; ++i)
      all += (list.nodes[std::size_t(i) + 1].at - list.nodes[std::size_t(i)].at).norm();
  return all;
}

/// Where an orbit runs over itself its dashes stay: a second round would fill their gaps.
TEST(Plot, AnOrbitIsDashedOnce) {
  Plot once = orbits({1}, 1), often = orbits({1}, 3.4);
  List first, all;
  for (Plot* each : {&once, &often}) each->lines[0].style = 1;
  const PlotArea area = plot_area(once, kRect, 2);
  draw_lines(once, area, first), draw_lines(often, area, all);
  // a dash more or less where the round closes
  EXPECT_NEAR(drawn(all), drawn(first), 0.03 * drawn(first));
  // one that comes back elsewhere is drawn on, and one without dashes is as it was
  Plot damped = orbits({1}, 3);
  damped.lines[0].style = 1;
  for (std::size_t k = 0; k < damped.lines[0].values.size(); ++k)
    for (std::vector<double>* of : {&damped.lines[0].values, &damped.lines[0].along})
      (*of)[k] *= std::exp(-0.004 * double(k));
  List spiral;
  draw_lines(damped, area, spiral);
  // its three rounds shrink to a third
  EXPECT_GT(drawn(spiral), 1.5 * drawn(first));
}

/// Of lines that end inside their plot, nothing at the right says which is which: their names are a key.
TEST(Plot, NamesOfOrbitsWithinEachOtherAreAKey) {
  const auto names = [](const std::vector<double>& radii) {
    List list;
    draw_plots({orbits(radii, 1)}, palette(Theme::paper), {kRect}, 1, list);
    std::vector<Point> places;
    for (const char* name : {"a", "b"})
      for (const Text& text : list.texts)
        if (said(text) == name) places.push_back(text.at);
    return places;
  };
  const auto key = names({1, 0.4});
  ASSERT_EQ(key.size(), 2u);
  EXPECT_EQ(key[0].y(), key[1].y()) << "in one row";
  EXPECT_LT(key[0].x(), key[1].x()) << "in their order";
  EXPECT_LT(key[1].x(), 500) << "beside the title";
}

TEST(Plot, NamesAreSpreadInTheirOrderAndWithinTheirEnds) {
  const std::vector<double> wanted{50, 52, 51, 10, 98};
  const std::vector<double> heights(5, 10);
  const std::vector<double> found = spread(wanted, heights, -5, 105, by_height(wanted));
  std::vector<double> sorted = found;
  std::sort(sorted.begin(), sorted.end());
  for (std::size_t i = 1; i < sorted.size(); ++i) EXPECT_GE(sorted[i] - sorted[i - 1], 10 - 1e-9);
  EXPECT_LT(found[0], found[2]);
  EXPECT_LT(found[2], found[1]);
  EXPECT_EQ(found[3], 10);
  EXPECT_EQ(found[4], 98);
  EXPECT_NEAR(found[2], 51, 1e-9);
  for (const double each : spread({99, 100, 100}, {10, 10, 10}, -5, 105, {0, 1, 2})) EXPECT_LE(each, 100);
}

TEST(Plot, NamesAreInTheOrderOfTheirLines) {
  EXPECT_THAT(by_height({5, 3, 5}), testing::ElementsAre(1, 0, 2));
  EXPECT_THAT(spread({52, 50}, {10, 10}, -5, 105, {0, 1}), testing::ElementsAre(46, 56));
}

// Two lines that cross ten times in a run, and one between them.
TEST(Plot, NamesStandBesideTheirOwnHeadsAndNeverOnEachOther) {
  constexpr double kApart = 10;
  const std::vector<double> kHeights(3, kApart);
  constexpr std::size_t kInstants = 1000;
  const auto winding = [](double periods) {
    std::vector<std::vector<double>> heads;
    for (std::size_t k = 0; k < kInstants; ++k) {
      const double angle = 2 * std::numbers::pi * periods * double(k) / kInstants;
      heads.push_back({50 + 40 * std::sin(angle), 50 - 40 * std::sin(angle), 55});
    }
    return heads;
  };
  const auto heads = winding(5);
  const NamePlaces places = names_beside(heads, kHeights, -5, 105);
  ASSERT_EQ(places.offsets.size(), 3u);
  for (std::size_t k = 0; k < kInstants; ++k) {
    for (std::size_t i = 0; i < 3; ++i) {
      const double name = heads[k][i] + places.offsets[i][k];
      EXPECT_GE(name, -1e-9);
      EXPECT_LE(name, 100 + 1e-9);
      const bool jumps = k == 0 || std::count(places.changes[i].begin(), places.changes[i].end(), k) > 0;
      if (!jumps) {
        const double before = heads[k - 1][i] + places.offsets[i][k - 1];
        EXPECT_LE(std::abs(name - before), 2.6) << "at " << k << ": it glides as fast as a head";
      }
      for (std::size_t j = 0; j < i; ++j) {
        const double other = heads[k][j] + places.offsets[j][k];
        EXPECT_GE(std::abs(name - other), kApart - 1e-9) << i << " and " << j << " at " << k;
        if (const double above = heads[k][i] - heads[k][j]; std::abs(above) > kApart) {
          EXPECT_GT((name - other) * above, 0) << i << " and " << j << " at " << k;
        }
      }
    }
  }
  // at about each crossing of the two; the third is passed by both
  EXPECT_EQ(places.changes[0].size(), places.changes[1].size());
  EXPECT_GE(places.changes[0].size(), 9u);
  // so fast that they would flicker
  for (const auto& changes : names_beside(winding(100), kHeights, -5, 105).changes)
    EXPECT_TRUE(changes.empty());
}

// Heads that cross once: from where they meet on the names are in the new order. Heads that wind about each
// other narrowly keep it.
TEST(Plot, NamesChangePlacesWhereTheirLinesMeet) {
  constexpr std::size_t kInstants = 1000;
  std::vector<std::vector<double>> crossing, narrow;
  for (std::size_t k = 0; k < kInstants; ++k) {
    const double t = double(k) / kInstants;
    crossing.push_back({50 + 8 * (t - 0.4001), 50 - 8 * (t - 0.4001)});
    narrow.push_back({50 + 2 * std::sin(2 * std::numbers::pi * 20 * t), 50});
  }
  const NamePlaces places = names_beside(crossing, {10, 10}, 0, 100);
  ASSERT_EQ(places.changes[0].size(), 1u);
  EXPECT_NEAR(double(places.changes[0][0]), 401, 2);
  for (const auto& changes : names_beside(narrow, {10, 10}, 0, 100).changes) EXPECT_TRUE(changes.empty());
}

// A line that comes back on itself, above another: names keep off both, off the heads and off each other, and
// hardly ever change their sides.
TEST(Plot, NamesAgainstAQuantityKeepOffLinesAndEachOther) {
  constexpr std::size_t kInstants = 900;
  const auto run = [&](double apart) {
    std::vector<std::vector<Point>> heads;
    for (std::size_t k = 0; k < kInstants; ++k) {
      const double angle = 2 * std::numbers::pi * 3 * double(k) / kInstants;
      const Point at(500 - 300 * std::cos(angle), 200 + 20 * std::cos(angle));
      heads.push_back({at, at + Point(0, apart)});
    }
    return heads;
  };
  const std::vector<Point> sizes{{80, 20}, {90, 20}};
  const Rect bounds{0, 0, 1000, 400};
  const auto heads = run(90);
  const NamesAround found = names_around(heads, sizes, bounds, 10, 2);
  EXPECT_TRUE(found.clear);
  std::size_t struck = 0;
  for (std::size_t k = 0; k < kInstants; ++k) {
    std::vector<Rect> boxes;
    for (std::size_t i = 0; i < 2; ++i) {
      const Point left = heads[k][i] + found.offsets[i][k];
      boxes.push_back({left.x(), left.y() - 10, sizes[i].x(), sizes[i].y()});
      const Rect& box = boxes.back();
      EXPECT_GE(box.x, bounds.x - 1e-9);
      EXPECT_LE(box.x + box.width, bounds.width + 1e-9);
      const auto within = [&](const Point& p) {
        return p.x() > box.x && p.x() < box.x + box.width && p.y() > box.y && p.y() < box.y + box.height;
      };
      bool on = false;
      for (std::size_t j = 0; j < 2; ++j)
        for (std::size_t past = 0; past <= k; ++past) on = on || within(heads[past][j]);
      struck += on;
      const bool changed = k > 0 && found.offsets[i][k] != found.offsets[i][k - 1];
      EXPECT_EQ(changed, std::count(found.changes[i].begin(), found.changes[i].end(), k) > 0);
    }
    EXPECT_TRUE(boxes[0].y + 20 <= boxes[1].y + 1e-9 || boxes[1].y + 20 <= boxes[0].y + 1e-9 ||
                boxes[0].x + 80 <= boxes[1].x || boxes[1].x + 90 <= boxes[0].x);
  }
  EXPECT_LE(double(struck), 0.04 * kInstants);
  // where there is no room at all, it says so
  EXPECT_FALSE(names_around(heads, sizes, {0, 170, 1000, 60}, 10, 2).clear);
}

/// Names that would be in the way wherever they stood are a key.
TEST(Charts, NamesWithoutRoomAreAKey) {
  const auto key_of = [](double second) {
    Plot plot;
    for (const double scale : {1.0, second}) {
      Series line;
      line.label = "\"name\"";
      for (int k = 0; k <= 400; ++k) {
        line.along.push_back(scale * std::cos(0.1 * k)), line.values.push_back(scale * std::sin(0.23 * k));
        if (scale == 1) plot.times.push_back(0.1 * k);
      }
      plot.lines.push_back(line);
    }
    Chart chart;
    chart.against = "x";
    return Charts({chart}, {plot}, palette(Theme::paper), 16.0 / 9, 40, {}, 0, 1).shown()[0].area.key.size();
  };
  EXPECT_EQ(key_of(0.95), 2u);
}

/// A key stays within its plot, however long the names are, and also where the plots share their left side.
TEST(Charts, AKeyEndsWithinThePicture) {
  constexpr double kAspect = 16.0 / 9;
  for (const int letters : {10, 25, 45, 90})
    for (const double type_scale : {1.0, 1.5}) {
      Plot plot;
      plot.title = over_unit("\"height\"", "m");
      for (int i = 0; i < 2; ++i) {
        Series line;
        line.label = "\"" + std::string(std::size_t(letters), i == 0 ? 'n' : 'a') + "\"";
        for (int k = 0; k <= 10; ++k) line.values.push_back(0.01 * k);
        plot.lines.push_back(line);
      }
      for (int k = 0; k <= 10; ++k) plot.times.push_back(k);
      Plot wide = plot;
      for (Series& line : wide.lines)
        for (double& value : line.values) value = 1e6 + 12345 * value;
      Chart chart;
      chart.place = Chart::Place::right;
      const Charts charts({chart, chart}, {plot, wide}, palette(Theme::paper), kAspect, 10, {}, 0,
                          type_scale);
      List list;
      charts.draw_still(list);
      for (const Text& text : list.texts)
        EXPECT_LE(width_from(text).second, 1080 * kAspect) << letters << " " << said(text);
    }
}

/// Lines that pass each other all the time have a key: names beside them would come and go. Lines that pass
/// each other now and then have not.
TEST(Charts, NamesOfLinesThatWindAboutEachOtherAreAKey) {
  const auto shown = [](double periods) {
    Plot plot;
    for (int i = 0; i < 10; ++i) {
      Series line;
      line.label = "\"name\"";
      for (int k = 0; k <= 1000; ++k) {
        line.values.push_back(std::sin(2 * std::numbers::pi * (periods * k / 1000.0 + 0.1 * i)));
        if (i == 0) plot.times.push_back(0.004 * k);
      }
      plot.lines.push_back(line);
    }
    Chart chart;
    chart.share = 0.5;
    return Charts({chart}, {plot}, palette(Theme::paper), 16.0 / 9, 4, {}, 0, 1).shown().front().area;
  };
  const PlotArea often = shown(8), seldom = shown(0.2);
  EXPECT_EQ(often.key.size(), 10u);
  EXPECT_EQ(often.last, 4);
  EXPECT_TRUE(seldom.key.empty());
  EXPECT_GT(often.top, seldom.top);
}

/// However little room an axis has, it has two numbers where they do not touch.
TEST(Plot, AnAxisHasTwoNumbers) {
  const auto numbers = [](double low, double high, double height) {
    Plot plot = plot_of({low, high});
    plot.range = {low, high};
    const PlotArea area = plot_area(plot, {0, 0, 400, height}, 1);
    std::vector<double> all = area.ticks;
    for (std::size_t i = 1; i < all.size(); ++i)
      EXPECT_GE(area.at(0, all[i - 1]).y() - area.at(0, all[i]).y(), 6.5 - 1e-9) << low << " to " << high;
    return all;
  };
  EXPECT_THAT(numbers(0.15, 2.6, 60), testing::ElementsAre(1, 2));
  EXPECT_THAT(numbers(0, 1.97, 39.3), testing::ElementsAre(0, 1.5));
  EXPECT_THAT(numbers(-4.2, 4.4, 38.3), testing::ElementsAre(-4, 4));
  for (double low = -3; low < 3; low += 0.37)
    for (double width = 0.2; width < 10; width *= 1.3)
      EXPECT_GE(numbers(low, low + width, 44).size(), 2u) << low << " to " << low + width;
  // and along the other axis
  for (double low = -3; low < 3; low += 0.37)
    for (double width = 0.2; width < 10; width *= 1.3) {
      Plot plot = plot_of({0, 1});
      plot.lines[0].along = {low, low + width};
      const PlotArea area = plot_area(plot, {0, 0, 110, 100}, 1);
      List list;
      draw_axes(plot, area, palette(Theme::paper), list);
      const auto below = std::count_if(list.texts.begin(), list.texts.end(), [&](const Text& text) {
        return text.at.y() > area.bottom + 4 && said(text).find_first_of("t/") == std::string::npos;
      });
      EXPECT_GE(below, 2) << low << " to " << low + width;
    }
}

/// With an emphasis, a spring between what is grey recedes; one that holds what is to be looked at does not.
TEST(Plot, LinksOfQuietBodiesRecede) {
  Look look;
  look.bodies.resize(3);
  look.bodies[0].quiet = look.bodies[1].quiet = true;
  for (const Theme theme : {Theme::paper, Theme::screen}) {
    const Palette colours = palette(theme);
    for (const auto& [a, b] : {std::pair(0, 1), std::pair(-1, 0), std::pair(1, -1)})
      EXPECT_LT(contrast(link_color(look, colours, std::array{a, b}), colours.room),
                0.6 * contrast(colours.spring, colours.room));
    for (const auto& [a, b] : {std::pair(0, 2), std::pair(-1, 2), std::pair(-1, -1)})
      EXPECT_EQ(link_color(look, colours, std::array{a, b}), colours.spring);
    Marks::Vector vector;
    vector.quantity = Quantity::velocity;
    EXPECT_FALSE(color_of(vector, colours) == colours.quiet);
    vector.quiet = true;
    EXPECT_EQ(color_of(vector, colours), colours.quiet);
  }
}

TEST(Plot, BodiesOfOneColourHaveShadesOfIt) {
  sim::SceneInfo cast;
  cast.bodies.resize(10);
  Measured all;
  all.quantities = {"height"};
  for (int i = 0; i < 10; ++i) all.bodies.push_back(i);
  for (const Theme theme : {Theme::paper, Theme::screen}) {
    const Palette colours = palette(theme);
    const Color own = paint(*color("sky"), theme).outline;
    const auto line_color = [&](int body) { return body == 9 ? *color("orange") : own; };
    const Plot plot = empty_plot(all, colours, cast, line_color);
    for (std::size_t i = 0; i < 9; ++i) {
      EXPECT_GE(contrast(plot.lines[i].color, colours.room), 2.9);
      for (std::size_t k = 0; k < i; ++k) EXPECT_FALSE(plot.lines[i].color == plot.lines[k].color);
    }
    EXPECT_GT(contrast(plot.lines[0].color, plot.lines[8].color), 2);
    EXPECT_EQ(plot.lines[9].color, *color("orange"));
    // grey ones are grey
    const Plot hushed = empty_plot(all, colours, cast, line_color, {}, [](int body) { return body < 9; });
    for (std::size_t i = 0; i < 10; ++i) {
      EXPECT_EQ(hushed.lines[i].color, line_color(int(i)));
      EXPECT_EQ(hushed.lines[i].quiet, i < 9);
    }
  }
}

TEST(Plot, SeveralBodiesHaveLinesOfTheirOwn) {
  sim::SceneInfo cast;
  cast.bodies.resize(2);
  cast.bodies[0].name = "a", cast.bodies[1].name = "b";
  Measured both;
  both.quantities = {"height"}, both.bodies = {0, 1};
  const Palette colours = palette(Theme::paper);
  const Color own[] = {{10, 20, 30}, {40, 50, 60}};
  const Plot plot = empty_plot(both, colours, cast, [&](int body) { return own[body]; });
  ASSERT_EQ(plot.lines.size(), 2u);
  EXPECT_EQ(plot.title, "height / \"m\"");
  for (std::size_t i = 0; i < 2; ++i) {
    EXPECT_EQ(plot.lines[i].color, own[i]);
    EXPECT_EQ(plot.lines[i].label, "\"" + cast.bodies[i].name + "\"");
  }
  EXPECT_NE(plot.lines[0].style, plot.lines[1].style);
  // energies are of all: a line each, in colours that mean no force, position
  // or velocity
  Measured energies;
  energies.quantities = {"energy", "kinetic", "potential", "springs"};
  const Plot second = empty_plot(energies, colours, cast, [&](int body) { return own[body]; });
  ASSERT_EQ(second.lines.size(), 4u);
  EXPECT_EQ(second.title, "E / \"J\"");
  for (const char* taken : {"vermilion", "blue", "green"})
    for (const Series& line : second.lines)
      EXPECT_FALSE(line.color == mix(*color(taken), colours.ink, 0.2)) << line.label << " " << taken;
}

/// A line that is alone has the colour of its quantity; where another body has that, its own body's.
TEST(Plot, TheOnlyLineOfABodyHasNoOtherBodysColour) {
  sim::SceneInfo cast;
  cast.bodies.resize(2);
  cast.bodies[0].name = "a", cast.bodies[1].name = "b";
  Measured one;
  one.quantities = {"x"}, one.bodies = {1};
  const Palette colours = palette(Theme::paper);
  const Color plain = mix(*color("blue"), colours.ink, 0.2);
  Color own[] = {compared_paint(1, Theme::paper).outline, compared_paint(2, Theme::paper).outline};
  ASSERT_FALSE(own[0] == plain);  // the outline of a blue body is hardly another blue
  const auto line_color = [&](int body) { return own[body]; };
  EXPECT_EQ(empty_plot(one, colours, cast, line_color).lines[0].color, own[1]);
  // of several quantities each has its own
  one.quantities = {"vx", "vy"};
  EXPECT_EQ(empty_plot(one, colours, cast, line_color).lines[0].color, plain);
  // nor where what is blue is fixed, or is not there
  one.quantities = {"x"}, cast.bodies[0].fixed = true;
  EXPECT_EQ(empty_plot(one, colours, cast, line_color).lines[0].color, plain);
  own[0] = own[1], cast.bodies[0].fixed = false;
  EXPECT_EQ(empty_plot(one, colours, cast, line_color).lines[0].color, plain);
}

TEST(Plot, BodiesAreWordsNotIdentifiers) {
  EXPECT_EQ(spoken("left_bob"), "\"left bob\"");
  EXPECT_EQ(spoken("crate[2]"), "\"crate\"_{2}");
}

TEST(Plot, KineticEnergyAndThatOfGravityAreOfBodiesToo) {
  sim::SceneInfo cast;
  cast.bodies.resize(2);
  sim::Snapshot now;
  now.bodies.resize(2);
  now.bodies[0].kinetic = 1, now.bodies[1].kinetic = 2, now.bodies[1].gravity = 5;
  now.energies.kinetic = 3, now.energies.gravity = 5;
  Measured both;
  both.quantities = {"kinetic", "gravity"}, both.bodies = {0, 1};
  std::vector<double> read;
  for (const Measured::Line& line : both.lines()) read.push_back(line.at(cast, now));
  EXPECT_EQ(read, (std::vector<double>{1, 2, 0, 5}));
  both.bodies.clear(), read.clear();
  for (const Measured::Line& line : both.lines()) read.push_back(line.at(cast, now));
  EXPECT_EQ(read, (std::vector<double>{3, 5}));
}

/// A plot against a quantity at the right is about as tall as wide, and its line keeps off the axis; over
/// time it is a column.
TEST(Charts, AgainstAQuantityAtTheRightIsNoStrip) {
  Plot plot;
  Series line;
  for (int k = 0; k <= 40; ++k)
    line.along.push_back(4 + std::cos(0.2 * k)), line.values.push_back(std::sin(0.2 * k)),
        plot.times.push_back(0.1 * k);
  plot.lines = {line};
  Chart chart;
  chart.place = Chart::Place::right;
  const auto area = [&] {
    return Charts({chart}, {plot}, palette(Theme::paper), 16.0 / 9, 4, {}, 0, 1).shown().front().area;
  };
  const PlotArea tall = area();
  EXPECT_GT(tall.bottom - tall.top, 2 * (tall.right - tall.left));
  chart.against = "x";
  const PlotArea square = area();
  EXPECT_LT(square.bottom - square.top, 1.7 * (square.right - square.left));
  EXPECT_GT(square.bottom - square.top, 0.7 * (square.right - square.left));
  EXPECT_LT(square.first, 3 - 0.05);
  EXPECT_GT(square.last, 5 + 0.05);
}

}  // namespace
}  // namespace obscura::draw

// Rulers of a sheet, outside the room's hatching: thin lines with ticks at round metres.

#include <algorithm>
#include <cmath>
#include <vector>

#include "draw/compose/annotate.h"
#include "draw/page/plot.h"
#include "draw/page/sheet.h"
#include "draw/picture/formula.h"
#include "draw/picture/formula_values.h"

namespace obscura::draw {
namespace {

// points, of type that is not larger than usual
constexpr double kRulerType = 8.5, kTick = 2.5, kLine = 0.6;
constexpr const char* kUpward = "y / \"m\"";
constexpr double kOff = 3;                             // from the picture
constexpr double kNameBelow = 9;                       // the numbers
constexpr double kInside = 1;                          // of the page's edge
constexpr double kFarNumbers = 26, kNearNumbers = 18;  // between numbers beside and above each other
constexpr double kNameBetween = 2.6 * kRulerType;      // between two numbers that have the name between them
constexpr double kNumbersApart = 4;                    // beside each other
constexpr double kOffTick = 6;                         // how far a number's middle is from its tick at most

double widest(const std::vector<std::string>& numbers, double point) {
  double all = 0;
  for (const std::string& each : numbers) all = std::max(all, formula(each, kRulerType * point, {}).width);
  return all;
}

// the visible part of the world: inside the hatching
Rect seen_part(const Layout& layout) {
  const Rect& w = layout.window;
  const double band = layout.clipped ? 0 : kBand * layout.weight + 2 * kPoint;
  return {w.x + band, w.y + band, w.width - 2 * band, w.height - 2 * band};
}

// round heights from `low` to `high`, at this height on the page
std::vector<double> upward(double low, double high, double height, double point) {
  return ticks(low, high, int(height / (kNearNumbers * point)));
}

// round places, so few that their numbers do not touch
std::vector<double> across(double low, double high, double width, double point) {
  std::vector<double> found;
  for (int count = int(width / (kFarNumbers * point)); count > 0; --count) {
    found = ticks(low, high, count);
    if (found.size() < 2 || (found[1] - found[0]) / (high - low) * width >=
                                widest(as_numbers(found), point) + kNumbersApart * point)
      break;
  }
  return found;
}

}  // namespace

double ruler_left(const Layout& layout, double type_scale) {
  const double point = type_scale * kPoint;
  const Rect part = seen_part(layout);
  const double up = (layout.middle.y() - part.y) / layout.scale,
               down = (part.y + part.height - layout.middle.y()) / layout.scale;
  const std::vector<double> heights =
      upward(layout.center.y() - down, layout.center.y() + up, part.height, point);
  // the name of what is up is wider in some fonts
  const double widest_text =
      std::max(formula(kUpward, kRulerType * point, {}).width, widest(as_numbers(heights), point));
  return std::max(type_scale * kRulerLeft, ((kOff + kTick + 1.5 + kInside) * point + widest_text) / kPoint);
}

void draw_rulers(const Layout& layout, const View& view, const Palette& colours, double type_scale,
                 List& list) {
  const double point = type_scale * kPoint, type = kRulerType * point, tick = kTick * point;
  const Rect& w = layout.window;
  const Rect part = seen_part(layout);
  const double left = part.x, right = part.x + part.width, top = part.y, bottom = part.y + part.height;
  const double x_low = (left - view.origin.x()) / view.scale, x_high = (right - view.origin.x()) / view.scale;
  const double y_low = (view.origin.y() - bottom) / view.scale, y_high = (view.origin.y() - top) / view.scale;
  const double under = w.y + w.height + kOff * point, beside = w.x - kOff * point;
  const auto line = [&](const Point& a, const Point& b) {
    list.add({{a, kLine * kPoint, colours.ink}, {b, kLine * kPoint, colours.ink}}, Cap::butt);
  };
  const auto write = [&](const std::string& text, const Point& at, double align) {
    const Formula f = formula(text, type, colours.ink);
    add(f, {at.x() - align * f.width, at.y()}, list,
        {align > 0.9   ? Align::right
         : align > 0.1 ? Align::center
                       : Align::left});
  };

  line({left, under}, {right, under});
  const double base = under + tick + 7.5 * point;
  // the name in a line of its own: beside the numbers it would take the place of the last
  write("x / \"m\"", {(left + right) / 2, base + kNameBelow * point}, 0.5);
  const double page_left = w.x, page_right = w.x + w.width;
  const std::vector<double> places = across(x_low, x_high, right - left, point);
  const std::vector<std::string> under_them = as_numbers(places);
  // a number that the page's edge would push off its tick is left out, if two remain
  std::vector<double> middles;
  std::size_t at_their_ticks = 0;
  const auto is_there = [&](std::size_t i) {
    return std::abs(middles[i] - view.page({places[i], 0, 0}).x()) <= kOffTick * point;
  };
  for (std::size_t i = 0; i < places.size(); ++i) {
    const double half = formula(under_them[i], type, colours.ink).width / 2 + kInside * point;
    middles.push_back(std::clamp(view.page({places[i], 0, 0}).x(), page_left + half, page_right - half));
    at_their_ticks += is_there(i);
  }
  for (std::size_t i = 0; i < places.size(); ++i) {
    const double at = view.page({places[i], 0, 0}).x();
    line({at, under}, {at, under + tick});
    if (is_there(i) || at_their_ticks < 2) write(under_them[i], {middles[i], base}, 0.5);
  }
  line({beside, top}, {beside, bottom});
  // the name between the numbers at the upper end, or in place of the last where they are close
  const std::vector<double> up = upward(y_low, y_high, bottom - top, point);
  const std::vector<std::string> beside_them = as_numbers(up);
  const auto page_y = [&](double y) { return view.page({0, y, 0}).y(); };
  double name = top + 0.26 * type;
  bool between = false;
  if (up.size() > 1) {
    const double last = page_y(up.back()), before = page_y(up[up.size() - 2]);
    between = before - last > kNameBetween * point;
    if (between) name = (last + before) / 2;
  }
  const double numbers_end = beside - tick - 1.5 * point;
  write(kUpward, {numbers_end, name + 0.24 * type}, 1);
  for (std::size_t i = 0; i < up.size(); ++i) {
    const double at = page_y(up[i]);
    line({beside, at}, {beside - tick, at});
    // nor one that the page's edge would cut
    if (at + 0.24 * type - formula(beside_them[i], type, {}).ascent < kInside * point) continue;
    if (between || at > top + 1.4 * type) write(beside_them[i], {numbers_end, at + 0.24 * type}, 1);
  }
}

}  // namespace obscura::draw

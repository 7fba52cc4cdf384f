// How long arrows may be so that each is seen whole. An arrow's tip is
//   tail + part * scale * value
// and part is the largest for which all tips of its kind lie in the picture. In the plane they also end below
// the room's ceiling, beyond which the title stands, and above its floor, where that does not make them much
// shorter.

#include "draw/compose/arrow_scales.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace obscura::draw {

namespace {

constexpr double kWellBelow = 0.6;    // of its length: what a ceiling or floor may leave of an arrow
constexpr double kLeastWhole = 0.15;  // of its length: one that would have to be shorter is cut
constexpr double kOpenSide = 0.5;     // of its length: what a side may leave of one where bodies go out
constexpr double kHeadRoom = 12;      // page units from the edge to a head

constexpr double Scales::*kArrowKinds[] = {&Scales::velocity, &Scales::force, &Scales::impulse,
                                           &Scales::momentum, &Scales::acceleration};

// Whether bodies whose arrows are shown go out of a picture at its left, upper, right and lower side.
struct Sides {
  bool open[4] = {};

  void see(const Rect& window, const Point& tail) {
    for (int i = 0; i < 2; ++i) {
      const double low = i == 0 ? window.x : window.y, high = low + (i == 0 ? window.width : window.height);
      open[i] = open[i] || tail[i] < low, open[2 + i] = open[2 + i] || tail[i] > high;
    }
  }
};

// How much of the way from tail to tip lies within a window, where the tail does. Where bodies go out of it,
// an arrow that would be much shorter is no reason to shorten all others.
double part_within(const Rect& window, const Sides& sides, double margin, const Point& tail,
                   const Point& tip) {
  const Point low = Point(window.x, window.y).array() + margin;
  const Point high = Point(window.x + window.width, window.y + window.height).array() - margin;
  if (!((tail.array() > low.array()).all() && (tail.array() < high.array()).all())) return 1;
  double part = 1;
  for (int i = 0; i < 2; ++i) {
    const bool down = tip[i] < tail[i];
    const double edge = down ? low[i] : high[i];
    if (!(std::abs(tip[i] - tail[i]) > std::abs(edge - tail[i]))) continue;
    const double fits = (edge - tail[i]) / (tip[i] - tail[i]);
    if (!sides.open[down ? i : 2 + i])
      part = std::min(part, std::max(fits, kLeastWhole));
    else if (fits > kOpenSide)
      part = std::min(part, fits);
  }
  return part;
}

}  // namespace

Scales kept_whole(const Marks& marks, const sim::SceneInfo& cast, std::span<const SeenInstant> seen,
                  double weight, Scales scales) {
  const auto each_reading = [&](const SeenInstant& instant, auto&& act) {
    for (const Marks::Vector& vector : marks.vectors) {
      if (!scale_of(vector.quantity, scales)) continue;
      if (!vector.shown.may_have(instant.now->time)) continue;
      for (const Reading& reading : readings(vector, cast, *instant.now))
        if (instant.view.before(reading.tail)) act(vector, reading);
    }
  };
  Sides sides;
  for (const SeenInstant& instant : seen)
    each_reading(instant, [&](const Marks::Vector&, const Reading& reading) {
      sides.see(instant.view.window(), instant.view.page(reading.tail));
    });
  Scales within{1, 1, 1, 1, 1}, below{1, 1, 1, 1, 1}, above{1, 1, 1, 1, 1};
  for (const SeenInstant& instant : seen) {
    const Projection& view = instant.view;
    // its ceiling on the page, or the page's upper edge; of a slope arrows cross the floor
    double top = -1e300, floor = 1e300;
    bool slopes = false;
    if (view.view()) {
      top = view.window().y;
      for (const sim::SceneInfo::Wall& wall : cast.walls) {
        if (wall.normal.y() < -0.99 * wall.normal.norm()) top = std::max(top, view.page(wall.point).y());
        if (wall.normal.y() > 0.99 * wall.normal.norm()) floor = std::min(floor, view.page(wall.point).y());
        slopes = slopes || (wall.normal.x() != 0 && wall.normal.y() > 0);
      }
    }
    each_reading(instant, [&](const Marks::Vector& vector, const Reading& reading) {
      const sim::Vec3 end = reading.tail + *scale_of(vector.quantity, scales) * reading.value;
      if (!view.before(end)) return;
      double &least = *scale_of(vector.quantity, within), &under = *scale_of(vector.quantity, below),
             &over = *scale_of(vector.quantity, above);
      const Point tail = view.page(reading.tail), tip = view.page(end);
      least = std::min(least, part_within(view.window(), sides, kHeadRoom * weight, tail, tip));
      if (const double fits = (tail.y() - top) / (tail.y() - tip.y());
          tail.y() > top && tip.y() < top && fits > kWellBelow)
        under = std::min(under, fits);
      if (tip.y() > floor && !slopes) over = std::min(over, (floor - tail.y()) / (tip.y() - tail.y()));
    });
  }
  for (const auto kind : kArrowKinds) {
    const double by = std::min(within.*kind, below.*kind);
    scales.*kind *= above.*kind > kWellBelow ? std::min(by, above.*kind) : by;
  }
  return scales;
}

}  // namespace obscura::draw

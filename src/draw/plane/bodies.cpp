#include <algorithm>
#include <cmath>

#include "draw/plane/gears.h"
#include "draw/plane/stage.h"

namespace obscura::draw {
namespace {

constexpr double kLeast = 1.6;        // radius of what is too small to see
constexpr double kSmallBody = 13;     // page units: half the width of what is small
constexpr double kThinOutline = 0.2;  // of a box that is small, of half its width
constexpr double kSmallFill = 1.6;    // how soon under that its fill is the strong one

/// How a ball that turns stands: a radius, as the axes of a box are.
void mark_turns(const Stage& stage, const View& view, const sim::Snapshot& now, const Gears& gears,
                List& list) {
  const double weight = stage.layout.weight;
  const auto each = [&](auto&& mark) {
    for (int i : stage.rounds) {
      const double radius =
          view.scale * (stage.cast.bodies[i].radius - cut_of_teeth(stage, view, now, gears, i));
      const Point center = view.page(now.bodies[i].position);
      if (!stage.cast.bodies[i].turns || radius < 7 * weight || outside(view.window, center, radius))
        continue;
      const double width = std::min(kAxisLine * weight, 0.14 * radius);
      list.of({Subject::What::body, i});
      mark(center, radius, width, now.bodies[i].angle, stage.paints[i].axis);
    }
  };
  each([&](const Point& center, double radius, double width, double angle, Color color) {
    const Point rim = center + (radius - width) * Point(std::cos(angle), -std::sin(angle));
    list.add({{center, width, color}, {rim, width, color}}, Cap::butt);
  });
  each([&](const Point& center, double, double width, double, Color color) {
    list.add(Disc{center, 1.5 * width, 0, color, color});
  });
}

}  // namespace

Color fill_of(const Paint& paint, double half, double weight) {
  const double size = std::min(half / (kSmallBody * weight), 1.0);
  return mix(paint.fill, paint.small, std::min(kSmallFill * (1 - size), 1.0));
}

void draw_boxes(const Stage& stage, const View& view, const sim::Snapshot& now, const Gears& gears, Rank rank,
                List& list) {
  const double weight = stage.layout.weight;
  list.boxes.reserve(stage.boxes.size());
  for (int i : stage.boxes) {
    if (stage.rank(i) != rank) continue;
    const sim::Snapshot::Body& body = now.bodies[i];
    Point half = view.scale * stage.cast.bodies[i].half.head<2>();
    Point center = view.page(body.position);
    // a rack as far as its teeth, the middle of whose outline is at their feet
    if (double cut = cut_of_teeth(stage, view, now, gears, i); cut > 0) {
      cut -= kOutline * weight / 2 / view.scale;
      const sim::Vec3& out = gears.racks.at(i).out;
      half -= view.scale * cut / 2 * out.head<2>().cwiseAbs();
      center = view.page(body.position + body.orientation * (cut / 2 * out));
    }
    if (outside(view.window, center, half.norm())) continue;
    const double shorter = half.minCoeff();
    Box box;
    box.center = center;
    box.x_axis = {std::cos(body.angle), -std::sin(body.angle)};
    box.half = half.cwiseMax(0.8 * weight);
    box.line = std::min(kOutline * weight, kThinOutline * shorter);
    if (stage.look.axes && !stage.cast.bodies[i].fixed && shorter > 18 * weight) {
      box.axis = std::min(0.56 * shorter, 44 * weight);
      box.axis_line = std::min(kAxisLine * weight, 0.16 * box.axis);
    }
    box.outline = stage.paints[i].outline;
    box.fill = fill_of(stage.paints[i], shorter, weight);
    box.axis_color = stage.paints[i].axis;
    list.of({Subject::What::body, i});
    list.add(box);
  }
}

void draw_rounds(const Stage& stage, const View& view, const sim::Snapshot& now, const Gears& gears,
                 List& list) {
  const double weight = stage.layout.weight;
  list.discs.reserve(list.discs.size() + stage.rounds.size());
  for (int i : stage.rounds) {
    const Point center = view.page(now.bodies[i].position);
    const double cut = cut_of_teeth(stage, view, now, gears, i);
    const double own = stage.dots[i] > 0 ? stage.dots[i] : view.scale * (stage.cast.bodies[i].radius - cut);
    const double radius = std::max(own, kLeast * weight);
    if (outside(view.window, center, radius)) continue;
    const Paint& paint = stage.paints[i];
    list.of({Subject::What::body, i});
    // small ones are all outline: a pale fill would be lost
    if (radius < 3.2 * weight) {
      list.add(Disc{center, radius, 0, paint.outline, paint.outline});
    } else {
      // a wheel's outline is that of its teeth
      list.add(Disc{center, radius, cut > 0 ? 0 : std::min(kOutline * weight, 0.32 * radius),
                    fill_of(paint, radius, weight), paint.outline});
    }
  }
  if (stage.look.axes) mark_turns(stage, view, now, gears, list);
}

}  // namespace obscura::draw

// The walls. The room is what of the page lies in every half plane; the band is what of the page lies in
// every half plane moved outwards by its depth, less the room. A hatching line is a strip cut by the band's
// outer border and, on either side of the room, by the wall where it meets it: all convex, all exact.

#include <algorithm>
#include <cmath>
#include <numbers>

#include "draw/plane/stage.h"

namespace obscura::draw {
namespace {

constexpr double kBeyond = 80;  // page units: how far walls run on outside the window

Convex cut_all(const Rect& rect, const std::vector<HalfPlane>& walls, double distance) {
  Convex shape = border(rect);
  for (std::size_t i = 0; i < walls.size() && !shape.empty(); ++i)
    shape = cut(shape, moved(walls[i], distance), int(i));
  return shape;
}

/// Along a wall's hatching: at 45 degrees to it, of the two ways the one that rises more to the right.
Point hatch_direction(const HalfPlane& wall) {
  constexpr double kHalf = std::numbers::sqrt2 / 2;
  const Point along(-wall.normal.y(), wall.normal.x()), rising(kHalf, -kHalf);
  Point best = kHalf * (along + wall.normal);
  const Point other = kHalf * (along - wall.normal);
  if (std::abs(other.dot(rising)) > std::abs(best.dot(rising)) + 1e-9) best = other;
  return best.dot(rising) < 0 ? Point(-best) : best;
}

/// The points at which the line p + s u enters and leaves a convex shape: the distances s, and the sides that
/// it meets.
struct Chord {
  double from = 0, to = 0;
  int in = -1, out = -1;
};

std::optional<Chord> chord(const Convex& shape, const Point& p, const Point& u) {
  const Point v(-u.y(), u.x());
  std::optional<Chord> found;
  const std::size_t n = shape.corners.size();
  for (std::size_t i = 0; i < n; ++i) {
    const Convex::Corner& a = shape.corners[i];
    const Point& b = shape.corners[(i + 1) % n].at;
    const double d = (a.at - p).dot(v), e = (b - p).dot(v);
    if ((d >= 0) == (e >= 0)) continue;
    const double s = (a.at + (b - a.at) * (d / (d - e)) - p).dot(u);
    if (!found) {
      found = {s, s, a.side, a.side};
    } else if (s < found->from) {
      found->from = s, found->in = a.side;
    } else {
      found->to = s, found->out = a.side;
    }
  }
  return found;
}

/// A sharp corner's band is cut off before it becomes a thorn.
void blunt(Convex& band, const Convex& room, const std::vector<HalfPlane>& walls, double depth) {
  const std::size_t n = room.corners.size();
  for (std::size_t i = 0; i < n; ++i) {
    const int before = room.corners[(i + n - 1) % n].side, after = room.corners[i].side;
    if (before < 0 || after < 0 || before == after) continue;
    const Point inwards = (walls[before].normal + walls[after].normal).normalized();
    band = cut(band, {room.corners[i].at - 1.5 * depth * inwards, inwards});
  }
}

void hatch(const std::vector<HalfPlane>& walls, const View& view, const Rect& page, double weight,
           Color color, List& list) {
  const double depth = kBand * weight, half = kHatchLine * weight / 2;
  const Convex room = cut_all(page, walls, -kWallLine * weight / 2);
  if (room.empty()) return;
  Convex band = cut_all(page, walls, -depth);
  blunt(band, room, walls, depth);

  // lines at fixed distances from the world's origin, so that they do not swim
  const double step = kHatchStep * weight * std::numbers::sqrt2 / 2;
  const auto lines = [&](const Convex& region, const Point& u, const auto& draw) {
    const Point v(-u.y(), u.x());
    double low = 1e300, high = -1e300;
    for (const Convex::Corner& c : region.corners) {
      low = std::min(low, (c.at - view.origin).dot(v));
      high = std::max(high, (c.at - view.origin).dot(v));
    }
    const auto last = std::int64_t(std::floor(high / step));
    for (auto k = std::int64_t(std::ceil(low / step)); k <= last; ++k) {
      const Point p = view.origin + double(k) * step * v;
      const Convex strip = cut(cut(region, {p - half * v, v}), {p + half * v, -v});
      if (!strip.empty()) draw(strip, p);
    }
  };

  // walls whose lines are parallel have them in common, across corners too
  std::vector<int> sides;
  for (const Convex::Corner& c : room.corners)
    if (c.side >= 0) sides.push_back(c.side);
  if (sides.empty()) return;
  const Point first = hatch_direction(walls[std::size_t(sides.front())]);
  const bool same = std::all_of(sides.begin(), sides.end(), [&](int side) {
    return (hatch_direction(walls[std::size_t(side)]) - first).norm() < 1e-6;
  });
  if (same) {
    lines(band, first, [&](const Convex& strip, const Point& p) {
      const auto inside = chord(room, p, first);
      if (!inside) return list.add(strip.outline(), color);
      for (int side : {inside->in, inside->out}) {
        if (side < 0) continue;
        const HalfPlane wall = moved(walls[side], -kWallLine * weight / 2);
        list.add(cut(strip, {wall.point, -wall.normal}).outline(), color);
      }
    });
    return;
  }
  // each other wall has its own part of the band, up to the lines that halve the corners
  const std::size_t n = room.corners.size();
  for (std::size_t i = 0; i < n; ++i) {
    const int side = room.corners[i].side;
    if (side < 0) continue;
    const HalfPlane wall = moved(walls[std::size_t(side)], -kWallLine * weight / 2);
    Convex part = cut(band, {wall.point, -wall.normal});
    const int before = room.corners[(i + n - 1) % n].side, after = room.corners[(i + 1) % n].side;
    const auto up_to = [&](int other, const Point& corner) {
      if (other < 0 || other == side) return;
      const Point across = walls[std::size_t(other)].normal - walls[std::size_t(side)].normal;
      if (across.norm() > 1e-9) part = cut(part, {corner, across.normalized()});
    };
    up_to(before, room.corners[i].at);
    up_to(after, room.corners[(i + 1) % n].at);
    lines(part, hatch_direction(walls[std::size_t(side)]),
          [&](const Convex& strip, const Point&) { list.add(strip.outline(), color); });
  }
}

/// The walls' lines, whole chains at once, so that their corners are mitred.
void draw_walls(const Convex& room, double width, Color color, List& list) {
  const std::size_t n = room.corners.size();
  if (room.closed()) {
    std::vector<Node> line;
    for (const Convex::Corner& c : room.corners) line.push_back({c.at, width, color});
    list.add(line, Cap::butt, Blend::over, true);
    return;
  }
  for (std::size_t i = 0; i < n; ++i) {
    // a chain begins where the border ends
    if (room.corners[i].side < 0 || room.corners[(i + n - 1) % n].side >= 0) continue;
    std::vector<Node> line{{room.corners[i].at, width, color}};
    for (std::size_t k = i; room.corners[k % n].side >= 0; ++k)
      line.push_back({room.corners[(k + 1) % n].at, width, color});
    list.add(line, Cap::butt);
  }
}

/// A fluid at rest: what of the room lies below its level, and the line of its surface.
void draw_fluid(const Stage& stage, const View& view, const Convex& room, List& list) {
  constexpr int kSurface = 1 << 20;  // its side: above those of all walls
  const Convex fluid = cut(room, {view.page({0, *stage.cast.surface, 0}), Point(0, 1)}, kSurface);
  if (fluid.empty()) return;
  list.add(fluid.outline(), stage.colours.water);
  const double width = kSurfaceLine * stage.layout.weight;
  for (std::size_t i = 0; i < fluid.corners.size(); ++i)
    if (fluid.corners[i].side == kSurface)
      list.add({{fluid.corners[i].at, width, stage.colours.surface},
                {fluid.corners[(i + 1) % fluid.corners.size()].at, width, stage.colours.surface}},
               Cap::butt);
}

}  // namespace

void draw_still(const Stage& stage, const View& view, List& list) {
  const double weight = stage.layout.weight;
  const Rect& w = view.window;
  const Rect page{w.x - kBeyond, w.y - kBeyond, w.width + 2 * kBeyond, w.height + 2 * kBeyond};
  if (stage.cast.walls.empty() && stage.cast.surface) {
    if (stage.layout.clipped) list.clip(w);
    list.of({Subject::What::layer, 0});
    draw_fluid(stage, view, border(page), list);
    list.unclip();
    list.of({});
  }
  if (!stage.cast.walls.empty()) {
    const std::vector<HalfPlane> walls = half_planes(stage.cast, view);
    const Convex room = cut_all(page, walls, -kWallLine * weight / 2);
    if (stage.layout.clipped) list.clip(w);
    list.of({Subject::What::layer, 0});
    if (!(stage.colours.room == stage.colours.ground)) list.add(room.outline(), stage.colours.room);
    if (stage.cast.surface && !room.empty()) draw_fluid(stage, view, room, list);
    if (stage.look.hatching) hatch(walls, view, page, weight, stage.colours.hatch, list);
    if (!room.empty()) draw_walls(room, kWallLine * weight, stage.colours.wall, list);
    list.unclip();
    list.of({});

    // a thin line marks where the strip cuts the room
    if (stage.layout.clipped && stage.layout.caption) {
      double over = 0;
      for (const Convex::Corner& c : room.corners) over = std::max(over, w.y - c.at.y());
      Color rule = stage.colours.hatch;
      rule.a = std::uint8_t(160 * std::clamp(over / 40, 0.0, 1.0));
      if (rule.a > 0)
        list.add({{{0, w.y}, 1.4 * weight, rule}, {{w.width, w.y}, 1.4 * weight, rule}}, Cap::butt);
    }
  }
  draw_words(stage.layout, list);
  stage.charts.draw_still(list);
}

}  // namespace obscura::draw

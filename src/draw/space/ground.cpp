// The ground and the room in space. The grid's lines lie at multiples of a tile from the origin and fade with
// the distance r from the foot of what is looked at, as 1 - smoothstep(r / W); in a room they end at its
// walls. On the dark theme a pool of light of the strength a lies over them:
//   line  c = g + (k - g) / (1 - a)     g  ground, k  ink of the lines, all of them colours
// so that (1 - a) (c - g), by which a line is brighter than what lies beside it, is the same everywhere.

#include <algorithm>
#include <cmath>

#include "draw/space/space.h"

namespace obscura::draw {
namespace {

using sim::Vec3;

constexpr double kTile = 105;  // page units that a tile measures at least where one looks
constexpr double kFrom = 0.35,
                 kTo = 1.25;  // of the width that is shown: where the grid begins to fade, and ends
constexpr double kGridLine = 1.5, kFrameLine = 1.8;
constexpr int kPieces = 28;     // of a line that fades
constexpr double kPool = 0.62;  // of the width that is shown: the radius of the pool of light
constexpr double kRow = 4;      // page units: the height of a row of it,
constexpr int kColumns = 48;    // and its pieces
constexpr Color kPoolInk{0x6A, 0x7C, 0x8E, 0x80};

Color faded(Color c, double alpha) {
  c.a = std::uint8_t(std::lround(c.a * std::clamp(alpha, 0.0, 1.0)));
  return c;
}

double smooth(double u) {
  u = std::clamp(u, 0.0, 1.0);
  return u * u * (3 - 2 * u);
}

/// The place on the ground under what is looked at.
Vec3 foot_of(const Ground& ground, const CameraProjection& lens) {
  return lens.target - ground.normal * (lens.target - ground.point).dot(ground.normal);
}

/// How strong (0 to 1) the pool of light is at this distance (m) from the foot of what is looked at.
double pool(const CameraProjection& lens, double distance) {
  return 1 - smooth(distance * lens.scale / (kPool * lens.window.width));
}

/// The colour of a line that stands off the pool of light over it as it does off the ground elsewhere.
Color under_pool(Color ink, Color ground, double strength) {
  const double a = strength * kPoolInk.a / 255, k = 1 / (1 - a);
  const auto part = [&](int i, int g) {
    return std::uint8_t(std::clamp(std::lround(g + k * (i - g)), 0L, 255L));
  };
  return {part(ink.r, ground.r), part(ink.g, ground.g), part(ink.b, ground.b), ink.a};
}

/// 1, 2 or 5 times a power of ten, not smaller than `least`.
double nice(double least) {
  double unit = 1;
  while (unit < least) unit *= 10;
  while (unit >= 10 * least) unit /= 10;
  // unit is the power of ten above: try its half and fifth
  for (double part : {0.2, 0.5, 1.0}) {
    if (unit * part >= least * (1 - 1e-9)) return unit * part;
  }
  return unit;
}

/// The ground's own axes: the first as near to the world's x as it lies in the plane.
struct Axes {
  Vec3 origin, u, v;
};

Axes axes(const Ground& ground) {
  const Vec3 n = ground.normal;
  Vec3 u = Vec3::UnitX() - n * n.x();
  if (u.norm() < 0.1) u = Vec3::UnitZ() - n * n.z();
  u.normalize();
  return {n * n.dot(ground.point), u, u.cross(n)};
}

/// The part of a line a + t d in a convex loop of the ground plane.
bool clip(const std::vector<Vec3>& loop, const Vec3& normal, const Vec3& a, const Vec3& d, double& from,
          double& to) {
  for (std::size_t i = 0; i < loop.size(); ++i) {
    const Vec3 side = loop[(i + 1) % loop.size()] - loop[i];
    const Vec3 inwards = normal.cross(side);
    const double height = inwards.dot(a - loop[i]), rise = inwards.dot(d);
    if (std::abs(rise) < 1e-12 * inwards.norm() * d.norm()) {
      if (height < 0) return false;
      continue;
    }
    const double t = -height / rise;
    if (rise > 0)
      from = std::max(from, t);
    else
      to = std::min(to, t);
  }
  return from < to;
}

/// A segment in the window, cut where it passes the eye.
void add_line(const CameraProjection& lens, Vec3 a, Vec3 b, double width, Color color, List& list) {
  constexpr double near = 0.02;
  const double da = lens.depth(a), db = lens.depth(b);
  if (da < near && db < near) return;
  if (da < near) a = b + (a - b) * ((db - near) / (db - da));
  if (db < near) b = a + (b - a) * ((da - near) / (da - db));
  list.add({{lens.page(a), width, color}, {lens.page(b), width, color}}, Cap::round);
}

void draw_grid(const SpaceStage& stage, const Panel& panel, const CameraProjection& lens, List& list) {
  const Ground& ground = *stage.ground;
  const Axes axis = axes(ground);
  const double weight = stage.layout.weight, shown = lens.window.width / lens.scale;
  // the same all the while, however near the camera comes
  const double tile =
      stage.look.tile > 0 ? stage.look.tile : nice(kTile * weight * panel.shown / panel.window.width);
  const bool bounded = stage.closed && stage.ground_face >= 0;

  // the foot of what is looked at, and how far around it lines are drawn
  const Vec3 foot = foot_of(ground, lens);
  const double x = (foot - axis.origin).dot(axis.u), y = (foot - axis.origin).dot(axis.v);
  double radius = kTo * shown;
  std::vector<Vec3> loop;
  if (bounded) {
    for (int v : stage.room.faces[stage.ground_face].loop) loop.push_back(stage.room.vertices[v]);
    radius = 0;
    for (const Vec3& v : loop) radius = std::max(radius, (v - foot).norm());
  }
  const auto last = std::int64_t(std::min(std::ceil(radius / tile), 400.0));
  const bool dark = stage.look.theme == Theme::screen;
  const Color ink = dark ? Color{0x50, 0x5D, 0x6A} : Color{0xC6, 0xCB, 0xD1};
  const Blend blend = dark ? Blend::lighten : Blend::darken;
  std::vector<Node> line;
  for (int way = 0; way < 2; ++way) {
    const Vec3 &along = way ? axis.v : axis.u, &across = way ? axis.u : axis.v;
    const double here = way ? x : y, there = way ? y : x;
    const auto middle = std::int64_t(std::llround(here / tile));
    for (std::int64_t k = middle - last; k <= middle + last; ++k) {
      const double off = double(k) * tile - here;
      if (std::abs(off) > radius) continue;
      const Vec3 start = axis.origin + double(k) * tile * across + there * along;
      const double half = std::sqrt(std::max(radius * radius - off * off, 0.0));
      double from = -half, to = half;
      // the loop of the room's face runs counter-clockwise seen from below the ground
      if (bounded && !clip(loop, -ground.normal, start, along, from, to)) continue;
      line.clear();
      for (int i = 0; i <= kPieces; ++i) {
        const double t = from + (to - from) * i / kPieces;
        const Vec3 place = start + t * along;
        if (lens.depth(place) < 0.05) {
          list.add(line, Cap::butt, blend);
          line.clear();
          continue;
        }
        const double r = std::hypot(off, t);
        const double strength = bounded ? 1 : 1 - smooth((r / shown - kFrom) / (kTo - kFrom));
        const Color own = dark ? under_pool(ink, stage.colours.ground, pool(lens, r)) : ink;
        line.push_back({lens.page(place), kGridLine * weight, faded(own, strength)});
      }
      list.add(line, Cap::butt, blend);
    }
  }
}

/// A pool of light around what is looked at, on the dark theme: rows of the page, each of one height, as
/// strong as 1 - smoothstep(r / R) where its line of sight meets the ground at the distance r from the foot.
/// Where it is nothing a row ends.
void draw_pool(const SpaceStage& stage, const CameraProjection& lens, List& list) {
  if (stage.look.theme != Theme::screen) return;
  const Ground& ground = *stage.ground;
  const Vec3 foot = foot_of(ground, lens);
  const auto strength = [&](const Point& page) {
    Vec3 from;
    const Vec3 way = lens.ray(page, from);
    const double fall = way.dot(ground.normal);
    if (!(fall < -1e-6)) return 0.0;
    const Vec3 place = from - way * ((from - ground.point).dot(ground.normal) / fall);
    return pool(lens, (place - foot).norm());
  };
  const Rect& w = lens.window;
  std::vector<Node> row;
  for (double y = w.y; y < w.y + w.height; y += kRow) {
    const double high = std::min(kRow, w.y + w.height - y);
    row.clear();
    std::size_t lit = 0;  // up to its last node with light, and the next
    for (int i = 0; i <= kColumns; ++i) {
      const Point at(w.x + w.width * i / kColumns, y + high / 2);
      row.push_back({at, high, faded(kPoolInk, strength(at))});
      if (row.back().color.a > 0) lit = row.size() + 1;
      if (lit == 0 && row.size() > 1) row.erase(row.begin());
    }
    row.resize(std::min(lit, row.size()));
    list.add_row(row);
  }
}

/// Whether an edge of the room lies behind what is in it.
bool behind(const SpaceStage& stage, const CameraProjection& lens, const Polyhedron::Edge& e) {
  const auto away = [&](int f) {
    const Polyhedron::Face& face = stage.room.faces[f];
    const Vec3& place = stage.room.vertices[face.loop[0]];
    return face.normal.dot(lens.perspective() ? Vec3(lens.eye() - place) : lens.back) < 0;
  };
  return away(e.left) || (e.right >= 0 && away(e.right));
}

void draw_frame(const SpaceStage& stage, const CameraProjection& lens, bool back, List& list) {
  if (!stage.closed) return;
  const double weight = stage.layout.weight;
  for (const Polyhedron::Edge& e : stage.room.edges) {
    if (behind(stage, lens, e) != back) continue;
    Color color = stage.colours.hatch;
    if (!back) color.a = 70;
    add_line(lens, stage.room.vertices[e.a], stage.room.vertices[e.b], (back ? 1 : 0.8) * kFrameLine * weight,
             color, list);
  }
}

/// Lines between panels: the ground has no edge, and two would look like one.
void draw_seams(const SpaceStage& stage, List& list) {
  const double half = kCameraGap / 2 * stage.layout.weight, width = kHatchLine * stage.layout.weight;
  const Color color = stage.colours.hatch;
  for (const Panel& panel : stage.panels) {
    const Rect& w = panel.window;
    const double right = w.x + w.width, bottom = w.y + w.height;
    const bool beside = right < stage.layout.width - half, over = bottom < stage.layout.height - half;
    if (beside)
      list.add({{{right + half, w.y}, width, color}, {{right + half, bottom}, width, color}}, Cap::butt);
    if (over)
      list.add({{{w.x, bottom + half}, width, color}, {{right, bottom + half}, width, color}}, Cap::butt);
  }
}

}  // namespace

void draw_space_still(const SpaceStage& stage, const std::vector<CameraProjection>& lenses, List& list) {
  for (std::size_t i = 0; i < lenses.size(); ++i) {
    const CameraProjection& lens = lenses[i];
    list.clip(lens.window);
    list.of(kSeenLines);
    const bool above =
        stage.ground &&
        stage.ground->normal.dot(lens.perspective() ? Vec3(lens.eye() - stage.ground->point) : lens.back) > 0;
    if (above && stage.look.ground) {
      draw_grid(stage, stage.panels[i], lens, list);
      draw_pool(stage, lens, list);
    }
    draw_frame(stage, lens, true, list);
    list.of({});
    list.unclip();
    for (const Text& text : stage.panels[i].words) list.add(text);
  }
  draw_seams(stage, list);
  draw_words(stage.layout, list);
  stage.charts.draw_still(list);
}

void draw_room_front(const SpaceStage& stage, const CameraProjection& lens, List& list) {
  list.of(kSeenLines);
  draw_frame(stage, lens, false, list);
}

}  // namespace obscura::draw

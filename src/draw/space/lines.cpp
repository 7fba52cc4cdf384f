// Trails, arrows and hands in space. Trails are hidden by what lies before them; arrows and pointers, which
// are said about the picture, lie over it.

#include <algorithm>
#include <cmath>

#include "draw/space/space.h"

namespace obscura::draw {
namespace {

using sim::Vec3;

constexpr int kTrailPieces = 120;    // of a trail
constexpr double kCusp = 0.9;        // cosine of a turn that is kept
constexpr double kBent = 0.8;        // page units: see draw/plane/trails.cpp
constexpr double kPathLine = 3.6;    // page units at the weight 1
constexpr double kPassedEye = 1e-2;  // depth over the target's
constexpr double kStep = 14, kWayDot = 2.1;
// page units: of a line from a body to the ground, and of the cross there
constexpr double kDropLine = 1.6, kDropDash = 7, kDropGap = 5, kDropFoot = 9;

}  // namespace

void trace_trails(SpaceFrame& s, Ways ways) {
  s.list.of(kSeenLines);
  const SpaceStage& stage = s.stage;
  HiddenLines::Parts parts;
  for (std::size_t i = 0; i < stage.look.bodies.size() && i < s.now.bodies.size(); ++i) {
    const double lasting = stage.look.bodies[i].trail;
    if (!(lasting > 0)) continue;
    const auto way = way_of(int(i), s.now.time - lasting, s.now, ways, kBent / s.lens.scale);
    const Color strong = paint(stage.own[i], stage.look.theme).trail, faint = faintest(strong, stage.colours);
    const auto age = [&](const sim::Track::Point& p) {
      return std::clamp(1 - (s.now.time - p.time) / lasting, 0.0, 1.0);
    };
    const auto node = [&](const Point& at, double strength, double depth) {
      const double width = kTrailLine * stage.layout.weight * std::clamp(1 / depth, 0.3, 1.6);
      return Node{at, width * (0.25 + 0.75 * strength), mix(faint, strong, std::pow(strength, 1.3))};
    };

    // points at fixed times, cusps and the last
    std::vector<sim::Track::Point> chosen;
    std::int64_t piece = 0;
    std::size_t before = 0;
    for (std::size_t k = 0; k < way.size(); ++k) {
      const auto here = std::int64_t(std::floor(way[k].time * kTrailPieces / lasting));
      bool cusp = false;
      if (k > 0 && k + 1 < way.size()) {
        const Vec3 in = way[k].place - way[k - 1].place, out = way[k + 1].place - way[k].place;
        cusp = in.dot(out) < kCusp * in.norm() * out.norm();
      }
      if (k > 0 && k + 1 < way.size() && !cusp && here == piece) continue;
      piece = here;
      // where a long trail bends between two of them it needs more
      if (k > 0)
        bends(way, before, k, kBent / s.lens.scale,
              [&](std::size_t between) { chosen.push_back(way[between]); });
      before = k;
      chosen.push_back(way[k]);
    }
    Solids::Way seen{int(i), s.now.time, lasting, kTrailLine * stage.layout.weight, strong, faint, {}, {}};
    for (const sim::Track::Point& p : chosen) seen.places.push_back(p.place), seen.times.push_back(p.time);
    s.solids.ways.push_back(std::move(seen));

    std::vector<Node> line;
    const auto flush = [&] {
      s.list.add(line, Cap::round);
      line.clear();
    };
    for (std::size_t k = 0; k + 1 < chosen.size(); ++k) {
      const Vec3 &a = chosen[k].place, &b = chosen[k + 1].place;
      s.sight.seen(a, b, -1, -1, parts);
      if (parts.empty()) {
        flush();
        continue;
      }
      const Point p = s.lens.page(a), q = s.lens.page(b);
      const double from_age = age(chosen[k]), to_age = age(chosen[k + 1]), da = s.lens.depth(a),
                   db = s.lens.depth(b);
      const auto at = [&](double t) {
        return node(p + t * (q - p), from_age + t * (to_age - from_age), da + t * (db - da));
      };
      for (const auto& [from, to] : parts) {
        if (from > 0) flush();
        if (line.empty()) line.push_back(at(from));
        line.push_back(at(to));
        if (to < 1) flush();
      }
    }
    flush();
  }
}

// from a body's middle, where it comes out of the body, to the ground, and a cross there
void trace_drops(SpaceFrame& s) {
  const SpaceStage& stage = s.stage;
  if (!stage.look.drop_lines || !stage.ground) return;
  const Vec3 up = stage.ground->normal;
  const Vec3 side = up.unitOrthogonal(), ahead = up.cross(side);
  const double weight = stage.layout.weight;
  HiddenLines::Parts parts;
  // how high the lowest point of each is, and how large it is
  std::vector<double> lowest(s.now.bodies.size(), 1e300), size(s.now.bodies.size(), 0);
  for (std::size_t i = 0; i < stage.pieces.size(); ++i) {
    const Piece& piece = stage.pieces[i];
    const sim::Snapshot::Body& body = s.now.bodies[std::size_t(piece.body)];
    double& low = lowest[std::size_t(piece.body)];
    const auto height = [&](const Vec3& p) { return (p - stage.ground->point).dot(up); };
    for (const Vec3& v : s.placed[i].vertices) low = std::min(low, height(v));
    if (piece.form != Piece::Form::polyhedron)
      for (const Vec3& end : {piece.a, piece.b})
        low = std::min(low, height(body.position + body.orientation * end) - piece.radius);
    size[std::size_t(piece.body)] = std::max(size[std::size_t(piece.body)], piece.reach);
  }
  for (std::size_t i = 0; i < s.now.bodies.size(); ++i) {
    if (stage.cast.bodies[i].fixed || !(lowest[i] < 1e299)) continue;
    const Vec3 top = s.now.bodies[i].position;
    const double high = (top - stage.ground->point).dot(up);
    const Vec3 foot = top - high * up;
    const double strength = std::clamp(lowest[i] / std::max(size[i], 1e-9) - 0.1, 0.0, 1.0);
    if (!(strength > 0) || s.lens.depth(top) < 1e-2 || s.lens.depth(foot) < 1e-2) continue;
    Color color = paint(stage.own[i], stage.look.theme).outline;
    color.a = std::uint8_t(std::lround(190 * strength));
    const auto seen = [&](const Vec3& a, const Vec3& b, double width, double dash, double gap) {
      s.sight.seen(a, b, -1, -1, parts);
      const Point p = s.lens.page(a), q = s.lens.page(b);
      const double length = (q - p).norm();
      if (!(length > 0)) return;
      for (const auto& [from, to] : parts)
        for (double at = std::floor(from * length / (dash + gap)) * (dash + gap); at < to * length;
             at += dash + gap) {
          const double begin = std::max(at, from * length), end = std::min(at + dash, to * length);
          if (end - begin < 0.3) continue;
          s.list.add(
              {{p + begin / length * (q - p), width, color}, {p + end / length * (q - p), width, color}},
              Cap::butt);
        }
    };
    // dashes are counted from the ground, so that they do not run along it
    seen(foot, top, kDropLine * weight, kDropDash * weight, kDropGap * weight);
    const double arm = kDropFoot * weight / s.lens.scale_at(foot);
    for (const Vec3& way : {side, ahead})
      seen(foot - arm * way, foot + arm * way, 1.3 * kDropLine * weight, 1e9, 0);
  }
}

void trace_paths(SpaceFrame& s, std::span<const WorldLine> paths, bool front) {
  s.list.of(kSeenLines);
  const SpaceStage& stage = s.stage;
  HiddenLines::Parts parts;
  for (const WorldLine& path : paths) {
    if (path.front != front) continue;
    const Color strong = path.color       ? *path.color
                         : path.body >= 0 ? paint(stage.own[std::size_t(path.body)], stage.look.theme).outline
                                          : stage.colours.ink;
    Solids::Way seen{
        path.body, s.now.time, path.lasting, kPathLine * stage.layout.weight, strong, stage.colours.room, {},
        {},        path.path,  front};
    for (const WorldLine::Node& node : path.nodes)
      seen.places.push_back(node.at), seen.times.push_back(node.time);
    if (!seen.places.empty()) s.solids.ways.push_back(std::move(seen));
    std::vector<Node> line;
    const auto flush = [&] {
      if (line.size() > 1) s.list.add(line, Cap::round);
      line.clear();
    };
    for (std::size_t k = 0; k + 1 < path.nodes.size(); ++k) {
      const WorldLine::Node &a = path.nodes[k], &b = path.nodes[k + 1];
      if (s.lens.depth(a.at) < 1e-2 || s.lens.depth(b.at) < 1e-2) {
        flush();
        continue;
      }
      if (front)
        parts = {{0, 1}};
      else
        s.sight.seen(a.at, b.at, -1, -1, parts);
      if (parts.empty()) flush();
      const Point p = s.lens.page(a.at), q = s.lens.page(b.at);
      const auto at = [&](double t) {
        const double depth = s.lens.depth(a.at) + t * (s.lens.depth(b.at) - s.lens.depth(a.at));
        const double strength = a.strength + t * (b.strength - a.strength);
        const double width = kPathLine * stage.layout.weight * std::clamp(1 / depth, 0.3, 1.6);
        return Node{p + t * (q - p), width * (0.4 + 0.6 * strength),
                    mix(stage.colours.room, strong, strength)};
      };
      for (const auto& [from, to] : parts) {
        if (from > 0) flush();
        if (line.empty()) line.push_back(at(from));
        line.push_back(at(to));
        if (to < 1) flush();
      }
    }
    flush();
  }
}

void draw_space_arrows(SpaceFrame& s) {
  // the lines that are seen, the farthest first
  std::stable_sort(s.lines.begin(), s.lines.end(),
                   [](const Trace& a, const Trace& b) { return a.near < b.near; });
  s.list.of(kSeenLines);
  for (const Trace& line : s.lines) s.list.add(line.nodes, Cap::round, Blend::over, line.closed);

  const SpaceStage& stage = s.stage;
  const double weight = stage.layout.weight;
  s.list.of({Subject::What::layer, 2});
  std::vector<Arrow> arrows;
  const auto arrow = [&](const Vec3& tail, const Vec3& tip) {
    if (s.lens.depth(tail) < 1e-2 || s.lens.depth(tip) < 1e-2) return;
    const std::size_t before = arrows.size();
    offer(s.lens.page(tail), s.lens.page(tip), s.lens.window, weight, arrows);
    if (arrows.size() > before) arrows.back().hang = Hang{tail, tip};
  };
  std::vector<Color> inks;
  for (const Push& push : pushes(stage.cast, stage.look, s.now)) {
    arrow(push.point, push.point + stage.force_scale * push.force);
    inks.resize(arrows.size(), push.quiet ? stage.colours.quiet : stage.colours.force);
  }
  draw_arrows(arrows, inks, weight, stage.colours.room, s.list);
  s.list.of({Subject::What::layer, 3});
  arrows.clear(), inks.clear();
  for (std::size_t i = 0; i < stage.look.bodies.size() && i < s.now.bodies.size(); ++i) {
    if (!stage.look.bodies[i].velocity) continue;
    const sim::Snapshot::Body& body = s.now.bodies[i];
    arrow(body.position, body.position + stage.look.velocity_scale * body.velocity);
    inks.resize(arrows.size(), stage.look.bodies[i].quiet ? stage.colours.quiet : stage.colours.velocity);
  }
  draw_arrows(arrows, inks, weight, stage.colours.room, s.list);
}

void draw_space_gone(SpaceFrame& s) {
  const SpaceStage& stage = s.stage;
  const Rect& w = s.lens.window;
  const Point half = Point(w.width, w.height) / 2, middle = Point(w.x, w.y) + half;
  std::vector<double> reach(s.now.bodies.size(), 0);
  for (const Piece& piece : stage.pieces)
    reach[std::size_t(piece.body)] = std::max(reach[std::size_t(piece.body)], piece.reach);
  std::vector<Arrow> arrows;
  std::vector<Color> inks;
  for (std::size_t i = 0; i < stage.look.bodies.size() && i < s.now.bodies.size(); ++i) {
    if (!(stage.look.bodies[i].trail > 0) || stage.cast.bodies[i].fixed) continue;
    const Vec3& place = s.now.bodies[i].position;
    if (!place.allFinite()) continue;
    const double depth = s.lens.depth(place);
    Point away;
    if (depth > kPassedEye) {
      away = s.lens.page(place) - middle;
      const double wide = std::max(s.lens.scale_at(place) * reach[i], stage.dots[i]);
      if (!((away.cwiseAbs() - half).maxCoeff() > wide)) continue;
    } else {
      // beside or behind the eye: to the side on which it is
      const Vec3 off = place - s.lens.eye();
      away = Point(off.dot(s.lens.right), -off.dot(s.lens.up)) * s.lens.scale;
      if (!(away.norm() > 0)) continue;
    }
    arrows.push_back(at_edge(w, away, stage.layout.weight));
    arrows.back().bare = 0;
    inks.push_back(paint(stage.own[i], stage.look.theme).outline);
  }
  // a page that looks from elsewhere has none
  s.list.of(kSeenLines);
  draw_arrows(arrows, inks, stage.layout.weight, stage.colours.room, s.list);
}

void draw_space_hands(SpaceFrame& s) {
  const SpaceStage& stage = s.stage;
  if (!stage.look.pointer) return;
  s.list.of({Subject::What::layer, 5});
  const double weight = stage.layout.weight;
  for (std::size_t i = 0; i < s.now.mice.size() && i < stage.cast.mice.size(); ++i) {
    const sim::SceneInfo::Mouse& mouse = stage.cast.mice[i];
    if (mouse.path.empty()) continue;
    const double alpha = shown(mouse, s.now.time);
    if (alpha <= 0) continue;

    // its way, dotted where it is seen
    double gone = 0, next = 0;
    const std::size_t n = mouse.path.size();
    for (std::size_t k = 0; k + 1 < n; ++k) {
      const Vec3 &a = mouse.path[k], &b = mouse.path[k + 1];
      if (s.lens.depth(a) < 1e-2 || s.lens.depth(b) < 1e-2) continue;
      const Point p = s.lens.page(a), q = s.lens.page(b);
      const double length = (q - p).norm();
      for (; next <= gone + length && length > 0; next += kStep * weight) {
        const double part = (next - gone) / length;
        if (!s.sight.seen(a + part * (b - a), -1)) continue;
        const double when = mouse.press + (mouse.release - mouse.press) * (double(k) + part) / double(n - 1);
        Color color = stage.colours.way;
        color.a = std::uint8_t(std::lround(255 * alpha * (when <= s.now.time ? 1 : 0.5)));
        s.list.add(Disc{p + part * (q - p), kWayDot * weight, 0, color, color});
      }
      gone += length;
    }
    const Vec3 tip = pointer(mouse, s.now.mice[i], s.now.time);
    if (s.lens.depth(tip) > 1e-2) draw_pointer(s.lens.page(tip), alpha, weight, stage.colours, s.list);
  }
}

}  // namespace obscura::draw

// A trail of duration T: a body's way from t - T to t, at age a as wide as W (0.25 + 0.75 s) and of a colour
// s^1.3 of the way from its faintest to its own, s = 1 - a / T. Its nodes are chosen on the physics clock,
// the first point of each T/240 and every cusp, so that they do not wander from frame to frame; where a
// trail bends between two of them, points between are added until it is as round as the motion
// (draw/picture/way.h). Drawn by minimum or maximum: where pieces overlap nothing shows.

#include <algorithm>
#include <cmath>
#include <functional>
#include <utility>

#include "draw/picture/way.h"
#include "draw/plane/stage.h"

namespace obscura::draw {
namespace {

constexpr int kTrailPieces = 240;
constexpr double kCusp = 0.9;   // cosine of a turn that breaks the line
constexpr double kClose = 0.5;  // page units: nearer points are one
constexpr double kGone = 44,
                 kGoneEdge = 10;  // page units: an arrow to what has left, and from its tip to the edge
constexpr double kBent = 0.4;  // page units: farther from the line through its neighbours a point is needed

using Way = std::vector<sim::Track::Point>;

}  // namespace

void bends(const std::vector<sim::Track::Point>& way, std::size_t a, std::size_t b, double least,
           const std::function<void(std::size_t)>& add) {
  const sim::Vec3 from = way[a].place, along = way[b].place - from;
  const double length = along.squaredNorm();
  double worst = least;
  std::size_t at = a;
  for (std::size_t k = a + 1; k < b; ++k) {
    const sim::Vec3 d = way[k].place - from;
    const double s = length > 0 ? std::clamp(d.dot(along) / length, 0.0, 1.0) : 0;
    if (const double far = (d - s * along).norm(); far > worst) worst = far, at = k;
  }
  if (at == a) return;
  bends(way, a, at, least, add);
  add(at);
  bends(way, at, b, least, add);
}

Way way_of(int body, double from, const sim::Snapshot& now, Ways ways, double tolerance) {
  Way way;
  for (const auto& track : ways) {
    const auto at = std::find(track->bodies.begin(), track->bodies.end(), body);
    if (at == track->bodies.end()) continue;
    const Way& points = track->points[at - track->bodies.begin()];
    auto first = std::lower_bound(points.begin(), points.end(), from,
                                  [](const sim::Track::Point& p, double t) { return p.time < t; });
    // the piece across the border is cut there: of all points before it the last, wherever the tracks part
    if (first != points.begin()) way.assign(1, *(first - 1));
    for (; first != points.end() && first->time < now.time; ++first) {
      if (way.empty() || first->time > way.back().time) way.push_back(*first);
    }
  }
  way.push_back(end_of_way(body, now));
  way = refined(way, sim::Vec3::Zero(), tolerance);
  const auto begin = std::find_if(way.begin(), way.end(), [&](const auto& p) { return p.time > from; });
  if (begin - way.begin() > 1) way.erase(way.begin(), begin - 1);
  if (way.size() > 1 && way[0].time < from) {
    const double part = (from - way[0].time) / (way[1].time - way[0].time);
    way[0] = {from, way[0].place + part * (way[1].place - way[0].place)};
  }
  return way;
}

void draw_trails(const Stage& stage, const View& view, const sim::Snapshot& now, Ways ways, List& list) {
  const Blend blend = stage.look.theme == Theme::paper ? Blend::darken : Blend::lighten;
  std::vector<Node> line;
  std::vector<std::pair<std::size_t, bool>> chosen;  // of a way, and whether it turns sharply there
  for (std::size_t i = 0; i < stage.look.bodies.size() && i < now.bodies.size(); ++i) {
    const double lasting = stage.look.bodies[i].trail;
    if (!(lasting > 0)) continue;
    const Way way = way_of(int(i), now.time - lasting, now, ways, kBent / view.scale);
    const double own = stage.dots[i] > 0 ? stage.dots[i] : view.scale * stage.cast.bodies[i].radius;
    const sim::ShapeKind kind = stage.cast.bodies[i].kind;
    const bool round = kind == sim::ShapeKind::point || kind == sim::ShapeKind::ball;
    const double widest = std::min(kTrailLine * stage.layout.weight, round ? std::max(1.5 * own, 1.2) : 1e9);
    const Color strong = stage.paints[i].trail, faint = faintest(strong, stage.colours);
    auto node = [&](const sim::Track::Point& p) {
      const double s = std::clamp(1 - (now.time - p.time) / lasting, 0.0, 1.0);
      return Node{view.page(p.place), widest * (0.25 + 0.75 * s), mix(faint, strong, std::pow(s, 1.3))};
    };

    // the points of fixed times, then those that the curve needs
    chosen.clear();
    std::int64_t piece = 0;
    for (std::size_t k = 0; k < way.size(); ++k) {
      const auto here = std::int64_t(std::floor(way[k].time * kTrailPieces / lasting));
      bool cusp = false;
      if (k > 0 && k + 1 < way.size()) {
        const Point in = (way[k].place - way[k - 1].place).head<2>(),
                    out = (way[k + 1].place - way[k].place).head<2>();
        cusp = in.dot(out) < kCusp * in.norm() * out.norm();
      }
      if (k > 0 && k + 1 < way.size() && !cusp && here == piece) continue;
      piece = here;
      if (!chosen.empty())
        bends(way, chosen.back().first, k, kBent / view.scale,
              [&](std::size_t between) { chosen.emplace_back(between, false); });
      chosen.emplace_back(k, cusp);
    }

    list.of({Subject::What::trail, int(i)});
    Trail trail;
    trail.begin = int(list.strokes.size());
    trail.now = now.time, trail.lasting = lasting, trail.widest = widest;
    trail.strong = strong, trail.faint = faint;
    trail.origin = view.origin, trail.scale = view.scale;
    trail.subject = {Subject::What::trail, int(i), list.part};
    line.clear();
    for (const auto& [k, cusp] : chosen) {
      const bool last = k + 1 == way.size();
      Node next = node(way[k]);
      if (!line.empty() && (next.at - line.back().at).norm() < kClose) {
        if (last && line.size() > 1) line.back() = next, trail.way.back() = {way[k].time, next.at, false};
        continue;
      }
      line.push_back(next);
      trail.way.push_back({way[k].time, next.at, cusp && !last});
      // a bounce is a corner with round ends, not a mitre
      if (cusp && !last) {
        list.add(line, Cap::round, blend);
        line.assign(1, next);
      }
    }
    list.add(line, Cap::round, blend);
    trail.end = int(list.strokes.size());
    if (trail.end > trail.begin) list.trails.push_back(std::move(trail));
  }
  list.of({});
}

Arrow at_edge(const Rect& window, const Point& away, double weight) {
  // where it is nearest: what is straight above the picture has its arrow straight below
  const Point half = Point(window.width, window.height) / 2,
              room = half - Point::Constant(kGoneEdge * weight), near = away.cwiseMax(-room).cwiseMin(room);
  const Point tip = Point(window.x, window.y) + half + near;
  return {tip - kGone * weight * (away - near).normalized(), tip};
}

void draw_gone(const Stage& stage, const View& view, const sim::Snapshot& now, List& list) {
  const Rect& w = view.window;
  const double weight = stage.layout.weight;
  const Point half = Point(w.width, w.height) / 2, middle = Point(w.x, w.y) + half;
  std::vector<Arrow> arrows;
  std::vector<Color> inks;
  for (std::size_t i = 0; i < stage.look.bodies.size() && i < now.bodies.size(); ++i) {
    const sim::SceneInfo::Body& body = stage.cast.bodies[i];
    if (!(stage.look.bodies[i].trail > 0) || body.fixed) continue;
    double reach = std::max(body.radius, body.half.norm());
    for (const sim::Vec3& vertex : body.vertices) reach = std::max(reach, vertex.norm());
    const Point at = view.page(now.bodies[i].position), away = at - middle;
    const double out = (away.cwiseAbs() - half).maxCoeff();
    if (!at.allFinite() || !(out > std::max(view.scale * reach, stage.dots[i]))) continue;
    arrows.push_back(at_edge(w, away, weight));
    inks.push_back(stage.paints[i].outline);
  }
  draw_arrows(arrows, inks, weight, stage.colours.room, list);
}

}  // namespace obscura::draw

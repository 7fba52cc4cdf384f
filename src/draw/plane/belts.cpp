// Belts: marks along the inside of the outline of a body whose surface runs around it. They go clockwise, as
// far as the surface at its speed in the time of the run; where an event gives it another speed they jump.

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "draw/picture/common.h"
#include "draw/plane/stage.h"

namespace obscura::draw {
namespace {

// page units at weight 1: from one mark to the next, how long and how wide one is
constexpr double kBetweenMarks = 36, kMarkLength = 12, kMarkWidth = 2.2;
constexpr double kMarkDepth = 0.45;                   // of the way to the body's middle
constexpr double kFewestMarks = 3, kMostMarks = 1e4;  // of a belt; of one of its sides
constexpr int kBeltCorners = 72;

// the outline of a body of one form, clockwise on the page; none: it has no belt that is drawn
std::vector<Point> belt_loop(const sim::SceneInfo::Body& form, const sim::Snapshot::Body& body,
                             const View& view) {
  std::vector<Point> around;
  if (form.kind == sim::ShapeKind::ball)
    for (int k = 0; k < kBeltCorners; ++k) {
      const double angle = -2 * std::numbers::pi * k / kBeltCorners;
      around.emplace_back(form.radius * std::cos(angle), form.radius * std::sin(angle));
    }
  if (form.kind == sim::ShapeKind::box) {
    const Point h = form.half.head<2>();
    around = {{-h.x(), h.y()}, h, {h.x(), -h.y()}, -h};
  }
  if (form.kind == sim::ShapeKind::polygon)
    for (auto vertex = form.vertices.rbegin(); vertex != form.vertices.rend(); ++vertex)
      around.emplace_back(vertex->head<2>());
  const double s = std::sin(body.angle), c = std::cos(body.angle);
  const Point center = view.page(body.position);
  for (Point& p : around) p = center + view.scale * Point(c * p.x() - s * p.y(), -(s * p.x() + c * p.y()));
  return around;
}

}  // namespace

void draw_belts(const Stage& stage, const View& view, const sim::Snapshot& now, Rank rank, bool rounds,
                List& list) {
  const double weight = stage.layout.weight;
  const Point seen(view.window.x + view.window.width / 2, view.window.y + view.window.height / 2);
  const double reach = std::hypot(view.window.width, view.window.height) / 2;
  for (std::size_t i = 0; i < now.bodies.size(); ++i) {
    const sim::Snapshot::Body& body = now.bodies[i];
    const sim::SceneInfo::Body& form = stage.cast.bodies[i];
    if (body.surface == 0 || (form.kind == sim::ShapeKind::ball) != rounds) continue;
    if (!rounds && stage.rank(int(i)) != rank) continue;
    const std::vector<Point> around = belt_loop(form, body, view);
    if (around.empty()) continue;
    const Point middle = view.page(body.position);
    double length = 0, narrow = 1e300;
    for (std::size_t k = 0; k < around.size(); ++k) {
      const Point edge = around[(k + 1) % around.size()] - around[k], to = middle - around[k];
      length += edge.norm();
      narrow = std::min(narrow, std::abs(edge.x() * to.y() - edge.y() * to.x()) / edge.norm());
    }
    if (outside(view.window, middle, length / 2)) continue;
    const double deep = std::min(kMarkLength * weight, kMarkDepth * narrow),
                 wide = std::min(kMarkWidth * weight, deep / 4);
    const double marks = std::max(kFewestMarks, std::floor(length / (kBetweenMarks * weight)));
    const double pitch = length / marks, gone = body.surface * now.time * view.scale / pitch;
    double ahead = pitch * (gone - std::floor(gone));  // of the next corner
    list.of({Subject::What::body, int(i)});
    for (std::size_t k = 0; k < around.size(); ++k) {
      const Point a = around[k], edge = around[(k + 1) % around.size()] - a;
      const Point along = edge.normalized(), inwards(-along.y(), along.x());
      const double side = edge.norm(), first = ahead, left = std::max(0.0, std::ceil((side - first) / pitch));
      ahead += left * pitch - side;
      // of a belt much longer than the window those near it
      const double off = (seen - a).dot(inwards), foot = (seen - a).dot(along);
      if (std::abs(off) > reach + deep) continue;
      const double begin = std::max(0.0, std::ceil((foot - reach - deep - first) / pitch)),
                   end = std::min(left, std::floor((foot + reach + deep - first) / pitch) + 1);
      const int seen_marks = int(std::clamp(end - begin, 0.0, kMostMarks));
      for (int n = 0; n < seen_marks; ++n) {
        const Point at = a + (first + (begin + n) * pitch) * along;
        list.add({{at, wide, stage.paints[i].outline}, {at + deep * inwards, wide, stage.paints[i].outline}},
                 Cap::butt);
      }
    }
  }
}

}  // namespace obscura::draw

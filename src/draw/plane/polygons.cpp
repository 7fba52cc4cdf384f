// Convex polygons, and bodies of several parts. A part is its form in the outline's colour, and on it the
// same form moved inwards by the outline's width in the fill's. For a body of several parts, first all the
// forms and then all the fills, which cover the inner outlines; if an edge lies within another part, its fill
// extends beyond it, so that the parts look like one.

#include <algorithm>
#include <cmath>
#include <limits>

#include "draw/picture/common.h"
#include "draw/picture/convex.h"
#include "draw/plane/stage.h"

namespace obscura::draw {
namespace {

constexpr int kMostEdges = 64;  // bits of a part's seams

using Part = sim::SceneInfo::Part;

/// The vertices of a box or polygon in the body's frame, counter-clockwise; none for a ball.
std::vector<Point> corners(const Part& part) {
  std::vector<Point> all;
  if (part.kind == sim::ShapeKind::box) {
    const Point c = part.center.head<2>(), h = part.half.head<2>();
    all = {c - h, c + Point(h.x(), -h.y()), c + h, c + Point(-h.x(), h.y())};
  }
  for (const sim::Vec3& vertex : part.vertices) all.emplace_back(vertex.head<2>());
  return all;
}

bool holds(const Part& part, const Point& p) {
  if (part.kind == sim::ShapeKind::ball) return (p - part.center.head<2>()).norm() < part.radius;
  const std::vector<Point> around = corners(part);
  for (std::size_t i = 0; i < around.size(); ++i) {
    const Point side = around[(i + 1) % around.size()] - around[i], to = p - around[i];
    if (side.x() * to.y() - side.y() * to.x() < 0) return false;
  }
  return true;
}

/// A polygon on the page and what is known of its edges.
struct Form {
  std::vector<Point> corners;  // page, clockwise to the eye as to the world
  std::uint64_t seams = 0;
  double narrow = 0;  // from its middle to the nearest edge
};

/// The half plane within edge i.
HalfPlane within(const std::vector<Point>& corners, std::size_t i) {
  const Point &a = corners[i], &b = corners[(i + 1) % corners.size()];
  const Point along = (b - a).normalized();
  return {a, {along.y(), -along.x()}};  // counter-clockwise in the world, y down on the page
}

Form form(const Part& part, std::uint64_t seams, const View& view, const sim::Snapshot::Body& body) {
  const Point center = view.page(body.position);
  const double s = std::sin(body.angle), c = std::cos(body.angle);
  Form it;
  it.seams = seams;
  Point middle = Point::Zero();
  for (const Point& p : corners(part)) {
    it.corners.push_back(center + view.scale * Point(c * p.x() - s * p.y(), -(s * p.x() + c * p.y())));
    middle += it.corners.back();
  }
  middle /= double(it.corners.size());
  it.narrow = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < it.corners.size(); ++i) {
    const HalfPlane edge = within(it.corners, i);
    it.narrow = std::min(it.narrow, (middle - edge.point).dot(edge.normal));
  }
  return it;
}

/// The part within its outline.
std::vector<Point> inner(const Form& form, double line) {
  // with many edges they are not cut one by one
  if (form.corners.size() > kMostEdges) {
    std::vector<HalfPlane> edges;
    for (std::size_t i = 0; i < form.corners.size(); ++i) {
      const bool seam = i < kMostEdges && (form.seams >> i & 1);
      edges.push_back(moved(within(form.corners, i), seam ? -line : line));
    }
    return within_all(edges);
  }
  Point low = form.corners[0], high = form.corners[0];
  for (const Point& p : form.corners) low = low.cwiseMin(p), high = high.cwiseMax(p);
  Convex left =
      border({low.x() - line, low.y() - line, high.x() - low.x() + 2 * line, high.y() - low.y() + 2 * line});
  for (std::size_t i = 0; i < form.corners.size() && !left.empty(); ++i) {
    const bool seam = i < kMostEdges && (form.seams >> i & 1);
    left = cut(left, moved(within(form.corners, i), seam ? -line : line), int(i));
  }
  return left.outline();
}

}  // namespace

std::vector<std::uint64_t> seams_of(const sim::SceneInfo::Body& body) {
  std::vector<std::uint64_t> seams;
  for (std::size_t p = 0; p < body.parts.size(); ++p) {
    const std::vector<Point> around = corners(body.parts[p]);
    std::uint64_t bits = 0;
    for (std::size_t i = 0; i < around.size() && i < kMostEdges; ++i) {
      const Point a = around[i], b = around[(i + 1) % around.size()];
      const Point out = 1e-3 * Point(b.y() - a.y(), a.x() - b.x());
      const auto covered = [&](double along) {
        const Point at = a + along * (b - a) + out;
        for (std::size_t q = 0; q < body.parts.size(); ++q)
          if (q != p && holds(body.parts[q], at)) return true;
        return false;
      };
      if (covered(0.02) && covered(0.5) && covered(0.98)) bits |= std::uint64_t(1) << i;
    }
    seams.push_back(bits);
  }
  return seams;
}

void draw_polygons(const Stage& stage, const View& view, const sim::Snapshot& now, Rank rank, List& list) {
  const double weight = stage.layout.weight;
  for (int i : stage.polygons) {
    if (stage.rank(i) != rank) continue;
    const sim::SceneInfo::Body& info = stage.cast.bodies[i];
    const sim::Snapshot::Body& body = now.bodies[i];
    const Paint& paint = stage.paints[i];
    list.of({Subject::What::body, i});
    std::vector<Part> parts = info.parts;
    if (info.kind == sim::ShapeKind::polygon)
      parts.push_back({sim::ShapeKind::polygon, 0, sim::Vec3::Zero(), sim::Vec3::Zero(), info.vertices});

    // one width for all of its outline
    std::vector<Form> forms;
    double narrow = std::numeric_limits<double>::infinity();
    for (std::size_t p = 0; p < parts.size(); ++p) {
      forms.push_back({});
      if (parts[p].kind != sim::ShapeKind::ball)
        forms.back() = form(parts[p], p < stage.seams[i].size() ? stage.seams[i][p] : 0, view, body);
      narrow = std::min(
          narrow, parts[p].kind == sim::ShapeKind::ball ? view.scale * parts[p].radius : forms.back().narrow);
    }
    const double line = std::min(kOutline * weight, 0.35 * narrow);
    const Color fill = fill_of(paint, narrow, weight);
    const auto middle = [&](const Part& part) {
      const double s = std::sin(body.angle), c = std::cos(body.angle);
      const Point p = part.center.head<2>();
      return Point(view.page(body.position) +
                   view.scale * Point(c * p.x() - s * p.y(), -(s * p.x() + c * p.y())));
    };
    for (std::size_t p = 0; p < parts.size(); ++p) {
      if (parts[p].kind == sim::ShapeKind::ball) {
        list.add(Disc{middle(parts[p]), view.scale * parts[p].radius, 0, paint.outline, paint.outline});
      } else {
        list.add(forms[p].corners, paint.outline);
      }
    }
    for (std::size_t p = 0; p < parts.size(); ++p) {
      if (parts[p].kind == sim::ShapeKind::ball) {
        list.add(Disc{middle(parts[p]), view.scale * parts[p].radius - line, 0, fill, fill});
      } else if (const std::vector<Point> within_it = inner(forms[p], line); within_it.size() > 2) {
        list.add(within_it, fill);
      }
    }
  }
}

}  // namespace obscura::draw

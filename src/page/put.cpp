// A list as strokes and fills. An outline lies within its rim: a stroke of width w is drawn w/2 inside, and
// the fill reaches to its middle, so that no ground shows between. A stroke that tapers or fades is a chain
// of pieces, each extending under the next; GL takes the darker of two pieces, here the newer lies on top.

#include <algorithm>
#include <cmath>
#include <numbers>
#include <span>

#include "page/pen.h"

namespace obscura::page {
namespace {

Color mixed(Color ground, Color color) {
  const double strength = color.a / 255.0;
  color.a = 255;
  return draw::mix(Color{ground.r, ground.g, ground.b, 255}, color, strength);
}

void put_disc(const draw::Disc& disc, double k, Pen& pen) {
  const Point center = k * disc.center;
  const double radius = k * disc.radius, line = std::min(k * disc.line, radius);
  if (line <= 0) return pen.fill_circle(center, radius, disc.fill);
  pen.fill_circle(center, radius - line / 2, disc.fill);
  pen.ring(center, radius - line / 2, line, disc.outline);
}

void put_box(const draw::Box& box, double k, Pen& pen) {
  const Point center = k * box.center, x = box.x_axis, y(-x.y(), x.x());
  const auto corners = [&](const Point& half) {
    return std::vector<Point>{center - half.x() * x - half.y() * y, center + half.x() * x - half.y() * y,
                              center + half.x() * x + half.y() * y, center - half.x() * x + half.y() * y};
  };
  const Point half = k * box.half;
  const double line = std::min(k * box.line, half.minCoeff());
  const std::vector<Point> middle = corners(half - Point::Constant(line / 2));
  pen.fill(middle, box.fill);
  if (line > 0) pen.stroke(middle, line, box.outline, draw::Cap::butt, true);
  if (box.axis <= 0 || box.axis_line <= 0) return;
  // the body's y is up
  const double width = k * box.axis_line;
  pen.stroke({center, center + k * box.axis * x}, width, box.axis_color, draw::Cap::butt, false);
  pen.stroke({center, center - k * box.axis * y}, width, box.axis_color, draw::Cap::butt, false);
  pen.fill_circle(center, 1.5 * width, box.axis_color);
}

struct Piece {
  Point at;
  double half;
  Color color;
};

void put_taper(const std::vector<Piece>& line, draw::Cap cap, Pen& pen) {
  const std::size_t n = line.size();
  const auto tangent = [&](std::size_t i) { return Point((line[i + 1].at - line[i].at).normalized()); };
  if (cap == draw::Cap::round) pen.fill_circle(line[0].at, line[0].half, line[0].color);
  for (std::size_t i = 0; i + 1 < n; ++i) {
    const Point t = tangent(i), normal(-t.y(), t.x());
    const Color color = draw::mix(line[i].color, line[i + 1].color, 0.5);
    // mitred where the line bends gently, a disc where it breaks
    const auto side = [&](std::size_t node, std::size_t other) {
      if (node == 0 || node + 1 == n) return Point(line[node].half * normal);
      const Point u = tangent(other), m = (normal + Point(-u.y(), u.x())).normalized();
      return Point(t.dot(u) < 0.5 ? line[node].half * normal : line[node].half / m.dot(normal) * m);
    };
    const Point a = side(i, i == 0 ? 0 : i - 1), b = side(i + 1, i + 2 < n ? i + 1 : i);
    const Point under = i + 2 < n ? Point(std::min(0.5, line[i + 1].half) * t) : Point(Point::Zero());
    pen.fill({line[i].at + a, line[i + 1].at + b, line[i + 1].at + b + under, line[i + 1].at - b + under,
              line[i + 1].at - b, line[i].at - a},
             color);
    const bool breaks = i + 2 < n && t.dot(tangent(i + 1)) < 0.5;
    if (breaks || (i + 2 == n && cap == draw::Cap::round))
      pen.fill_circle(line[i + 1].at, line[i + 1].half, breaks ? color : line[i + 1].color);
  }
}

void put_stroke(const draw::List& list, const draw::Stroke& stroke, double k, Color ground, Pen& pen) {
  const std::span nodes(list.nodes.data() + stroke.begin, std::size_t(stroke.end - stroke.begin));
  std::vector<Piece> line;
  bool even = true;
  for (const draw::Node& node : nodes) {
    const Point at = k * node.at;
    if (!at.allFinite() || (!line.empty() && (at - line.back().at).norm() < 1e-4)) continue;
    line.push_back(
        {at, k * node.width / 2, stroke.blend == draw::Blend::over ? node.color : mixed(ground, node.color)});
    even = even && line.back().color == line[0].color && std::abs(line.back().half - line[0].half) < 1e-3;
  }
  if (line.empty()) return;
  if (line.size() == 1) {
    if (stroke.cap == draw::Cap::round) pen.fill_circle(line[0].at, line[0].half, line[0].color);
    return;
  }
  if (!even && !stroke.closed) return put_taper(line, stroke.cap, pen);
  std::vector<Point> points;
  for (const Piece& piece : line) points.push_back(piece.at);
  pen.stroke(points, 2 * line[0].half, line[0].color, stroke.cap, stroke.closed && points.size() > 2);
}

void put_text(const draw::Text& text, double k, Pen& pen) {
  const draw::Line line = draw::shape(text);
  double start = text.at.x();
  if (text.align == draw::Align::center) start -= line.width / 2;
  if (text.align == draw::Align::right) start -= line.width;
  pen.type({k * start, k * text.at.y()}, text, line, k);
}

}  // namespace

void put(const draw::List& list, double k, Color ground, Pen& pen) {
  int clip = -1;
  for (const draw::Batch& batch : list.batches) {
    if (batch.clip != clip) {
      if (clip >= 0) pen.unclip();
      clip = batch.clip;
      if (clip >= 0) {
        const draw::Rect& r = list.clips[std::size_t(clip)];
        pen.clip({k * r.x, k * r.y, k * r.width, k * r.height});
      }
    }
    for (int i = batch.begin; i < batch.end; ++i) {
      const auto at = std::size_t(i);
      switch (batch.kind) {
        case draw::Kind::disc:
          put_disc(list.discs[at], k, pen);
          break;
        case draw::Kind::box:
          put_box(list.boxes[at], k, pen);
          break;
        case draw::Kind::stroke:
          put_stroke(list, list.strokes[at], k, ground, pen);
          break;
        case draw::Kind::polygon: {
          std::vector<Point> outline;
          for (int p = list.polygons[at].begin; p < list.polygons[at].end; ++p)
            outline.push_back(k * list.points[std::size_t(p)]);
          pen.fill(outline, list.polygons[at].fill);
          break;
        }
        case draw::Kind::text:
          put_text(list.texts[at], k, pen);
          break;
      }
    }
  }
  if (clip >= 0) pen.unclip();
}

}  // namespace obscura::page

// A stroke as a strip of quads, one a segment, that meet along their joints.
//
// At a joint with turn theta, half width d (antialiased margin included), the edges of both segments meet on
// the line that halves the joint, d / cos(theta / 2) from the node. On the inside the edge of a segment is
// shortened by d tan(theta / 2) there: if that is more than half the segment, the inner corners stop at
//   d_in = length / (2 tan(theta / 2)),
// for even nodes on a smooth curve its centre of curvature: neighbours never overlap, whatever the width.
// A turn that is sharp as well has no mitre. The stroke is broken there, in two round ends. Each keeps to its
// side of the line that halves the joint, pixel by pixel, so that nothing is blended twice.

#include "gl/strip.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace obscura::gl {
namespace {

using draw::Point;

constexpr double kStrokeMargin = 0.75;  // px beyond the edge where a pixel may still be covered: sqrt(1/2)
constexpr double kMitreLimit = 4;       // mitre length over width, as in SVG
constexpr double kSharp = 0.5;          // cosine of the turn beyond which a joint that does not fit is broken
constexpr double kCutLimit = 16;        // arms closer to parallel are left to overlap

struct Vertex {
  Point at;
  double half = 0;
  draw::Color color;
  Point left = Point::Zero(), right = Point::Zero();  // corners of the strip, from `at`
};

enum class End { joined, butt, round };

/// One end of an arm: a cap, a broken joint, or none.
struct Tip {
  End end = End::joined;
  double side = 0;   // -1, 1 at a broken joint
  double reach = 0;  // px along the arm to which the cut matters
  Point cut = Point::Zero(), cut_normal = Point::Zero();
};

Point normal_of(const Point& t) { return {-t.y(), t.x()}; }

/// A turn from t0 to t1 where the neighbouring segments are `room` px long at least.
struct Joint {
  Point left, right;
  bool broken = false;
  double mitre = 1;  // 1 / cos(theta / 2)
};

Joint joint(const Point& t0, const Point& t1, double room, double half) {
  const double cosine = std::clamp(t0.dot(t1), -1.0, 1.0);
  const double d = half + kStrokeMargin;
  Joint j;
  j.mitre = 1 / std::sqrt(std::max((1 + cosine) / 2, 1e-12));
  const double tangent = std::sqrt(std::max((1 - cosine) / 2, 0.0)) * j.mitre;
  const bool tight = 2 * d * tangent > room;
  j.broken = j.mitre > kMitreLimit || (tight && cosine < kSharp);
  if (j.broken) return j;

  const Point n = (normal_of(t0) + normal_of(t1)).normalized() * j.mitre;
  const double inner = tight ? room / (2 * tangent) : d;
  // positive: the turn is towards the left normal, whose side is the inner one
  const bool left_turn = t0.x() * t1.y() - t0.y() * t1.x() > 0;
  j.left = n * (left_turn ? inner : d);
  j.right = -n * (left_turn ? d : inner);
  return j;
}

class Builder {
 public:
  Builder(Strip& strip, Bounds& bounds) : strip_(strip), bounds_(bounds) {}

  /// An arm: nodes without broken joints. `closed`: the last is the first again.
  void arm(std::vector<Vertex>& nodes, const Tip& start, const Tip& finish, bool closed);

 private:
  void quad(const Vertex& a, const Vertex& b, const Point& tangent, const Tip& tip, const Point& end,
            double outward, bool terminal, bool cut);
  void cap(const Vertex& node, const Point& outward, const Tip& tip);
  /// A straight stroke of one width and colour with two ends alike, in one.
  void bar(const Vertex& a, const Vertex& b, End end);
  void rectangle(std::uint32_t first);

  Strip& strip_;
  Bounds& bounds_;
};

void Builder::quad(const Vertex& a, const Vertex& b, const Point& tangent, const Tip& tip, const Point& end,
                   double outward, bool terminal, bool cut) {
  const Point n = normal_of(tangent);
  const auto first = std::uint32_t(strip_.vertices.size());
  const std::array<std::pair<const Vertex*, Point>, 4> corners{
      {{&a, a.at + a.left}, {&a, a.at + a.right}, {&b, b.at + b.left}, {&b, b.at + b.right}}};
  for (const auto& [node, at] : corners) {
    StripVertex v;
    v.x = float(at.x());
    v.y = float(at.y());
    v.lateral = float(n.dot(at - a.at));
    v.past = terminal ? float(outward * tangent.dot(at - end)) : -1e4f;
    v.half = float(node->half);
    v.color = node->color;
    v.tangent_x = float(tangent.x() * outward);
    v.tangent_y = float(tangent.y() * outward);
    v.lateral *= float(outward);
    v.butt = tip.end == End::butt ? 1 : 0;
    if (cut) {
      v.side = float(tip.side);
      v.cut_x = float(tip.cut.x());
      v.cut_y = float(tip.cut.y());
      v.cut_normal_x = float(tip.cut_normal.x());
      v.cut_normal_y = float(tip.cut_normal.y());
    }
    strip_.vertices.push_back(v);
  }
  rectangle(first);
}

void Builder::rectangle(std::uint32_t first) {
  for (const std::uint32_t i : {0, 1, 2, 2, 1, 3}) strip_.indices.push_back(first + i);
  for (std::size_t i = first; i < first + 4; ++i) {
    const StripVertex& v = strip_.vertices[i];
    bounds_ = {std::min(bounds_.x0, v.x), std::min(bounds_.y0, v.y), std::max(bounds_.x1, v.x),
               std::max(bounds_.y1, v.y)};
  }
}

void Builder::bar(const Vertex& a, const Vertex& b, End end) {
  const Point step = b.at - a.at, middle = (a.at + b.at) / 2;
  const double length = step.norm(), wide = a.half + kStrokeMargin;
  const double reach = length / 2 + kStrokeMargin + (end == End::round ? a.half : 0);
  const Point tangent = step / length, n = normal_of(tangent);
  const auto first = std::uint32_t(strip_.vertices.size());
  for (const double along : {-reach, reach}) {
    for (const double across : {wide, -wide}) {
      const Point at = middle + along * tangent + across * n;
      StripVertex v;
      v.x = float(at.x());
      v.y = float(at.y());
      v.lateral = float(across);
      v.past = float(along);
      v.half = float(a.half);
      v.color = a.color;
      v.tangent_x = float(tangent.x());
      v.tangent_y = float(tangent.y());
      v.butt = end == End::butt ? 1 : 0;
      v.cut_x = float(length / 2);
      strip_.vertices.push_back(v);
    }
  }
  rectangle(first);
}

void Builder::cap(const Vertex& node, const Point& outward, const Tip& tip) {
  if (tip.end == End::joined || (tip.end == End::round && node.half <= 0)) return;
  Vertex far = node;
  far.at += outward * (kStrokeMargin + (tip.end == End::round ? node.half : 0));
  // the strip's left and right are those of its own direction
  const bool forward = normal_of(outward).dot(node.left) > 0;
  quad(node, far, forward ? outward : Point(-outward), tip, node.at, forward ? 1 : -1, true, tip.side != 0);
}

void Builder::arm(std::vector<Vertex>& nodes, const Tip& start, const Tip& finish, bool closed) {
  if (nodes.size() == 2 && !closed && start.end == finish.end && start.end != End::joined &&
      start.side == 0 && finish.side == 0 && nodes[0].half == nodes[1].half && nodes[0].half > 0 &&
      nodes[0].color == nodes[1].color) {
    bar(nodes[0], nodes[1], start.end);
    return;
  }
  // one segment with two ends: each has its half
  if (nodes.size() == 2 && !closed) {
    Vertex middle = nodes[0];
    middle.at = (nodes[0].at + nodes[1].at) / 2;
    middle.half = (nodes[0].half + nodes[1].half) / 2;
    middle.color = draw::mix(nodes[0].color, nodes[1].color, 0.5);
    nodes.insert(nodes.begin() + 1, middle);
  }
  const int segments = int(nodes.size()) - 1;
  std::vector<Point> tangents(static_cast<std::size_t>(segments));
  std::vector<double> lengths(static_cast<std::size_t>(segments));
  double total = 0;
  for (int i = 0; i < segments; ++i) {
    const Point step = nodes[i + 1].at - nodes[i].at;
    lengths[i] = step.norm();
    tangents[i] = step / lengths[i];
    total += lengths[i];
  }

  for (int i = 0; i <= segments; ++i) {
    Vertex& v = nodes[i];
    const bool end = i == 0 || i == segments;
    if (end && !closed) {
      v.left = normal_of(tangents[i == 0 ? 0 : segments - 1]) * (v.half + kStrokeMargin);
      v.right = -v.left;
    } else {
      const int before = i == 0 ? segments - 1 : i - 1, after = i == segments ? 0 : i;
      const Joint j =
          joint(tangents[before], tangents[after], std::min(lengths[before], lengths[after]), v.half);
      v.left = j.left;
      v.right = j.right;
    }
  }

  // each segment knows the nearer end alone
  if (!closed) cap(nodes.front(), -tangents.front(), start);
  double along = 0;
  for (int i = 0; i < segments; ++i) {
    const double middle = along + lengths[i] / 2;
    const bool first_half = middle < total / 2;
    const Tip& tip = first_half ? start : finish;
    const bool terminal = !closed && (first_half ? i == 0 : i == segments - 1);
    const double from_end = first_half ? along : total - along - lengths[i];
    const bool cut = tip.side != 0 && from_end < tip.reach;
    quad(nodes[i], nodes[i + 1], tangents[i], tip, first_half ? nodes.front().at : nodes.back().at,
         first_half ? -1 : 1, terminal, cut);
    along += lengths[i];
  }
  if (!closed) cap(nodes.back(), tangents.back(), finish);
}

/// The stroke's nodes in px, those that do not advance left out.
std::vector<Vertex> distinct(std::span<const draw::Node> nodes, bool closed, double scale) {
  std::vector<Vertex> found;
  found.reserve(nodes.size() + 2);
  for (const draw::Node& node : nodes) {
    const Point at = node.at * scale;
    if (!at.allFinite()) continue;
    if (!found.empty() && (at - found.back().at).norm() < 1e-4) continue;
    found.push_back({at, std::max(node.width * scale / 2, 0.0), node.color});
  }
  while (closed && found.size() > 1 && (found.front().at - found.back().at).norm() < 1e-4) found.pop_back();
  return found;
}

}  // namespace

void Strip::clear() {
  vertices.clear();
  indices.clear();
}

Bounds add_stroke(std::span<const draw::Node> line, const draw::Stroke& stroke, double scale, Strip& strip) {
  constexpr float far = std::numeric_limits<float>::infinity();
  Bounds bounds{far, far, -far, -far};
  Builder builder(strip, bounds);
  std::vector<Vertex> nodes = distinct(line, stroke.closed, scale);
  const Tip cap{stroke.cap == draw::Cap::round ? End::round : End::butt, 0, 0, Point::Zero(), Point::Zero()};
  if (nodes.empty()) return bounds;
  if (nodes.size() == 1) {
    // a point: round ends make a dot of it
    if (cap.end == End::butt) return bounds;
    nodes.push_back(nodes[0]);
    nodes[0].at.x() -= 1e-3;
    nodes[1].at.x() += 1e-3;
    builder.arm(nodes, cap, cap, false);
    return bounds;
  }
  const bool closed = stroke.closed && nodes.size() > 2;

  // the places where it is broken
  const int count = int(nodes.size());
  std::vector<Tip> breaks(static_cast<std::size_t>(count));
  std::vector<int> broken;
  for (int i = closed ? 0 : 1; i < (closed ? count : count - 1); ++i) {
    const Point back = nodes[i].at - nodes[(i + count - 1) % count].at;
    const Point ahead = nodes[(i + 1) % count].at - nodes[i].at;
    const Point t0 = back.normalized(), t1 = ahead.normalized();
    const Joint j = joint(t0, t1, std::min(back.norm(), ahead.norm()), nodes[i].half);
    if (!j.broken) continue;
    broken.push_back(i);
    breaks[i].end = End::round;
    if (j.mitre > kCutLimit) continue;
    breaks[i].side = 1;
    breaks[i].reach = 1.5 * (nodes[i].half + kStrokeMargin) * j.mitre;
    breaks[i].cut = nodes[i].at;
    breaks[i].cut_normal = (t0 + t1).normalized();
  }

  // arms from break to break
  if (closed && broken.empty()) {
    nodes.push_back(nodes.front());
    builder.arm(nodes, Tip{}, Tip{}, true);
    return bounds;
  }
  if (closed) {
    std::rotate(nodes.begin(), nodes.begin() + broken[0], nodes.end());
    std::rotate(breaks.begin(), breaks.begin() + broken[0], breaks.end());
    nodes.push_back(nodes.front());
    breaks.push_back(breaks.front());
  } else {
    breaks.front() = breaks.back() = cap;
  }
  for (std::size_t from = 0, i = 1; i < nodes.size(); ++i) {
    if (breaks[i].end == End::joined) continue;
    std::vector<Vertex> arm(nodes.begin() + std::ptrdiff_t(from), nodes.begin() + std::ptrdiff_t(i) + 1);
    Tip finish = breaks[i];
    finish.side = -finish.side;
    builder.arm(arm, breaks[from], finish, false);
    from = i;
  }
  return bounds;
}

}  // namespace obscura::gl

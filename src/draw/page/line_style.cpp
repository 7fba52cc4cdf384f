#include "draw/page/line_style.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <utility>

namespace obscura::draw {
namespace {

// dashes and gaps along a line, points; one after another
const std::vector<std::vector<double>> kDashes = {{},       {5, 2.2},  {1.2, 1.8}, {6, 1.8, 1.2, 1.8},
                                                  {9, 2.5}, {2.6, 1.4}};
constexpr int kMarkers = 4;
constexpr double kMarkersApart = 46, kFirstMarker = 12;  // points along a line
constexpr double kNextLine = 7;       // points: so much later the next line's first marker is
constexpr double kAlongRadius = 2.1;  // points
// what runs so near to a line, so far along it from there, and in its direction but for this sine, lies on it
constexpr double kOnIt = 0.3, kFurther = 4, kAslant = 0.3;  // points

const std::vector<double>& dashes_of(int style) { return kDashes[std::size_t(style) % kDashes.size()]; }

// The pieces of a line, by the squares of the page through which they go.
class Drawn {
 public:
  explicit Drawn(double point) : point_(point) {}

  // `along`: page units of the line up to the end of the piece
  void add(const Point& from, const Point& to, double along) {
    const double steps = std::max(1.0, std::ceil((to - from).norm() / (0.5 * kFurther * point_)));
    std::pair<long, long> before{0, 0};
    for (double k = 0; k <= steps; ++k) {
      const auto square = square_of(from + k / steps * (to - from));
      if (k == 0 || square != before) pieces_[square].push_back({from, to, along});
      before = square;
    }
  }

  // whether a place, to which the line comes in this direction after so many page units, is on one
  bool has(const Point& at, const Point& direction, double along) const {
    const auto [x, y] = square_of(at);
    for (long i = x - 1; i <= x + 1; ++i)
      for (long j = y - 1; j <= y + 1; ++j) {
        const auto found = pieces_.find({i, j});
        if (found == pieces_.end()) continue;
        for (const Piece& each : found->second) {
          const Point way = each.to - each.from;
          const double length = way.norm();
          if (along - each.along < kFurther * point_ || !(length > 0)) continue;
          const double off = std::abs(way.x() * direction.y() - way.y() * direction.x()) / length;
          const double u = std::clamp((at - each.from).dot(way) / (length * length), 0.0, 1.0);
          if (off < kAslant && (at - each.from - u * way).norm() < kOnIt * point_) return true;
        }
      }
    return false;
  }

 private:
  struct Piece {
    Point from, to;
    double along;
  };
  std::pair<long, long> square_of(const Point& p) const {
    const double side = kFurther * point_;
    return {std::lround(p.x() / side), std::lround(p.y() / side)};
  }

  double point_;
  std::map<std::pair<long, long>, std::vector<Piece>> pieces_;
};

}  // namespace

std::vector<std::vector<Node>> once(const std::vector<Node>& nodes, double point) {
  std::vector<std::vector<Node>> pieces{{nodes.front()}};
  Drawn drawn(point);
  double along = 0;
  bool on_it = false, apart = false;
  for (std::size_t i = 1; i < nodes.size(); ++i) {
    const Point &from = nodes[i - 1].at, &to = nodes[i].at;
    const double length = (to - from).norm();
    if (!(length > 0)) continue;
    along += length;
    const bool before = std::exchange(on_it, drawn.has(to, (to - from) / length, along));
    if (before && on_it) {
      apart = true;
      continue;
    }
    if (std::exchange(apart, false)) pieces.push_back({nodes[i - 1]});
    pieces.back().push_back(nodes[i]);
    drawn.add(from, to, along);
  }
  return pieces;
}

int marker_of(int style) { return style / int(kDashes.size()) % kMarkers; }

// styles that share their dashes have different ones, up to the sixteenth and beyond
int value_marker_of(int style) { return (style + style / 12) % kMarkers; }

void add_marker(int marker, const Point& at, double radius, Color color, List& list) {
  const auto corners = [&](int count, double first, double size) {
    std::vector<Point> all;
    for (int k = 0; k < count; ++k) {
      const double a = first + 2 * std::numbers::pi * k / count;
      all.push_back(at + size * radius * Point(std::cos(a), -std::sin(a)));
    }
    list.add(all, color);
  };
  switch (marker) {
    case 0:
      list.add(Disc{at, radius, 0, color, color});
      break;
    case 1:
      corners(4, std::numbers::pi / 4, 1.3);
      break;
    case 2:
      corners(3, std::numbers::pi / 2, 1.5);
      break;
    default:
      corners(4, 0, 1.5);
      break;
  }
}

void add_dashed(const std::vector<Node>& nodes, int style, double point, List& list) {
  const std::vector<double>& dashes = dashes_of(style);
  if (dashes.empty()) {
    list.add(nodes, Cap::round);
    return;
  }
  std::size_t which = 0;
  double left = dashes[0] * point;
  std::vector<Node> dash{nodes.front()};
  for (std::size_t i = 0; i + 1 < nodes.size(); ++i) {
    Point from = nodes[i].at;
    const Point to = nodes[i + 1].at;
    for (double way = (to - from).norm(); way > left; way = (to - from).norm()) {
      from += left / way * (to - from);
      Node node = nodes[i];
      node.at = from;
      if (which % 2 == 0) {
        dash.push_back(node);
        list.add(dash, Cap::butt);
      }
      dash = {node};
      which = (which + 1) % dashes.size();
      left = dashes[which] * point;
    }
    left -= (to - from).norm();
    if (which % 2 == 0) dash.push_back(nodes[i + 1]);
  }
  if (which % 2 == 0 && dash.size() > 1) list.add(dash, Cap::butt);
}

void add_markers_along(const std::vector<Node>& nodes, int style, double point, List& list) {
  const int marker = marker_of(style);
  if (marker == 0) return;
  double left = (kFirstMarker + kNextLine * (style % int(kDashes.size()))) * point;
  for (std::size_t i = 0; i + 1 < nodes.size(); ++i) {
    Point from = nodes[i].at;
    const Point to = nodes[i + 1].at;
    for (double way = (to - from).norm(); way > left; way = (to - from).norm()) {
      from += left / way * (to - from);
      add_marker(marker, from, kAlongRadius * point, nodes[i].color, list);
      left = kMarkersApart * point;
    }
    left -= (to - from).norm();
  }
}

}  // namespace obscura::draw

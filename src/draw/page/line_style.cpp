#include "draw/page/line_style.h"

#include <cmath>
#include <numbers>

namespace obscura::draw {
namespace {

// dashes and gaps along a line, points; one after another
const std::vector<std::vector<double>> kDashes = {{},       {5, 2.2},  {1.2, 1.8}, {6, 1.8, 1.2, 1.8},
                                                  {9, 2.5}, {2.6, 1.4}};
constexpr int kMarkers = 4;
constexpr double kMarkersApart = 46, kFirstMarker = 12;  // points along a line
constexpr double kNextLine = 7;       // points: so much later the next line's first marker is
constexpr double kAlongRadius = 2.1;  // points

const std::vector<double>& dashes_of(int style) { return kDashes[std::size_t(style) % kDashes.size()]; }

}  // namespace

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

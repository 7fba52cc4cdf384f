// The cost of a place: the length of the lines that run through its rectangle, each by its weight, the area
// it shares with other words, and its distance from the usual place. A place that leaves the page is
// excluded.

#include "draw/page/placing.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

namespace obscura::draw {
namespace {

/// How much of a segment lies within a rectangle, by clipping it at each side.
double within(const Point& a, const Point& b, const Rect& r) {
  double from = 0, to = 1;
  const Point d = b - a;
  const std::array<std::pair<double, double>, 4> sides{{{-d.x(), a.x() - r.x},
                                                        {d.x(), r.x + r.width - a.x()},
                                                        {-d.y(), a.y() - r.y},
                                                        {d.y(), r.y + r.height - a.y()}}};
  for (const auto& [p, q] : sides) {
    if (p == 0) {
      if (q < 0) return 0;
    } else if (p < 0) {
      from = std::max(from, q / p);
    } else {
      to = std::min(to, q / p);
    }
  }
  return from < to ? (to - from) * d.norm() : 0;
}

double shared(const Rect& a, const Rect& b) {
  const double w = std::min(a.x + a.width, b.x + b.width) - std::max(a.x, b.x);
  const double h = std::min(a.y + a.height, b.y + b.height) - std::max(a.y, b.y);
  return w > 0 && h > 0 ? w * h : 0;
}

/// From a point to the middle of a label of `size` that just clears it in direction n.
Point clear(const Point& n, double gap, const Point& size) {
  return n * gap + Point(n.x() * size.x() / 2, n.y() * size.y() / 2);
}

}  // namespace

void Placing::avoid(const Point& a, const Point& b, double weight) { lines_.push_back({a, b, weight}); }

double Placing::cost(const Rect& rect) const {
  double sum = 0;
  for (const Line& line : lines_) sum += line.weight * within(line.a, line.b, rect);
  for (const Rect& other : taken_) {
    if (const double area = shared(rect, other); area > 0) sum += 200 + area;
  }
  const bool outside = rect.x < page_.x || rect.y < page_.y || rect.x + rect.width > page_.x + page_.width ||
                       rect.y + rect.height > page_.y + page_.height;
  return outside ? sum + 1e6 : sum;
}

Placing::Candidate Placing::place(const Point& size, const std::vector<Candidate>& candidates) {
  const auto rect = [&](const Candidate& c, double margin) {
    return Rect{c.center.x() - size.x() / 2 - margin, c.center.y() - size.y() / 2 - margin,
                size.x() + 2 * margin, size.y() + 2 * margin};
  };
  const double margin = 0.12 * size.y();
  const auto best =
      std::min_element(candidates.begin(), candidates.end(), [&](const Candidate& a, const Candidate& b) {
        return a.cost + cost(rect(a, margin)) < b.cost + cost(rect(b, margin));
      });
  taken_.push_back(rect(*best, margin));
  return *best;
}

std::vector<Placing::Candidate> Placing::around(const Point& at, double gap, const Point& size, double unit) {
  // up to the right first, as on a map
  constexpr std::array<double, 16> angles{45, 135, -45, -135, 25,  155,  0,   180,
                                          65, 115, 90,  -90,  -25, -155, -65, -115};
  std::vector<Candidate> all;
  double ring = 0;
  for (const double off : {0.0, 5.0, 10.0, 16.0, 24.0, 34.0}) {
    double order = 0;
    for (const double angle : angles) {
      const double a = angle * std::numbers::pi / 180;
      const Point n(std::cos(a), -std::sin(a));
      all.push_back({at + clear(n, gap + off * unit, size), ring + order, off > 6});
      order += 0.25 * unit;
    }
    ring += 8 * unit + (off > 0 ? 6 * unit : 0);
  }
  return all;
}

std::vector<Placing::Candidate> Placing::along(const Point& tail, const Point& tip, double gap,
                                               const Point& size, double unit) {
  const Point u = (tip - tail).normalized(), v(-u.y(), u.x());
  std::vector<Candidate> all;
  double ring = 0;
  for (const double off : {0.0, 3.0, 8.0, 15.0}) {
    double order = 0;
    for (const double part : {0.85, 0.7, 0.55, 1.0, 0.4, 0.25}) {
      const Point at = tail + part * (tip - tail);
      // to the right of an arrow that points up
      for (const double side : {u.y() < 0 ? 1.0 : -1.0, u.y() < 0 ? -1.0 : 1.0}) {
        all.push_back({at + clear(side * v, gap + off * unit, size), ring + order, off > 6});
        order += 0.3 * unit;
      }
    }
    all.push_back({tip + clear(u, gap, size), ring + 1.5 * unit, false});
    ring += 8 * unit;
  }
  return all;
}

}  // namespace obscura::draw

// The cost of a place: the length of the lines that run through its rectangle, each by its weight, and its
// distance from the usual place; of words that are placed together also the area that they share and what
// their leaders cross. Of these, places that leave the page are excluded.

#include "draw/page/placing.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <numeric>

namespace obscura::draw {
namespace {

constexpr double kPast = 3;        // units: the cost of words past an arrow's tip, beside its line
constexpr double kBehind = 6;      // units: the cost of words behind an arrow's tail
constexpr double kStill = 14;      // units: of words that stand still while their arrow swings
constexpr double kFarther = 14;    // units: of those as far from the tail as the arrow is long
constexpr double kAgainst = 10;    // units: of those against their arrow
constexpr double kBeginsOn = 0.5;  // page units: so near it begins on an arrow
constexpr double kOffPage = 1e6;   // the cost of words that leave the page
// page units: the cost of words on others, of a leader across an arrow or another body, of one through other
// words, and of two that cross
constexpr double kOnWords = 200, kLedAcross = 48, kThroughWords = 240, kCrossing = 160;
constexpr int kRounds = 8;               // in which words that are placed together go to better places
constexpr std::size_t kManyWords = 150;  // of more each is placed once

/// How much of a segment lies within a rectangle.
double within(const Point& a, const Point& b, const Rect& rect) {
  const auto part = part_within(a, b, rect);
  return part ? (part->second - part->first) * (b - a).norm() : 0;
}

/// Whether two segments cross.
bool cross(const Point& a, const Point& b, const Point& c, const Point& d) {
  const auto side = [](const Point& p, const Point& q, const Point& r) {
    return (q.x() - p.x()) * (r.y() - p.y()) - (q.y() - p.y()) * (r.x() - p.x());
  };
  return side(a, b, c) * side(a, b, d) < 0 && side(c, d, a) * side(c, d, b) < 0;
}

double shared(const Rect& a, const Rect& b) {
  const double w = std::min(a.x + a.width, b.x + b.width) - std::max(a.x, b.x);
  const double h = std::min(a.y + a.height, b.y + b.height) - std::max(a.y, b.y);
  return w > 0 && h > 0 ? w * h : 0;
}

/// Whether two rectangles have a point in common.
bool meet(const Rect& a, const Rect& b) {
  return a.x <= b.x + b.width && b.x <= a.x + a.width && a.y <= b.y + b.height && b.y <= a.y + a.height;
}

/// Whether a convex polygon has a point, whichever way its corners go.
bool inside(const std::vector<Point>& outline, const Point& p) {
  bool left = false, right = false;
  for (std::size_t k = 0; k < outline.size(); ++k) {
    const Point &a = outline[k], &b = outline[(k + 1) % outline.size()];
    const double side = (b.x() - a.x()) * (p.y() - a.y()) - (b.y() - a.y()) * (p.x() - a.x());
    left = left || side > 0, right = right || side < 0;
  }
  return !(left && right);
}

/// Which part of its half size a label in direction n is moved by: aslant it stands with its corner at the
/// point.
Point part_of_half(const Point& n) {
  return (std::numbers::sqrt2 * n).cwiseMax(Point(-1, -1)).cwiseMin(Point(1, 1));
}

/// From a point to the middle of a label of `size` that just clears it in direction n.
Point clear(const Point& n, double gap, const Point& size) {
  return n * gap + part_of_half(n).cwiseProduct(size) / 2;
}

/// The same for a label that clears the whole line across n: no corner of it reaches over.
Point clear_line(const Point& n, double gap, const Point& size) {
  const Point part = n.cwiseAbs();
  const double corner = (part.array() * (1 - part.array()) * size.array()).sum() / 2;
  return n * (gap + corner) + n.cwiseProduct(size) / 2;
}

}  // namespace

// by clipping it at each side
std::optional<std::pair<double, double>> part_within(const Point& a, const Point& b, const Rect& r) {
  if (std::max(a.x(), b.x()) < r.x || std::min(a.x(), b.x()) > r.x + r.width ||
      std::max(a.y(), b.y()) < r.y || std::min(a.y(), b.y()) > r.y + r.height)
    return std::nullopt;
  double from = 0, to = 1;
  const Point d = b - a;
  const std::array<std::pair<double, double>, 4> sides{{{-d.x(), a.x() - r.x},
                                                        {d.x(), r.x + r.width - a.x()},
                                                        {-d.y(), a.y() - r.y},
                                                        {d.y(), r.y + r.height - a.y()}}};
  for (const auto& [p, q] : sides) {
    if (p == 0) {
      if (q < 0) return std::nullopt;
    } else if (p < 0) {
      from = std::max(from, q / p);
    } else {
      to = std::min(to, q / p);
    }
  }
  if (!(from < to)) return std::nullopt;
  return std::pair(from, to);
}

void Placing::avoid(const Point& a, const Point& b, double weight, bool arrow) {
  lines_.push_back({a, b, weight, arrow});
}

void Placing::avoid(const std::vector<Point>& area, double cost, std::optional<double> led) {
  if (area.size() < 3) return;
  Point low = area[0], high = area[0];
  for (const Point& p : area) low = low.cwiseMin(p), high = high.cwiseMax(p);
  areas_.push_back(
      {area, {low.x(), low.y(), high.x() - low.x(), high.y() - low.y()}, cost, led.value_or(cost)});
}

double Placing::lines(const Rect& rect) const {
  double sum = 0;
  for (const Line& line : lines_) sum += line.weight * within(line.a, line.b, rect);
  // of an area as much as covers places spread over the rectangle
  constexpr int kAcross = 5, kDown = 3;
  for (const Area& area : areas_) {
    if (shared(rect, area.around) <= 0) continue;
    int covered = 0;
    for (int i = 0; i < kAcross * kDown; ++i)
      covered += inside(area.outline, {rect.x + rect.width * (i % kAcross) / (kAcross - 1),
                                       rect.y + rect.height * int(i / kAcross) / (kDown - 1)});
    sum += area.cost * covered / (kAcross * kDown);
  }
  return sum;
}

bool Placing::on_page(const Rect& rect) const {
  return rect.x >= page_.x && rect.y >= page_.y && rect.x + rect.width <= page_.x + page_.width &&
         rect.y + rect.height <= page_.y + page_.height;
}

Rect Placing::rect_of(const Point& size, const Candidate& c) const {
  const double margin = margin_ * size.y();
  return {c.center.x() - size.x() / 2 - margin, c.center.y() - size.y() / 2 - margin, size.x() + 2 * margin,
          size.y() + 2 * margin};
}

double Placing::cost(const Point& size, const Candidate& candidate) const {
  return candidate.cost + lines(rect_of(size, candidate));
}

double Placing::leading(const Point& anchor, const Point& size, const Point& center, double crossing) const {
  const Point way = center - anchor;
  const double across = std::min(size.x() / 2 / std::max(std::abs(way.x()), 1e-9),
                                 size.y() / 2 / std::max(std::abs(way.y()), 1e-9));
  if (!(across < 1)) return 0;
  const Point end = anchor + (1 - across) * way;
  double sum = 0;
  for (const Line& line : lines_) {
    if (!line.arrow) continue;
    const Point d = line.b - line.a, from = anchor - line.a, to = end - line.a;
    const double here = d.x() * from.y() - d.y() * from.x(), there = d.x() * to.y() - d.y() * to.x();
    // what begins on it does not cross it
    if (std::abs(here) < kBeginsOn * d.norm() || (here < 0) == (there < 0)) continue;
    const Point at = from + here / (here - there) * (to - from);
    if (const double part = at.dot(d); part > 0 && part < d.squaredNorm()) sum += crossing;
  }
  constexpr int kPieces = 8;
  const Point low = anchor.cwiseMin(end), high = anchor.cwiseMax(end);
  const Rect around{low.x(), low.y(), high.x() - low.x(), high.y() - low.y()};
  for (const Area& area : areas_) {
    if (!meet(around, area.around)) continue;
    if (area.led < crossing || inside(area.outline, anchor)) continue;
    int covered = 0;
    for (int i = 1; i <= kPieces; ++i)
      covered += inside(area.outline, anchor + i * (1 - across) / kPieces * way);
    if (covered > 0) sum += crossing + area.led * covered / kPieces;
  }
  return sum;
}

// the cost of two places that words have at once
double Placing::together(const Words& a, const Candidate& at, const Words& b, const Candidate& other) const {
  const Rect own = rect_of(a.size, at), its = rect_of(b.size, other);
  double cost = 0;
  if (const double area = shared(own, its); area > 0) cost += kOnWords + area;
  if (at.leader && within(at.center, at.end, its) > 0) cost += kThroughWords;
  if (other.leader && within(other.center, other.end, own) > 0) cost += kThroughWords;
  if (at.leader && other.leader && cross(at.center, at.end, other.center, other.end)) cost += kCrossing;
  return cost;
}

// One after another has the place of least cost beside those that have one; then each goes on to a better
// place until none has any. Both orders are tried, for what comes first has the choice.
std::vector<Placing::Candidate> Placing::place(std::vector<Words> all) const {
  for (Words& words : all) {
    for (Candidate& each : words.places) {
      const Rect rect = rect_of(words.size, each);
      each.cost += lines(rect) + (on_page(rect) ? 0 : kOffPage);
      if (each.leader) each.cost += leading(each.end, words.size, each.center, kLedAcross);
    }
    std::stable_sort(words.places.begin(), words.places.end(),
                     [](const Candidate& a, const Candidate& b) { return a.cost < b.cost; });
  }
  using Choice = std::vector<std::optional<std::size_t>>;
  const auto beside_others = [&](std::size_t i, const Candidate& each, const Choice& chosen, double most) {
    double cost = each.cost;
    for (std::size_t j = 0; j < all.size() && cost < most; ++j)
      if (j != i && chosen[j]) cost += together(all[i], each, all[j], all[j].places[*chosen[j]]);
    return cost;
  };
  const auto best = [&](std::size_t i, const Choice& chosen) {
    double least = std::numeric_limits<double>::infinity();
    std::size_t found = 0;
    for (std::size_t k = 0; k < all[i].places.size() && all[i].places[k].cost < least; ++k)
      if (const double cost = beside_others(i, all[i].places[k], chosen, least); cost < least)
        least = cost, found = k;
    return found;
  };
  std::vector<std::size_t> order(all.size());
  std::iota(order.begin(), order.end(), 0);
  Choice best_choice;
  double least = std::numeric_limits<double>::infinity();
  const bool many = all.size() > kManyWords;
  for (int turn = 0; turn < (many ? 1 : 2); ++turn, std::reverse(order.begin(), order.end())) {
    Choice chosen(all.size());
    bool moved = true;
    for (int round = 0; round < (many ? 1 : kRounds) && moved; ++round) {
      moved = false;
      for (const std::size_t i : order)
        if (const std::size_t k = best(i, chosen); chosen[i] != k) chosen[i] = k, moved = true;
    }
    double cost = 0;
    for (std::size_t i = 0; i < all.size(); ++i) {
      const Candidate& own = all[i].places[*chosen[i]];
      cost += own.cost;
      for (std::size_t j = 0; j < i; ++j) cost += together(all[i], own, all[j], all[j].places[*chosen[j]]);
    }
    if (cost < least) least = cost, best_choice = std::move(chosen);
  }
  std::vector<Candidate> found;
  for (std::size_t i = 0; i < all.size(); ++i) found.push_back(all[i].places[*best_choice[i]]);
  return found;
}

Point Placing::beyond(const Point& at, const Point& n, double gap, const Point& size) {
  return at + clear(n, gap, size);
}

double Placing::off_line(const Point& center, const Point& size, const Point& a, const Point& b) {
  const Rect rect{center.x() - size.x() / 2, center.y() - size.y() / 2, size.x(), size.y()};
  if (within(a, b, rect) > 0) return 0;
  const auto off_rect = [&](const Point& p) {
    return ((p - center).cwiseAbs() - size / 2).cwiseMax(Point(0, 0)).norm();
  };
  double least = std::min(off_rect(a), off_rect(b));
  const Point way = b - a;
  for (int corner = 0; corner < 4 && way.squaredNorm() > 0; ++corner) {
    const Point p = center + Point(corner & 1 ? 0.5 : -0.5, corner & 2 ? 0.5 : -0.5).cwiseProduct(size);
    const double part = std::clamp((p - a).dot(way) / way.squaredNorm(), 0.0, 1.0);
    least = std::min(least, (p - a - part * way).norm());
  }
  return least;
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
                                               const Point& size, double unit, bool fixed,
                                               std::optional<double> past) {
  const Point u = (tip - tail).normalized(), v(-u.y(), u.x());
  const Point out = tail + std::max((tip - tail).norm(), past.value_or(0)) * u;
  std::vector<Candidate> all;
  double ring = 0;
  for (const double off : {0.0, 3.0, 8.0, 15.0, 24.0}) {
    double order = 0;
    for (const double part : {0.85, 0.7, 0.55, 1.0, 0.4, 0.25}) {
      const Point at = tail + part * (tip - tail);
      // to the right of an arrow that points up
      const double first = fixed || u.y() < 0 ? 1 : -1;
      for (const double side : {first, -first}) {
        const Point n = side * v;
        const double far = gap + off * unit;
        all.push_back({at + clear_line(n, far, size), ring + order, off > (fixed ? 10 : 6)});
        order += 0.3 * unit;
      }
    }
    all.push_back({tip + clear(u, gap, size), ring + 1.5 * unit, false});
    // past it and beside its line
    if (past && off < 4)
      for (const double side : {1.0, -1.0})
        all.push_back(
            {out + (gap + off * unit + u.cwiseAbs().dot(size) / 2) * u + clear_line(side * v, gap, size),
             ring + kPast * unit, false});
    if (off > 6) all.push_back({tail + clear(-u, gap + off * unit, size), ring + kBehind * unit, true});
    ring += 8 * unit;
  }
  // where many arrows leave one body: beyond its outline
  const double along = u.cwiseAbs().dot(size) / 2;
  for (const double off : {36.0, 52.0, 70.0}) {
    for (const double side : {1.0, -1.0}) {
      for (const double part : {1.0, 0.4})
        all.push_back(
            {tail + part * (tip - tail) + clear_line(side * v, gap + off * unit, size), ring, true});
      // beside its line, as of an arrow along the ground
      all.push_back({tip + (gap + off * unit / 2 + along) * u + clear_line(side * v, gap, size), ring, true});
      // aslant, past what lies beside it
      all.push_back({tip + (gap + off * unit / 2 + along) * u + clear_line(side * v, gap + off * unit, size),
                     ring + 2 * unit, true});
    }
    all.push_back({tip + clear(u, gap + off * unit / 2, size), ring, true});
    // and behind it
    all.push_back({tail + clear(-u, gap + off * unit, size), ring + kBehind * unit, true});
    for (const double side : {1.0, -1.0})
      all.push_back({tail - (gap + off * unit / 2 + along) * u + clear_line(side * v, gap, size),
                     ring + kBehind * unit, true});
    ring += 6 * unit;
  }
  return all;
}

std::vector<Placing::Candidate> Placing::beside_swing(const Point& tail, const Point& tip, double reach,
                                                      double longest, double gap, const Point& size,
                                                      double unit) {
  constexpr int kAround = 8;
  const Point u = (tip - tail).norm() > 0 ? Point((tip - tail).normalized()) : Point(0, 0);
  std::vector<Candidate> all;
  for (const double part : {1.0, 0.6, 0.3, 0.0})
    for (int k = 0; k < kAround; ++k) {
      const double a = (k + 0.5) * 2 * std::numbers::pi / kAround;
      const Point n(std::cos(a), -std::sin(a));
      all.push_back({tail + clear(n, reach + part * longest + gap, size),
                     (kStill + kFarther * part + kAgainst * std::max(0.0, -u.dot(n))) * unit, true});
    }
  return all;
}

}  // namespace obscura::draw

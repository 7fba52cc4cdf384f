// Names of lines that go anywhere, as in a plot against a quantity. A name has a place at each side of its
// head. At an instant place i costs c_i: how much of it lies on lines as they are then, on heads and on other
// names. The course i(t) is the one of least
//   integral of c_i dt / T + a for each change
// which dynamic programming finds (Viterbi). Names are planned one after another; the earlier ones are in the
// way of the later ones. What lines cover is kept in cells, each with the first instant at which it is
// covered, for lines only grow.

#include "draw/page/names_around.h"

#include <algorithm>
#include <cmath>

namespace obscura::draw {
namespace {

constexpr std::size_t kInstants = 480;                                    // of a run that are looked at
constexpr double kCell = 2;                                               // points
constexpr double kOnLine = 12, kOnHead = 8, kOnName = 30, kOutside = 30;  // costs of lying wholly there
constexpr double kTouched = 2;                                            // and of touching a line at all
constexpr double kAnotherSide = 0.06;                                     // of a change of sides
constexpr double kMostTouched = 0.02;  // of the run: a name that lies on something for longer is not clear
constexpr std::size_t kMostChanges = 8;
constexpr double kHeadRadius = 3.5;  // points, with its halo

Rect box_at(const Point& head, const Point& offset, const Point& size) {
  return {head.x() + offset.x(), head.y() + offset.y() - size.y() / 2, size.x(), size.y()};
}

/// The part of a rectangle that lies on another.
double part_on(const Rect& a, const Rect& b) {
  const double wide = std::min(a.x + a.width, b.x + b.width) - std::max(a.x, b.x),
               high = std::min(a.y + a.height, b.y + b.height) - std::max(a.y, b.y);
  return wide > 0 && high > 0 ? wide * high / (a.width * a.height) : 0;
}

/// The places of a name, the usual ones first, each with the cost of being less usual.
struct Side {
  Point offset;
  double cost;
};
std::vector<Side> sides(const Point& size, double gap) {
  const double w = size.x(), up = 0.75 * gap + size.y() / 2, aslant = 0.7 * gap;
  return {{{gap, 0}, 0},
          {{aslant, -up}, 0.2},
          {{aslant, up}, 0.2},
          {{-gap - w, 0}, 0.3},
          {{-aslant - w, -up}, 0.35},
          {{-aslant - w, up}, 0.35},
          {{-w / 2, -gap - size.y() / 2}, 0.35},
          {{-w / 2, gap + size.y() / 2}, 0.35},
          {{-w / 2, -gap - 1.5 * size.y()}, 1.2},
          {{-w / 2, gap + 1.5 * size.y()}, 1.2}};
}

/// When a part of the page is first covered by a line.
class Covered {
 public:
  Covered(const Rect& bounds, double cell)
      : bounds_(bounds),
        cell_(cell),
        across_(std::size_t(std::max(1.0, std::ceil(bounds.width / cell)))),
        down_(std::size_t(std::max(1.0, std::ceil(bounds.height / cell)))),
        first_(across_ * down_, SIZE_MAX) {}

  void add(const Point& from, const Point& to, std::size_t instant) {
    const double steps = std::max(1.0, std::ceil((to - from).norm() / (0.5 * cell_)));
    for (double k = 0; k <= steps; ++k) {
      const Point p = from + k / steps * (to - from);
      const double x = (p.x() - bounds_.x) / cell_, y = (p.y() - bounds_.y) / cell_;
      if (!(x >= 0 && y >= 0 && x < double(across_) && y < double(down_))) continue;
      std::size_t& first = first_[std::size_t(y) * across_ + std::size_t(x)];
      first = std::min(first, instant);
    }
  }

  /// How many cells of a row as wide as the rectangle are covered at an instant, of one.
  double part(const Rect& rect, std::size_t instant) const {
    const auto index = [&](double at, std::size_t count) {
      return std::size_t(std::clamp(at / cell_, 0.0, double(count)));
    };
    const std::size_t left = index(rect.x - bounds_.x, across_),
                      right = index(rect.x + rect.width - bounds_.x + cell_, across_),
                      top = index(rect.y - bounds_.y, down_),
                      bottom = index(rect.y + rect.height - bounds_.y + cell_, down_);
    std::size_t cells = 0;
    for (std::size_t y = top; y < bottom; ++y)
      for (std::size_t x = left; x < right; ++x) cells += first_[y * across_ + x] <= instant;
    return std::min(1.0, double(cells) * cell_ / rect.width);
  }

 private:
  Rect bounds_;
  double cell_;
  std::size_t across_, down_;
  std::vector<std::size_t> first_;
};

}  // namespace

NamesAround names_around(const std::vector<std::vector<Point>>& heads, const std::vector<Point>& sizes,
                         const Rect& bounds, double gap, double unit) {
  const std::size_t n = heads.size(), count = sizes.size();
  NamesAround found;
  found.offsets.assign(count, std::vector<Point>(n, Point(gap, 0)));
  found.changes.resize(count);
  if (n == 0) return found;

  Covered covered(bounds, kCell * unit);
  for (std::size_t i = 0; i < count; ++i)
    for (std::size_t k = 1; k < n; ++k) covered.add(heads[k - 1][i], heads[k][i], k);

  const std::size_t stride = n / kInstants + 1, samples = (n - 1) / stride + 1;
  std::vector<std::vector<Rect>> taken(samples);  // by names that are planned
  for (std::size_t line = 0; line < count; ++line) {
    const std::vector<Side> all = sides(sizes[line], gap);
    const auto clash = [&](std::size_t s, const Side& side) {
      const std::size_t k = s * stride;
      const Rect box = box_at(heads[k][line], side.offset, sizes[line]);
      double cost = kOutside * (1 - part_on(box, bounds));
      if (const double part = covered.part(box, k); part > 0) cost += kTouched + kOnLine * part;
      const double radius = kHeadRadius * unit;
      for (std::size_t other = 0; other < count; ++other) {
        const Point& head = heads[k][other];
        if (other == line) continue;
        if (const double part = part_on(box, {head.x() - radius, head.y() - radius, 2 * radius, 2 * radius});
            part > 0)
          cost += kTouched + kOnHead * part;
      }
      for (const Rect& name : taken[s])
        if (const double part = part_on(box, name); part > 0) cost += kTouched + kOnName * part;
      return cost < 1e-9 ? 0.0 : cost;
    };

    // the course of least cost; ties stay
    std::vector<double> best(all.size(), 0), now(all.size());
    std::vector<std::vector<double>> clashes(samples, std::vector<double>(all.size()));
    std::vector<std::vector<std::size_t>> from(samples, std::vector<std::size_t>(all.size()));
    for (std::size_t s = 0; s < samples; ++s) {
      const auto cheapest = std::size_t(std::min_element(best.begin(), best.end()) - best.begin());
      for (std::size_t i = 0; i < all.size(); ++i) {
        const bool stays = s == 0 || best[i] <= best[cheapest] + kAnotherSide;
        from[s][i] = stays ? i : cheapest;
        clashes[s][i] = clash(s, all[i]);
        now[i] = (stays ? best[i] : best[cheapest] + kAnotherSide) +
                 (all[i].cost + clashes[s][i]) / double(samples);
      }
      best = now;
    }
    std::vector<std::size_t> place(samples);
    place.back() = std::size_t(std::min_element(best.begin(), best.end()) - best.begin());
    for (std::size_t s = samples - 1; s > 0; --s) place[s - 1] = from[s][place[s]];

    std::size_t touched = 0;
    for (std::size_t s = 0; s < samples; ++s) {
      touched += clashes[s][place[s]] > 0;
      taken[s].push_back(box_at(heads[s * stride][line], all[place[s]].offset, sizes[line]));
      for (std::size_t k = s * stride; k < std::min(n, (s + 1) * stride); ++k)
        found.offsets[line][k] = all[place[s]].offset;
      if (s > 0 && place[s] != place[s - 1]) found.changes[line].push_back(s * stride);
    }
    found.clear = found.clear && double(touched) <= kMostTouched * double(samples) &&
                  found.changes[line].size() <= kMostChanges;
  }
  return found;
}

}  // namespace obscura::draw

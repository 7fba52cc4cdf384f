#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

#include "draw/plane/stage.h"

namespace obscura::draw {
namespace {

constexpr double kAppear = 0.4, kLeave = 0.4;  // s before the press and after the release
constexpr double kStep = 14, kWayDot = 2.1;    // of the dotted path, page units
constexpr double kWayLasts = 0.7;              // s: how long the path stays behind the hand
constexpr double kPointerEdge = 2.4;           // the pointer's outline

Color faded(Color c, double alpha) {
  c.a = std::uint8_t(std::lround(c.a * std::clamp(alpha, 0.0, 1.0)));
  return c;
}

// The pointer, its tip at the origin, in page units. The points within its long edges draw the mean up to
// where it sees every other.
const std::vector<Point> kPointer{{0, 0},       {0, 10},      {0, 20},      {0, 29},
                                  {6.55, 22.9}, {11.4, 33.6}, {16.4, 31.4}, {11.75, 20.8},
                                  {21, 20.8},   {14, 13.87},  {7, 6.93}};

std::vector<Point> placed(const std::vector<Point>& form, const Point& at, double scale) {
  std::vector<Point> points;
  for (const Point& p : form) points.push_back(at + scale * p);
  return points;
}

/// Dots at equal distances along the way that the hand has just gone, fainter the older they are. A way that
/// comes back over itself is dotted once.
void dot_way(const sim::SceneInfo::Mouse& mouse, const Stage& stage, const View& view, double time,
             double alpha, List& list) {
  const double step = kStep * stage.layout.weight, radius = kWayDot * stage.layout.weight;
  const double lasts = mouse.release - mouse.press;
  const std::size_t n = mouse.path.size();
  // which dots lie in a square of the page, a step wide
  std::map<std::pair<int, int>, std::vector<Point>> dotted;
  auto square = [&](double x) { return int(std::floor(x / step)); };
  auto taken = [&](const Point& p) {
    for (int i = -1; i <= 1; ++i) {
      for (int j = -1; j <= 1; ++j) {
        const auto there = dotted.find({square(p.x()) + i, square(p.y()) + j});
        if (there == dotted.end()) continue;
        for (const Point& q : there->second) {
          if ((q - p).norm() < 0.8 * step) return true;
        }
      }
    }
    return false;
  };
  double gone = 0, next = 0;
  for (std::size_t i = 0; i + 1 < n; ++i) {
    const Point a = view.page(mouse.path[i]), b = view.page(mouse.path[i + 1]);
    const double length = (b - a).norm();
    for (; next <= gone + length && length > 0; next += step) {
      const double part = (next - gone) / length;
      const Point at = a + part * (b - a);
      const double when = mouse.press + lasts * (double(i) + part) / double(n - 1);
      const double strength = 1 - (time - when) / kWayLasts;
      if (when > time || !(strength > 0)) continue;
      if (outside(view.window, at, step) || taken(at)) continue;
      dotted[{square(at.x()), square(at.y())}].push_back(at);
      const Color color = faded(stage.colours.way, alpha * strength);
      list.add(Disc{at, radius, 0, color, color});
    }
    gone += length;
  }
}

/// A mouse that is shown, where its pointer is, and how strongly: it appears before the press and leaves
/// after the release.
struct Hand {
  std::size_t mouse;
  Point at;
  double alpha;
};

std::vector<Hand> hands(const Stage& stage, const View& view, const sim::Snapshot& now) {
  std::vector<Hand> found;
  if (!stage.look.pointer) return found;
  for (std::size_t i = 0; i < now.mice.size() && i < stage.cast.mice.size(); ++i) {
    const sim::SceneInfo::Mouse& mouse = stage.cast.mice[i];
    if (mouse.path.empty()) continue;
    const double alpha = shown(mouse, now.time);
    if (alpha > 0) found.push_back({i, view.page(pointer(mouse, now.mice[i], now.time)), alpha});
  }
  return found;
}

}  // namespace

double shown(const sim::SceneInfo::Mouse& mouse, double time) {
  const double before = mouse.press - time, after = time - mouse.release;
  return std::clamp(std::min(1 - before / kAppear, 1 - after / kLeave), 0.0, 1.0);
}

sim::Vec3 pointer(const sim::SceneInfo::Mouse& mouse, const sim::Snapshot::Mouse& now, double time) {
  return time < mouse.press ? mouse.path.front() : time > mouse.release ? mouse.path.back() : now.pointer;
}

void draw_pointer(const Point& at, double alpha, double weight, const Palette& colours, List& list) {
  std::vector<Node> around;
  for (const Point& p : placed(kPointer, at, weight))
    around.push_back({p, 2 * kPointerEdge * weight, faded(colours.room, alpha)});
  list.add(around, Cap::round, Blend::over, true);
  list.add(placed(kPointer, at, weight), faded(colours.ink, alpha));
}

void draw_ways(const Stage& stage, const View& view, const sim::Snapshot& now, List& list) {
  for (const Hand& hand : hands(stage, view, now)) {
    dot_way(stage.cast.mice[hand.mouse], stage, view, now.time, hand.alpha, list);
  }
}

void draw_hands(const Stage& stage, const View& view, const sim::Snapshot& now, List& list) {
  const double weight = stage.layout.weight, zoom = view.scale / stage.layout.scale;
  const std::vector<Hand> found = hands(stage, view, now);
  for (const Hand& hand : found) {
    const sim::Snapshot::Mouse& mouse = now.mice[hand.mouse];
    if (!mouse.pressed || mouse.body < 0) continue;
    const Coil& form = stage.hands[hand.mouse];
    const Point held = view.page(mouse.held);
    const double width = line_width(form, (hand.at - held).norm(), zoom);
    std::vector<Node> nodes;
    for (const Point& p : coil_line(form, held, hand.at, zoom)) {
      nodes.push_back({p, width, stage.colours.spring});
    }
    list.add(nodes, Cap::round, Blend::over, false, winding(form, (hand.at - held).norm(), zoom));
    list.add(Disc{held, kJoint * weight, 0, stage.colours.spring, stage.colours.spring});
  }
  for (const Hand& hand : found) draw_pointer(hand.at, hand.alpha, weight, stage.colours, list);
}

}  // namespace obscura::draw

// An arrow: a shaft of even width and a head with swept barbs, all heads of one size; an arrow shorter than
// its head shrinks as a whole. One that would leave the window has its head at the edge, and is broken by two
// strokes across its shaft, as an axis is that does not begin at zero.

#include <algorithm>
#include <cmath>

#include "draw/page/touching.h"
#include "draw/plane/stage.h"

namespace obscura::draw {
namespace {

constexpr double kHead = 24, kHeadHalf = 8.6, kNotch = 17;  // tip to barbs, half across, tip to notch
constexpr double kHalo = 2.4;
constexpr double kWhole = 1.5;  // heads long: from here on the head is full
constexpr double kEdge = 8;     // page units from a window's edge to a head
constexpr double kSmall = 40;   // radius: a halo would bite a good part out of a smaller disc
constexpr int kHalos = 1000;    // after the layers
constexpr int kBreaks = 2000;   // after these
// page units: between the strokes of a break, half of one across the shaft and along it; a shaft that is not
// so long has a smaller one
constexpr double kBreakGap = 9, kBreakAcross = 8.6, kBreakAlong = 4, kBroken = 30;

/// The head, larger by `halo` all around.
std::vector<Point> head(const Arrow& arrow, double weight, double halo) {
  const Point u = (arrow.tip - arrow.tail).normalized(), v(-u.y(), u.x());
  const double g = arrow.grow * weight, slant = halo * kHead / kHeadHalf;
  const double tip = std::min(slant, 2.2 * halo), back = kHead * g + halo, side = kHeadHalf * g + halo;
  return {arrow.tip + u * tip, arrow.tip - u * back + v * side, arrow.tip - u * (kNotch * g + halo),
          arrow.tip - u * back - v * side};
}

/// The break of an arrow that is cut: a gap in its shaft between two strokes.
void draw_break(const Arrow& arrow, double weight, Color room, Color ink, List& list) {
  const Point u = (arrow.tip - arrow.tail).normalized(), v(-u.y(), u.x());
  const double shaft = (arrow.tip - arrow.tail).norm() - kNotch * weight * arrow.grow;
  const double size = weight * std::clamp(shaft / (kBroken * weight), 0.0, 1.0);
  if (!(size > 0)) return;
  const Point middle = arrow.tail + 0.5 * shaft * u, half = 0.5 * kBreakGap * size * u,
              slant = size * (kBreakAcross * v + kBreakAlong * u);
  list.halo(true);
  list.add({middle - half + slant, middle + half + slant, middle + half - slant, middle - half - slant},
           room);
  list.halo(false);
  for (const Point& at : {Point(middle - half), Point(middle + half)})
    list.add({{at - slant, 0.6 * kArrowLine * weight, ink}, {at + slant, 0.6 * kArrowLine * weight, ink}},
             Cap::butt);
}

/// Draws a halo of this width along a way, but not over small discs.
void draw_halo(const Point& from, const Point& to, double width, Color room, const std::vector<Disc>& small,
               List& list) {
  const double length = (to - from).norm();
  if (!(length > 0)) return;
  const Point u = (to - from) / length;
  std::vector<std::pair<double, double>> covered;  // from one place to another, along the way
  for (const Disc& disc : small) {
    const double middle = (disc.center - from).dot(u), off = (disc.center - from - middle * u).norm();
    if (off >= disc.radius + width / 2) continue;
    // also where only an edge of the halo is over it
    const double reach = std::sqrt(disc.radius * disc.radius - std::pow(std::max(off - width / 2, 0.0), 2));
    covered.emplace_back(middle - reach, middle + reach);
  }
  std::sort(covered.begin(), covered.end());
  covered.emplace_back(length, length);
  double at = 0;
  for (const auto& [begin, end] : covered) {
    if (const double next = std::min(begin, length); next > at + 1e-9)
      list.add({{from + at * u, width, room}, {from + next * u, width, room}}, Cap::butt);
    at = std::max(at, end);
  }
}

}  // namespace

double growth(const Point& tail, const Point& tip, double weight) {
  return std::min(1.0, (tip - tail).norm() / (kWhole * kHead * weight));
}

void offer(const Point& tail, Point tip, const Rect& window, double weight, std::vector<Arrow>& arrows) {
  // one that begins in the window and would leave it has its head a little before the edge: the farther it
  // goes beyond it the more, so that the head does not jump
  const Point low(window.x, window.y), high = low + Point(window.width, window.height);
  const auto within = [&](const Point& p, double margin) {
    return (p.array() >= low.array() + margin).all() && (p.array() <= high.array() - margin).all();
  };
  const bool cut = within(tail, kEdge * weight) && !within(tip, 0);
  if (cut) {
    double part = 1;
    for (int i = 0; i < 2; ++i) {
      const bool down = tip[i] < tail[i];
      const double beyond = down ? low[i] - tip[i] : tip[i] - high[i];
      if (!(beyond > 0)) continue;
      const double margin = std::min(beyond, kEdge * weight);
      const double edge = down ? low[i] + margin : high[i] - margin;
      part = std::min(part, (edge - tail[i]) / (tip[i] - tail[i]));
    }
    tip = tail + part * (tip - tail);
  }
  const double grow = growth(tail, tip, weight);
  if (grow > kSmallest) arrows.push_back({.tail = tail, .tip = tip, .grow = grow, .cut = cut});
}

// one kind after another: few batches
void draw_arrows(const std::vector<Arrow>& arrows, const std::vector<Color>& inks, double weight, Color room,
                 List& list) {
  if (arrows.empty()) return;
  const bool hung = std::any_of(arrows.begin(), arrows.end(), [](const Arrow& a) { return a.hang; });
  const auto hang = [&](const Arrow& a) {
    if (hung) list.hang(a.hang);
  };
  // what is small, round and has an outline keeps it
  std::vector<Disc> small;
  for (const Disc& disc : list.discs)
    if (disc.radius < kSmall * weight && disc.line > 0) small.push_back(disc);
  auto shaft = [&](const Arrow& a, double halo, Color ink) {
    hang(a);
    const Point u = (a.tip - a.tail).normalized();
    const double width = kArrowLine * weight * a.grow + 2 * halo;
    Point end = a.tip - u * (kNotch - 1) * weight * a.grow;
    if (halo > 0 && a.bare < 1) {
      const Point last = a.tail + a.bare * (a.tip - a.tail);
      if ((last - end).dot(u) < 0) end = last;
    }
    if (halo > 0)
      draw_halo(a.tail, end, width, ink, small, list);
    else
      list.add({{a.tail, width, ink}, {end, width, ink}}, Cap::butt);
  };
  const auto beside = [&](const Arrow& a) {
    const Point u = (a.tip - a.tail).normalized();
    return std::none_of(small.begin(), small.end(), [&](const Disc& disc) {
      const double along = std::clamp((disc.center - a.tip).dot(-u), 0.0, kHead * weight * a.grow);
      return (a.tip - along * u - disc.center).norm() < disc.radius + kHalo * weight;
    });
  };
  // halos come and go: as a layer of their own, so that in the next picture none is taken for an arrow
  const Subject own = list.abouts.empty() ? Subject{} : list.abouts.back().subject;
  Subject halos = own;
  halos.index += kHalos;
  list.of(halos);
  list.halo(true);
  for (const Arrow& a : arrows)
    if (a.bare > 0) shaft(a, kHalo * weight * a.grow, room);
  for (const Arrow& a : arrows)
    if (a.bare > 1 && beside(a)) hang(a), list.add(head(a, weight, kHalo * weight * a.grow), room);
  list.halo(false);
  list.of(own);
  for (std::size_t i = 0; i < arrows.size(); ++i) shaft(arrows[i], 0, inks[i]);
  for (std::size_t i = 0; i < arrows.size(); ++i)
    hang(arrows[i]), list.add(head(arrows[i], weight, 0), inks[i]);
  Subject breaks = own;
  breaks.index += kBreaks;
  list.of(breaks);
  for (std::size_t i = 0; i < arrows.size(); ++i)
    if (arrows[i].cut) hang(arrows[i]), draw_break(arrows[i], weight, room, inks[i], list);
  list.of(own);
  if (hung) list.hang({});
}

void draw_arrows(const std::vector<Arrow>& arrows, double weight, Color room, Color color, List& list) {
  draw_arrows(arrows, std::vector<Color>(arrows.size(), color), weight, room, list);
}

void draw_velocities(const Stage& stage, const View& view, const sim::Snapshot& now, List& list) {
  std::vector<Arrow> arrows;
  std::vector<Color> inks;
  for (int i : stage.arrows) {
    const sim::Snapshot::Body& body = now.bodies[i];
    offer(view.page(body.position), view.page(body.position + stage.look.velocity_scale * body.velocity),
          view.window, stage.layout.weight, arrows);
    inks.resize(arrows.size(), stage.looks(i).quiet ? stage.colours.quiet : stage.colours.velocity);
  }
  draw_arrows(arrows, inks, stage.layout.weight, stage.colours.room, list);
}

std::vector<Push> pushes(const sim::SceneInfo& cast, const Look& look, const sim::Snapshot& now) {
  std::vector<Push> found;
  const auto wanted = [&](int body) { return body < int(look.bodies.size()) && look.bodies[body].contact; };
  const auto quiet = [&](bool shown, int body) { return !shown || look.bodies[std::size_t(body)].quiet; };
  const sim::Vec3 up = cast.gravity.norm() > 0 ? sim::Vec3(-cast.gravity) : sim::Vec3::UnitY();
  const auto force = [](const sim::Snapshot::Contact& each) -> const sim::Vec3& { return each.force; };
  each_touching(now, force, 0, [&](const Touching& all) {
    const bool on_body = wanted(all.first.body);
    const bool on_other = all.first.other >= 0 && wanted(all.first.other);
    if ((!on_body && !on_other) || !(all.pressed > 0)) return;
    // the body of the two that is carried
    const bool turned = !on_body || (on_other && all.sum.dot(up) < 0);
    found.push_back({all.point, turned ? sim::Vec3(-all.sum) : all.sum,
                     quiet(on_body, all.first.body) && quiet(on_other, all.first.other)});
  });
  return found;
}

void draw_contacts(const Stage& stage, const View& view, const sim::Snapshot& now, List& list) {
  std::vector<Arrow> arrows;
  std::vector<Color> inks;
  for (const Push& push : pushes(stage.cast, stage.look, now)) {
    offer(view.page(push.point), view.page(push.point + stage.force_scale * push.force), view.window,
          stage.layout.weight, arrows);
    inks.resize(arrows.size(), push.quiet ? stage.colours.quiet : stage.colours.force);
  }
  draw_arrows(arrows, inks, stage.layout.weight, stage.colours.room, list);
}

}  // namespace obscura::draw

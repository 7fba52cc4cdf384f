// The friction cone at each contact of a body: the forces f with
//   |f - n n . f| <= mu n . f,
// within arctan mu of the normal n. In the plane it is a sector; in space it is seen as the hull of its apex
// and its rim.

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "draw/compose/notes.h"
#include "draw/page/touching.h"
#include "draw/picture/convex.h"

namespace obscura::draw {

using sim::Vec3;

namespace {

constexpr double kMostOfPicture = 0.5;  // of the picture's shorter side: its length in a film
constexpr int kCorners = 64;            // of its rim in space
constexpr double kArcInSpace = 0.6;     // of its length there: the radius of the arc of its angle

}  // namespace

void Notes::cone(int index, const Marks::Cone& cone, const Scales& scales) {
  const auto push = [](const sim::Snapshot::Contact& each) -> const Vec3& { return each.force; };
  each_touching(now_, push, 0, [&](const Touching& all) {
    const sim::Snapshot::Contact& first = all.first;
    if ((first.body != cone.body && first.other != cone.body) || !(all.pressed > 0)) return;
    const Vec3 &force = all.sum, &point = all.point;
    hang(point, point);
    // a little longer than the arrow of the force
    const double mu = sim::friction(cast_, first), half = std::atan(mu);
    const double arrow = scales.force * force.norm();
    double long_side = arrow > 0 ? 1.2 * arrow : 15 * millimetre_ / view_.scale_at(point);
    // and within the picture, where a film shows it
    const Rect& window = view_.window();
    if (film())
      long_side =
          std::min(long_side, kMostOfPicture * std::min(window.width, window.height) / view_.scale_at(point));
    const Vec3 n = first.body == cone.body ? first.normal : Vec3(-first.normal);
    const bool space = cast_.dimension == 3;
    // the direction across the normal in which the angle is drawn: in space that which is seen the widest
    Vec3 along(-n.y(), n.x(), 0);
    std::vector<Vec3> rim;
    if (space) {
      const Vec3 u = n.unitOrthogonal(), w = n.cross(u);
      double widest = 0;
      for (int k = 0; k < kCorners; ++k) {
        const double turn = 2 * std::numbers::pi * k / kCorners;
        const Vec3 across = std::cos(turn) * u + std::sin(turn) * w;
        rim.push_back(point + long_side * (std::cos(half) * n + std::sin(half) * across));
        const double wide = view_.page(rim.back()).x() - view_.page(point).x();
        if (k == 0 || wide < widest) widest = wide, along = across;
      }
    }
    const auto edge = [&](double a) { return Vec3(std::cos(a) * n + std::sin(a) * along); };
    const auto tip = [&](double a, double r) { return Vec3(point + r * edge(a)); };
    std::vector<Vec3> sector{point}, arc;
    const double radius = space ? kArcInSpace * long_side : long_side;
    for (int k = -8; k <= 8 && rim.empty(); ++k) sector.push_back(tip(half * k / 8, long_side));
    sector.insert(sector.end(), rim.begin(), rim.end());
    for (int k = 0; k <= 8; ++k) arc.push_back(tip(half * k / 8, radius));
    // grey, for the force within it has its own colour
    Color tint = colours_.quiet;
    const Color rim_ink = colours_.quiet;
    tint.a = 40;
    std::vector<Point> outline;
    for (const Vec3& place : sector) outline.push_back(view_.page(place));
    if (rim.empty()) {
      by_nodes(sector);
      list_.add(outline, tint);
      for (const double side : {-1.0, 1.0})
        stroke_through({point, tip(side * half, long_side)}, thin_, rim_ink, 2);
    } else {
      const std::vector<Point> hull = convex_hull(outline);
      std::vector<Vec3> corners;
      for (const Point& p : hull)
        corners.push_back(
            sector[std::size_t(std::find(outline.begin(), outline.end(), p) - outline.begin())]);
      if (hull.size() > 2) by_nodes(corners), list_.add(hull, tint);
      // the rim, and the two lines from the apex that touch it as it is seen
      const std::size_t first_corner =
          std::size_t(std::find(hull.begin(), hull.end(), outline[0]) - hull.begin());
      for (const std::size_t beside : {first_corner + 1, first_corner + hull.size() - 1})
        if (first_corner < hull.size() && hull.size() > 2)
          stroke_through({point, corners[beside % hull.size()]}, thin_, rim_ink, 2);
      rim.push_back(rim[0]);
      stroke_through(rim, thin_, rim_ink, 2);
    }
    dashes(point, tip(0, long_side));
    stroke_through(arc, thin_, colours_.ink, 2);
    const WordKey key{WordKey::cone, index, first.other >= 0 ? first.other : -1 - first.wall};
    const Formula f = set(key, cone.label, half * 180 / std::numbers::pi, "°", -1, colours_.ink);
    // beyond the arc; in space beside the line that it ends at, for it lies within the cone
    const Point beside = view_.page(space ? tip(half, radius) : tip(half / 2, radius));
    const Point middle = view_.page(space ? tip(0, radius) : point);
    const Point apex = view_.page(point), end = view_.page(tip(half, long_side));
    const auto [from, to] = eased(key, apex, end, center(cone.body));
    std::vector<Placing::Candidate> places = Placing::along(from, to, gap_, size(f), point_, film());
    for (Placing::Candidate& each : places) each.cost += 4 * point_;
    const Point out = (beside - middle).normalized();
    const Point moved = from - apex + radius / long_side * (to - from - (end - apex));
    for (const double off : {3.0, 2.0, 1.0}) {
      const Point far = off * gap_ * out + Point(out.x() * f.width / 2, out.y() * (f.ascent + f.descent) / 2);
      places.insert(places.begin(), {beside + moved + far, off / 2 * point_, false});
    }
    word(key, f, places, beside);
  });
}

}  // namespace obscura::draw

// The words of marks that have no arrow: of points, at places and of bodies.

#include <algorithm>
#include <cmath>
#include <numbers>

#include "draw/compose/notes.h"
#include "draw/page/measure.h"
#include "draw/page/readings.h"
#include "draw/picture/convex.h"

namespace obscura::draw {
namespace {

constexpr std::size_t kManyNames = 40;        // from here on a name stands above its body or below
constexpr double kNameGap = 1.3;              // from a body to its name, as against others
constexpr double kInRoom = 12, kOffWall = 4;  // points: the cost of a place off a wall, and how far off
constexpr double kBesideArrows = 4;           // points: the cost of a place that turns with an arrow
constexpr double kSteady = 0.25;              // of its greatest length: an arrow that is never shorter
constexpr std::size_t kSidesOfAxes = 4;       // places of words beside two axes
constexpr double kLeader = 6;                 // points: farther off words have a line to what they name
constexpr double kStraight = 1e-3;            // sine of an angle: a way that turns by less is straight
constexpr double kInner = 24;  // points: the cost of a time on the other side of its body's way

// of a body one arrow, from its centre
constexpr Quantity kSingle[] = {Quantity::velocity, Quantity::acceleration, Quantity::momentum,
                                Quantity::weight,   Quantity::net_force,    Quantity::drag,
                                Quantity::field};

using sim::Vec3;

}  // namespace

void Notes::point(int index, const Marks::Point& point) {
  if (!view_.before(place(point.at, now_))) return;
  const Point at = view_.page(place(point.at, now_));
  if (is_unseen({WordKey::point, index}, at)) return;
  hang(place(point.at, now_), place(point.at, now_));
  const Color ink = inked(point.color.value_or(colours_.ink), colours_);
  if (point.dot) dots_.push_back({at, ink, hang_});
  const Formula f = formula(point.label, type_, legible(ink, colours_));
  // its dot, and the halo around that
  const double clear = dot_radius_ + 1.2 * point_;
  placing_.avoid(at - Point(clear, 0), at + Point(clear, 0), 8);
  if (!film()) placing_.avoid(at - Point(0, clear), at + Point(0, clear), 8);
  forms_[WordKey::point].emplace_back(std::vector<Point>{at});
  if (Word* its =
          word({WordKey::point, index}, f, Placing::around(at, dot_radius_ + gap_, size(f), point_), at))
    its->form = forms_[WordKey::point].size() - 1;
}

void Notes::label(int index, const Marks::Label& label) {
  if (!view_.before(place(label.at, now_))) return;
  const Point at = view_.page(place(label.at, now_));
  if (is_unseen({WordKey::label, index}, at)) return;
  hang(place(label.at, now_), place(label.at, now_));
  const WordKey key{WordKey::label, index};
  const Measure* measure = draw::measure(label.quantity);
  const Formula f = measure && measure->read ? set(key, label.text, measure->at(cast_, now_, label.body),
                                                   measure->unit, label.body, colours_.ink)
                                             : formula(label.text, type_, colours_.ink);
  std::vector<Placing::Candidate> places{{at, 0, false}};
  // beside the body, not on it
  double gap = gap_;
  if (label.at.body >= 0) {
    gap *= kNameGap;
    const sim::SceneInfo::Body& body = cast_.bodies[std::size_t(label.at.body)];
    const double reach = body.radius > 0 ? body.radius : body.half.norm();
    gap += std::max(0.0, view_.scale_at(place(label.at, now_)) * (reach - label.at.local.norm()));
  }
  if (label.at.body >= 0) places = Placing::around(at, gap, size(f), point_);
  // at a place of the room: there, but beside the axes, on either side of each
  if (film() && label.at.body < 0 && !axes_.empty()) {
    places.clear();
    for (std::size_t sides = 0; sides < kSidesOfAxes; ++sides) {
      const Point center = beside_axes(at, size(f), sides);
      places.push_back({center, (center - at).norm(), false});
    }
  }
  word(key, f, places, at);
}

// Words that would lie on axes are shifted beside them, each to the side that its bit says. Past the end of
// an axis the shift fades out, so that words that pass it do not jump.
Point Notes::beside_axes(const Point& center, const Point& size, std::size_t sides) const {
  Point at = center;
  for (std::size_t i = 0; i < axes_.size(); ++i) {
    const Point way = axes_[i].tip - axes_[i].tail;
    if (!(way.norm() > 0)) continue;
    const Point u = way.normalized(), n = ((sides >> (i % 2)) & 1 ? -1 : 1) * Point(-u.y(), u.x());
    const double along = u.cwiseAbs().dot(size) / 2, across = n.cwiseAbs().dot(size) / 2 + gap_;
    const double part = (at - axes_[i].tail).dot(u), off = (at - axes_[i].tail).dot(n);
    if (!(std::abs(off) < across)) continue;
    const double shared = std::min(part + along, way.norm() + along - part);
    at += std::clamp(2 * shared / along, 0.0, 1.0) * (across - off) * n;
  }
  return at;
}

bool stays(const WordKey& key, std::size_t places) {
  return places == 1 || (key.kind == WordKey::label && places <= kSidesOfAxes);
}

// The ways of the arrows of a body that begin at its centre and are never short, in a film: for places that
// turn with them.
std::vector<Point> Notes::steady_arrows(int body, const Marks& marks) const {
  std::vector<Point> ways;
  if (!how_.plan) return ways;
  const Vec3& center = now_.bodies[std::size_t(body)].position;
  for (std::size_t i = 0; i < marks.vectors.size() && marks.names.size() <= kManyNames; ++i) {
    const Marks::Vector& vector = marks.vectors[i];
    const bool single =
        std::find(std::begin(kSingle), std::end(kSingle), vector.quantity) != std::end(kSingle);
    if (vector.body != body || vector.at || !single) continue;
    const auto range = how_.plan->ranges.find({WordKey::vector, int(i)});
    if (range == how_.plan->ranges.end() || !(range->second.low > kSteady * range->second.high)) continue;
    const Vec3 value = sum(vector.quantity, body, cast_, now_);
    const double step = 1 / view_.scale_at(center);
    const Point way = value.norm() > 0
                          ? Point(view_.page(center + step * value.normalized()) - view_.page(center))
                          : Point(0, 1);
    ways.push_back(way.norm() > 1e-3 ? Point(way.normalized()) : Point(0, 1));
  }
  return ways;
}

// Beside the body, however it is turned: best above it.
void Notes::name(int index, const Marks::Name& name, const Marks& marks) {
  const bool many = marks.names.size() > kManyNames;
  const Vec3& center = now_.bodies[std::size_t(name.body)].position;
  if (!view_.before(center)) return;
  const Point at = view_.page(center);
  const Rect& window = view_.window();
  const double within = std::min({at.x() - window.x, window.x + window.width - at.x(), at.y() - window.y,
                                  window.y + window.height - at.y()});
  if (!(within > 0)) return;
  hang(center, center);
  const Color ink = name.quiet ? colours_.quiet : colours_.ink;
  Formula f = formula(name.text, type_, ink);
  const Point low(window.x + gap_, window.y + gap_),
      high(window.x + window.width - gap_, window.y + window.height - gap_);
  if (f.width > high.x() - low.x()) f = formula(name.text, type_ * (high.x() - low.x()) / f.width, ink);
  // a body that leaves the picture takes it along
  if (film()) fade(f, within / (2 * gap_));

  const std::vector<Point> outline = outline_of(name.body, now_);
  if (outline.empty()) return;
  const Point half = size(f) / 2;
  const auto in_window = [&](int i, double x) {
    return std::clamp(x, low[i] + half[i], std::max(low[i] + half[i], high[i] - half[i]));
  };
  struct Side {
    Point out;
    double cost;  // points
  };
  const double s = std::numbers::sqrt2 / 2;
  static const std::vector<Side> sides{{{0, -1}, 0}, {{0, 1}, 4},   {{1, 0}, 8}, {{-1, 0}, 9},
                                       {{s, -s}, 7}, {{-s, -s}, 8}, {{s, s}, 9}, {{-s, s}, 10}};
  std::vector<Placing::Candidate> places;
  for (const double off : {0.0, 5.0, 12.0, 22.0, 34.0}) {
    for (const Side& side : sides) {
      const Point& n = side.out;
      double reach = 0;
      for (const Point& p : outline) reach = std::max(reach, (p - at).dot(n));
      // its near side, or its near corner, is at the line that the body touches from within
      Point middle = at + (reach + kNameGap * gap_ + off * point_) * n;
      for (int i = 0; i < 2; ++i)
        middle[i] =
            std::abs(n[i]) < 1e-9 ? in_window(i, middle[i]) : middle[i] + std::copysign(half[i], n[i]);
      places.push_back({middle, (side.cost + (off > 0 ? 4 + off : 0)) * point_, off > kLeader});
      if (many && places.size() == 2) break;
    }
    if (many) break;
  }
  // within the room, where a wall is beside it
  if (film() && !many) {
    const auto [room_low, room_high] = room_window();
    const Point margin(kOffWall * point_, kOffWall * point_), first = room_low + half + margin,
                                                              last = room_high - half - margin;
    for (const double off : {0.0, 13.0, 26.0, 39.0})
      for (const double up : {-1.0, 1.0}) {
        double reach = 0;
        for (const Point& p : outline) reach = std::max(reach, up * (p.y() - at.y()));
        Point middle(at.x(), at.y() + up * (reach + kNameGap * gap_ + off * point_ + half.y()));
        if (first.x() < last.x()) middle.x() = std::clamp(middle.x(), first.x(), last.x());
        places.push_back({middle, (kInRoom + (up > 0 ? 4 : 0) + off) * point_, off > kLeader});
      }
  }
  // beside its arrows, however they turn
  for (const Point& way : steady_arrows(name.body, marks)) {
    const Point across(-way.y(), way.x());
    for (const double off : {0.0, 6.0})
      for (const Point& n : {Point(-way), across, Point(-across)}) {
        double reach = n.cwiseAbs().dot(half) + kNameGap * gap_ + off * point_, outer = 0;
        for (const Point& p : outline) outer = std::max(outer, (p - at).dot(n));
        places.push_back({at + (reach + outer) * n, (kBesideArrows + off) * point_, off > kLeader});
      }
  }
  // others may be taken for what it names
  std::vector<Form>& all = forms_[WordKey::name];
  for (std::size_t i = all.size(); i < cast_.bodies.size() && !film() && !many; ++i)
    all.emplace_back(outline_of(int(i), now_));
  if (Word* its = word({WordKey::name, index}, f, places, at)) {
    its->outline = outline;
    if (!all.empty()) its->form = std::size_t(name.body);
  }
}

// The side of a way that most of it bends away from, 1: left of it; of a straight one the upper or right
// side.
int Notes::outer_side(const std::vector<Point>& way) {
  int turns = 0;
  for (std::size_t k = 1; k + 1 < way.size(); ++k) {
    const Point a = way[k] - way[k - 1], b = way[k + 1] - way[k];
    const double turn = a.x() * b.y() - a.y() * b.x();
    if (std::abs(turn) > kStraight * a.norm() * b.norm()) turns += turn > 0 ? 1 : -1;
  }
  if (turns != 0) return turns > 0 ? 1 : -1;
  const Point whole = way.back() - way.front();
  return whole.x() + 0.2 * whole.y() >= 0 ? 1 : -1;
}

// The times of earlier instants of a body, each beside it, and all on one side of its way if there is room.
void Notes::times() {
  if (how_.times.empty()) return;
  const auto body = std::size_t(how_.times_of);
  std::vector<Point> way;
  std::vector<Form>& all = forms_[WordKey::time];
  for (const Timed& each : how_.times) {
    way.push_back(view_.page(each.then->bodies[body].position));
    all.emplace_back(outline_of(how_.times_of, *each.then));
  }
  way.push_back(view_.page(now_.bodies[body].position));
  all.emplace_back(outline_of(how_.times_of, now_));
  const int side = outer_side(way);
  Point along(1, 0);
  for (std::size_t k = 0; k < how_.times.size(); ++k) {
    const std::vector<Point>& outline = all[k].outline;
    if (outline.empty()) continue;
    const Point &at = way[k], d = way[k + 1] - way[k > 0 ? k - 1 : 0];
    if (d.norm() > 1e-6) along = d.normalized();
    const Point out = side * Point(along.y(), -along.x()), across(-out.y(), out.x());
    const Formula f = formula(how_.times[k].words, type_, colours_.ink);
    std::vector<Placing::Candidate> places;
    for (const double off : {0.0, 4.0, 9.0, 15.0, 22.0, 30.0})
      for (const double turned :
           {0.0, 20.0, -20.0, 40.0, -40.0, 65.0, -65.0, 115.0, -115.0, 150.0, -150.0, 180.0}) {
        const double a = turned * std::numbers::pi / 180;
        const Point n = std::cos(a) * out + std::sin(a) * across;
        double reach = 0;
        for (const Point& p : outline) reach = std::max(reach, (p - at).dot(n));
        const double cost = std::abs(turned) / 8 + (off > 0 ? 4 + off : 0) + (n.dot(out) < 0 ? kInner : 0);
        places.push_back(
            {Placing::beyond(at, n, reach + gap_ + off * point_, size(f)), cost * point_, off > kLeader});
      }
    if (Word* its = word({WordKey::time, int(k)}, f, std::move(places), at))
      its->outline = outline, its->form = k;
  }
}

}  // namespace obscura::draw

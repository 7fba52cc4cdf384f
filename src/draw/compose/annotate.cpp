// Annotation. Arrows and lines first; then every word, by `Placing`, off the lines that are there.

#include "draw/compose/annotate.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "draw/compose/readings.h"
#include "draw/page/placing.h"
#include "draw/page/sheet.h"
#include "draw/picture/formula.h"
#include "draw/plane/stage.h"

namespace obscura::draw {
namespace {

constexpr double kType = 10 * kPoint;                 // em
constexpr double kArrow = 1.1 * kPoint / kArrowLine;  // weight at which a shaft is 1.1 pt
constexpr double kThin = 0.5 * kPoint;                // of angles and lengths
constexpr double kDotRadius = 1.7 * kPoint, kGap = 2.2 * kPoint;
constexpr double kNormal = 9 * 72 / 25.4 * kPoint;  // a unit normal: 9 mm
constexpr double kAngle = 13 * kPoint;              // radius of an arc
constexpr double kAxes = 0.36;                      // of the picture's shorter side: axes in space
constexpr double kMillimetre = 72 / 25.4 * kPoint;

using sim::Vec3;

/// Puts the figure on one page: lines at once, words when all lines are known.
class Notes {
 public:
  Notes(const sim::SceneInfo& cast, const Palette& colours, const Projection& projection,
        const sim::Snapshot& now, List& list)
      : cast_(cast),
        colours_(colours),
        view_(projection),
        now_(now),
        list_(list),
        placing_(projection.window()) {
    avoid_bodies();
    if (!view_.view()) return;
    for (const HalfPlane& wall : half_planes(cast, *view_.view())) {
      const Point along(-wall.normal.y(), wall.normal.x());
      placing_.avoid(wall.point - 1e4 * along, wall.point + 1e4 * along, 3);
      // nor in the hatching
      for (double deep = 2; deep < kBand * kPrint; deep += 4)
        placing_.avoid(wall.point - deep * wall.normal - 1e4 * along,
                       wall.point - deep * wall.normal + 1e4 * along, 1);
    }
  }

  void vector(const Figure::Vector& vector, Scales scales);
  void angle(const Figure::Angle& angle);
  void length(const Figure::Length& length);
  void point(const Figure::Point& point);
  void label(const Figure::Label& label);
  void cone(const Figure::Cone& cone, const Scales& scales);
  void axes();
  void finish();

 private:
  struct Word {
    Formula set;
    std::vector<Placing::Candidate> places;
    Point anchor;
  };
  static Point size(const Formula& f) { return {f.width, f.ascent + f.descent}; }
  void avoid_bodies();
  void arrow(const Point& tail, const Point& tip, const Formula& label, Color ink);
  void stroke(const std::vector<Point>& line, double width, Color color, double weight);
  void dashes(const Point& a, const Point& b);
  void turn(const Figure::Vector& vector, const Reading& reading, const Formula& label, Color ink);
  template <class At>
  void arc(const At& at, double radius, double from, double to, double width, Color color);
  void word(Formula set, std::vector<Placing::Candidate> places, const Point& anchor) {
    if (!set.empty()) words_.push_back({std::move(set), std::move(places), anchor});
  }

  const sim::SceneInfo& cast_;
  const Palette& colours_;
  const Projection& view_;
  const sim::Snapshot& now_;
  List& list_;
  Placing placing_;
  std::vector<Word> words_;
  std::vector<std::pair<Point, Color>> dots_;
};

void Notes::avoid_bodies() {
  const bool flat = view_.view() != nullptr;
  for (std::size_t i = 0; i < cast_.bodies.size(); ++i) {
    const sim::SceneInfo::Body& body = cast_.bodies[i];
    const sim::Snapshot::Body& it = now_.bodies[i];
    std::vector<Vec3> corners = flat ? body.vertices : std::vector<Vec3>();
    if (body.kind == sim::ShapeKind::box)
      corners = {Vec3(-body.half.x(), -body.half.y(), 0), Vec3(body.half.x(), -body.half.y(), 0),
                 Vec3(body.half.x(), body.half.y(), 0), Vec3(-body.half.x(), body.half.y(), 0)};
    std::vector<Point> outline;
    for (const Vec3& corner : corners) outline.push_back(view_.page(place({int(i), corner}, now_)));
    if (outline.empty()) {
      const double scale = view_.scale_at(it.position);
      const double radius = body.radius > 0 ? scale * body.radius : kDot * kPrint;
      for (int k = 0; k < 12; ++k)
        outline.push_back(view_.page(it.position) + radius * Point(std::cos(k * std::numbers::pi / 6),
                                                                   -std::sin(k * std::numbers::pi / 6)));
    }
    for (std::size_t k = 0; k < outline.size(); ++k)
      placing_.avoid(outline[k], outline[(k + 1) % outline.size()], 2);
  }
  for (const sim::Snapshot::Spring& spring : now_.springs) {
    const Point a = view_.page(spring.a), b = view_.page(spring.b), u = (b - a).normalized();
    for (const double side : {-3.0, 0.0, 3.0})
      placing_.avoid(a + side * kPoint * Point(-u.y(), u.x()), b + side * kPoint * Point(-u.y(), u.x()), 1);
  }
}

void Notes::arrow(const Point& tail, const Point& tip, const Formula& label, Color ink) {
  std::vector<Arrow> arrows;
  offer(tail, tip, view_.window(), kArrow, arrows);
  if (arrows.empty()) return;
  draw_arrows(arrows, kArrow, colours_.room, ink, list_);
  placing_.avoid(tail, tip, 4);
  word(label, Placing::along(tail, tip, 1.7 * kGap, size(label), kPoint), (tail + tip) / 2);
}

void Notes::stroke(const std::vector<Point>& line, double width, Color color, double weight) {
  std::vector<Node> nodes;
  for (const Point& p : line) nodes.push_back({p, width, color});
  list_.add(nodes, Cap::butt);
  for (std::size_t i = 0; i + 1 < line.size(); ++i) placing_.avoid(line[i], line[i + 1], weight);
}

void Notes::dashes(const Point& a, const Point& b) {
  const double length = (b - a).norm(), dash = 2.4 * kPoint, gap = 1.8 * kPoint;
  if (!(length > 0)) return;
  const Point u = (b - a) / length;
  for (double s = 0; s < length; s += dash + gap)
    stroke({a + s * u, a + std::min(s + dash, length) * u}, kThin, colours_.ink, 1);
}

// An arc with a tip through `at` of an angle, rad, of about `radius` on the page.
template <class At>
void Notes::arc(const At& at, double radius, double from, double to, double width, Color color) {
  std::vector<Point> line;
  const int n = std::max(6, int(std::abs(to - from) / 0.06));
  // the shaft ends within its head
  double head = std::copysign(std::min(20 * kArrow / radius, 0.7 * std::abs(to - from)), to - from);
  // longer where the arc is seen aslant
  while ((at(to) - at(to - head)).norm() < 16 * kArrow && std::abs(head) < 0.4 * std::abs(to - from))
    head *= 1.2;
  for (int i = 0; i <= n; ++i) line.push_back(at(from + (to - 0.8 * head - from) * i / n));
  stroke(line, width, color, 3);
  // the head points along the chord to its tip
  const Point end = at(to), back = at(to - head);
  const double grow = std::min(1.0, (end - back).norm() / (20 * kArrow));
  if (!(grow > 0)) return;
  std::vector<Arrow> arrows{{Point(end - (end - back).normalized() * 18 * kArrow * grow), end, grow}};
  draw_arrows(arrows, kArrow, colours_.room, color, list_);
  placing_.avoid(back, end, 4);
}

// An arc with the way that it turns: in the plane over the body's middle; in space around it, about the axis,
// which is dashed, and open away from the eye; its tip is before the body.
void Notes::turn(const Figure::Vector& vector, const Reading& reading, const Formula& label, Color ink) {
  if (!(std::abs(reading.signed_value) > 1e-9)) return;
  const sim::SceneInfo::Body& body = cast_.bodies[std::size_t(vector.body)];
  const Point center = view_.page(reading.tail);
  const double scale = view_.scale_at(reading.tail), wide = 1.1 * kPoint;
  std::vector<Placing::Candidate> places;
  const auto around = [&](const auto& at, std::initializer_list<double> angles) {
    for (const double a : angles) {
      const Point out = at(a) - center, n = out.norm() > 0 ? Point(out.normalized()) : Point(1, 0);
      for (const double off : {1.0, 3.0, 7.0})
        places.push_back({at(a) + n * kGap * off +
                              Point(n.x() * label.width / 2, n.y() * (label.ascent + label.descent) / 2),
                          off * kPoint, false});
    }
  };
  if (view_.view()) {
    const double reach = body.radius > 0        ? 1.6 * body.radius
                         : body.half.norm() > 0 ? 0.62 * body.half.head<2>().minCoeff()
                                                : 0;
    const double radius = std::clamp(scale * reach, 9 * kPoint, 24 * kPoint);
    const auto at = [&](double a) { return Point(center + radius * Point(std::cos(a), -std::sin(a))); };
    const double low = 25 * std::numbers::pi / 180, high = 165 * std::numbers::pi / 180;
    const bool left = reading.signed_value > 0;
    arc(at, radius, left ? low : high, left ? high : low, wide, ink);
    around(at, {low, 0.8, 1.2, high, 1.6, 2.1});
  } else {
    const double reach = body.radius > 0 ? 1.4 * body.radius : 1.05 * body.half.norm();
    const double radius = std::clamp(scale * reach, 12 * kPoint, 40 * kPoint), world = radius / scale;
    const Vec3 axis = reading.value.normalized();
    Vec3 near = view_.sight(reading.tail);
    near -= axis.dot(near) * axis;
    near = near.norm() > 1e-6 ? Vec3(near.normalized()) : axis.unitOrthogonal();
    const Vec3 on = axis.cross(near);
    const auto at = [&](double a) {
      return view_.page(reading.tail + world * (std::cos(a) * near + std::sin(a) * on));
    };
    const double back = -150 * std::numbers::pi / 180, ahead = 65 * std::numbers::pi / 180;
    dashes(center, view_.page(reading.tail + 1.5 * world * axis));
    arc(at, radius, back, ahead, wide, ink);
    around(at, {ahead, 0.5 * ahead, 0.0, 0.3 * back, 0.6 * back, back});
  }
  word(label, places, center);
}

void Notes::vector(const Figure::Vector& vector, Scales scales) {
  const Color ink = color_of(vector, colours_);
  for (const Reading& reading : readings(vector, cast_, now_)) {
    const std::string label = as_vector(vector.label);
    const auto set = [&](double value) {
      return formula(with_value(label, value, unit(vector.quantity)), kType, ink);
    };
    if (vector.quantity == Quantity::spin || vector.quantity == Quantity::torque) {
      turn(vector, reading, set(reading.signed_value), ink);
      continue;
    }
    const Formula label_set = set(reading.value.norm());
    if (vector.quantity == Quantity::normal && view_.view()) {
      const Point tail = view_.page(reading.tail);
      arrow(tail, tail + kNormal * Point(reading.value.x(), -reading.value.y()).normalized(), label_set, ink);
    } else {
      const double* scale = scale_of(vector.quantity, scales);
      const double length = vector.quantity == Quantity::normal ? kNormal / view_.scale_at(reading.tail)
                            : scale                             ? *scale
                                                                : 1.0;
      arrow(view_.page(reading.tail), view_.page(reading.tail + length * reading.value), label_set, ink);
    }
  }
}

void Notes::angle(const Figure::Angle& angle) {
  Vec3 center = Vec3::Zero(), from = Vec3::UnitX(), to = Vec3::UnitX();
  double wide = kAngle;
  if (angle.body >= 0) {
    const sim::Snapshot::Body& body = now_.bodies[std::size_t(angle.body)];
    center = body.position;
    to = body.orientation * Vec3::UnitX();
    const double reach = 22 * kPoint / view_.scale_at(center);
    dashes(view_.page(center), view_.page(center + reach * from));
    stroke({view_.page(center), view_.page(center + reach * to)}, kThin, colours_.ink, 2);
  } else {
    if (!angle.at || !angle.from || !angle.to) return;
    center = place(*angle.at, now_);
    from = place(*angle.from, now_) - center, to = place(*angle.to, now_) - center;
    if (!(from.norm() > 0 && to.norm() > 0)) return;
    // in space two directions may look close: farther out
    const double shorter = std::min(from.norm(), to.norm()) * view_.scale_at(center);
    if (!view_.view()) wide = std::clamp(0.4 * shorter, kAngle, 2.5 * kAngle);
    from.normalize(), to.normalize();
    dashes(view_.page(center), view_.page(center + (wide + 7 * kPoint) / view_.scale_at(center) * from));
  }
  // an arc of the great circle through both
  const double whole = std::atan2(from.cross(to).norm(), from.dot(to));
  Vec3 across = to - from.dot(to) * from;
  if (!(across.norm() > 1e-12)) return;
  across.normalize();
  const double radius = wide / view_.scale_at(center);
  const auto at = [&](double a, double r) {
    return view_.page(center + r * (std::cos(a) * from + std::sin(a) * across));
  };
  std::vector<Point> line;
  const int n = std::max(6, int(whole / 0.06));
  for (int i = 0; i <= n; ++i) line.push_back(at(whole * i / n, radius));
  stroke(line, kThin, colours_.ink, 3);

  const double degrees = whole * 180 / std::numbers::pi;
  const Formula f = formula(with_value(angle.label, degrees, "°"), kType, colours_.ink);
  const Point hub = view_.page(center), rim = at(whole / 2, radius), out = rim - hub;
  const Point m = out.norm() > 0 ? Point(out.normalized()) : Point(1, 0);
  std::vector<Placing::Candidate> places;
  for (const double off : {1.0, 2.0, 4.0, -3.2})
    places.push_back({rim + off * kGap * m +
                          (off > 0 ? 1 : -1) * Point(m.x() * f.width / 2, m.y() * (f.ascent + f.descent) / 2),
                      std::abs(off) * kPoint, false});
  for (const Placing::Candidate& more : Placing::around(rim, kGap, size(f), kPoint)) {
    places.push_back(more);
    places.back().cost += 12 * kPoint;
  }
  word(f, places, rim);
}

// Friction holds while the force lies within arctan mu of the normal.
void Notes::cone(const Figure::Cone& cone, const Scales& scales) {
  for (std::size_t i = 0; i < now_.contacts.size();) {
    const sim::Snapshot::Contact& first = now_.contacts[i];
    Vec3 force = Vec3::Zero(), point = Vec3::Zero();
    double pressed = 0;
    for (; i < now_.contacts.size(); ++i) {
      const sim::Snapshot::Contact& each = now_.contacts[i];
      if (each.body != first.body || each.other != first.other || each.wall != first.wall) break;
      const double weight = std::max(each.force.dot(each.normal), 0.0);
      force += each.force, point += weight * each.point, pressed += weight;
    }
    if ((first.body != cone.body && first.other != cone.body) || !(pressed > 0)) continue;
    point /= pressed;
    // a little longer than the arrow of the force
    const double mu = sim::friction(cast_, first), half = std::atan(mu);
    const double arrow = scales.force * force.norm();
    const double long_side = arrow > 0 ? 1.2 * arrow : 15 * kMillimetre / view_.scale_at(point);
    const Vec3 n = first.body == cone.body ? first.normal : Vec3(-first.normal), along(-n.y(), n.x(), 0);
    const auto edge = [&](double a) { return Vec3(std::cos(a) * n + std::sin(a) * along); };
    const auto tip = [&](double a, double r) { return view_.page(point + r * edge(a)); };
    std::vector<Point> sector{view_.page(point)}, arc;
    const double radius = std::max(kAngle, 0.55 * long_side * view_.scale_at(point)) / view_.scale_at(point);
    for (int k = -8; k <= 8; ++k) sector.push_back(tip(half * k / 8, long_side));
    for (int k = 0; k <= 8; ++k) arc.push_back(tip(half * k / 8, radius));
    Color tint = colours_.force, rim_ink = mix(colours_.force, colours_.ink, 0.12);
    tint.a = 36;
    list_.add(sector, tint);
    for (const double side : {-1.0, 1.0})
      stroke({view_.page(point), tip(side * half, long_side)}, kThin, rim_ink, 2);
    dashes(view_.page(point), tip(0, long_side));
    stroke(arc, kThin, colours_.ink, 2);
    const Formula f =
        formula(with_value(cone.label, half * 180 / std::numbers::pi, "°"), kType, colours_.ink);
    const Point rim = tip(half / 2, radius);
    std::vector<Placing::Candidate> places =
        Placing::along(view_.page(point), tip(half, long_side), kGap, size(f), kPoint);
    for (Placing::Candidate& each : places) each.cost += 2 * kPoint;
    const Point out = (rim - view_.page(point)).normalized();
    places.insert(
        places.begin(),
        {rim + kGap * out + Point(out.x() * f.width / 2, out.y() * (f.ascent + f.descent) / 2), 0, false});
    word(f, places, rim);
  }
}

// In space: from the origin, all of one length.
void Notes::axes() {
  const Rect& window = view_.window();
  const double length = kAxes * std::min(window.width, window.height) / view_.scale_at(Vec3::Zero());
  const std::pair<Vec3, const char*> all[] = {
      {Vec3::UnitX(), "x"}, {Vec3::UnitY(), "y"}, {Vec3::UnitZ(), "z"}};
  for (const auto& [axis, name] : all)
    arrow(view_.page(Vec3::Zero()), view_.page(length * axis), formula(name, kType, colours_.ink),
          colours_.ink);
}

void Notes::length(const Figure::Length& length) {
  const Point a = view_.page(place(length.from, now_)), b = view_.page(place(length.to, now_));
  const Point u = (b - a).normalized(), v(u.y(), -u.x());
  const Point off = length.offset * kMillimetre * v;
  const Point from = a + off, to = b + off;
  // lines from what is measured to the measure
  if (std::abs(length.offset) > 0.5) {
    const double side = length.offset > 0 ? 1 : -1;
    for (const auto& [start, end] : {std::pair(a, from), std::pair(b, to)})
      stroke({start + side * 1.5 * kPoint * v, end + side * 1.5 * kPoint * v}, 0.35 * kPoint, colours_.ink,
             1);
  }
  stroke({from, to}, kThin, colours_.ink, 2);
  const double head = std::min(4.5 * kPoint, 0.4 * (to - from).norm()), half = 0.3 * head;
  for (const auto& [tip, way] : {std::pair(from, u), std::pair(to, Point(-u))})
    list_.add({tip, tip + head * way + half * v, tip + 0.75 * head * way, tip + head * way - half * v},
              colours_.ink);
  const double metres = (place(length.to, now_) - place(length.from, now_)).norm();
  const Formula f = formula(with_value(length.label, metres, "m"), kType, colours_.ink);
  const Point middle = (from + to) / 2;
  std::vector<Placing::Candidate> places;
  for (const double s : {1.0, -1.0})
    for (const double part : {0.5, 0.35, 0.65})
      places.push_back({from + part * (to - from) +
                            s * (kGap * v + Point(v.x() * f.width / 2, v.y() * (f.ascent + f.descent) / 2)),
                        (part == 0.5 ? 0 : 3) * kPoint + (s > 0 ? 0 : kPoint), false});
  word(f, places, middle);
}

void Notes::point(const Figure::Point& point) {
  const Point at = view_.page(place(point.at, now_));
  const Color ink = point.color.value_or(colours_.ink);
  if (point.dot) dots_.emplace_back(at, ink);
  const Formula f = formula(point.label, kType, ink);
  placing_.avoid(at - Point(kDotRadius, 0), at + Point(kDotRadius, 0), 8);
  word(f, Placing::around(at, kDotRadius + kGap, size(f), kPoint), at);
}

void Notes::label(const Figure::Label& label) {
  const Point at = view_.page(place(label.at, now_));
  const Formula f = formula(label.text, kType, colours_.ink);
  std::vector<Placing::Candidate> places{{at, 0, false}};
  if (label.at.body >= 0) places = Placing::around(at, kGap, size(f), kPoint);
  word(f, places, at);
}

void Notes::finish() {
  for (const auto& [at, ink] : dots_) {
    list_.add(Disc{at, kDotRadius + 0.6 * kPoint, 0, colours_.room, colours_.room});
    list_.add(Disc{at, kDotRadius, 0, ink, ink});
  }
  for (Word& word : words_) {
    const Point size = Notes::size(word.set);
    const Placing::Candidate best = placing_.place(size, word.places);
    if (best.leader) {
      const Point way = word.anchor - best.center;
      // from the words' edge to just before what they name
      const double out = std::min(size.x() / 2 / std::max(std::abs(way.normalized().x()), 1e-9),
                                  size.y() / 2 / std::max(std::abs(way.normalized().y()), 1e-9));
      const Point u = way.normalized();
      const Point from = best.center + (out + 1.2 * kPoint) * u,
                  to = word.anchor - (kDotRadius + 1.5 * kPoint) * u;
      if ((to - from).dot(u) > 2 * kPoint)
        list_.add({{from, 0.4 * kPoint, word.set.color}, {to, 0.4 * kPoint, word.set.color}}, Cap::butt);
    }
    add(word.set, {best.center.x() - size.x() / 2, best.center.y() - size.y() / 2 + word.set.ascent}, list_);
  }
}

}  // namespace

Projection::Projection(const CameraProjection& lens, double scale, const Point& corner)
    : lens_(lens), scale_(scale), corner_(corner) {
  const Rect& w = lens.window;
  window_ = {corner.x() + scale * w.x, corner.y() + scale * w.y, scale * w.width, scale * w.height};
}

Point Projection::page(const Vec3& place) const {
  return view_ ? view_->page(place) : Point(corner_ + scale_ * lens_.page(place));
}

double Projection::scale_at(const Vec3& place) const {
  return view_ ? view_->scale : scale_ * lens_.scale_at(place);
}

Vec3 Projection::sight(const Vec3& place) const { return view_ ? Vec3(Vec3::UnitZ()) : lens_.sight(place); }

void annotate(const Figure& figure, const Scales& scales, const sim::SceneInfo& cast, const Palette& colours,
              const Projection& projection, const sim::Snapshot& now, List& list) {
  Notes notes(cast, colours, projection, now, list);
  if (figure.axes && !projection.view()) notes.axes();
  for (const Figure::Cone& cone : figure.cones) notes.cone(cone, scales);
  for (const Figure::Length& length : figure.lengths) notes.length(length);
  for (const Figure::Angle& angle : figure.angles) notes.angle(angle);
  for (const Figure::Vector& vector : figure.vectors) notes.vector(vector, scales);
  for (const Figure::Point& point : figure.points) notes.point(point);
  for (const Figure::Label& label : figure.labels) notes.label(label);
  notes.finish();
}

}  // namespace obscura::draw

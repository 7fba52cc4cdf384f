// Annotation. Arrows and lines first; then every word, by `Placing`, off the lines that are there.

#include "draw/annotate.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "draw/formula.h"
#include "draw/placing.h"
#include "draw/sheet.h"
#include "draw/stage.h"

namespace obscura::draw {
namespace {

constexpr double kType = 10 * kPoint, kSmall = 8.5 * kPoint;  // em of labels, of the legend
constexpr double kArrow = 1.1 * kPoint / kArrowLine;          // weight at which a shaft is 1.1 pt
constexpr double kThin = 0.5 * kPoint;                        // of angles and lengths
constexpr double kDotRadius = 1.7 * kPoint, kGap = 2.2 * kPoint;
constexpr double kNormal = 9 * 72 / 25.4 * kPoint;  // a unit normal: 9 mm
constexpr double kLongest = 0.34;                   // of the picture's shorter side
constexpr double kMillimetre = 72 / 25.4 * kPoint;

using sim::Vec3;

double cross(const Vec3& a, const Vec3& b) { return a.x() * b.y() - a.y() * b.x(); }

/// What an arrow shows, before it is scaled.
struct Reading {
  Vec3 tail, value;
  double signed_value = 0;  // of what turns
};

/// The velocity of a point of a body.
Vec3 velocity_at(const sim::Snapshot& now, int body, const Vec3& point) {
  const sim::Snapshot::Body& it = now.bodies[std::size_t(body)];
  const Vec3 r = point - it.position;
  return it.velocity + it.spin.z() * Vec3(-r.y(), r.x(), 0);
}

/// All that pushes on a body where it touches: one for each that it touches, at the middle of its contacts.
std::vector<Reading> touches(const sim::Snapshot& now, int body, Quantity what) {
  std::vector<Reading> found;
  for (std::size_t i = 0; i < now.contacts.size();) {
    const sim::Snapshot::Contact& first = now.contacts[i];
    Vec3 sum = Vec3::Zero(), point = Vec3::Zero();
    double weight = 0;
    for (; i < now.contacts.size(); ++i) {
      const sim::Snapshot::Contact& each = now.contacts[i];
      if (each.body != first.body || each.other != first.other || each.wall != first.wall) break;
      const Vec3& push = what == Quantity::contact ? each.force : each.impulse;
      const double w = std::max(push.dot(each.normal), what == Quantity::normal ? 1e-12 : 0.0);
      sum += push, point += w * each.point, weight += w;
    }
    if ((first.body != body && first.other != body) || !(weight > 0)) continue;
    const double side = first.body == body ? 1 : -1;
    found.push_back(
        {point / weight, side * (what == Quantity::normal ? first.normal : sum), side * sum.norm()});
  }
  return found;
}

/// The pull of each spring on a body, at the point that it holds.
std::vector<Reading> pulls(const sim::Cast& cast, const sim::Snapshot& now, int body) {
  std::vector<Reading> found;
  for (std::size_t i = 0; i < cast.springs.size(); ++i) {
    const sim::Cast::Spring& spring = cast.springs[i];
    if (spring.a != body && spring.b != body) continue;
    const bool at_a = spring.a == body;
    const Vec3 here = at_a ? now.springs[i].a : now.springs[i].b,
               there = at_a ? now.springs[i].b : now.springs[i].a;
    const Vec3 way = there - here;
    if (!(way.norm() > 0)) continue;
    found.push_back({here, spring.stiffness * (way.norm() - spring.rest_length) * way.normalized()});
  }
  return found;
}

std::vector<Reading> readings(const Figure::Vector& vector, const sim::Cast& cast, const sim::Snapshot& now) {
  if (vector.quantity == Quantity::position) {
    const Vec3 tail = vector.at ? place(*vector.at, now) : Vec3(Vec3::Zero());
    const Vec3 tip = vector.to         ? place(*vector.to, now)
                     : vector.body < 0 ? tail
                                       : now.bodies[std::size_t(vector.body)].position;
    return {{tail, tip - tail}};
  }
  if (vector.body < 0) return {};
  const sim::Snapshot::Body& body = now.bodies[std::size_t(vector.body)];
  const Vec3 at = vector.at ? place(*vector.at, now) : body.position;
  switch (vector.quantity) {
    case Quantity::velocity:
      return {{at, velocity_at(now, vector.body, at)}};
    case Quantity::weight:
      return {{at, cast.bodies[std::size_t(vector.body)].mass * cast.gravity}};
    case Quantity::spring:
      return pulls(cast, now, vector.body);
    case Quantity::contact:
    case Quantity::impulse:
    case Quantity::normal:
      return touches(now, vector.body, vector.quantity);
    case Quantity::spin:
      return {{body.position, Vec3::Zero(), body.spin.z()}};
    case Quantity::torque: {
      double torque = 0;
      for (const auto& all : {pulls(cast, now, vector.body), touches(now, vector.body, Quantity::contact)})
        for (const Reading& each : all) torque += cross(each.tail - body.position, each.value);
      return {{body.position, Vec3::Zero(), torque}};
    }
    case Quantity::position:
      break;
  }
  return {};
}

std::string_view unit(Quantity quantity) {
  switch (quantity) {
    case Quantity::position:
      return "m";
    case Quantity::velocity:
      return "m/s";
    case Quantity::weight:
    case Quantity::spring:
    case Quantity::contact:
      return "N";
    case Quantity::impulse:
      return "N s";
    case Quantity::normal:
      return "";
    case Quantity::spin:
      return "rad/s";
    case Quantity::torque:
      return "N m";
  }
  return "";
}

double* scale_of(Quantity quantity, Scales& scales) {
  switch (quantity) {
    case Quantity::velocity:
      return &scales.velocity;
    case Quantity::weight:
    case Quantity::spring:
    case Quantity::contact:
      return &scales.force;
    case Quantity::impulse:
      return &scales.impulse;
    default:
      return nullptr;
  }
}

Color color_of(const Figure::Vector& vector, const Palette& colours) {
  if (vector.color) return *vector.color;
  switch (vector.quantity) {
    case Quantity::position:
      return mix(*color("blue"), colours.ink, 0.3);
    case Quantity::velocity:
      return mix(colours.velocity, colours.ink, 0.25);
    case Quantity::normal:
    case Quantity::spin:
    case Quantity::torque:
      return colours.ink;
    default:
      return mix(colours.force, colours.ink, 0.12);
  }
}

/// Puts the figure on one page: lines at once, words when all lines are known.
class Notes {
 public:
  Notes(const sim::Cast& cast, const Palette& colours, const Layout& layout, const View& view,
        const sim::Snapshot& now, List& list)
      : cast_(cast), colours_(colours), view_(view), now_(now), list_(list), placing_(layout.window) {
    avoid_bodies();
    for (const HalfPlane& wall : half_planes(cast, view)) {
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
  void finish();

 private:
  struct Word {
    Formula set;
    std::vector<Placing::Candidate> places;
    Point anchor;
  };
  static Point size(const Formula& f) { return {f.width, f.ascent + f.descent}; }
  void avoid_bodies();
  void stroke(const std::vector<Point>& line, double width, Color color, double weight);
  void dashes(const Point& a, const Point& b);
  void arc(const Point& center, double radius, double from, double to, bool tip, double width, Color color);
  void word(Formula set, std::vector<Placing::Candidate> places, const Point& anchor) {
    if (!set.empty()) words_.push_back({std::move(set), std::move(places), anchor});
  }

  const sim::Cast& cast_;
  const Palette& colours_;
  const View& view_;
  const sim::Snapshot& now_;
  List& list_;
  Placing placing_;
  std::vector<Word> words_;
  std::vector<std::pair<Point, Color>> dots_;
};

void Notes::avoid_bodies() {
  for (std::size_t i = 0; i < cast_.bodies.size(); ++i) {
    const sim::Cast::Body& body = cast_.bodies[i];
    std::vector<Vec3> corners = body.vertices;
    if (body.kind == sim::ShapeKind::box)
      corners = {Vec3(-body.half.x(), -body.half.y(), 0), Vec3(body.half.x(), -body.half.y(), 0),
                 Vec3(body.half.x(), body.half.y(), 0), Vec3(-body.half.x(), body.half.y(), 0)};
    const double radius = body.radius > 0 ? body.radius : kDot * kPrint / view_.scale;
    if (corners.empty())
      for (int k = 0; k < 12; ++k)
        corners.push_back(radius *
                          Vec3(std::cos(k * std::numbers::pi / 6), std::sin(k * std::numbers::pi / 6), 0));
    for (std::size_t k = 0; k < corners.size(); ++k)
      placing_.avoid(view_.page(place({int(i), corners[k]}, now_)),
                     view_.page(place({int(i), corners[(k + 1) % corners.size()]}, now_)), 2);
  }
  for (const sim::Snapshot::Spring& spring : now_.springs) {
    const Point a = view_.page(spring.a), b = view_.page(spring.b), u = (b - a).normalized();
    for (const double side : {-3.0, 0.0, 3.0})
      placing_.avoid(a + side * kPoint * Point(-u.y(), u.x()), b + side * kPoint * Point(-u.y(), u.x()), 1);
  }
}

void Notes::stroke(const std::vector<Point>& line, double width, Color color, double weight) {
  std::vector<Node> nodes;
  for (const Point& p : line) nodes.push_back({p, width, color});
  list_.add(nodes, Cap::butt);
  for (std::size_t i = 0; i + 1 < line.size(); ++i) placing_.avoid(line[i], line[i + 1], weight);
}

void Notes::dashes(const Point& a, const Point& b) {
  const double length = (b - a).norm(), dash = 2.4 * kPoint, gap = 1.8 * kPoint;
  const Point u = (b - a) / length;
  for (double s = 0; s < length; s += dash + gap)
    stroke({a + s * u, a + std::min(s + dash, length) * u}, kThin, colours_.ink, 1);
}

// angles counter-clockwise from the right, rad
void Notes::arc(const Point& center, double radius, double from, double to, bool tip, double width,
                Color color) {
  const auto at = [&](double a) { return Point(center + radius * Point(std::cos(a), -std::sin(a))); };
  std::vector<Point> line;
  const int n = std::max(6, int(std::abs(to - from) / 0.06));
  // the shaft ends within its head
  const double head =
      tip ? std::copysign(std::min(20 * kArrow / radius, 0.7 * std::abs(to - from)), to - from) : 0;
  for (int i = 0; i <= n; ++i) line.push_back(at(from + (to - 0.8 * head - from) * i / n));
  stroke(line, width, color, 3);
  if (!tip) return;
  // the head points along the chord to its tip
  const Point end = at(to), back = at(to - head);
  const double grow = std::min(1.0, (end - back).norm() / (20 * kArrow));
  std::vector<Arrow> arrows{{Point(end - (end - back).normalized() * 18 * kArrow * grow), end, grow}};
  draw_arrows(arrows, kArrow, colours_.room, color, list_);
  placing_.avoid(back, end, 4);
}

void Notes::vector(const Figure::Vector& vector, Scales scales) {
  const Color ink = color_of(vector, colours_);
  for (const Reading& reading : readings(vector, cast_, now_)) {
    const std::string label = as_vector(vector.label);
    const auto set = [&](double value) {
      return formula(with_value(label, value, unit(vector.quantity)), kType, ink);
    };
    if (vector.quantity == Quantity::spin || vector.quantity == Quantity::torque) {
      if (!(std::abs(reading.signed_value) > 1e-9)) continue;
      // over the body's middle, with the way it turns
      const sim::Cast::Body& body = cast_.bodies[std::size_t(vector.body)];
      const double reach = body.radius > 0        ? 1.6 * body.radius
                           : body.half.norm() > 0 ? 0.62 * body.half.head<2>().minCoeff()
                                                  : 0;
      const double radius = std::clamp(view_.scale * reach, 9 * kPoint, 24 * kPoint);
      const double low = 25 * std::numbers::pi / 180, high = 165 * std::numbers::pi / 180;
      const Point center = view_.page(reading.tail);
      const bool left = reading.signed_value > 0;
      arc(center, radius, left ? low : high, left ? high : low, true, 1.1 * kPoint, ink);
      const Formula f = set(reading.signed_value);
      std::vector<Placing::Candidate> places;
      for (const double a : {low, 0.8, 1.2, high, 1.6, 2.1}) {
        const Point n(std::cos(a), -std::sin(a));
        for (const double off : {1.0, 3.0, 7.0})
          places.push_back({center + n * (radius + kGap * off) +
                                Point(n.x() * f.width / 2, n.y() * (f.ascent + f.descent) / 2),
                            off * kPoint, false});
      }
      word(f, places, center);
      continue;
    }
    const Point tail = view_.page(reading.tail);
    Point tip;
    if (vector.quantity == Quantity::normal) {
      tip = tail + kNormal * Point(reading.value.x(), -reading.value.y()).normalized();
    } else {
      const double* scale = scale_of(vector.quantity, scales);
      tip = view_.page(reading.tail + (scale ? *scale : 1.0) * reading.value);
    }
    std::vector<Arrow> arrows;
    offer(tail, tip, view_.window, kArrow, arrows);
    if (arrows.empty()) continue;
    draw_arrows(arrows, kArrow, colours_.room, ink, list_);
    placing_.avoid(tail, tip, 4);
    const Formula f = set(reading.value.norm());
    word(f, Placing::along(tail, tip, 1.7 * kGap, size(f), kPoint), (tail + tip) / 2);
  }
}

void Notes::angle(const Figure::Angle& angle) {
  Point center;
  double from = 0, to = 0;
  if (angle.body >= 0) {
    const sim::Snapshot::Body& body = now_.bodies[std::size_t(angle.body)];
    center = view_.page(body.position);
    to = std::remainder(body.angle, 2 * std::numbers::pi);
    const double reach = 22 * kPoint;
    dashes(center, center + Point(reach, 0));
    stroke({center, center + reach * Point(std::cos(to), -std::sin(to))}, kThin, colours_.ink, 2);
  } else {
    if (!angle.at || !angle.from || !angle.to) return;
    center = view_.page(place(*angle.at, now_));
    const Point a = view_.page(place(*angle.from, now_)) - center,
                b = view_.page(place(*angle.to, now_)) - center;
    from = std::atan2(-a.y(), a.x());
    to = from + std::remainder(std::atan2(-b.y(), b.x()) - from, 2 * std::numbers::pi);
  }
  const double radius = 13 * kPoint, middle = (from + to) / 2;
  arc(center, radius, from, to, false, kThin, colours_.ink);
  const double degrees = std::abs(to - from) * 180 / std::numbers::pi;
  const Formula f = formula(with_value(angle.label, degrees, "°"), kType, colours_.ink);
  const Point n(std::cos(middle), -std::sin(middle));
  std::vector<Placing::Candidate> places;
  for (const double off : {1.0, 2.0, 4.0, -3.2})
    places.push_back({center + n * (radius + off * kGap) +
                          (off > 0 ? 1 : -1) * Point(n.x() * f.width / 2, n.y() * (f.ascent + f.descent) / 2),
                      std::abs(off) * kPoint, false});
  for (const Placing::Candidate& more : Placing::around(center + radius * n, kGap, size(f), kPoint)) {
    places.push_back(more);
    places.back().cost += 12 * kPoint;
  }
  word(f, places, center + radius * n);
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

sim::Vec3 place(const Site& site, const sim::Snapshot& now) {
  if (site.body < 0) return site.local;
  const sim::Snapshot::Body& body = now.bodies[std::size_t(site.body)];
  const double c = std::cos(body.angle), s = std::sin(body.angle);
  return body.position +
         Vec3(c * site.local.x() - s * site.local.y(), s * site.local.x() + c * site.local.y(), 0);
}

double round_below(double x) {
  if (!(x > 0)) return 0;
  const double power = std::pow(10, std::floor(std::log10(x)));
  for (const double digit : {5.0, 2.0})
    if (digit * power <= x * (1 + 1e-12)) return digit * power;
  return power;
}

Scales scales(const Figure& figure, const sim::Cast& cast, std::span<const sim::Snapshot> moments,
              const Layout& layout) {
  Scales longest;
  for (const sim::Snapshot& now : moments) {
    for (const Figure::Vector& vector : figure.vectors) {
      double* most = scale_of(vector.quantity, longest);
      if (!most) continue;
      for (const Reading& each : readings(vector, cast, now)) *most = std::max(*most, each.value.norm());
    }
  }
  const double room = kLongest * std::min(layout.window.width, layout.window.height) / layout.scale;
  const auto scale = [&](double most) { return most > 1e-9 ? room / most : 0; };
  return {scale(longest.velocity), scale(longest.force), scale(longest.impulse)};
}

void annotate(const Figure& figure, const Scales& scales, const sim::Cast& cast, const Palette& colours,
              const Layout& layout, const View& view, const sim::Snapshot& now, List& list) {
  Notes notes(cast, colours, layout, view, now, list);
  for (const Figure::Length& length : figure.lengths) notes.length(length);
  for (const Figure::Angle& angle : figure.angles) notes.angle(angle);
  for (const Figure::Vector& vector : figure.vectors) notes.vector(vector, scales);
  for (const Figure::Point& point : figure.points) notes.point(point);
  for (const Figure::Label& label : figure.labels) notes.label(label);
  notes.finish();
}

bool has_legend(const Figure& figure) {
  Scales any;
  return figure.scale_bar || std::any_of(figure.vectors.begin(), figure.vectors.end(),
                                         [&](const auto& v) { return scale_of(v.quantity, any) != nullptr; });
}

void draw_legend(const Figure& figure, const Scales& scales, const Palette& colours, double scale,
                 double left, double right, double baseline, List& list) {
  const double middle = baseline - 0.24 * kSmall;
  const auto write = [&](const std::string& text, double x, Color ink) {
    const Formula f = formula(text, kSmall, ink);
    add(f, {x, baseline}, list);
    return f.width;
  };
  // the room's scale at the left
  if (figure.scale_bar) {
    const double metres = round_below(0.25 * (right - left) / scale), length = metres * scale;
    const double tick = 2 * kPoint;
    const auto line = [&](const Point& a, const Point& b) {
      list.add({{a, 0.7 * kPoint, colours.ink}, {b, 0.7 * kPoint, colours.ink}}, Cap::butt);
    };
    line({left, middle}, {left + length, middle});
    for (const double x : {left, left + length}) line({x, middle - tick}, {x, middle + tick});
    write(fmt::format("{:g} \"m\"", metres), left + length + 3 * kPoint, colours.ink);
  }
  // from the right: an arrow of each kind
  double x = right;
  struct Each {
    double scale;
    const char* unit;
    Quantity quantity;
  };
  for (const Each& kind :
       {Each{scales.impulse, "N s", Quantity::impulse}, Each{scales.force, "N", Quantity::contact},
        Each{scales.velocity, "m/s", Quantity::velocity}}) {
    if (!(kind.scale > 0)) continue;
    const double value = round_below(32 * kPoint / (kind.scale * scale));
    const double length = value * kind.scale * scale;
    const Formula f = formula(fmt::format("{:g} \"{}\"", value, kind.unit), kSmall, colours.ink);
    x -= f.width;
    add(f, {x, baseline}, list);
    x -= 3 * kPoint;
    std::vector<Arrow> arrows;
    offer({x - length, middle}, {x, middle}, {left, middle - length, right - left, 2 * length}, kArrow,
          arrows);
    Figure::Vector of;
    of.quantity = kind.quantity;
    draw_arrows(arrows, kArrow, colours.ground, color_of(of, colours), list);
    x -= length + 10 * kPoint;
  }
}

}  // namespace obscura::draw

// Annotation. Arrows and lines first; then every word, by `Placing`, off the lines that are there.

#include "draw/compose/annotate.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "draw/compose/notes.h"
#include "draw/page/measure.h"
#include "draw/page/readings.h"
#include "draw/page/sheet.h"
#include "draw/picture/convex.h"

namespace obscura::draw {
namespace {

constexpr double kBetweenArcs = 12;     // points
constexpr double kFilmType = 28 / 8.5;  // page units a point at the weight 1; of charts 33 / 8.5
constexpr double kAxes = 0.36;          // of the picture's shorter side: axes in space
constexpr double kAslant = 0.05;        // sine of an angle: nearer to each other two arrows are in line
constexpr double kApart = 1.1;          // widths of an arrow: how far one on another's line moves aside
constexpr double kHeads = 3;            // the same: so near to each other heads meet
constexpr double kTail = 1.7;           // widths of an arrow: radius of the dot where it begins
constexpr double kFull = 0.28;  // of an arrow's growth: from here on words of one that is cut are whole
constexpr double kValued = 0.14, kValuedFull = 0.18;   // the same: between these a value comes
constexpr double kLeastGrowth = 0.1;                   // the same: of less an arrow is nothing
constexpr double kNamedFrom = 0.4, kNamedFull = 0.66;  // the same of a name alone, up to the head's length
constexpr double kOutOfBall = 0.6;  // of a ball's radius: how far beyond it words of an arrow within it end

constexpr double kBeside = 2.3, kBesideInPrint = 2.1;  // gaps: from an arrow to its words
constexpr double kOffTip = 0.6;                        // of each unit from an axis's tip to its name
constexpr double kLate = 0.5;        // of each unit by which words are not where their arrow is
constexpr double kOnHead = 6;        // of each unit of a measure's end under words
constexpr double kOffMeasure = 0.1;  // points: more than rounding
constexpr double kAlongMeasure = 6;  // points: the cost of words along a measure, as beside an arrow
constexpr double kRing = 26;         // points: how far around a body words of short arrows stand at most

using sim::Vec3;

}  // namespace

Lettering film_lettering(double weight, double type_scale, int rows) {
  return {.point = kFilmType * weight * type_scale,
          .arrow = weight * std::max(1.0, type_scale),
          .weight = weight,
          .pixel = rows > 0 ? 1080.0 / rows : 0};
}

std::vector<Marks::Name> names_of(const Look& look) {
  std::vector<Marks::Name> names;
  for (std::size_t i = 0; i < look.bodies.size(); ++i)
    if (const BodyLook& body = look.bodies[i]; !body.label.empty())
      names.push_back({int(i), as_words(body.label), body.quiet});
  return names;
}

// where an arrow that runs along a spring leaves the body that it begins in: its halo would bite the coils
double Notes::bare(const Point& tail, const Point& tip) {
  constexpr int kPieces = 64;
  const Point u = (tip - tail).normalized();
  for (const sim::Snapshot::Spring& spring : now_.springs) {
    if (spring.loose) continue;
    const Point a = view_.page(spring.a), b = view_.page(spring.b), way = b - a;
    if (!(way.norm() > 0) || std::abs(way.normalized().dot(u)) < 0.9) continue;
    const auto off = [&](const Point& p) {
      const double part = std::clamp((p - a).dot(way) / way.squaredNorm(), 0.0, 1.0);
      return (p - a - part * way).norm();
    };
    if (off(tip) > 4 * point_ || off((tail + tip) / 2) > 4 * point_) continue;
    for (int k = 0; k <= kPieces; ++k)
      if (const double part = double(k) / kPieces; !on_body(tail + part * (tip - tail))) return part;
  }
  return 2;
}

// how much of its whole size an arrow comes to have in a film
double Notes::most_growth(const WordKey& key) const {
  if (!how_.plan) return 1;
  const auto range = how_.plan->ranges.find(key);
  if (range == how_.plan->ranges.end()) return 1;
  return std::max(kLeastGrowth, growth({0, 0}, {range->second.longest, 0}, arrow_));
}

bool Notes::arrow(const WordKey& key, const Point& tail, const Point& tip, Formula label, Color ink,
                  const AroundTail& around) {
  std::vector<Arrow> arrows;
  offer(tail, tip, view_.window(), arrow_, arrows);
  if (how_.ranges) {
    double& longest = (*how_.ranges)[key].longest;
    longest = std::max(longest, (tip - tail).norm());
  }
  // a value is read also where its arrow is always too short to be drawn
  const bool drawn = !arrows.empty();
  const double grow = growth(tail, tip, arrow_), most = film() && around.valued ? most_growth(key) : 1;
  if (!drawn && !(film() && around.valued && grow > kValued * most && grow <= kSmallest)) return false;
  if (how_.ranges && drawn) {
    const Point way = tip - tail;
    const double turn = std::atan2(-way.y(), way.x()) / (2 * std::numbers::pi);
    (*how_.ranges)[key].ways |= 1u << (int(std::floor(8 * turn)) & 7);
  }
  if (!drawn) arrows.push_back({.tail = tail, .tip = tip, .grow = grow});
  arrows[0].hang = hang_;
  if (drawn) arrows[0].bare = bare(arrows[0].tail, arrows[0].tip);
  // axes lie under plates, so that words are read over them; the others are drawn when all are known
  if (key.kind == WordKey::axis) {
    if (!how_.survey) draw_arrows(arrows, arrow_, colours_.room, ink, list_);
    axes_.push_back(arrows[0]);
  } else if (drawn) {
    arrows_.push_back(arrows[0]), inks_.push_back(ink);
  }
  // in print words stand beside what is seen of it
  const auto part = film() ? std::optional(std::pair(tail, arrows[0].tip)) : seen(tail, arrows[0].tip);
  if (!part) return false;
  const auto [start, end] = *part;
  if (drawn && (film() || key.kind == WordKey::axis)) avoid_arrow(start, end);
  // words come and go with the arrow: a value is as strong as others while that is there, or is as long as it
  // ever is; a name alone says nothing of an arrow that is hardly seen, but for one that is leaving the
  // picture
  const auto [from_grow, full_grow] = arrows[0].cut   ? std::pair(kSmallest, kFull)
                                      : around.valued ? std::pair(kValued * most, kValuedFull * most)
                                                      : std::pair(kNamedFrom, kNamedFull);
  if (film()) fade(label, (arrows[0].grow - from_grow) / (full_grow - from_grow));
  // those of one that ends within its ball stand where it would leave it; which place they have is chosen for
  // the others
  const auto [from, to] = eased(key, start, end, around.center);
  const double length = (to - from).norm(), reach = (1 + kOutOfBall) * around.ball;
  const bool within = film() && !how_.survey && length > 0 && length < reach;
  const Point beyond = within ? Point(from + reach / length * (to - from)) : to;
  const double gap = (film() ? kBeside : kBesideInPrint) * gap_;
  std::vector<Placing::Candidate> places =
      Placing::along(from, beyond, gap, size(label), point_, film(), past(around.along_ground, from, to));
  // an axis is named at its tip
  if (key.kind == WordKey::axis)
    for (Placing::Candidate& each : places) each.cost += kOffTip * (each.center - to).norm();
  // where they are not beside it yet, or no more
  if (how_.plan && how_.survey && (from != tail || to != end)) {
    const std::vector<Placing::Candidate> beside =
        Placing::along(tail, end, gap, size(label), point_, true, past(around.along_ground, tail, end));
    for (std::size_t i = 0; i < places.size(); ++i)
      places[i].cost += kLate * (places[i].center - beside[i].center).norm();
  }
  if (how_.plan) {
    const auto range = how_.plan->ranges.find(key);
    if (range != how_.plan->ranges.end() && range->second.swings())
      for (const Placing::Candidate& still :
           Placing::beside_swing(from, to, around.reach, std::max(range->second.longest, kRing * point_), gap,
                                 size(label), point_))
        places.push_back(still);
  }
  Word* its = word(key, label, std::move(places), (start + end) / 2, std::pair(start, end), around.center);
  if (its) its->ball = around.ball;
  if (its && drawn && key.kind != WordKey::axis) its->shown = int(arrows_.size()) - 1;
  return true;
}

// where the words of an arrow take its ends to be, as it is seen from its body
EasedArrow::Ends Notes::eased(const WordKey& key, const Point& tail, const Point& tip,
                              const Point& center) const {
  const EasedArrow::Ends ends{tail - center, tip - center};
  if (how_.arrows) (*how_.arrows)[key].add(how_.film, how_.before, ends);
  if (!how_.plan) return {tail, tip};
  const auto found = how_.plan->arrows.find(key);
  if (found == how_.plan->arrows.end()) return {tail, tip};
  const auto [from, to] = found->second.at(how_.film, ends);
  return {from + center, to + center};
}

// how far a body reaches from an arrow's tail along it
std::optional<double> Notes::past(std::optional<int> body, const Point& tail, const Point& tip) const {
  if (!film() || !body) return std::nullopt;
  const Point u = (tip - tail).normalized();
  double far = 0;
  for (const std::vector<Point>& outline : forms(*body, 12, now_))
    for (const Point& p : outline) far = std::max(far, (p - tail).dot(u));
  return far;
}

// Whether two arrows begin at one place.
bool Notes::begin_together(std::size_t i, std::size_t j) const {
  return (arrows_[i].tail - arrows_[j].tail).norm() < kArrowLine * arrow_;
}

// How much arrow i lies on the line of arrow j and over it, 0 to 1, where it would also if either were longer
// by so much.
double Notes::on_one_line(std::size_t i, std::size_t j, double longer) const {
  const Arrow &a = arrows_[i], &b = arrows_[j];
  const Point along = a.tip - a.tail, other = b.tip - b.tail;
  const double length = along.norm(), wide = kArrowLine * arrow_;
  const Point u = along / length, across(-u.y(), u.x());
  const double from = (b.tail - a.tail).dot(u), to = (b.tip - a.tail).dot(u);
  const double shared = std::min(std::max(from, to), length) - std::max(std::min(from, to), 0.0) + longer;
  const double aslant = std::abs(other.normalized().dot(across)) / kAslant,
               off = std::abs((b.tail - a.tail).dot(across)) / wide;
  return std::min(std::clamp(2 - std::max(aslant, off), 0.0, 1.0),
                  std::clamp(shared / (2 * wide) - 0.5, 0.0, 1.0));
}

// Arrows that lie over each other on one line read as one, with a head at either end: a dot shows where each
// begins. It grows as they come into line, so that it does not flicker.
std::vector<double> Notes::tails() const {
  std::vector<double> strength(arrows_.size(), 0);
  for (std::size_t i = 0; i < arrows_.size() && view_.view(); ++i)
    for (std::size_t j = 0; j < arrows_.size(); ++j)
      if (i != j && !begin_together(i, j)) strength[i] = std::max(strength[i], on_one_line(i, j, 0));
  return strength;
}

void Notes::mark_tails(const std::vector<double>& strength) {
  for (std::size_t i = 0; i < arrows_.size(); ++i) {
    const double radius = kTail * kArrowLine * arrow_ * strength[i];
    if (radius > 0.5 * kArrowLine * arrow_) list_.add(Disc{arrows_[i].tail, radius, 0, inks_[i], inks_[i]});
  }
}

// Two arrows on one line that meet head on, or lie over each other, are moved to either side of it, and the
// ends of their words' leaders with them.
void Notes::set_apart() {
  const double wide = kArrowLine * arrow_;
  std::vector<Point> moved(arrows_.size(), Point(0, 0));
  for (std::size_t i = 0; i < arrows_.size(); ++i)
    for (std::size_t j = i + 1; j < arrows_.size(); ++j) {
      const Point u = (arrows_[i].tip - arrows_[i].tail).normalized(), across(-u.y(), u.x());
      const bool head_on = u.dot(arrows_[j].tip - arrows_[j].tail) < 0;
      if (head_on && begin_together(i, j)) continue;
      const double by = kApart * wide * on_one_line(i, j, head_on ? kHeads * wide : 0);
      moved[i] -= by * across, moved[j] += by * across;
    }
  for (std::size_t i = 0; i < arrows_.size(); ++i) arrows_[i].tail += moved[i], arrows_[i].tip += moved[i];
  for (Word& word : words_) {
    if (word.shown < 0) continue;
    const Point& by = moved[std::size_t(word.shown)];
    word.anchor += by, word.arrow->first += by, word.arrow->second += by;
    for (Placing::Candidate& each : word.places) each.center += by;
  }
}

void Notes::hang(const Vec3& a, const Vec3& b) {
  if (view_.view() || how_.survey) return;
  hang_ = Hang{a, b};
  list_.hang(hang_);
}

// Seen from elsewhere it goes with its nodes.
void Notes::stroke_through(const std::vector<Vec3>& way, double width, Color color, double weight) {
  std::vector<Point> line;
  for (const Vec3& place : way) line.push_back(view_.page(place));
  by_nodes(way);
  stroke(line, width, color, weight);
  list_.hang(hang_);
}

void Notes::by_nodes(const std::vector<Vec3>& way) {
  if (hang_) list_.hang(Hang{Vec3::Zero(), Vec3::Zero(), way});
}

void Notes::stroke(const std::vector<Point>& line, double width, Color color, double weight) {
  std::vector<Node> nodes;
  for (const Point& p : line) nodes.push_back({p, width, color});
  list_.add(nodes, Cap::butt);
  for (std::size_t i = 0; i + 1 < line.size(); ++i) placing_.avoid(line[i], line[i + 1], weight);
}

void Notes::dashes(const Vec3& from, const Vec3& to) {
  const Point a = view_.page(from), b = view_.page(to);
  const double length = (b - a).norm(), dash = 2.4 * point_, gap = 1.8 * point_;
  if (!(length > 0)) return;
  const Point u = (b - a) / length;
  for (double s = 0; s < length; s += dash + gap) {
    const double end = std::min(s + dash, length);
    by_nodes({view_.between(from, to, s / length), view_.between(from, to, end / length)});
    stroke({a + s * u, a + end * u}, thin_, colours_.ink, 1);
  }
  list_.hang(hang_);
}

// An arc with a tip through `at` of an angle, rad, of about `radius` on the page.
template <class At, class Place>
void Notes::arc(const At& at, const Place& place, double radius, double from, double to, double width,
                Color color) {
  std::vector<Point> line;
  const int n = std::max(6, int(std::abs(to - from) / 0.06));
  // the shaft ends within its head
  double head = std::copysign(std::min(20 * arrow_ / radius, 0.7 * std::abs(to - from)), to - from);
  // longer where the arc is seen aslant
  while ((at(to) - at(to - head)).norm() < 16 * arrow_ && std::abs(head) < 0.4 * std::abs(to - from))
    head *= 1.2;
  std::vector<Vec3> way;
  for (int i = 0; i <= n; ++i) {
    const double angle = from + (to - 0.8 * head - from) * i / n;
    line.push_back(at(angle)), way.push_back(place(angle));
  }
  by_nodes(way);
  stroke(line, width, color, 3);
  list_.hang(hang_);
  // the head points along the chord to its tip
  const Point end = at(to), back = at(to - head);
  const double grow = std::min(1.0, (end - back).norm() / (20 * arrow_));
  if (!(grow > 0)) return;
  std::vector<Arrow> arrows{{Point(end - (end - back).normalized() * 18 * arrow_ * grow), end, grow}};
  if (hang_) arrows[0].hang = Hang{place(to - head), place(to)};
  draw_arrows(arrows, arrow_, colours_.room, color, list_);
  placing_.avoid(back, end, 4);
}

// An arc with the way that it turns: in the plane over the body's middle; in space around it, about the axis,
// which is dashed, and open away from the eye; its tip is before the body.
void Notes::turn(const WordKey& key, const Marks::Vector& vector, const Reading& reading,
                 const Formula& label, Color ink, int among) {
  if (!(std::abs(reading.signed_value) > negligible(unit(vector.quantity), cast_, vector.body))) return;
  const sim::SceneInfo::Body& body = cast_.bodies[std::size_t(vector.body)];
  const Point center = view_.page(reading.tail);
  const double scale = view_.scale_at(reading.tail), wide = 1.1 * point_;
  std::vector<Placing::Candidate> places;
  const auto around = [&](const auto& at, std::initializer_list<double> angles) {
    for (const double a : angles) {
      const Point out = at(a) - center, n = out.norm() > 0 ? Point(out.normalized()) : Point(1, 0);
      for (const double off : {1.0, 3.0, 7.0})
        places.push_back({at(a) + n * gap_ * off +
                              Point(n.x() * label.width / 2, n.y() * (label.ascent + label.descent) / 2),
                          off * point_, false});
    }
  };
  if (view_.view()) {
    const double reach = body.radius > 0        ? 1.6 * body.radius
                         : body.half.norm() > 0 ? 0.62 * body.half.head<2>().minCoeff()
                                                : 0;
    const double radius = std::clamp(scale * reach, 9 * point_, 24 * point_) + kBetweenArcs * among * point_;
    const auto at = [&](double a) { return Point(center + radius * Point(std::cos(a), -std::sin(a))); };
    const double low = 25 * std::numbers::pi / 180, high = 165 * std::numbers::pi / 180;
    const bool left = reading.signed_value > 0;
    arc(
        at, [](double) { return Vec3(Vec3::Zero()); }, radius, left ? low : high, left ? high : low, wide,
        ink);
    around(at, {low, 0.8, 1.2, high, 1.6, 2.1});
  } else {
    const double reach = body.radius > 0 ? 1.4 * body.radius : 1.05 * body.half.norm();
    const double radius = std::clamp(scale * reach, 12 * point_, 40 * point_) + kBetweenArcs * among * point_,
                 world = radius / scale;
    const Vec3 axis = reading.value.normalized();
    Vec3 near = view_.sight(reading.tail);
    near -= axis.dot(near) * axis;
    near = near.norm() > 1e-6 ? Vec3(near.normalized()) : axis.unitOrthogonal();
    const Vec3 on = axis.cross(near);
    const auto place = [&](double a) {
      return Vec3(reading.tail + world * (std::cos(a) * near + std::sin(a) * on));
    };
    const auto at = [&](double a) { return view_.page(place(a)); };
    const double back = -150 * std::numbers::pi / 180, ahead = 65 * std::numbers::pi / 180;
    dashes(reading.tail, reading.tail + 1.5 * world * axis);
    arc(at, place, radius, back, ahead, wide, ink);
    around(at, {ahead, 0.5 * ahead, 0.0, 0.3 * back, 0.6 * back, back});
  }
  word(key, label, places, center);
}

Point Notes::center(int body) const {
  return body < 0 ? Point(0, 0) : view_.page(now_.bodies[std::size_t(body)].position);
}

AroundTail Notes::around(const Marks::Vector& vector, const Reading& reading) const {
  const bool valued = vector.label.find('{') != vector.label.npos;
  if (vector.body < 0) return {.valued = valued};
  std::optional<int> ground;
  if (vector.quantity == Quantity::friction && !vector.at) ground = vector.body;
  const sim::SceneInfo::Body& body = cast_.bodies[std::size_t(vector.body)];
  const double scale = view_.scale_at(reading.tail);
  const double off = (reading.tail - now_.bodies[std::size_t(vector.body)].position).norm();
  const double reach = body.radius > 0 ? body.radius : body.half.norm();
  return {off < 1e-9 ? scale * body.radius : 0, scale * (reach + (off < 1e-9 ? 0 : off)), center(vector.body),
          valued, ground};
}

void Notes::vector(int index, const Marks::Vector& vector, Scales scales) {
  const Color ink = color_of(vector, colours_);
  const std::vector<Reading> all = readings(vector, cast_, now_);
  for (const Reading& reading : all) {
    if (!view_.before(reading.tail)) continue;
    hang(reading.tail, reading.tail);
    const WordKey key{WordKey::vector, index, reading.part};
    const auto numbered = std::find(vector.numbered.begin(), vector.numbered.end(), reading.part);
    const std::string with_its_number =
        numbered == vector.numbered.end()
            ? vector.label
            : with_number(vector.label, int(numbered - vector.numbered.begin()) + 1);
    // its letter is a vector's, but where a number says how large it is
    const std::string label =
        vector.label.find('=') == std::string::npos ? as_vector(with_its_number) : with_its_number;
    const auto set = [&](double value) {
      return this->set(key, label, value, unit(vector.quantity), vector.body, legible(ink, colours_));
    };
    if (turns(vector.quantity)) {
      // arcs about one place lie around each other
      const auto among = std::count_if(all.data(), &reading, [&](const Reading& other) {
        return (other.tail - reading.tail).norm() < 1e-9 * cast_.scale;
      });
      turn(key, vector, reading, set(reading.signed_value), ink, int(among));
      continue;
    }
    const Formula label_set = set(reading.value.norm());
    if (vector.quantity == Quantity::normal && view_.view()) {
      const Point tail = view_.page(reading.tail);
      arrow(key, tail, tail + normal_ * Point(reading.value.x(), -reading.value.y()).normalized(), label_set,
            ink, {.center = center(vector.body)});
    } else {
      const double* scale = scale_of(vector.quantity, scales);
      const double length = vector.quantity == Quantity::normal ? normal_ / view_.scale_at(reading.tail)
                            : scale                             ? *scale
                                                                : 1.0;
      const Vec3 tip = reading.tail + length * reading.value;
      hang(reading.tail, tip);
      if (view_.before(tip))
        arrow(key, view_.page(reading.tail), view_.page(tip), label_set, ink, around(vector, reading));
    }
  }
}

void Notes::angle(int index, const Marks::Angle& angle) {
  Vec3 center = Vec3::Zero(), from = Vec3::UnitX(), to = Vec3::UnitX();
  double wide = angle_;
  std::optional<double> turned;  // of a body of the plane: its angle, with its sign and whole turns
  if (angle.body >= 0) {
    const sim::Snapshot::Body& body = now_.bodies[std::size_t(angle.body)];
    center = body.position;
    to = body.orientation * Vec3::UnitX();
    if (view_.view()) turned = body.angle;
    const double reach = 22 * point_ / view_.scale_at(center);
    dashes(center, center + reach * from);
    stroke_through({center, center + reach * to}, thin_, colours_.ink, 2);
  } else {
    if (!angle.at || !angle.from || !angle.to) return;
    center = place(*angle.at, now_);
    from = place(*angle.from, now_) - center, to = place(*angle.to, now_) - center;
    if (!(from.norm() > 0 && to.norm() > 0)) return;
    // in space two directions may look close: farther out
    const double shorter = std::min(from.norm(), to.norm()) * view_.scale_at(center);
    if (!view_.view()) wide = std::clamp(0.4 * shorter, angle_, 2.5 * angle_);
    from.normalize(), to.normalize();
    hang(center, center);
    dashes(center, center + (wide + 7 * point_) / view_.scale_at(center) * from);
  }
  // an arc of the great circle through both; of a body's angle as far as it has turned, but for whole turns
  const double whole =
      turned ? std::fmod(*turned, 2 * std::numbers::pi) : std::atan2(from.cross(to).norm(), from.dot(to));
  Vec3 across = turned ? Vec3(Vec3::UnitY()) : Vec3(to - from.dot(to) * from);
  if (!(across.norm() > 1e-12 && std::abs(whole) > 1e-12)) return;
  across.normalize();
  const double radius = wide / view_.scale_at(center);
  const auto on_arc = [&](double a) {
    return Vec3(center + radius * (std::cos(a) * from + std::sin(a) * across));
  };
  std::vector<Vec3> way;
  const int n = std::max(6, int(std::abs(whole) / 0.06));
  for (int i = 0; i <= n; ++i) way.push_back(on_arc(whole * i / n));
  stroke_through(way, thin_, colours_.ink, 3);
  hang(on_arc(whole / 2), on_arc(whole / 2));

  const double degrees = turned.value_or(whole) * 180 / std::numbers::pi;
  const WordKey key{WordKey::angle, index};
  const Formula f = set(key, angle.label, degrees, "°", angle.body, colours_.ink);
  const Point hub = view_.page(center), rim = view_.page(on_arc(whole / 2)), out = rim - hub;
  const Point m = out.norm() > 0 ? Point(out.normalized()) : Point(1, 0);
  std::vector<Placing::Candidate> places;
  for (const double off : {1.0, 2.0, 4.0, -3.2})
    places.push_back({rim + off * gap_ * m +
                          (off > 0 ? 1 : -1) * Point(m.x() * f.width / 2, m.y() * (f.ascent + f.descent) / 2),
                      std::abs(off) * point_, false});
  for (const Placing::Candidate& more : Placing::around(rim, gap_, size(f), point_)) {
    places.push_back(more);
    places.back().cost += 12 * point_;
  }
  word(key, f, places, rim);
}

// In space: from the origin, all of one length.
void Notes::axes() {
  const Rect& window = view_.window();
  const double length = kAxes * std::min(window.width, window.height) / view_.scale_at(Vec3::Zero());
  const std::pair<Vec3, const char*> all[] = {
      {Vec3::UnitX(), "x"}, {Vec3::UnitY(), "y"}, {Vec3::UnitZ(), "z"}};
  int index = 0;
  for (const auto& [axis, name] : all) {
    // the plane's two
    if (view_.view() && index == 2) break;
    hang(Vec3::Zero(), length * axis);
    arrow({WordKey::axis, index++}, view_.page(Vec3::Zero()), view_.page(length * axis),
          formula(name, type_, colours_.ink), colours_.ink);
  }
}

void Notes::length(int index, const Marks::Length& length) {
  if (!view_.before(place(length.from, now_)) || !view_.before(place(length.to, now_))) return;
  const Point a = view_.page(place(length.from, now_)), b = view_.page(place(length.to, now_));
  hang(place(length.from, now_), place(length.to, now_));
  const Point u = (b - a).normalized(), v(u.y(), -u.x());
  const Point off = length.offset * millimetre_ * v;
  const Point from = a + off, to = b + off;
  // lines from what is measured to the measure
  if (std::abs(length.offset) > 0.5) {
    const double side = length.offset > 0 ? 1 : -1;
    for (const auto& [start, end] : {std::pair(a, from), std::pair(b, to)})
      stroke({start + side * 1.5 * point_ * v, end + side * 1.5 * point_ * v}, 0.35 * point_, colours_.ink,
             1);
  }
  stroke({from, to}, thin_, colours_.ink, 2);
  const double head = std::min(4.5 * point_, 0.4 * (to - from).norm()), half = 0.3 * head;
  for (const auto& [tip, way] : {std::pair(from, u), std::pair(to, Point(-u))}) {
    if (!film()) placing_.avoid(tip - half * v, tip + head * way + half * v, kOnHead);
    list_.add({tip, tip + head * way + half * v, tip + 0.75 * head * way, tip + head * way - half * v},
              colours_.ink);
  }
  const double metres = (place(length.to, now_) - place(length.from, now_)).norm();
  const WordKey key{WordKey::length, index};
  const Formula f = set(key, length.label, metres, "m", -1, colours_.ink);
  // in print beside what is seen of it
  const auto shown = film() ? std::optional(std::pair(from, to)) : seen(from, to);
  if (!shown) return;
  const auto [start, end] = *shown;
  const Point middle = (start + end) / 2;
  const double high = f.ascent + f.descent;
  // so far from the line that the room around them is free
  const double gap = film() ? gap_ : std::max(gap_, kMarginInPrint * high + kOffMeasure * point_);
  std::vector<Placing::Candidate> places;
  for (const double s : {1.0, -1.0})
    for (const double part : {0.5, 0.35, 0.65})
      places.push_back(
          {start + part * (end - start) + s * (gap * v + Point(v.x() * f.width / 2, v.y() * high / 2)),
           (part == 0.5 ? 0 : 3) * point_ + (s > 0 ? 0 : point_), false});
  // farther off where there is no room beside it
  for (const double far : {12.0, 26.0, 42.0})
    for (const double s : {1.0, -1.0})
      places.push_back(
          {middle + s * ((gap + far * point_) * v + Point(v.x() * f.width / 2, v.y() * high / 2)),
           (8 + far) * point_, true});
  if (!film())
    for (Placing::Candidate each : Placing::along(start, end, gap, size(f), point_)) {
      each.cost += kAlongMeasure * point_;
      places.push_back(each);
    }
  word(key, f, places, middle);
}

Projection::Projection(const CameraProjection& lens, double scale, const Point& corner)
    : lens_(lens), scale_(scale), corner_(corner) {
  const Rect& w = lens.window;
  window_ = {corner.x() + scale * w.x, corner.y() + scale * w.y, scale * w.width, scale * w.height};
}

Point Projection::page(const Vec3& place) const {
  return view_ ? view_->page(place) : Point(corner_ + scale_ * lens_.page(place));
}

Vec3 Projection::between(const Vec3& a, const Vec3& b, double part) const {
  if (!view_) {
    const double da = lens_.depth(a), db = lens_.depth(b);
    part = part * da / (db + part * (da - db));
  }
  return a + part * (b - a);
}

double Projection::scale_at(const Vec3& place) const {
  return view_ ? view_->scale : scale_ * lens_.scale_at(place);
}

bool Projection::before(const Vec3& place) const { return view_ || lens_.depth(place) > 1e-2; }

Vec3 Projection::sight(const Vec3& place) const { return view_ ? Vec3(Vec3::UnitZ()) : lens_.sight(place); }

void annotate(const Marks& marks, const Scales& scales, const sim::SceneInfo& cast, const Palette& colours,
              const Projection& projection, const sim::Snapshot& now, List& list, const Annotating& how) {
  Notes notes(cast, colours, projection, now, how, list);
  const auto each = [&](const auto& all, auto draw) {
    for (std::size_t i = 0; i < all.size(); ++i)
      if (all[i].shown.has(now.time, how.film)) draw(int(i), all[i]);
  };
  if (marks.axes && (!projection.view() || how.plan || how.survey)) notes.axes();
  each(marks.cones, [&](int i, const Marks::Cone& cone) { notes.cone(i, cone, scales); });
  each(marks.lengths, [&](int i, const Marks::Length& length) { notes.length(i, length); });
  each(marks.angles, [&](int i, const Marks::Angle& angle) { notes.angle(i, angle); });
  each(marks.vectors, [&](int i, const Marks::Vector& vector) { notes.vector(i, vector, scales); });
  each(marks.points, [&](int i, const Marks::Point& point) { notes.point(i, point); });
  each(marks.labels, [&](int i, const Marks::Label& label) { notes.label(i, label); });
  for (std::size_t i = 0; i < marks.names.size(); ++i) notes.name(int(i), marks.names[i], marks);
  notes.times();
  notes.finish();
}

}  // namespace obscura::draw

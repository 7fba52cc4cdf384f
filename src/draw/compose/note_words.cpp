// The words of marks: what they keep off, where they may stand, and their plates.

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "draw/compose/notes.h"
#include "draw/page/measure.h"

namespace obscura::draw {
namespace {

// points
constexpr double kType = 10;   // em
constexpr double kThin = 0.5;  // of angles and lengths
constexpr double kDotRadius = 1.7, kGap = 2.2;
constexpr double kMillimetre = 72 / 25.4;
constexpr double kNormal = 9 * 72 / 25.4;  // a unit normal: 9 mm
constexpr double kAngle = 13;              // radius of an arc
constexpr double kOffHatching = 2.5;       // from it to the words of a film
constexpr double kCovered = 60;            // the cost of words over a body

constexpr std::uint8_t kPlate = 150;  // how much of what lies under the words of a film is covered

using sim::Vec3;

}  // namespace

Notes::Notes(const sim::SceneInfo& cast, const Palette& colours, const Projection& projection,
             const sim::Snapshot& now, const Annotating& how, List& list)
    : cast_(cast),
      colours_(colours),
      view_(projection),
      now_(now),
      how_(how),
      list_(list),
      placing_(projection.window()),
      point_(how.lettering.point),
      arrow_(how.lettering.arrow),
      type_(kType * point_),
      thin_(kThin * point_),
      dot_radius_(kDotRadius * point_),
      gap_(kGap * point_),
      millimetre_(kMillimetre * point_),
      normal_(kNormal * point_),
      angle_(kAngle * point_) {
  // of a film the places are known
  if (how_.plan && !how_.survey) return;
  how_.survey ? avoid_areas() : avoid_bodies();
  if (!view_.view()) return;
  for (const HalfPlane& wall : half_planes(cast, *view_.view())) {
    const Point along(-wall.normal.y(), wall.normal.x());
    placing_.avoid(wall.point - 1e4 * along, wall.point + 1e4 * along, film() ? 12 : 3);
    // nor in the hatching; in a film not at its edge either, where a word that moves would touch it
    const double band = kBand * how_.lettering.weight + (film() ? kOffHatching * point_ : 0);
    for (double deep = 2; deep < band; deep += 4)
      placing_.avoid(wall.point - deep * wall.normal - 1e4 * along,
                     wall.point - deep * wall.normal + 1e4 * along, film() ? 12 : 1);
  }
}

const std::vector<std::vector<Point>>& Notes::outlines() {
  if (!outlines_.empty()) return outlines_;
  const bool flat = view_.view() != nullptr;
  for (std::size_t i = 0; i < cast_.bodies.size(); ++i) {
    const sim::SceneInfo::Body& body = cast_.bodies[i];
    const sim::Snapshot::Body& it = now_.bodies[i];
    std::vector<Vec3> corners = flat ? body.vertices : std::vector<Vec3>();
    if (body.kind == sim::ShapeKind::box)
      corners = {Vec3(-body.half.x(), -body.half.y(), 0), Vec3(body.half.x(), -body.half.y(), 0),
                 Vec3(body.half.x(), body.half.y(), 0), Vec3(-body.half.x(), body.half.y(), 0)};
    std::vector<Point>& outline = outlines_.emplace_back();
    for (const Vec3& corner : corners) outline.push_back(view_.page(place({int(i), corner}, now_)));
    if (!outline.empty()) continue;
    const double scale = view_.scale_at(it.position);
    const double radius = body.radius > 0 ? scale * body.radius : kDot * how_.lettering.weight;
    for (int k = 0; k < 12; ++k)
      outline.push_back(view_.page(it.position) + radius * Point(std::cos(k * std::numbers::pi / 6),
                                                                 -std::sin(k * std::numbers::pi / 6)));
  }
  return outlines_;
}

void Notes::avoid_bodies() {
  for (const std::vector<Point>& outline : outlines())
    for (std::size_t k = 0; k < outline.size(); ++k)
      placing_.avoid(outline[k], outline[(k + 1) % outline.size()], 2);
  avoid_springs();
}

void Notes::avoid_springs() {
  for (const sim::Snapshot::Spring& spring : now_.springs) {
    const Point a = view_.page(spring.a), b = view_.page(spring.b), u = (b - a).normalized();
    for (const double side : {-3.0, 0.0, 3.0})
      placing_.avoid(a + side * point_ * Point(-u.y(), u.x()), b + side * point_ * Point(-u.y(), u.x()), 1);
  }
}

bool Notes::on_body(const Point& p) {
  return std::any_of(outlines().begin(), outlines().end(), [&](const std::vector<Point>& outline) {
    bool left = false, right = false;
    for (std::size_t k = 0; k < outline.size(); ++k) {
      const Point a = outline[k], way = outline[(k + 1) % outline.size()] - a;
      const double side = way.x() * (p.y() - a.y()) - way.y() * (p.x() - a.x());
      left = left || side > 0, right = right || side < 0;
    }
    return !(left && right);
  });
}

// what a label says, with its value; in a film in digits of equal width, as many at every instant
Formula Notes::set(const WordKey& key, const std::string& text, double value, std::string_view unit,
                   Color ink) {
  if (how_.ranges) {
    ValueRange& range = (*how_.ranges)[key];
    range.low = std::min(range.low, value), range.high = std::max(range.high, value);
  }
  if (!how_.plan) return formula(with_value(text, value, unit), type_, ink);
  const auto known = how_.plan->ranges.find(key);
  ValueRange range = known == how_.plan->ranges.end() ? ValueRange{value, value} : known->second;
  range.low = std::min(range.low, value), range.high = std::max(range.high, value);
  return live(text, value, range.low, range.high, unit, type_, ink);
}

// where the plan has a word now; on its way from one place to another between both
Placing::Candidate Notes::planned(const Word& word, double& leader) const {
  const auto found = how_.plan->courses.find(word.key);
  const int n = int(word.places.size());
  const auto at = [&](int i) { return word.places[std::size_t(std::clamp(i, 0, n - 1))]; };
  if (found == how_.plan->courses.end()) return at(0);
  const LabelPlan::Course& course = found->second;
  Placing::Candidate now = at(course.first);
  double led = now.leader ? 1 : 0;
  for (const LabelPlan::Move& move : course.moves) {
    if (how_.film <= move.begin) break;
    const double u = how_.film >= move.end ? 1 : (how_.film - move.begin) / (move.end - move.begin);
    const double s = u * u * (3 - 2 * u);
    const Placing::Candidate next = at(move.to);
    now.center += s * (next.center - now.center);
    led += s * ((next.leader ? 1 : 0) - led);
  }
  now.leader = led > 0, leader = led;
  return now;
}

// Words stand out against what they cover.
void Notes::plate(const Point& center, const Point& size, std::uint8_t strength) {
  Color color = colours_.room;
  color.a = std::uint8_t(kPlate * strength / 255);
  Box box;
  box.center = center, box.x_axis = {1, 0}, box.half = size / 2 + Point(1.2, 0.8) * point_, box.fill = color;
  list_.add(box);
}

// the outlines of bodies, and what lies within
void Notes::avoid_areas() {
  const auto area = [&](const std::vector<Point>& outline) {
    for (std::size_t k = 0; k < outline.size(); ++k)
      placing_.avoid(outline[k], outline[(k + 1) % outline.size()], 2);
    placing_.avoid(outline, kCovered * point_);
  };
  const auto round = [&](const Vec3& center, double radius) {
    if (!view_.before(center)) return;
    const double r = radius > 0 ? view_.scale_at(center) * radius : kDot * how_.lettering.weight;
    std::vector<Point> outline;
    for (int k = 0; k < 12; ++k)
      outline.push_back(view_.page(center) +
                        r * Point(std::cos(k * std::numbers::pi / 6), -std::sin(k * std::numbers::pi / 6)));
    area(outline);
  };
  const auto form = [&](const sim::DrawnForm& it, const sim::Snapshot::Body& body) {
    std::vector<Vec3> corners = it.vertices;
    if (it.kind == sim::ShapeKind::box)
      for (int k = 0; k < 8; ++k)
        corners.push_back(it.half.cwiseProduct(Vec3(k & 1 ? 1 : -1, k & 2 ? 1 : -1, k & 4 ? 1 : -1)));
    const auto world = [&](const Vec3& local) {
      return Vec3(body.position + body.orientation * (it.center + it.turn * local));
    };
    std::vector<Point> all;
    if (it.kind == sim::ShapeKind::capsule) {
      for (int k = 0; k < 24; ++k) {
        const Vec3 end = world(Vec3(0, k < 12 ? it.half.y() : -it.half.y(), 0));
        if (!view_.before(end)) return;
        const double a = k * std::numbers::pi / 6;
        all.push_back(view_.page(end) + view_.scale_at(end) * it.radius * Point(std::cos(a), std::sin(a)));
      }
      return area(convex_hull(all));
    }
    if (corners.empty()) return round(world(Vec3::Zero()), it.radius);
    for (const Vec3& corner : corners) {
      if (!view_.before(world(corner))) return;
      all.push_back(view_.page(world(corner)));
    }
    area(convex_hull(all));
  };
  for (std::size_t i = 0; i < cast_.bodies.size(); ++i) {
    const sim::SceneInfo::Body& body = cast_.bodies[i];
    for (const sim::DrawnForm& part : body.parts) form(part, now_.bodies[i]);
    if (!body.parts.empty()) continue;
    sim::DrawnForm whole;
    whole.kind = body.kind, whole.radius = body.radius, whole.half = body.half,
    whole.vertices = body.vertices;
    form(whole, now_.bodies[i]);
  }
  avoid_springs();
  for (std::size_t i = 0; i < cast_.joints.size(); ++i) {
    const sim::Snapshot::Joint& joint = now_.joints[i];
    if (!joint.broken && view_.before(joint.a) && view_.before(joint.b))
      placing_.avoid(view_.page(joint.a), view_.page(joint.b), 2);
  }
}

void Notes::finish() {
  if (film()) draw_arrows(arrows_, inks_, arrow_, colours_.room, list_);
  mark_tails();
  for (const auto& [at, ink, hang] : dots_) {
    list_.hang(hang);
    list_.add(Disc{at, dot_radius_ + 0.6 * point_, 0, colours_.room, colours_.room});
    list_.add(Disc{at, dot_radius_, 0, ink, ink});
  }
  list_.hang({});
  if (how_.survey) return offer_places();
  // words that move keep to whole pixels: they look the same in every frame, and are cheap to encode
  const auto whole = [&](const Point& at) {
    const double pixel = how_.lettering.pixel;
    return pixel > 0 ? Point(std::round(at.x() / pixel) * pixel, std::round(at.y() / pixel) * pixel) : at;
  };
  const auto write = [&](const Word& word, const Point& center) {
    const Point half = size(word.set) / 2;
    const Point at(center.x() - half.x(), center.y() - half.y() + word.set.ascent);
    const std::size_t first = list_.texts.size();
    list_.hang(word.hang);
    add(word.set, whole(at), list_, hold(word, center));
    if (how_.lettering.pixel > 0) return;
    for (std::size_t i = first; i < list_.texts.size(); ++i) list_.texts[i].whole = at;
  };
  std::vector<Point> centers;
  for (Word& word : words_) {
    double leader = 1;
    const Placing::Candidate best =
        how_.plan ? planned(word, leader) : placing_.place(size(word.set), word.places);
    list_.hang(word.hang);
    if (best.leader) lead(word, best.center, leader);
    centers.push_back(best.center);
    if (!film()) write(word, best.center);
  }
  if (!film()) return;
  // one kind after another is drawn in few batches
  for (std::size_t i = 0; i < words_.size(); ++i)
    if (covers(words_[i].key))
      list_.hang(words_[i].hang), plate(whole(centers[i]), size(words_[i].set), words_[i].set.color.a);
  for (std::size_t i = 0; i < words_.size(); ++i) write(words_[i], centers[i]);
  list_.hang({});
}

// whether something may lie under words of a film
bool Notes::covers(const WordKey& key) const {
  if (!how_.plan) return true;
  const auto found = how_.plan->courses.find(key);
  return found == how_.plan->courses.end() || found->second.covers;
}

// the side of words that faces what they name
Hold Notes::hold(const Word& word, const Point& center) {
  Point to = word.anchor;
  if (word.arrow) {
    const auto& [tail, tip] = *word.arrow;
    const Point way = tip - tail;
    const double part = way.squaredNorm() > 0 ? (center - tail).dot(way) / way.squaredNorm() : 0;
    to = tail + std::clamp(part, 0.0, 1.0) * way;
  }
  const Point out = to - center, half = 0.8 * size(word.set) / 2;
  return {out.x() < -half.x()  ? Align::left
          : out.x() > half.x() ? Align::right
                               : Align::center,
          out.y() < -half.y()  ? Level::top
          : out.y() > half.y() ? Level::bottom
                               : Level::middle};
}

// the places where words could stand, each with its cost
void Notes::offer_places() {
  for (Word& word : words_) {
    Offered offered{word.key, size(word.set), word.anchor, std::move(word.places), word.arrow};
    if (!how_.ranges)
      for (Placing::Candidate& each : offered.places) {
        const double cost = placing_.cost(offered.size, each);
        each.clear = cost <= each.cost, each.cost = cost;
      }
    how_.survey->push_back(std::move(offered));
  }
}

// a line from the words' edge to just before what they name
void Notes::lead(const Word& word, const Point& center, double strength) {
  const Point size = Notes::size(word.set), way = word.anchor - center;
  const double out = std::min(size.x() / 2 / std::max(std::abs(way.normalized().x()), 1e-9),
                              size.y() / 2 / std::max(std::abs(way.normalized().y()), 1e-9));
  const Point u = way.normalized();
  const Point from = center + (out + 1.2 * point_) * u, to = word.anchor - (dot_radius_ + 1.5 * point_) * u;
  Color line = word.set.color;
  line.a = std::uint8_t(std::lround(line.a * strength));
  if ((to - from).dot(u) > 2 * point_)
    list_.add({{from, 0.4 * point_, line}, {to, 0.4 * point_, line}}, Cap::butt);
}

}  // namespace obscura::draw

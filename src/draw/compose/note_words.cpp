// The words of marks: what they keep off, where they may stand, and their plates.

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <optional>

#include "draw/compose/notes.h"
#include "draw/compose/passing.h"
#include "draw/page/measure.h"
#include "draw/picture/convex.h"
#include "draw/picture/formula_values.h"
#include "draw/picture/rope_way.h"

namespace obscura::draw {
namespace {

// points
constexpr double kThin = 0.5;  // of angles and lengths
constexpr double kDotRadius = 1.7, kGap = 2.2;
constexpr double kMillimetre = 72 / 25.4;
constexpr double kNormal = 9 * 72 / 25.4;  // a unit normal: 9 mm
constexpr double kAngle = 13;              // radius of an arc
constexpr double kOffHatching = 2.5;       // from it to the words of a film
constexpr double kBracketHalf = 24;        // page units: half the width of what something hangs from
constexpr double kMargin = 0.2;            // around words, of their height
constexpr double kCovered = 60;            // the cost of words over a body
constexpr double kCoveredInPrint = 6, kLedInPrint = 60;  // the same in print, of words and of leaders
constexpr double kOnFixed = 0.1;                         // as against that: over one that is fixed
constexpr double kPale = 1.7;     // contrast to the room under which words are read as on the room
constexpr double kOnOutline = 8;  // of each unit of a body's outline under words of a film
constexpr double kGhostCovered = 40, kOnGhost = 4;  // the same of an earlier instant
constexpr std::size_t kManyGhosts = 200;
constexpr double kRailChord = 8;                       // the length of a curve's pieces, as words see them
constexpr double kOnRail = 4;                          // of each unit of a curve under words
constexpr double kOnTrail = 0.8, kOnTrailInPrint = 3;  // of each unit of a trail or path under words
constexpr double kFromEdge = 3;                        // points: from words to the page's edge at least
constexpr double kLeaves = 1.5;    // times as fast as what they name words leave the page with it
constexpr double kLedAcross = 12;  // points: of a leader across an arrow or over another body

constexpr std::uint8_t kLegible = 128;  // opacity from which on words are read
constexpr std::uint8_t kPlate = 150;    // how much of what lies under the words of a film is covered

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
      placing_(projection.window(), how.plan || how.survey ? kMargin : kMarginInPrint),
      point_(how.lettering.point),
      arrow_(how.lettering.arrow),
      type_(kAnnotationType * point_),
      thin_(kThin * point_),
      dot_radius_(kDotRadius * point_),
      gap_(kGap * point_),
      millimetre_(kMillimetre * point_),
      normal_(kNormal * point_),
      angle_(kAngle * point_) {
  // of a film the places are known, or nothing but values is asked for
  if (how_.ranges || (how_.plan && !how_.survey)) return;
  avoid_areas();
  avoid_ghosts();
  avoid_own_arrows();
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

void Notes::avoid_springs() {
  for (const sim::Snapshot::Spring& spring : now_.springs) {
    if (spring.loose) continue;
    const Point a = view_.page(spring.a), b = view_.page(spring.b), u = (b - a).normalized();
    for (const double side : {-4.5, -1.5, 1.5, 4.5})
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
Formula Notes::set(const WordKey& key, const std::string& text, double value, std::string_view unit, int body,
                   Color ink) {
  if (std::abs(value) < negligible(unit, cast_, body)) value = 0;
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

Point on_its_way(WordKey::Kind kind, const Point& anchor, const Point& from, const Point& to, double part) {
  if (!goes_around(kind)) return from + part * (to - from);
  const Point a = from - anchor, b = to - anchor;
  const double turn = std::atan2(a.x() * b.y() - a.y() * b.x(), a.dot(b)) * part,
               far = a.norm() + part * (b.norm() - a.norm()), s = std::sin(turn), c = std::cos(turn);
  if (!(a.norm() > 0)) return to;
  return anchor + far / a.norm() * Point(c * a.x() - s * a.y(), s * a.x() + c * a.y());
}

std::pair<Placing::Candidate, double> place_of_course(const LabelPlan::Course& course, WordKey::Kind kind,
                                                      const Point& anchor,
                                                      const std::vector<Placing::Candidate>& places,
                                                      double film) {
  const int n = int(places.size());
  const auto at = [&](int i) { return places[std::size_t(std::clamp(i, 0, n - 1))]; };
  Placing::Candidate now = at(course.first);
  double led = now.leader ? 1 : 0;
  for (const LabelPlan::Move& move : course.moves) {
    if (film <= move.begin) break;
    const double u = film >= move.end ? 1 : (film - move.begin) / (move.end - move.begin);
    const double s = u * u * (3 - 2 * u);
    const Placing::Candidate next = at(move.to);
    now.center = on_its_way(kind, anchor, now.center, next.center, s);
    led += s * ((next.leader ? 1 : 0) - led);
  }
  now.leader = led > 0;
  return {now, led};
}

// where the plan has a word now; on its way from one place to another between both
Placing::Candidate Notes::planned(const Word& word, double& leader) const {
  const auto found = how_.plan->courses.find(word.key);
  if (found == how_.plan->courses.end()) return word.places.front();
  const auto [now, led] = place_of_course(found->second, word.key.kind, word.anchor, word.places, how_.film);
  leader = led;
  return now;
}

std::vector<Notes::Placed> Notes::planned_places() const {
  std::vector<Placed> placed;
  for (const Word& word : words_) {
    Placed& it = placed.emplace_back();
    it.at = planned(word, it.leader);
    it.at.center = on_page(word, it.at.center);
  }
  return placed;
}

// Moved so far that the words do not reach over an edge; those of what leaves the page go with it, of an
// arrow when it is wholly beyond the edge.
Point Notes::on_page(const Word& word, const Point& center) const {
  const Rect page = view_.window();
  const Point half = size(word.set) / 2 + Point(kFromEdge * point_, 0);
  const auto& [a, b] = word.arrow ? *word.arrow : std::pair(word.anchor, word.anchor);
  const Point near = a.cwiseMin(b), far = a.cwiseMax(b);
  const auto moved = [&](int i, double low, double high) {
    if (high - low < 2 * half[i]) return center[i];
    const double under = std::max(0.0, low - far[i]), over = std::max(0.0, near[i] - high);
    return std::clamp(center[i], low + half[i] - kLeaves * under, high - half[i] + kLeaves * over);
  };
  return {moved(0, page.x, page.x + page.width), moved(1, page.y, page.y + page.height)};
}

// Words stand out against what they cover.
void Notes::plate(const Point& center, const Point& size, std::uint8_t strength) {
  Color color = colours_.room;
  color.a = std::uint8_t(kPlate * strength / 255);
  Box box;
  box.center = center, box.x_axis = {1, 0}, box.half = size / 2 + Point(1.2, 0.8) * point_, box.fill = color;
  list_.halo(true);
  list_.add(box);
  list_.halo(false);
}

// The convex forms that a body is made of, round ones with so many corners; none if it is not wholly before
// the eye.
std::vector<std::vector<Point>> Notes::forms(int index, int corners, const sim::Snapshot& at) const {
  const sim::SceneInfo::Body& body = cast_.bodies[std::size_t(index)];
  const sim::Snapshot::Body& it = at.bodies[std::size_t(index)];
  const double step = 2 * std::numbers::pi / corners;
  std::vector<std::vector<Point>> all;
  const auto add = [&](const sim::DrawnForm& form) {
    const auto world = [&](const Vec3& local) {
      return Vec3(it.position + it.orientation * (form.center + form.turn * local));
    };
    std::vector<Vec3> vertices = form.vertices;
    if (form.kind == sim::ShapeKind::box)
      for (int k = 0; k < 8; ++k)
        vertices.push_back(form.half.cwiseProduct(Vec3(k & 1 ? 1 : -1, k & 2 ? 1 : -1, k & 4 ? 1 : -1)));
    std::vector<Point> outline;
    if (form.kind == sim::ShapeKind::capsule) {
      for (int k = 0; k < 2 * corners; ++k) {
        const Vec3 end = world(Vec3(0, k < corners ? form.half.y() : -form.half.y(), 0));
        if (!view_.before(end)) return;
        outline.push_back(view_.page(end) +
                          view_.scale_at(end) * form.radius * Point(std::cos(k * step), std::sin(k * step)));
      }
    } else if (vertices.empty()) {
      const Vec3 center = world(Vec3::Zero());
      if (!view_.before(center)) return;
      const double radius =
          form.radius > 0 ? view_.scale_at(center) * form.radius : kDot * how_.lettering.weight;
      for (int k = 0; k < corners; ++k)
        outline.push_back(view_.page(center) + radius * Point(std::cos(k * step), -std::sin(k * step)));
      all.push_back(std::move(outline));
      return;
    }
    for (const Vec3& vertex : vertices) {
      if (!view_.before(world(vertex))) return;
      outline.push_back(view_.page(world(vertex)));
    }
    all.push_back(convex_hull(outline));
  };
  for (const sim::DrawnForm& part : body.parts) add(part);
  if (!body.parts.empty()) return all;
  sim::DrawnForm whole;
  whole.kind = body.kind, whole.radius = body.radius, whole.half = body.half, whole.vertices = body.vertices;
  add(whole);
  return all;
}

std::vector<Point> Notes::outline_of(int body, const sim::Snapshot& at) const {
  std::vector<Point> outline;
  for (const std::vector<Point>& form : forms(body, 24, at))
    outline.insert(outline.end(), form.begin(), form.end());
  return outline.empty() ? outline : convex_hull(outline);
}

// whether words are read on a body as beside it: what is fixed and pale
bool Notes::is_ground(int index) const {
  if (!view_.view() || !how_.look || !cast_.bodies[std::size_t(index)].fixed) return false;
  const Look& look = *how_.look;
  const BodyLook own = std::size_t(index) < look.bodies.size() ? look.bodies[std::size_t(index)] : BodyLook();
  return contrast(fixed_paint(own, look.theme).fill, colours_.room) < kPale;
}

// the outlines of bodies, and what lies within
void Notes::avoid_areas() {
  for (std::size_t i = 0; i < cast_.bodies.size(); ++i)
    for (const std::vector<Point>& outline : forms(int(i), 12, now_)) {
      for (std::size_t k = 0; k < outline.size(); ++k)
        placing_.avoid(outline[k], outline[(k + 1) % outline.size()], kOnOutline);
      if (is_ground(int(i))) continue;
      const double part = (cast_.bodies[i].fixed ? kOnFixed : 1) * point_;
      // in print words are read on a body, off its outline
      if (film())
        placing_.avoid(outline, part * kCovered);
      else
        placing_.avoid(outline, part * kCoveredInPrint, part * kLedInPrint);
    }
  avoid_springs();
  avoid_joints();
  // what is made fast to the room has a bracket there
  if (!view_.view() || !film()) return;
  const double half = kBracketHalf * how_.lettering.weight;
  const auto bracket = [&](int body, const Vec3& at) {
    for (const double up : {0.0, 0.5, 1.0})
      if (body < 0)
        placing_.avoid(view_.page(at) - Point(half, up * half / 2),
                       view_.page(at) + Point(half, -up * half / 2), 4);
  };
  for (std::size_t i = 0; i < cast_.springs.size(); ++i)
    if (!now_.springs[i].loose)
      bracket(cast_.springs[i].a, now_.springs[i].a), bracket(cast_.springs[i].b, now_.springs[i].b);
  for (std::size_t i = 0; i < cast_.joints.size(); ++i)
    if (cast_.joints[i].places.empty() && !now_.joints[i].broken)
      bracket(cast_.joints[i].a, now_.joints[i].a), bracket(cast_.joints[i].b, now_.joints[i].b);
}

void Notes::avoid_joints() {
  for (std::size_t i = 0; i < cast_.joints.size(); ++i) {
    const sim::Snapshot::Joint& joint = now_.joints[i];
    if (joint.broken) continue;
    const auto line = [&](const Vec3& a, const Vec3& b) {
      if (view_.before(a) && view_.before(b)) placing_.avoid(view_.page(a), view_.page(b), 2);
    };
    if (cast_.joints[i].kind != sim::JointKind::pulley) {
      line(joint.a, joint.b);
      continue;
    }
    const std::vector<Vec3> way = rope_way(cast_, i, now_);
    for (std::size_t k = 0; k + 1 < way.size(); ++k) line(way[k], way[k + 1]);
  }
  avoid_rails();
}

// earlier instants, as bodies; of very many the outlines are not looked at one by one
void Notes::avoid_ghosts() {
  for (const SpaceGhost& ghost : how_.ghosts)
    for (std::size_t i = 0; i < cast_.bodies.size(); ++i) {
      const std::vector<int>& only = *ghost.bodies;
      if (i >= ghost.then->bodies.size()) break;
      if (only.empty() ? cast_.bodies[i].fixed : std::find(only.begin(), only.end(), int(i)) == only.end())
        continue;
      for (const std::vector<Point>& outline : forms(int(i), 12, *ghost.then)) {
        placing_.avoid(outline, kGhostCovered * point_);
        for (std::size_t k = 0; k < outline.size() && how_.ghosts.size() < kManyGhosts; ++k)
          placing_.avoid(outline[k], outline[(k + 1) % outline.size()], kOnGhost);
      }
    }
}

// the curves on which bodies roll and slide, as chords of some length on the page
void Notes::avoid_rails() {
  for (const sim::SceneInfo::Rail& rail : cast_.rails) {
    std::optional<Point> last;
    for (std::size_t k = 0; k < rail.places.size(); ++k) {
      const Vec3 at = place({rail.body, rail.places[k]}, now_);
      if (!view_.before(at)) {
        last.reset();
        continue;
      }
      const Point here = view_.page(at);
      if (last && (here - *last).norm() < kRailChord * point_ && k + 1 < rail.places.size()) continue;
      if (last) placing_.avoid(*last, here, kOnRail);
      last = here;
    }
  }
}

// the arrows that bodies have by themselves, and what they leave behind them
void Notes::avoid_own_arrows() {
  if (!how_.look) return;
  const Look& look = *how_.look;
  const auto line = [&](const Vec3& tail, const Vec3& tip, double weight, bool of_arrow = false) {
    if (view_.before(tail) && view_.before(tip))
      placing_.avoid(view_.page(tail), view_.page(tip), weight, of_arrow);
  };
  const auto arrow = [&](const Vec3& tail, const Vec3& tip) { line(tail, tip, 4, true); };
  for (std::size_t i = 0; i < look.bodies.size() && i < now_.bodies.size(); ++i) {
    const sim::Snapshot::Body& body = now_.bodies[i];
    if (look.bodies[i].velocity) arrow(body.position, body.position + look.velocity_scale * body.velocity);
  }
  for (const std::vector<Vec3>& way : how_.behind)
    for (std::size_t k = 0; k + 1 < way.size(); ++k)
      line(way[k], way[k + 1], film() ? kOnTrail : kOnTrailInPrint);
  const bool any =
      std::any_of(look.bodies.begin(), look.bodies.end(), [](const auto& b) { return b.contact; });
  if (!any) return;
  const double scale = look.force_scale > 0 ? look.force_scale : newton(cast_);
  for (const Push& push : pushes(cast_, look, now_)) arrow(push.point, push.point + scale * push.force);
}

// Words that come over others in passing are not seen there.
void Notes::yield(std::vector<Placed>& placed) {
  for (std::size_t i = 0; i < words_.size(); ++i) {
    const auto course = how_.plan->courses.find(words_[i].key);
    if (course == how_.plan->courses.end()) continue;
    placed[i].strength = strength(course->second, how_.film);
    if (placed[i].strength < 1)
      fade(words_[i].set, placed[i].strength), placed[i].leader *= placed[i].strength;
  }
}

void Notes::tell_standing(const std::vector<Placed>& placed) const {
  for (std::size_t i = 0; i < words_.size(); ++i)
    how_.standing->push_back({words_[i].key, placed[i].at.center, size(words_[i].set),
                              words_[i].set.color.a / 255.0, stays(words_[i].key, words_[i].places.size())});
}

void Notes::finish() {
  if (how_.survey) return offer_places();
  // words that move keep to whole pixels: they look the same in every frame, and are cheap to encode
  const auto whole = [&](const Point& at) {
    const double pixel = how_.lettering.pixel;
    return pixel > 0 ? Point(std::round(at.x() / pixel) * pixel, std::round(at.y() / pixel) * pixel) : at;
  };
  const std::vector<double> tails = this->tails();
  if (!film()) set_apart();
  std::vector<Placed> placed = film() ? planned_places() : still_places();
  if (how_.standing) return tell_standing(placed);
  if (how_.plan) yield(placed);
  // plates lie over bodies and lines but under arrows, which stay whole; one kind after another is drawn in
  // few batches
  for (std::size_t i = 0; film() && i < words_.size(); ++i)
    if (covers(words_[i].key)) {
      const Formula& set = words_[i].set;
      list_.hang(words_[i].hang);
      plate(whole(placed[i].at.center), size(set), set.color.a);
    }
  if (film()) {
    set_apart();
    for (std::size_t i = 0; i < words_.size(); ++i) placed[i].at.end = led_to(words_[i], placed[i].at.center);
  }
  if (film()) draw_arrows(arrows_, inks_, arrow_, colours_.room, list_);
  // in print each has a halo over those before it
  for (std::size_t i = 0; !film() && i < arrows_.size(); ++i)
    draw_arrows({arrows_[i]}, arrow_, colours_.room, inks_[i], list_);
  list_.hang({});
  mark_tails(tails);
  for (const auto& [at, ink, hang] : dots_) {
    list_.hang(hang);
    list_.halo(true);
    list_.add(Disc{at, dot_radius_ + 0.6 * point_, 0, colours_.room, colours_.room});
    list_.halo(false);
    list_.add(Disc{at, dot_radius_, 0, ink, ink});
  }
  const auto write = [&](const Word& word, const Point& center) {
    const Point half = size(word.set) / 2;
    const Point at(center.x() - half.x(), center.y() - half.y() + word.set.ascent);
    const std::size_t first = list_.texts.size();
    list_.hang(word.hang);
    add(word.set, whole(at), list_, hold(word, center));
    if (how_.lettering.pixel > 0) return;
    for (std::size_t i = first; i < list_.texts.size(); ++i) list_.texts[i].whole = at;
  };
  for (std::size_t i = 0; i < words_.size(); ++i) {
    list_.hang(words_[i].hang);
    if (placed[i].at.leader && placed[i].strength > 0) lead(words_[i], placed[i]);
    if (!film()) write(words_[i], placed[i].at.center);
  }
  for (std::size_t i = 0; film() && i < words_.size(); ++i)
    if (placed[i].strength > 0) write(words_[i], placed[i].at.center);
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
  const auto seen = [page = view_.window()](const Point& size, const Point& center) {
    const Point low = center - size / 2, high = center + size / 2;
    return high.x() > page.x && low.x() < page.x + page.width && high.y() > page.y &&
           low.y() < page.y + page.height;
  };
  for (Word& word : words_) {
    Offered offered{word.key,
                    size(word.set),
                    word.anchor,
                    std::move(word.places),
                    word.arrow,
                    word.along,
                    word.set.color.a >= kLegible,
                    word.ball};
    if (!how_.ranges)
      for (Placing::Candidate& each : offered.places) {
        const Point wanted = each.center;
        each.center = on_page(word, wanted), each.moved = each.center - wanted;
        // words that have left the page with what they name cover nothing
        if (!seen(offered.size, each.center)) {
          each.cost = 0, each.clear = true;
          continue;
        }
        double cost = placing_.cost(offered.size, each);
        each.clear = cost <= each.cost;
        if (each.leader)
          cost += placing_.leading(led_to(word, each.center), offered.size, each.center, kLedAcross * point_);
        each.cost += (word.key.kind == WordKey::name ? kNameCovered : 1) * (cost - each.cost);
      }
    how_.survey->push_back(std::move(offered));
  }
}

// where the line from words ends: at what they name, of words behind an arrow at its tail
Point Notes::led_to(const Word& word, const Point& center) {
  if (!word.arrow) return word.anchor;
  const auto& [tail, tip] = *word.arrow;
  return (center - tail).dot(tip - tail) < 0 ? tail : word.anchor;
}

// a line from the words' edge to just before what they name
void Notes::lead(const Word& word, const Placed& placed) {
  const Point &center = placed.at.center, &anchor = placed.at.end;
  const Point size = Notes::size(word.set), way = anchor - center;
  const double out = std::min(size.x() / 2 / std::max(std::abs(way.normalized().x()), 1e-9),
                              size.y() / 2 / std::max(std::abs(way.normalized().y()), 1e-9));
  const Point u = way.normalized();
  const Point from = center + (out + 1.2 * point_) * u;
  // as far as a body's outline, where it is that of one; in print up to an arrow, beside which lie others
  double inner = word.outline.empty() && (film() || !word.arrow) ? dot_radius_ : 0;
  inner = std::max(inner, reach_of(word.outline, anchor, -u));
  const Point to = anchor - (inner + 1.5 * point_) * u;
  Color line = word.set.color;
  line.a = std::uint8_t(std::lround(line.a * placed.leader));
  if ((to - from).dot(u) > 2 * point_)
    list_.add({{from, 0.4 * point_, line}, {to, 0.4 * point_, line}}, Cap::butt);
}

}  // namespace obscura::draw

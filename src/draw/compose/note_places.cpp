// The places of words that stand still: of a figure, and of one picture's names. All are placed together
// (draw/page/placing.h), and none stands nearer to another thing of the kind that it names than to its own,
// or a leader says which is its own.

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "draw/compose/notes.h"
#include "draw/plane/stage.h"

namespace obscura::draw {
namespace {

constexpr double kOnArrow = 16, kOnArrowInPrint = 4;  // of each unit of an arrow under words
constexpr double kHaloInPrint = 1.6;  // points: from the middle of an arrow to the edge of its halo
constexpr double kOnPage = 0.1;       // page units: more than rounding
constexpr double kUpright = 0.999;    // of a normal: a wall along an edge of the page
// points
constexpr double kNear = 6;                     // from its place without a leader a word is moved by less
constexpr double kNearer = 1;                   // to its own it stands by more than this
constexpr double kAstray = 24, kAstrayLed = 8;  // the cost of words nearer to another, and with a leader
constexpr double kLedAcrossArrow = 12;          // of a leader across an arrow
constexpr double kBehindTail = 4;               // off an arrow's tail: leaders
constexpr double kOffMiddle = 4;                // of a leader's end off the arrow's middle
constexpr double kOffOthers = 6;                // it is plain whose it is so far from other arrows
constexpr double kNearOthers = 1.5;             // of each unit by which it is nearer

}  // namespace

bool Notes::in_window(const Point& p) const {
  const Rect& w = view_.window();
  return p.x() >= w.x && p.x() <= w.x + w.width && p.y() >= w.y && p.y() <= w.y + w.height;
}

// whether a point or label of a picture that stands still lies outside of it: that is told
bool Notes::is_unseen(const WordKey& key, const Point& at) const {
  if (film() || in_window(at)) return false;
  if (how_.unseen) how_.unseen->push_back(key);
  return true;
}

std::optional<std::pair<Point, Point>> Notes::seen(const Point& a, const Point& b) const {
  const auto part = part_within(a, b, view_.window());
  if (!part) return std::nullopt;
  return std::pair(Point(a + part->first * (b - a)), Point(a + part->second * (b - a)));
}

void Notes::avoid_arrow(const Point& tail, const Point& tip) {
  const Point way = tip - tail;
  // in print leaders keep off the dot at its tail, too
  const double behind = film() || !(way.norm() > 0) ? 0 : kBehindTail * point_ / way.norm();
  placing_.avoid(tail - behind * way, tip, film() ? kOnArrow : kOnArrowInPrint, true);
  // and words off its halo: those that touch it look cut
  if (film() || !(way.norm() > 0)) return;
  for (const double side : {1.0, -1.0}) {
    const Point off = side * kHaloInPrint * point_ * Point(-way.y(), way.x()) / way.norm();
    placing_.avoid(tail + off, tip + off, 2);
  }
}

// The corners of the part of the page that is within the walls that stand along its edges.
std::pair<Point, Point> Notes::room_window() const {
  const Rect& page = view_.window();
  Point low(page.x, page.y), high = low + Point(page.width, page.height);
  if (!view_.view()) return {low, high};
  for (const HalfPlane& wall : half_planes(cast_, *view_.view()))
    for (int i = 0; i < 2; ++i) {
      if (wall.normal[i] > kUpright) low[i] = std::clamp(wall.point[i], low[i], high[i]);
      if (wall.normal[i] < -kUpright) high[i] = std::clamp(wall.point[i], low[i], high[i]);
    }
  return {low, high};
}

// The places of a word, and those that would leave the room, or the page, moved into it.
std::vector<Placing::Candidate> Notes::places_on_page(const Word& word) const {
  std::vector<Placing::Candidate> all = word.places;
  const auto [low, high] = room_window();
  const Point size = Notes::size(word.set);
  const double margin = kMarginInPrint * size.y() + kOnPage;
  const Point half = size / 2 + Point(margin, margin);
  if ((high - low - 2 * half).minCoeff() < 0) return all;
  for (const Placing::Candidate& place : word.places) {
    const Point center = place.center.cwiseMax(low + half).cwiseMin(high - half);
    const double far = (center - place.center).norm();
    if (far > 0) all.push_back({center, place.cost + far, place.leader || far > kNear * point_});
  }
  return all;
}

Notes::Form::Form(std::vector<Point> all) : outline(std::move(all)) {
  if (outline.empty()) return;
  Point low = outline[0], high = outline[0];
  for (const Point& p : outline) low = low.cwiseMin(p), high = high.cwiseMax(p);
  middle = (low + high) / 2, half = (high - low) / 2;
}

// how far words are from it
double Notes::Form::off(const Point& center, const Point& size) const {
  double least = std::numeric_limits<double>::infinity();
  for (std::size_t k = 0; k < outline.size(); ++k)
    least = std::min(least, Placing::off_line(center, size, outline[k], outline[(k + 1) % outline.size()]));
  return least;
}

// How much nearer words would have to be to what they name than they are, for it to be plain which of its
// kind that is, page units.
double Notes::astray(const Word& word, const Point& center) const {
  const auto kind = forms_.find(word.key.kind);
  if (word.form == kNoForm || kind == forms_.end()) return 0;
  const Point size = Notes::size(word.set);
  const double own = kind->second[word.form].off(center, size) + kNearer * point_;
  double other = own;
  for (std::size_t i = 0; i < kind->second.size(); ++i) {
    const Form& form = kind->second[i];
    const Point apart = (form.middle - center).cwiseAbs() - form.half - size / 2;
    if (i != word.form && apart.cwiseMax(Point(0, 0)).norm() < other)
      other = std::min(other, form.off(center, size));
  }
  return own - other;
}

// how far a convex outline reaches from a point in direction u
double Notes::reach_of(const std::vector<Point>& outline, const Point& from, const Point& u) {
  double reach = 0;
  for (std::size_t k = 0; k < outline.size(); ++k) {
    const Point a = outline[k] - from, d = outline[(k + 1) % outline.size()] - outline[k];
    const double across = u.x() * d.y() - u.y() * d.x();
    if (std::abs(across) < 1e-12) continue;
    const double part = (a.x() * u.y() - a.y() * u.x()) / across;
    if (part >= 0 && part <= 1) reach = std::max(reach, (a.x() * d.y() - a.y() * d.x()) / across);
  }
  return reach;
}

// Where a leader ends: of an arrow's where it crosses no other, and none lies beside it, the middle if that
// can be; and the cost of what does.
std::pair<Point, double> Notes::end_of_leader(const Word& word, const Point& center) const {
  if (!word.arrow) {
    const Point u = (center - word.anchor).normalized();
    return {word.anchor + reach_of(word.outline, word.anchor, u) * u, 0.0};
  }
  const auto& [tail, tip] = *word.arrow;
  std::pair<Point, double> best(word.anchor, 0.0);
  double least = std::numeric_limits<double>::infinity();
  for (const double part : {0.5, 0.35, 0.65, 0.2, 0.8, 0.95}) {
    const Point at = tail + part * (tip - tail);
    double near = 0;
    for (std::size_t i = 0; i < arrows_.size(); ++i)
      if (int(i) != word.shown)
        near +=
            kNearOthers * std::max(0.0, kOffOthers * point_ -
                                            Placing::off_line(at, {0, 0}, arrows_[i].tail, arrows_[i].tip));
    const double cost = near + kOffMiddle * point_ * std::abs(part - 0.5) +
                        placing_.leading(at, size(word.set), center, kLedAcrossArrow * point_);
    if (cost < least) least = cost, best = {at, near};
  }
  return best;
}

// when all arrows are where they are drawn
std::vector<Notes::Placed> Notes::still_places() {
  for (const Arrow& arrow : arrows_) {
    forms_[WordKey::vector].emplace_back(std::vector<Point>{arrow.tail, arrow.tip});
    if (const auto part = seen(arrow.tail, arrow.tip)) avoid_arrow(part->first, part->second);
  }
  for (Word& word : words_)
    if (word.key.kind == WordKey::vector && word.shown >= 0) word.form = std::size_t(word.shown);
  std::vector<Placing::Words> all;
  for (const Word& word : words_) {
    Placing::Words& it = all.emplace_back(Placing::Words{size(word.set), places_on_page(word)});
    for (Placing::Candidate& each : it.places) {
      if (!word.outline.empty())
        each.leader = forms_[word.key.kind][word.form].off(each.center, it.size) > kNear * point_;
      if (const double off = astray(word, each.center); off > 0)
        each.cost += (each.leader ? kAstrayLed : kAstray) * point_ + off, each.leader = true;
      if (word.key.kind == WordKey::name)
        each.cost += (kNameCovered - 1) * (placing_.cost(it.size, each) - each.cost);
      if (!each.leader) continue;
      const auto [end, near] = end_of_leader(word, each.center);
      each.end = end, each.cost += near;
    }
  }
  std::vector<Placed> placed;
  for (Placing::Candidate& each : placing_.place(std::move(all))) placed.push_back({each});
  return placed;
}

}  // namespace obscura::draw

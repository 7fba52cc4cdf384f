// The places of a film's labels. At each sample of the run every place i of a label costs c_i: what it covers
// there, and how far it is from what is usual. The course i(t) is the one of least
//   sum c_i dt + a for each change + b for each unit of its way
// which dynamic programming finds (Viterbi). Labels are planned one after another; the earlier ones are in
// the way of the later ones, also while they go from one place to another, which takes as long as the speed
// of a label says. Where labels clash all the same, they are planned again beside all others.

#include "draw/compose/label_courses.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <optional>
#include <utility>

namespace obscura::draw {
namespace {

constexpr double kChange = 14;                   // points: of a change of place, as against a second of cost
constexpr double kWay = 0.12;                    // of each unit of its way
constexpr double kQuickest = 0.3, kSlowest = 4;  // s: a change
constexpr double kHeadWide = 10;  // page units: of an arrow's head, which is wider than its line
constexpr double kShared = 4000;  // points: of a second of lying on another label
constexpr double kPassing = 0.4;  // of the time that a label is shown: for less it lies on others in passing
constexpr double kAroundWords = 1.2;  // of their size: which leaders keep off
constexpr double kLedThrough = 400;   // points: of a leader through another label
constexpr double kOver = 8;           // of each unit of its own arrow that it passes over
constexpr double kTouches = 120;      // page units: of touching it on the way
constexpr double kJump = 20;          // of each unit that it would jump with its arrow
constexpr double kFlips = 0.8;        // cosine of the least angle by which an arrow flips
constexpr double kNoJump = 3;         // points: no jump yet
constexpr int kRounds = 3;            // in which labels that clash are planned again
constexpr double kSteadily = 1.5;     // times as far as in the intervals around it: still a swing

/// A label that is planned, where it stands at a sample.
struct Planned {
  const Offered* label;
  Placing::Candidate at;
};

// of the smaller label, which part lies on the other
inline double overlap(const Offered& a, const Point& at, const Planned& b) {
  const auto near = [&](int i) { return kNearWords * (a.size[i] + b.label->size[i]); };
  const Point room(near(0) - std::abs(at.x() - b.at.center.x()),
                   near(1) - std::abs(at.y() - b.at.center.y()));
  if (!(room.x() > 0 && room.y() > 0)) return 0;
  const Point least = a.size.cwiseMin(b.label->size);
  return std::min(room.x() / least.x(), 1.0) * std::min(room.y() / least.y(), 1.0);
}

// how much of a line lies under a label, page units
double under(const Point& a, const Point& b, const Point& center, const Point& size) {
  double from = 0, to = 1;
  for (int i = 0; i < 2; ++i) {
    const double way = b[i] - a[i], low = center[i] - size[i] / 2 - a[i], high = low + size[i];
    if (std::abs(way) < 1e-9) {
      if (low > 0 || high < 0) return 0;
      continue;
    }
    from = std::max(from, std::min(low / way, high / way)),
    to = std::min(to, std::max(low / way, high / way));
  }
  return from < to ? (to - from) * (b - a).norm() : 0;
}

// whether the line from words to what they name runs through other words
bool leads_through(const Offered& a, const Placing::Candidate& at, const Offered& b,
                   const Placing::Candidate& other) {
  // of words behind an arrow it ends at the tail
  const bool behind = a.arrow && (at.center - a.arrow->first).dot(a.arrow->second - a.arrow->first) < 0;
  return at.leader &&
         under(behind ? a.arrow->first : a.anchor, at.center, other.center, kAroundWords * b.size) > 0;
}

// how far it is from one place to another
double way(const Offered& label, std::size_t i, std::size_t j) {
  const Point a = label.places[i].center - label.anchor, b = label.places[j].center - label.anchor;
  if (!goes_around(label.key.kind)) return (b - a).norm();
  const double turn = std::atan2(std::abs(a.x() * b.y() - a.y() * b.x()), a.dot(b));
  return std::hypot(turn * std::max(a.norm(), b.norm()), b.norm() - a.norm());
}

// how deep a ball lies in a rectangle
double deep_in(const Point& ball, double radius, const Point& center, const Point& size) {
  return radius - ((ball - center).cwiseAbs() - size / 2).cwiseMax(Point(0, 0)).norm();
}

// The cost of its way from place i to place j: a label goes around the head of its arrow and around the ball
// in which that begins, not over them. No more is added up than `most`.
double cost_of_way(const Offered& label, std::size_t i, std::size_t j,
                   double most = std::numeric_limits<double>::infinity()) {
  const Point &from = label.places[i].center, &to = label.places[j].center;
  double cost = kWay * way(label, i, j);
  if (!label.arrow) return cost;
  for (const double part : {0.2, 0.4, 0.6, 0.8}) {
    if (cost >= most) break;
    const double over = under(label.arrow->first, label.arrow->second, from + part * (to - from),
                              label.size + Point(kHeadWide, kHeadWide));
    if (over > 0) cost += kTouches + kOver * over;
    const double deep = deep_in(label.arrow->first, label.ball, from + part * (to - from), label.size);
    if (label.ball > 0 && deep > 0) cost += kTouches + kOver * deep;
  }
  return cost;
}

/// The samples that have a label, and what it offers there.
using Seen = std::vector<std::pair<std::size_t, const Offered*>>;
/// Of each sample the labels that are planned.
using Taken = std::vector<std::vector<Planned>>;

/// Brings moves, from the first that may be brought, forward in time so that the last of them ends at
/// `until`.
void make_room(std::vector<LabelPlan::Move>& moves, std::size_t first, double until) {
  for (std::size_t m = moves.size(); m > first && moves[m - 1].end > until; --m) {
    const double early = std::min(moves[m - 1].end - until, std::max(moves[m - 1].begin, 0.0));
    moves[m - 1].begin -= early, moves[m - 1].end -= early;
    until = moves[m - 1].begin;
  }
}

// How far words at place i jump from sample k - 1 to sample k, where their arrow flips: farther than they go
// in the second fastest of the intervals around. With an arrow that only becomes longer they may.
double jump(const Seen& at, std::size_t k, std::size_t i, double least) {
  const Offered &last = *at[k - 1].second, &now = *at[k].second;
  // while they are faint none is seen
  if (!last.arrow || !now.arrow || !last.legible || !now.legible) return 0;
  const auto way = [](const Offered& label) {
    return Point((label.arrow->second - label.arrow->first).normalized());
  };
  if (way(last).dot(way(now)) > kFlips) return 0;
  // beside the body, where words that stand still keep their place
  const auto beside = [&](const Offered& each) {
    return Point(each.places[i].center - each.places[i].moved - each.along);
  };
  const auto step = [&](std::size_t n) -> std::optional<double> {
    if (n < 1 || n >= at.size() || at[n - 1].first + 1 < at[n].first) return std::nullopt;
    return (beside(*at[n].second) - beside(*at[n - 1].second)).norm();
  };
  const std::optional<double> here = step(k);
  if (!here) return 0;
  std::vector<double> around;
  for (const std::size_t n : {k + 1, k + 2, k - 1, k > 1 ? k - 2 : 0})
    if (const std::optional<double> each = step(n)) around.push_back(*each);
  if (around.size() < 2) return 0;
  std::sort(around.begin(), around.end(), std::greater());
  return std::max(0.0, *here - kSteadily * around[1] - least);
}

/// The course of one label among those that are planned.
class Planner {
 public:
  Planner(const Seen& at, const std::vector<double>& films, const Taken& taken, double point, double speed)
      : at_(at),
        films_(films),
        taken_(taken),
        point_(point),
        speed_(speed),
        kind_(at.front().second->key.kind) {
    for (const auto& [sample, label] : at) times_.push_back(films[sample]);
    if (kind_ != WordKey::vector) return;
    const std::size_t n = at_.front().second->places.size();
    for (std::size_t k = 0; k < at_.size(); ++k)
      for (std::size_t i = 0; i < n; ++i) {
        const double far = k > 0 ? jump(at_, k, i, kNoJump * point_) : 0;
        if (far > 0 && jumps_.empty()) jumps_.resize(at_.size() * n, 0.0);
        if (far > 0) jumps_[k * n + i] = kJump * far;
      }
  }

  /// The course of least cost. Ways take their time, which the search does not know: where one would have to
  /// begin before the last is over, the label is planned again, more and more reluctant to go, and the course
  /// is taken that costs least as it is gone.
  LabelPlan::Course course() const {
    LabelPlan::Course best;
    double least = std::numeric_limits<double>::infinity();
    for (const double reluctance : {1.0, 4.0, 16.0, 64.0}) {
      bool in_time = true;
      LabelPlan::Course course = scheduled(places(reluctance * kChange * point_), in_time);
      if (in_time && reluctance == 1) return course;
      if (const double cost = spent(course); cost < least) least = cost, best = std::move(course);
      if (in_time) break;
    }
    return best;
  }

  // what a course costs as it is gone, the changes and the lengths of its ways too
  double spent(const LabelPlan::Course& course) const {
    double sum = 0;
    int from = course.first;
    for (const LabelPlan::Move& move : course.moves) {
      std::size_t k = 0;
      while (k + 1 < at_.size() && film(k) < move.begin) ++k;
      sum += kChange * point_ + cost_of_way(*at_[k].second, std::size_t(from), std::size_t(move.to));
      from = move.to;
    }
    for (std::size_t k = 0; k < at_.size(); ++k) {
      const Offered& label = *at_[k].second;
      double own = label.places[std::size_t(course.first)].cost;
      for (const LabelPlan::Move& move : course.moves) {
        if (film(k) <= move.begin) break;
        const double gone = film(k) >= move.end ? 1 : (film(k) - move.begin) / (move.end - move.begin);
        own += gone * (label.places[std::size_t(move.to)].cost - own);
      }
      sum += jumped(course, k);
      sum += lasting(k) *
             (own + among(k, place_of_course(course, kind_, label.anchor, label.places, film(k)).first));
    }
    return sum;
  }

  /// Whether it lies on others anywhere, or a leader runs through words.
  bool clashes(const LabelPlan::Course& course) const {
    for (std::size_t k = 0; k < at_.size(); ++k) {
      const Offered& label = *at_[k].second;
      if (among(k, place_of_course(course, kind_, label.anchor, label.places, film(k)).first) > 0)
        return true;
    }
    return false;
  }

 private:
  double film(std::size_t k) const { return times_[k]; }
  // whether it was not shown before sample k
  bool appears(std::size_t k) const { return at_[k - 1].first + 1 < at_[k].first; }
  // for how long sample k stands
  double lasting(std::size_t k) const {
    const std::size_t sample = at_[k].first;
    return std::clamp(sample + 1 < films_.size() ? films_[sample + 1] - films_[sample] : 0.1, 0.02, 1.0);
  }

  // the cost a second of lying on other labels at a sample
  double on_others(std::size_t sample, const Offered& label, const Point& center) const {
    double cost = 0;
    for (const Planned& other : taken_[sample])
      if (const double both = overlap(label, center, other); both > 0) cost += kShared * point_ * (1 + both);
    return cost;
  }
  // the same, part of the time of the way from place i to place j
  double on_others(std::size_t sample, const Offered& label, std::size_t i, std::size_t j,
                   double part) const {
    if (taken_[sample].empty()) return 0;
    const Point &from = label.places[i].center, &to = label.places[j].center;
    const double s = part * part * (3 - 2 * part);
    if (goes_around(kind_)) return on_others(sample, label, on_its_way(kind_, label.anchor, from, to, s));
    return on_others(sample, label, {from.x() + s * (to.x() - from.x()), from.y() + s * (to.y() - from.y())});
  }

  // the cost a second of standing somewhere at sample k, as others are there
  double among(std::size_t k, const Placing::Candidate& there) const {
    const auto& [sample, label] = at_[k];
    double cost = on_others(sample, *label, there.center);
    for (const Planned& other : taken_[sample])
      if (leads_through(*label, there, *other.label, other.at) ||
          leads_through(*other.label, other.at, *label, there))
        cost += kLedThrough * point_;
    return cost;
  }

  // the cost of jumping at place i from sample k - 1 to sample k
  double jumping(std::size_t k, std::size_t i) const {
    return jumps_.empty() ? 0 : jumps_[k * at_.front().second->places.size() + i];
  }
  // the same, on the way from place i to place j, from `begin` to `end`, about sample k
  double jumping(std::size_t k, std::size_t i, std::size_t j, double begin, double end) const {
    if (jumps_.empty()) return 0;
    while (k > 1 && film(k - 1) > begin) --k;
    double cost = 0;
    for (; k < at_.size() && film(k - 1) < end; ++k) {
      const double u = std::clamp(((film(k) + film(k - 1)) / 2 - begin) / (end - begin), 0.0, 1.0);
      const double gone = u * u * (3 - 2 * u);
      cost += (1 - gone) * jumping(k, i) + gone * jumping(k, j);
    }
    return cost;
  }

  // how long a label takes from place i to place j, s
  double time_of_way(const Offered& label, std::size_t i, std::size_t j) const {
    return std::clamp(1.5 * way(label, i, j) / speed_, kQuickest, kSlowest);
  }

  // the cost of going over other labels from place i to place j, half of the time before sample k; no more is
  // added up than `most`
  double crossing(std::size_t k, std::size_t i, std::size_t j, double most) const {
    const double lasting = time_of_way(*at_[k].second, i, j);
    const double begin = (film(k) + film(k - 1) - lasting) / 2;
    double cost = 0;
    constexpr int kParts = 8;
    for (int n = 1; n < kParts && cost < most; ++n) {
      const double part = double(n) / kParts;
      // the last sample until then
      const auto after = std::upper_bound(times_.begin() + 1, times_.end(), begin + part * lasting);
      const std::size_t near = std::size_t(after - times_.begin()) - 1;
      cost += lasting / kParts * on_others(at_[near].first, *at_[near].second, i, j, part);
    }
    return cost;
  }

  // at each sample the place of the course of least cost, each change at `change`
  std::vector<std::size_t> places(double change) const {
    const std::size_t n = at_.front().second->places.size();
    std::vector<double> best(n, 0), now(n);
    std::vector<std::size_t> ranked(n);
    struct Ranked {
      double best;
      Point center;
    };
    std::vector<Ranked> ahead(n);
    const bool straight = !goes_around(kind_);
    std::vector<std::vector<std::size_t>> from(at_.size(), std::vector<std::size_t>(n, 0));
    for (std::size_t k = 0; k < at_.size(); ++k) {
      const Offered& offered = *at_[k].second;
      // those that cost least first, so that others are soon known to cost more
      std::iota(ranked.begin(), ranked.end(), std::size_t(0));
      std::stable_sort(ranked.begin(), ranked.end(),
                       [&](std::size_t i, std::size_t j) { return best[i] < best[j]; });
      for (std::size_t r = 0; r < n; ++r) ahead[r] = {best[ranked[r]], offered.places[ranked[r]].center};
      for (std::size_t i = 0; i < n; ++i) {
        const Point here = offered.places[i].center;
        std::size_t before = i;
        double least = k > 0 ? best[i] + jumping(k, i) : 0;
        if (k > 0 && appears(k)) {
          // while it is not shown a label changes its place at no cost
          before = ranked.front(), least = best[before];
        } else if (k > 0) {
          for (std::size_t r = 0; r < n; ++r) {
            const double changed = ahead[r].best + change;
            if (changed >= least) break;
            // by its length alone it may cost too much
            const double left = (least - changed) / kWay;
            if (straight && (here - ahead[r].center).squaredNorm() >= left * left) continue;
            const std::size_t j = ranked[r];
            double all = changed + cost_of_way(offered, j, i, least - changed);
            if (all < least && !jumps_.empty()) {
              const double middle = (film(k) + film(k - 1)) / 2, lasting = time_of_way(offered, j, i);
              all += jumping(k, j, i, middle - lasting / 2, middle + lasting / 2);
            }
            if (all < least) all += crossing(k, j, i, least - all);
            if (all < least) before = j, least = all;
          }
        }
        from[k][i] = before;
        now[i] = least + lasting(k) * (offered.places[i].cost + among(k, offered.places[i]));
      }
      best = now;
    }
    std::vector<std::size_t> place(at_.size());
    place.back() = std::size_t(std::min_element(best.begin(), best.end()) - best.begin());
    for (std::size_t k = at_.size() - 1; k > 0; --k) place[k - 1] = from[k][place[k]];
    return place;
  }

  /// How long before its jump, at sample k, a label begins its way from place i to place j: so that of the
  /// time before and after it spends the least at places that cost. On its way it is at half of either.
  double best_lead(std::size_t k, std::size_t i, std::size_t j, double lasting) const {
    const double jump = (film(k) + film(k - 1)) / 2;
    double best = lasting / 2, least = 1e300;
    for (const double part : {0.5, 0.75, 1.0, 0.25, 0.0}) {
      const double begin = jump - part * lasting, end = begin + lasting;
      double sum = jumping(k, i, j, begin, end);
      for (std::size_t near = 0; near < at_.size(); ++near) {
        if (film(near) < jump - lasting || film(near) > jump + lasting) continue;
        const auto& [sample, offered] = at_[near];
        const double gone = std::clamp((film(near) - begin) / (end - begin), 0.0, 1.0);
        sum += (1 - gone) * offered->places[i].cost + gone * offered->places[j].cost +
               on_others(sample, *offered, i, j, gone);
      }
      if (sum < 0.98 * least) least = sum, best = part * lasting;
    }
    return best;
  }

  // when a label goes from place to place; `in_time`: whether each way is over when the next begins
  LabelPlan::Course scheduled(const std::vector<std::size_t>& place, bool& in_time) const {
    LabelPlan::Course course{int(place[0]), {}};
    double free = -1e300;   // when the last way ends
    std::size_t shown = 0;  // the first move since it is shown
    for (std::size_t k = 1; k < at_.size(); ++k) {
      if (place[k] == place[k - 1]) continue;
      LabelPlan::Move move{(film(k) + film(k - 1)) / 2, (film(k) + film(k - 1)) / 2, int(place[k])};
      if (!appears(k)) {
        // in the middle of its way when it would jump
        const double lasting = time_of_way(*at_[k].second, place[k - 1], place[k]);
        move.begin -= best_lead(k, place[k - 1], place[k], lasting);
        move.end = move.begin + lasting;
        make_room(course.moves, shown, move.begin);
        if (move.begin < free) {
          // the last way cannot be over sooner
          free = shown < course.moves.size() ? course.moves.back().end : free;
          in_time = in_time && move.begin >= free;
          if (move.begin < free) move.end += free - move.begin, move.begin = free;
        }
      } else {
        // the label is hidden before its last move ends: that goes on while it is hidden
        shown = course.moves.size() + 1;
      }
      free = move.end;
      course.moves.push_back(move);
    }
    return course;
  }

  // what a course costs by its jumps from sample k - 1 to sample k
  double jumped(const LabelPlan::Course& course, std::size_t k) const {
    if (k == 0 || jumps_.empty()) return 0;
    const double middle = (film(k) + film(k - 1)) / 2;
    double sum = jumping(k, std::size_t(course.first));
    for (const LabelPlan::Move& move : course.moves) {
      if (middle <= move.begin) break;
      const double u = middle >= move.end ? 1 : (middle - move.begin) / (move.end - move.begin);
      sum += u * u * (3 - 2 * u) * (jumping(k, std::size_t(move.to)) - sum);
    }
    return sum;
  }

  const Seen& at_;
  const std::vector<double>& films_;
  const Taken& taken_;
  double point_, speed_;
  WordKey::Kind kind_;
  std::vector<double> times_;  // s of the film: of each sample
  std::vector<double> jumps_;  // of each sample each place's cost of jumping there; none: nothing jumps
};

// where the words of a course stand
Placing::Candidate standing(const LabelPlan::Course& course, const Offered& offered, double film) {
  return place_of_course(course, offered.key.kind, offered.anchor, offered.places, film).first;
}

void take(const Seen& at, const LabelPlan::Course& course, const std::vector<double>& films, Taken& taken) {
  for (const auto& [sample, offered] : at)
    taken[sample].push_back({offered, standing(course, *offered, films[sample])});
}

// whether something lies under its words, and whether they lie on earlier ones only in passing
void tell_covers(const Seen& at, const std::vector<double>& films, const Taken& taken,
                 LabelPlan::Course& course) {
  course.covers = !course.moves.empty();
  std::size_t covering = 0;
  for (const auto& [sample, offered] : at) {
    const Placing::Candidate stands = standing(course, *offered, films[sample]);
    course.covers = course.covers || !stands.clear;
    covering += std::any_of(taken[sample].begin(), taken[sample].end(), [&](const Planned& other) {
      return overlap(*offered, stands.center, other) > 0;
    });
  }
  course.yields = double(covering) < kPassing * double(at.size());
}

}  // namespace

std::map<WordKey, LabelPlan::Course> courses(const std::vector<std::vector<Offered>>& samples,
                                             const std::vector<double>& films, double point, double speed) {
  // the samples that have each label, in the order in which words are set
  std::vector<WordKey> order;
  std::map<WordKey, Seen> seen;
  for (std::size_t k = 0; k < samples.size(); ++k)
    for (const Offered& each : samples[k]) {
      auto& at = seen[each.key];
      if (at.empty()) order.push_back(each.key);
      at.emplace_back(k, &each);
    }
  // what has one place, or hardly more, cannot go out of the way of what has many
  std::stable_partition(order.begin(), order.end(), [&](const WordKey& key) {
    return stays(key, seen[key].front().second->places.size());
  });
  std::map<WordKey, LabelPlan::Course> planned;
  Taken taken(samples.size());
  for (const WordKey& key : order) {
    planned[key] = Planner(seen[key], films, taken, point, speed).course();
    take(seen[key], planned[key], films, taken);
  }
  // those that clash are planned again, beside all others
  for (int round = 0; round < kRounds; ++round) {
    bool better = false;
    for (const WordKey& key : order) {
      for (const auto& [sample, offered] : seen[key])
        std::erase_if(taken[sample], [&](const Planned& each) { return each.label->key == key; });
      const Planner planner(seen[key], films, taken, point, speed);
      if (planner.clashes(planned[key])) {
        LabelPlan::Course other = planner.course();
        if (planner.spent(other) < planner.spent(planned[key]) - point)
          planned[key] = std::move(other), better = true;
      }
      take(seen[key], planned[key], films, taken);
    }
    if (!better) break;
  }
  taken.assign(samples.size(), {});
  for (const WordKey& key : order) {
    tell_covers(seen[key], films, taken, planned[key]);
    take(seen[key], planned[key], films, taken);
  }
  return planned;
}

}  // namespace obscura::draw

// When gaps close with an impact in a step, and how they stand then. Until its first impact a body flies as
// it would without contacts, after one with the velocity it got:
//   x(t) = x + v t + a t^2 / 2,    L(t) = L + M t      a and M as in the step without contacts
// Most gaps do not close; two limits say so without a search. A gap changes no faster than its bodies' matter
// moves there, and its second derivative is bounded by what accelerates and turns them:
//   g(t) >= g - s t        g(t) >= g + g' t - b t^2 / 2

#include <algorithm>
#include <cmath>
#include <limits>

#include "sim/math/lie_step.h"
#include "sim/solve/iterate/closing_time.h"
#include "sim/solve/iterate/pieces.h"
#include "sim/solve/iterate/space.h"

namespace obscura::sim {

namespace {

constexpr double kFarthestPoint = 3;  // bounding radii of both: how far from a body features of a pair touch
constexpr double kWidest = 2.5;       // bounding radii of the smaller: across all where two bodies touch
constexpr double kLeastPart = 1e-3;   // of what a root is in: how far from its ends it is looked for
constexpr double kLevel = 1e-12;      // bounding radii: rounding of what is as deep
constexpr int kRenewals = 4;          // of a gap's features in a step

}  // namespace

// Where a body is at a time of the step, after its last impact if it had one. `own`: where to put it, for
// threads that may not write to its course.
const SpaceIterative::Flown& SpaceIterative::flown(int body, double t, double h, Flown* own) const {
  if (body >= int(model_.bodies.size()) || (inactive_[body] && drives_.number(body) < 0)) return flown_[body];
  if (t == std::max(0.0, when_[body])) return flown_[body];
  if (own) {
    if (t == h && courses_[body].ends) return courses_[body].end;
    return *own = fly(body, t, h);
  }
  // of many gaps of a body one asks what another has asked; most do not close, and ask where the step ends
  Course& course = courses_[body];
  if (t == h) {
    if (!course.ends) course.end = fly(body, h, h), course.ends = true;
    return course.end;
  }
  if (course.asked[course.last] != t) course.last = 1 - course.last;
  if (course.asked[course.last] != t)
    course.then[course.last] = fly(body, t, h), course.asked[course.last] = t;
  return course.then[course.last];
}

SpaceIterative::Flown SpaceIterative::fly(int body, double t, double h) const {
  Flown at = flown_[body];
  const double time = t - std::max(0.0, when_[body]);
  const Body<D>& it = model_.bodies[body];
  const Vec<D> gain = (time / h) * (v_free_[body] - stances_[body].v);
  at.stance.x += time * (at.stance.v + 0.5 * gain), at.stance.v += gain;
  const int k = body - (int(model_.bodies.size()) - int(turn_.size()));
  if (k < 0 || !it.turns()) return at;
  const AngularVec<D> twist = (time / h) * twist_[std::size_t(body)];
  if (at.stance.w.isZero(0) && twist.isZero(0) && drives_.number(body) < 0) return at;
  if (drives_.number(body) >= 0) {
    const AngularVec<D> more = (time / h) * (w_free_[k] - stances_[body].w);
    at.turn = turned<D>(at.turn, AngularVec<D>(time * (at.stance.w + 0.5 * more)));
    at.stance.room_from_body = rotation<D>(at.turn), at.stance.w += more;
    return at;
  }
  if (!wobbles<D>(it.inertia)) {
    const AngularVec<D> more = inverse_inertia_times<D>(it.inertia, at.stance.room_from_body, twist);
    at.turn = turned<D>(at.turn, AngularVec<D>(time * (at.stance.w + 0.5 * more)));
    at.stance.room_from_body = rotation<D>(at.turn), at.stance.w += more;
    return at;
  }
  // Runge and Kutta, as the body sees itself (sim/math/lie_step.h)
  const int pieces = pieces_of_turn<D>(at.stance.w, time);
  const double piece = time / pieces;
  const AngularVec<D> momentum = inertia_times<D>(it.inertia, at.stance.room_from_body, at.stance.w);
  const auto spins = [&](double part) {
    return inverse_inertia_times<D>(it.inertia, at.stance.room_from_body,
                                    AngularVec<D>(momentum + part * twist));
  };
  for (int i = 0; i < pieces; ++i) {
    // with the momentum of the middle of the piece
    if (!twist.isZero(0)) at.stance.w = spins((i + 0.5) / pieces);
    const AngularVec<D> w0 = from_room<D>(at.stance.room_from_body, at.stance.w);
    AngularVec<D> d[4], w[4], step = AngularVec<D>::Zero(), spin = w0;
    for (int s = 0; s < 4; ++s) {
      d[s] = displacement_rate<D>(step, spin), w[s] = gyroscopic_acceleration<D>(it.inertia, spin);
      const double by = s < 2 ? 0.5 * piece : piece;
      step = by * d[s], spin = w0 + by * w[s];
    }
    const AngularVec<D> by = piece / 6 * (d[0] + 2 * d[1] + 2 * d[2] + d[3]);
    at.turn = displaced<D>(at.turn, by);
    at.stance.room_from_body = rotation<D>(at.turn);
    at.stance.w = spins((i + 1.0) / pieces);
  }
  return at;
}

// a gap at a time: how wide, and how fast it changes
SpaceIterative::Instant SpaceIterative::instant(int i, double t, double h, Flown* own) const {
  const ContactConstraint& touch = touches_[i];
  Instant at{flown(touch.a, t, h, own).stance, flown(touch.b, t, h, own ? own + 1 : nullptr).stance, {}};
  if (t == 0 && touch.renewals == 0 && when_[touch.a] < 0 && when_[touch.b] < 0) {
    at.now.value = touch.gap, at.now.point = touch.point, at.now.normal = touch.n;
  } else {
    at.now = evaluate(features_[i], at.a, at.b);
  }
  at.speed = at.now.normal.dot(at.a.velocity(at.now.point - at.a.x) - at.b.velocity(at.now.point - at.b.x));
  return at;
}

// what the free motion adds to a body's velocity
Vec<3> SpaceIterative::free_gain(int body) const {
  if (body == int(inactive_.size()) || (inactive_[body] && drives_.number(body) < 0)) return Vec<D>::Zero();
  return v_free_[body] - stances_[body].v;
}

// No slower does a touch strike: kRestingGains, of gravity restitution_threshold_. Schemes that share out a
// whole step lead what bears aside, and it is struck.
double SpaceIterative::strike_speed(const ContactConstraint& touch) const {
  if (!smooth()) return touch.least_strike;
  // and joints whip what was closing already
  const auto tied = [&](int body) { return body < int(inactive_.size()) && joints_.has(body); };
  if (tied(touch.a) || tied(touch.b)) {
    Vec<D> passes = stances_[touch.a].velocity(touch.arm_a);
    if (touch.b < int(inactive_.size())) passes -= stances_[touch.b].velocity(touch.arm_b);
    if (touch.n.dot(passes) < -restitution_threshold_) return touch.least_strike;
  }
  const auto gain = [&](int body) -> Vec<D> {
    return body < int(inactive_.size()) && inactive_[body] ? Vec<D>(Vec<D>::Zero()) : free_gain(body);
  };
  return std::max(touch.least_strike, -kRestingGains * touch.n.dot(gain(touch.a) - gain(touch.b)));
}

// How fast the matter of two bodies passes at most, m/s, wherever they touch in the step before an impact: at
// the contact, and farther from it by how differently they turn and fall.
double SpaceIterative::most_passing(const ContactConstraint& touch) const {
  static const BodyMotion<D> room;
  const bool wall = touch.b == int(inactive_.size());
  const BodyMotion<D>&a = stances_[touch.a], &b = wall ? room : stances_[touch.b];
  const double size =
      wall ? bounding_radius_[touch.a] : std::min(bounding_radius_[touch.a], bounding_radius_[touch.b]);
  const Vec<D> here = a.velocity(touch.arm_a) - b.velocity(touch.arm_b);
  const AngularVec<D> turns = a.w - b.w;
  return std::sqrt(here.squaredNorm()) + std::sqrt((free_gain(touch.a) - free_gain(touch.b)).squaredNorm()) +
         kWidest * size * std::sqrt(turns.squaredNorm());
}

// how fast a body may become until its next impact
void SpaceIterative::limit_speed(int body, double h) {
  Fastest& it = fastest_[body];
  const BodyMotion<D>& at = flown_[body].stance;
  // what wobbles gains at most a third of its spin while it turns by a quarter of a radian
  it.spin = 4.0 / 3 * (std::sqrt(at.w.squaredNorm()) + it.turns);
  if (it.spin * h > kFarTurn) it.spin = 1e300;
  it.ever = std::max(it.ever, std::sqrt(at.v.squaredNorm()) + it.gain);
}

// How fast a gap may close at most until one of its bodies is struck, m/s: as fast as their matter there.
double SpaceIterative::approach_limit(int i, double h) const {
  const ContactConstraint& touch = touches_[i];
  const Fastest &a = fastest_[touch.a], &b = fastest_[touch.b];
  const double size =
      bounding_radius_[touch.a] + (touch.b < int(inactive_.size()) ? bounding_radius_[touch.b] : 0);
  if (!(h * (a.ever + b.ever) <= size)) return 1e300;
  const Vec<D> passes = flown_[touch.a].stance.v - flown_[touch.b].stance.v;
  return std::sqrt(passes.squaredNorm()) + a.gain + b.gain + kFarthestPoint * size * (a.spin + b.spin);
}

// By how much its second derivative may be below zero, m/s^2: by what accelerates and turns the bodies and
// the normal.
double SpaceIterative::bend_limit(int i, const Instant& at, double h) const {
  const ContactConstraint& touch = touches_[i];
  const Fastest &a = fastest_[touch.a], &b = fastest_[touch.b];
  const bool wall = touch.b == int(inactive_.size());
  const double size = bounding_radius_[touch.a] + (wall ? 0 : bounding_radius_[touch.b]);
  const auto gain = [&](int body) -> Vec<D> {
    if (fastest_[body].gain == 0) return Vec<D>::Zero();
    return v_free_[body] - stances_[body].v;
  };
  const double falls = std::sqrt((gain(touch.a) - gain(touch.b)).squaredNorm());
  const double far = kFarthestPoint * size, spins = a.spin + b.spin;
  const double passes = std::sqrt((at.a.v - at.b.v).squaredNorm()) + falls + far * spins;
  const double matter = 2 * far * (a.spin * a.spin + b.spin * b.spin) + far * (a.turns + b.turns) / h;
  const ContactCandidate<D>& gap = features_[i];
  if (gap.kind == ContactCandidate<D>::Kind::edges) {
    // the less they cross, the faster their normal turns
    const double sine = std::sqrt(at.a.arm(gap.edge_a).cross(at.b.arm(gap.edge_b)).squaredNorm());
    if (!(h * spins < 0.25 * sine)) return 1e300;
    const double turns = 2 * spins / sine;
    return falls / h + matter + 2 * turns * passes + 14 * far * turns * turns;
  }
  return falls / h + matter + 2 * spins * passes;
}

// whether a gap surely stays wider than `apart` until the step ends or one of its bodies is struck
bool SpaceIterative::stays_apart(int i, double apart, double h) {
  const ContactConstraint& touch = touches_[i];
  Reach& reach = reach_[i];
  if (reach.least(h) > apart) return true;
  const double from = std::max({0.0, when_[touch.a], when_[touch.b]}), left = h - from;
  const Instant at = instant(i, from, h);
  reach.gap = at.now.value, reach.when = from;
  return reach.least(h) > apart ||
         (reach.gap > apart && reach.gap + left * (at.speed - 0.5 * left * bend_limit(i, at, h)) > apart);
}

// when a gap closes with an impact
double SpaceIterative::closing_time(int i, double h) {
  return stays_apart(i, kInTime * bounding_radius_[touches_[i].a], h) ? kNeverCloses : meeting_time(i, h);
}

// of one that may; `own` as of flown(), for both
double SpaceIterative::meeting_time(int i, double h, Flown* own) const {
  const ContactConstraint& touch = touches_[i];
  const double from = std::max({0.0, when_[touch.a], when_[touch.b]});
  const Instant at = instant(i, from, h, own);
  const double slow = -strike_speed(touch);
  const bool nears = at.speed < slow;
  const double gap = at.now.value;
  if (gap <= 0) return nears ? from : kNeverCloses;
  return sim::closing_time(from, nears ? from - gap / at.speed : kNeverCloses, h, slow, [&](double when) {
    const Instant then = instant(i, when, h, own);
    return GapInTime{then.now.value, then.speed};
  });
}

// the gaps of a pair at a time, by the features that are nearest then, into `gaps`; how wide the least of
// them
double SpaceIterative::find_features(int a, int b, double t, double h, std::vector<ContactCandidate<D>>& gaps,
                                     Flown* own) const {
  const BodyMotion<D>& at_a = flown(a, t, h, own).stance;
  const BodyMotion<D>& at_b = flown(b, t, h, own ? own + 1 : nullptr).stance;
  gaps.clear();
  Clearance ignored;
  sim::collide(a, model_.bodies[a].shape, at_a, b, model_.bodies[b].shape, at_b, pair_margin(a, b, h),
               Gaps::touching, gaps, ignored);
  double least = 1e300;
  for (ContactCandidate<D>& gap : gaps) {
    gap.value = evaluate(gap, at_a, at_b).value;
    least = std::min(least, gap.value);
  }
  return least;
}

// whether a pair parts at a time, or does not come together again in what is left of the step
bool SpaceIterative::parts_at(int a, int b, double t, double h) {
  find_features(a, b, t, h, gaps_);
  const BodyMotion<D>&at_a = flown(a, t, h).stance, &at_b = flown(b, t, h).stance;
  return std::all_of(gaps_.begin(), gaps_.end(), [&](const ContactCandidate<D>& gap) {
    const EvaluatedContact<D> now = evaluate(gap, at_a, at_b);
    const double speed =
        now.normal.dot(at_a.velocity(now.point - at_a.x) - at_b.velocity(now.point - at_b.x));
    return speed > 0 || now.value + (h - t) * speed > 0;
  });
}

// whether other features of a pair may come nearer while they turn
bool SpaceIterative::features_change(const ContactConstraint& touch) const {
  const auto is_round = [&](int body) { return bool(round_radius(model_.bodies[body].shape)); };
  return touch.b < int(model_.bodies.size()) && touch.renewals < kRenewals &&
         !(is_round(touch.a) && is_round(touch.b));
}

// Gives the gaps of a pair, from `first` on, those features by which it meets between `low` and `high`, when
// some gap is closed or, where none is, those that are nearest then; they are due anew.
void SpaceIterative::renew_features(int first, double low, double high, double h) {
  const int a = touches_[first].a, b = touches_[first].b;
  double closed = find_features(a, b, high, h, gaps_),
         open = closed < 0 ? find_features(a, b, low, h, gaps_) : 0;
  if (closed < 0 && open > 0) {
    // false position; what stays on its side twice counts half
    for (int side = 0; high - low > kInTime * h;) {
      const double part = std::clamp(open / (open - closed), kLeastPart, 1 - kLeastPart);
      const double mid = low + part * (high - low), least = find_features(a, b, mid, h, gaps_);
      if (least > 0) {
        low = mid, open = least;
        if (side > 0) closed *= 0.5;
        side = 1;
      } else {
        high = mid, closed = least;
        if (side < 0) open *= 0.5;
        side = -1;
      }
    }
    find_features(a, b, low, h, gaps_);
  }
  if (gaps_.empty()) return;
  std::stable_sort(gaps_.begin(), gaps_.end(),
                   [](const auto& p, const auto& q) { return p.value < q.value; });
  for (int i = first; i < int(touches_.size()) && touches_[i].a == a && touches_[i].b == b; ++i) {
    if (touches_[i].renewals++ == 0) renewed_.emplace_back(i, features_[i]);
    features_[i] = gaps_[std::min(i - first, int(gaps_.size()) - 1)];
    reach_[i].gap = -1e300;
    const double when = closing_time(i, h);
    touches_[i].passes = when == kNeverCloses;
    if (when < kNeverCloses) due_.push(when, i, rounds(i));
  }
}

// Whether a touch that closes at a time does so by the features that are nearest then, and no others have met
// before.
bool SpaceIterative::meets_by_nearest(int i, double when, double h, std::vector<ContactCandidate<D>>& gaps,
                                      Flown* own) const {
  const ContactConstraint& touch = touches_[i];
  if (!features_change(touch)) return true;
  const double least = find_features(touch.a, touch.b, when, h, gaps, own);
  const auto feature = features_[i].key.feature;
  const double from = std::max({0.0, when_[touch.a], when_[touch.b]});
  const bool found = std::any_of(gaps.begin(), gaps.end(),
                                 [&](const ContactCandidate<D>& gap) { return gap.key.feature == feature; });
  // what lies in each other from the first has not met before
  return found && (least >= -kTogether * bounding_radius_[touch.a] ||
                   find_features(touch.a, touch.b, from, h, gaps, own) <= 0);
}

// The same of one that is due. Where other features are nearer, the gaps of its pair are due by those.
bool SpaceIterative::has_nearest_features(const ImpactQueue::Due& due, double h) {
  const ContactConstraint& touch = touches_[due.number];
  // before anything has been struck it is known
  const bool known = due.rounds == 0;
  if (known ? bool(nearest_[due.number]) : meets_by_nearest(due.number, due.when, h, gaps_, nullptr))
    return true;
  const double from = std::max({0.0, when_[touch.a], when_[touch.b]});
  int first = due.number;
  while (first > 0 && touches_[first - 1].a == touch.a && touches_[first - 1].b == touch.b) --first;
  renew_features(first, from, due.when, h);
  return false;
}

// Whether a pair, whose touches these are, may come to lie in each other deeper than the features of the
// step's start say, while none of its gaps closes; `least`: how wide the least of them is then.
bool SpaceIterative::may_turn_into(int first, int end, double h, Flown* own, double& least) const {
  const ContactConstraint& touch = touches_[first];
  const auto turned = [&](int body) {
    return 2 * h * bounding_radius_[body] * std::sqrt(stances_[body].w.squaredNorm());
  };
  const double turns = turned(touch.a) + turned(touch.b);
  int wide = first;
  while (wide < end && reach_[wide].least(h) > turns + kLevel * bounding_radius_[touch.a]) ++wide;
  if (wide == end) return false;
  least = 1e300;
  for (int i = first; i < end; ++i) least = std::min(least, instant(i, h, h, own).now.value);
  if (least > turns || least - turns > -kTogether * bounding_radius_[touch.a]) return false;
  // nothing lies deeper where they stay so far apart along the normal of a gap
  for (int i = first; i < end; ++i) {
    const Instant at = instant(i, h, h, own);
    if (separation_along(at.now.normal, model_.bodies[touch.a].shape, at.a, model_.bodies[touch.b].shape,
                         at.b) >= std::min(0.0, least) - kLevel * bounding_radius_[touch.a])
      return false;
  }
  return true;
}

// Pairs that come to lie in each other, deeper than the features of the step's start say, none of which
// closes.
void SpaceIterative::find_turned_pairs(double h) {
  turning_.clear();
  for (int first = 0, end = 0; first < int(touches_.size()); first = end) {
    const ContactConstraint& touch = touches_[first];
    bool due = false;
    for (end = first; end < int(touches_.size()) && touches_[end].a == touch.a && touches_[end].b == touch.b;
         ++end)
      due = due || !touches_[end].passes;
    if (!due && features_change(touch)) turning_.push_back({first, end});
  }
  each(workers(), int(turning_.size()), kBodyPiece, [&](int begin, int end) {
    Flown own[2];
    for (int i = begin; i < end; ++i) {
      TurningPair& pair = turning_[std::size_t(i)];
      pair.may = may_turn_into(pair.first, pair.end, h, own, pair.least);
    }
  });
  for (const TurningPair& pair : turning_) {
    if (!pair.may) continue;
    const ContactConstraint& touch = touches_[pair.first];
    if (find_features(touch.a, touch.b, h, h, gaps_) <
        std::min(0.0, pair.least) - kTogether * bounding_radius_[touch.a])
      renew_features(pair.first, 0, h, h);
  }
}

}  // namespace obscura::sim

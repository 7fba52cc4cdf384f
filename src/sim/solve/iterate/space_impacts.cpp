// Impacts in space, each at its own time within the step and where its bodies stand then:
//   w = K p + J v,   p_n >= 0,   w_n + e v_n >= 0,   p_n (w_n + e v_n) = 0,   p_t in Coulomb's cone
// of all that touches there at once, exactly (sim/solve/cone/cone.h). Until then a body flies as it would
// without contacts, after it with the velocity it got; where it comes to so is what the iterations begin
// from. What hangs together on joints meets the impact together: M^-1 is that of the bodies and their joints,
// with the rows of the joints where the step begins. Large heaps are left to the iterations. Newton's law
// can raise the energy, with friction or where something already parts; then e is less, so that it does not.

#include <algorithm>
#include <cmath>
#include <limits>

#include "sim/math/lie_step.h"
#include "sim/solve/iterate/space.h"

namespace obscura::sim {

namespace {

constexpr double kTogether =
    1e-6;                         // of a body's bounding radius: no wider open, a gap takes part in an impact
constexpr int kMost = 8;          // gaps of one impact
constexpr int kTimes = 8;         // Newton steps for its time
constexpr double kInTime = 1e-9;  // of the step: the next would be by its square
constexpr double kLatest = 1.5;   // steps: so late a gap may close that its tangent would close in one
constexpr double kImpactGain = 1e-13;  // of the energy that moves along the rows: rounding
constexpr int kShares = 24;            // halvings for the share of e that does so
constexpr double kLockedPush = 1e-9;   // of what a push moves without joints
constexpr int kRenewals = 4;           // of a gap's features in a step
constexpr int kTurns = 40;             // impacts, of those that there are at first

}  // namespace

// where a body is at a time of the step, after its last impact if it had one
template <int D>
typename SpaceIterative<D>::Flown SpaceIterative<D>::flown(int body, double t, double h) const {
  if (body >= int(model_.bodies.size()) || inactive_[body]) return flown_[body];
  if (t != h) return fly(body, t, h);
  // most gaps do not close: they are asked for where the step ends
  if (!ended_[body]) landed_[body] = fly(body, h, h), ended_[body] = 1;
  return landed_[body];
}

template <int D>
typename SpaceIterative<D>::Flown SpaceIterative<D>::fly(int body, double t, double h) const {
  Flown at = flown_[body];
  const double time = t - std::max(0.0, when_[body]);
  if (time == 0) return at;
  const Body<D>& it = model_.bodies[body];
  const Vec<D> gain = (time / h) * (v_free_[body] - stances_[body].v);
  at.stance.x += time * (at.stance.v + 0.5 * gain), at.stance.v += gain;
  const int k = body - (int(model_.bodies.size()) - int(turn_.size()));
  if (k < 0 || !it.turns()) return at;
  // Runge and Kutta, as the body sees itself (sim/math/lie_step.h)
  const int pieces = pieces_of_turn<D>(at.stance.w, time);
  const double piece = time / pieces;
  const AngularVec<D> momentum = inertia_times<D>(it.inertia, at.stance.room_from_body, at.stance.w);
  for (int i = 0; i < pieces; ++i) {
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
    at.stance.w = inverse_inertia_times<D>(it.inertia, at.stance.room_from_body, momentum);
  }
  return at;
}

// a gap at a time: how wide, and how fast it changes
template <int D>
typename SpaceIterative<D>::Instant SpaceIterative<D>::instant(int i, double t, double h) const {
  Instant at;
  const ContactConstraint& touch = touches_[i];
  at.a = flown(touch.a, t, h).stance, at.b = flown(touch.b, t, h).stance;
  at.now = evaluate(features_[i], at.a, at.b);
  at.speed = at.now.normal.dot(at.a.velocity(at.now.point - at.a.x) - at.b.velocity(at.now.point - at.b.x));
  return at;
}

// When a gap closes with an impact; never: 1e300. Newton's method along its course; where the body turns so
// far that this misleads, by halving.
template <int D>
double SpaceIterative<D>::closing_time(int i, double h) const {
  const ContactConstraint& touch = touches_[i];
  const double from = std::max({0.0, when_[touch.a], when_[touch.b]});
  Instant at = instant(i, from, h);
  const bool nears = at.speed < -restitution_threshold_;
  const double gap = at.now.value;
  if (gap <= 0) return nears ? from : 1e300;
  double when = nears ? from - gap / at.speed : 1e300, low = from, high = -1;
  for (int n = 0; n < kTimes && when <= from + kLatest * h; ++n) {
    at = instant(i, when, h);
    if (at.now.value > 0 && !(at.speed < 0)) {
      // it has come nearest before: was it closed then?
      for (double parted = when; parted - low > kInTime * h && high < 0;) {
        const double mid = 0.5 * (low + parted);
        const Instant then = instant(i, mid, h);
        if (then.now.value <= 0)
          high = mid;
        else
          (then.speed < 0 ? low : parted) = mid;
      }
      if (high < 0) return 1e300;
      break;
    }
    if (!(at.speed < -restitution_threshold_)) break;
    const double next = when - at.now.value / at.speed;
    if (std::abs(next - when) <= kInTime * h) return when <= h ? when : 1e300;
    when = std::clamp(next, from, from + kLatest * h);
  }
  if (high < 0) {
    if (from >= h || instant(i, h, h).now.value > 0) return 1e300;
    high = h;
  }
  while (high - low > kInTime * h) {
    when = 0.5 * (low + high);
    (instant(i, when, h).now.value > 0 ? low : high) = when;
  }
  return instant(i, low, h).speed < -restitution_threshold_ ? low : 1e300;
}

// the gaps of a pair at a time, by the features that are nearest then, into gaps_; how wide the least of them
template <int D>
double SpaceIterative<D>::find_features(int a, int b, double t, double h) {
  const BodyMotion<D> at_a = flown(a, t, h).stance, at_b = flown(b, t, h).stance;
  gaps_.clear();
  sim::collide(a, model_.bodies[a].shape, at_a, b, model_.bodies[b].shape, at_b, pair_margin(a, b, h), gaps_);
  double least = 1e300;
  for (ContactCandidate<D>& gap : gaps_) {
    gap.value = evaluate(gap, at_a, at_b).value;
    least = std::min(least, gap.value);
  }
  return least;
}

// whether other features of a pair may come nearer while they turn
template <int D>
bool SpaceIterative<D>::features_change(const ContactConstraint& touch) const {
  const auto is_round = [&](int body) { return bool(round_radius(model_.bodies[body].shape)); };
  return touch.b < int(model_.bodies.size()) && touch.renewals < kRenewals &&
         !(is_round(touch.a) && is_round(touch.b));
}

// Gives the gaps of a pair, from `first` on, those features by which it meets between `low` and `high`, when
// some gap is closed or, where none is, those that are nearest then; they are due anew.
template <int D>
void SpaceIterative<D>::renew_features(int first, double low, double high, double h) {
  const int a = touches_[first].a, b = touches_[first].b;
  if (find_features(a, b, high, h) < 0 && find_features(a, b, low, h) > 0) {
    while (high - low > kInTime * h) {
      const double mid = 0.5 * (low + high);
      (find_features(a, b, mid, h) > 0 ? low : high) = mid;
    }
    find_features(a, b, low, h);
  }
  if (gaps_.empty()) return;
  std::stable_sort(gaps_.begin(), gaps_.end(),
                   [](const auto& p, const auto& q) { return p.value < q.value; });
  for (int i = first; i < int(touches_.size()) && touches_[i].a == a && touches_[i].b == b; ++i) {
    features_[i] = gaps_[std::min(i - first, int(gaps_.size()) - 1)];
    ++touches_[i].renewals;
    const double when = closing_time(i, h);
    touches_[i].passes = when == 1e300;
    if (when < 1e300) push_due(i, when);
  }
}

// Whether a pair meets by the features that are nearest then. Where others are, or have met before, its gaps
// are due by those.
template <int D>
bool SpaceIterative<D>::has_nearest_features(const Due& due, double h) {
  const ContactConstraint& touch = touches_[due.touch];
  if (!features_change(touch)) return true;
  const double least = find_features(touch.a, touch.b, due.when, h);
  const auto feature = features_[due.touch].key.feature;
  const double from = std::max({0.0, when_[touch.a], when_[touch.b]});
  const bool found = std::any_of(gaps_.begin(), gaps_.end(),
                                 [&](const ContactCandidate<D>& gap) { return gap.key.feature == feature; });
  // what lies in each other from the first has not met before
  if (found &&
      (least >= -kTogether * bounding_radius_[touch.a] || find_features(touch.a, touch.b, from, h) <= 0))
    return true;
  int first = due.touch;
  while (first > 0 && touches_[first - 1].a == touch.a && touches_[first - 1].b == touch.b) --first;
  renew_features(first, from, due.when, h);
  return false;
}

// pairs that come to lie in each other by other features than those of the step's start, none of which closes
template <int D>
void SpaceIterative<D>::find_turned_pairs(double h) {
  for (int first = 0, end = 0; first < int(touches_.size()); first = end) {
    const ContactConstraint& touch = touches_[first];
    bool due = false;
    double least = 1e300;
    for (end = first; end < int(touches_.size()) && touches_[end].a == touch.a && touches_[end].b == touch.b;
         ++end)
      due = due || !touches_[end].passes;
    if (due || !features_change(touch)) continue;
    for (int i = first; i < end; ++i) least = std::min(least, instant(i, h, h).now.value);
    const auto turned = [&](int body) {
      return 2 * h * bounding_radius_[body] * std::sqrt(stances_[body].w.squaredNorm());
    };
    if (least > turned(touch.a) + turned(touch.b)) continue;
    if (find_features(touch.a, touch.b, h, h) < -kTogether * bounding_radius_[touch.a])
      renew_features(first, 0, h, h);
  }
}

// what meets with a gap at a time, through gaps that are closed; false where that is not for here
template <int D>
bool SpaceIterative<D>::gather_impact(int first, double t, double h) {
  meets_.assign(1, first);
  bool few = true;
  for (std::size_t k = 0; few && k < meets_.size(); ++k) {
    for (const int side : {touches_[meets_[k]].a, touches_[meets_[k]].b}) {
      each_tied(side, [&](int body) {
        for (int at = around_start_[body]; few && at < around_start_[body + 1]; ++at) {
          const int other = around_[at];
          if (std::find(meets_.begin(), meets_.end(), other) != meets_.end()) continue;
          if (instant(other, t, h).now.value > kTogether * bounding_radius_[body]) continue;
          few = int(meets_.size()) < kMost;
          if (few) meets_.push_back(other);
        }
      });
    }
  }
  return few;
}

// the rows of what meets at a time, n and across it of each gap, their M^-1 J', K and J v; false where joints
// leave it nothing to move
template <int D>
bool SpaceIterative<D>::build_impact_rows(double t, double h) {
  const int count = int(meets_.size()), rows = D * count, n = int(model_.bodies.size());
  K_.resize(rows, rows), speeds_.resize(rows), blocks_.assign(count, {});
  impact_rows_.assign(rows, {}), impact_responses_.resize(rows);
  impact_tied_ = false;
  for (int k = 0; k < count; ++k) {
    const ContactConstraint& touch = touches_[meets_[k]];
    const Instant at = instant(meets_[k], t, h);
    Vec<D> ways[D];
    ways[0] = at.now.normal, ways[1] = perpendicular<D>(at.now.normal);
    if constexpr (D == 3) ways[2] = ways[0].cross(ways[1]);
    blocks_[k].mu = touch.mu;
    for (int i = 0; i < D; ++i) {
      Row<D>& row = impact_rows_[D * k + i];
      row.a = touch.a, row.b = touch.b == n ? -1 : touch.b, row.along = ways[i];
      row.angular_a = moment<D>(Vec<D>(at.now.point - at.a.x), ways[i]);
      row.angular_b = moment<D>(Vec<D>(at.now.point - at.b.x), ways[i]);
      impact_responses_[D * k + i] = response_.of(row, at.a, at.b);
      speeds_[D * k + i] =
          row.along.dot(at.a.v - at.b.v) + row.angular_a.dot(at.a.w) - row.angular_b.dot(at.b.w);
    }
    if (joints_.empty()) continue;
    for (const auto& [body, it] : {std::pair(touch.a, &at.a), std::pair(touch.b, &at.b)}) {
      if (body == n) continue;
      const bool tied = joints_.component(body) >= 0;
      impact_tied_ = impact_tied_ || tied;
      if (!tied) joints_.body_motion(body) = *it;
    }
  }
  if (!impact_tied_) {
    for (int i = 0; i < rows; ++i) {
      for (int j = 0; j <= i; ++j)
        K_(i, j) = K_(j, i) = coupling(impact_rows_[i], impact_responses_[i], impact_rows_[j]);
    }
    return true;
  }
  if (int(tied_responses_.size()) < rows) tied_responses_.resize(rows);
  for (int i = 0; i < rows; ++i) {
    tied_responses_[i].row = impact_rows_[i];
    joints_.compute_response(tied_responses_[i]);
    for (int j = 0; j <= i; ++j)
      K_(i, j) = K_(j, i) = joints_.response_between(tied_responses_[i], tied_responses_[j]);
    const Row<D>& row = impact_rows_[i];
    const double without = response_.inverse_mass(row.a) + response_.inverse_mass(row.b);
    if (i % D == 0 && !(K_(i, i) > kLockedPush * without)) return false;
  }
  return true;
}

// all that meets at a time, at once; false where no impulses were found
template <int D>
bool SpaceIterative<D>::solve_impact(double t, double h) {
  if (!build_impact_rows(t, h)) return false;
  const int count = int(meets_.size()), rows = D * count;
  const Eigen::VectorXd& v = speeds_;
  b_.resize(rows), p_.resize(rows);
  // with e times `share`; how much more energy there is after it, of the largest part that an impulse moves
  const auto gain = [&](double share) {
    b_ = v;
    for (int k = 0; k < count; ++k) {
      if (v[D * k] < -restitution_threshold_) b_[D * k] += share * touches_[meets_[k]].bounce * v[D * k];
    }
    modes_.assign(count, {}), p_.setZero();
    if (!cone_.solve(K_, b_, blocks_, modes_, p_).found) return std::numeric_limits<double>::infinity();
    double sum = 0, size = 0;
    for (int i = 0; i < rows; ++i)
      sum += p_[i] * (v[i] + 0.5 * K_.row(i).dot(p_)), size = std::max(size, std::abs(p_[i] * v[i]));
    return sum > kImpactGain * size ? sum / size : 0;
  };
  double rise = gain(1), low = rise > 0 ? 0 : 1, high = 1;
  if (rise > 0) {
    // with friction half of it and half again, as by the other solvers; without, the largest share that keeps
    // it
    const bool rubs =
        std::any_of(blocks_.begin(), blocks_.end(), [](const auto& block) { return block.mu > 0; });
    for (int n = 0; n < kShares && (low == 0 || !rubs); ++n) {
      const double mid = 0.5 * (low + high);
      (gain(mid) > 0 ? high : low) = mid;
    }
    rise = gain(low);
  }
  if (!std::isfinite(rise)) return false;

  for (const int i : meets_) {
    for (const int side : {touches_[i].a, touches_[i].b}) {
      each_tied(side, [&](int body) {
        if (when_[body] == t) return;
        flown_[body] = flown(body, t, h), when_[body] = t, ended_[body] = 0;
      });
    }
  }
  for (int i = 0; i < rows; ++i) {
    touches_[meets_[i / D]].impact_impulse += p_[i] * impact_rows_[i].along;
    if (impact_tied_) {
      joints_.each_push(tied_responses_[i], p_[i], [&](int body, const Vec<D>& dv, const AngularVec<D>& dw) {
        flown_[body].stance.v += dv, flown_[body].stance.w += dw;
      });
      continue;
    }
    each_response(impact_rows_[i], impact_responses_[i], p_[i],
                  [&](int body, const Vec<D>& dv, const AngularVec<D>& spin, double p) {
                    BodyMotion<D>& it = flown_[body].stance;
                    it.v += dv, it.w += p * spin;
                  });
  }
  return true;
}

// Adds the step's impacts to the positions without contacts, and leaves the rest to the iterations of the
// gaps of those that had one.
template <int D>
void SpaceIterative<D>::resolve_impacts(StepPart<D> step) {
  State<D>& state = step.state;
  const double h = step.h;
  const int n = int(model_.bodies.size());
  struck_ = false;
  when_.assign(n + 1, -1), due_.clear();
  const auto fast = [&](int i) {
    const ContactConstraint& touch = touches_[i];
    const auto speed = [&](int body) {
      return body == n ? 0
                       : std::sqrt(stances_[body].v.squaredNorm()) +
                             bounding_radius_[body] * std::sqrt(stances_[body].w.squaredNorm());
    };
    return speed(touch.a) + speed(touch.b) >= restitution_threshold_;
  };
  bool any = false;
  for (int i = 0; i < int(touches_.size()) && !any; ++i) any = fast(i);
  if (!any) return;
  flown_.assign(n + 1, {}), landed_.resize(n + 1), ended_.assign(n + 1, 0);
  for (int i = 0; i < n; ++i) {
    flown_[i].stance = stances_[i];
    if (const int k = turning(state, i); k >= 0) flown_[i].turn = turn_[k];
  }
  for (int i = 0; i < int(touches_.size()); ++i) {
    if (!fast(i)) continue;
    const double when = closing_time(i, h);
    if (when < 1e300)
      due_.push_back({when, i, 0});
    else
      touches_[i].passes = true;
  }
  row_features_ = features_;
  rounds_.assign(n + 1, 0);
  std::make_heap(due_.begin(), due_.end());
  find_turned_pairs(h);
  if (due_.empty()) {
    features_.swap(row_features_);
    return;
  }

  // the gaps of each body
  around_start_.assign(n + 2, 0);
  const auto each = [&](const auto& act) {
    for (int i = 0; i < int(touches_.size()); ++i) {
      for (const int body : {touches_[i].a, touches_[i].b}) {
        if (body < n && !inactive_[body]) act(i, body);
      }
    }
  };
  each([&](int, int body) { ++around_start_[body + 1]; });
  for (int i = 1; i < n + 2; ++i) around_start_[i] += around_start_[i - 1];
  around_.resize(around_start_[n + 1]);
  std::vector<int>& next = changed_;
  next.assign(around_start_.begin(), around_start_.end());
  each([&](int i, int body) { around_[next[body]++] = i; });

  // in the order of time, then of gaps
  for (std::size_t left = kTurns * due_.size() + 100; left > 0 && !due_.empty(); --left) {
    std::pop_heap(due_.begin(), due_.end());
    const Due due = due_.back();
    due_.pop_back();
    if (due.rounds != rounds(due.touch)) continue;
    if (!has_nearest_features(due, h)) continue;
    if (!gather_impact(due.touch, due.when, h) || !solve_impact(due.when, h)) continue;
    struck_ = true;
    changed_.clear();
    for (const int i : meets_) {
      for (const int side : {touches_[i].a, touches_[i].b}) {
        each_tied(side, [&](int body) {
          ++rounds_[body];
          changed_.insert(changed_.end(), around_.begin() + around_start_[body],
                          around_.begin() + around_start_[body + 1]);
        });
      }
    }
    std::sort(changed_.begin(), changed_.end());
    changed_.erase(std::unique(changed_.begin(), changed_.end()), changed_.end());
    for (const int i : changed_) {
      const double when = closing_time(i, h);
      if (when < 1e300) push_due(i, when);
    }
  }
  features_.swap(row_features_);
  if (!struck_) return;

  for (int i = 0; i < int(touches_.size()); ++i) {
    ContactConstraint& touch = touches_[i];
    if (when_[touch.a] < 0 && when_[touch.b] < 0) continue;
    const double t = std::max(when_[touch.a], when_[touch.b]), left = h - t;
    const Instant at = instant(i, t, h);
    const auto along = [&](const BodyMotion<D>& body, const Vec<D>& arm) {
      return touch.n.dot(body.velocity(arm));
    };
    touch.after = true;
    touch.least = along(at.a, touch.arm_a) - along(at.b, touch.arm_b) - at.speed;
    if (at.now.value <= kTogether * bounding_radius_[touch.a]) continue;
    // what comes near so fast passes: else it would have met
    const bool passes = at.speed < -restitution_threshold_ || left <= kInTime * h;
    touch.least = passes ? -1e9 : touch.least - at.now.value / left;
  }
  for (int i = 0; i < n; ++i) {
    if (when_[i] < 0) continue;
    const Flown end = flown(i, h, h);
    state.x[i] = x_free_[i] = end.stance.x, state.v[i] = v_free_[i] = moving_[i].v = end.stance.v;
    if (const int k = turning(state, i); k >= 0) {
      state.turn[k] = turn_free_[k] = end.turn, state.spin[k] = w_free_[k] = moving_[i].w = end.stance.w;
    }
  }
  energy_guard_.open(state);
}

template void SpaceIterative<3>::resolve_impacts(StepPart<3>);

}  // namespace obscura::sim

// Impacts in space, each at its own time within the step and where its bodies stand then:
//   w = K p + J v,   p_n >= 0,   w_n + e v_n >= 0,   p_n (w_n + e v_n) = 0,   p_t in Coulomb's cone
// of all that touches there at once, exactly (sim/solve/cone/cone.h). Until then a body flies as it would
// without contacts, after it with the velocity it got; where it comes to so is what the iterations begin
// from. What hangs together on joints meets the impact together: M^-1 is that of the bodies and their joints,
// with the rows of the joints where the step begins. Large heaps are left to the iterations. Newton's law
// can raise the energy, with friction or where something already parts; then e is less, so that it does not.

#include <algorithm>
#include <atomic>
#include <cmath>
#include <tuple>

#include "sim/solve/iterate/closing_time.h"
#include "sim/solve/iterate/endless_impacts.h"
#include "sim/solve/iterate/pieces.h"
#include "sim/solve/iterate/space.h"

namespace obscura::sim {

// whether a gap is closed at a time, up to what its pair overlaps
bool SpaceIterative::closed(int touch, double bounding_radius, double t, double h) const {
  if (reach_[touch].least(t) > closed_up_to(bounding_radius, -bounding_radius)) return false;
  const double gap = instant(touch, t, h).now.value;
  if (gap <= kTogether * bounding_radius) return true;
  const auto beside = [&](int i) {
    return touches_[i].a == touches_[touch].a && touches_[i].b == touches_[touch].b;
  };
  double least = gap;
  for (int i = touch; i-- > 0 && beside(i);) least = std::min(least, instant(i, t, h).now.value);
  for (int i = touch + 1; i < int(touches_.size()) && beside(i); ++i)
    least = std::min(least, instant(i, t, h).now.value);
  return gap <= closed_up_to(bounding_radius, least);
}

// whether joints hold a body of a touch
bool SpaceIterative::on_joints(const ContactConstraint& touch) const {
  return joints_.component(touch.a) >= 0 ||
         (touch.b < int(model_.bodies.size()) && joints_.component(touch.b) >= 0);
}

// what meets with a gap at a time, through gaps that are closed: those of its pair alone, if pairs are struck
// one after another; false where that is not for here
bool SpaceIterative::gather_impact(int first, double t, double h) {
  meets_.assign(1, first);
  const ContactKey pair = touches_[first].key;
  const bool alone = model_.impacts == Impacts::sequential;
  bool few = true, tied = on_joints(touches_[first]);
  for (std::size_t k = 0; few && k < meets_.size(); ++k) {
    for (const int side : {touches_[meets_[k]].a, touches_[meets_[k]].b}) {
      each_tied(side, [&](int body) {
        for (const int other : around_.of(body)) {
          if (!few) return;
          const ContactKey& key = touches_[other].key;
          if (alone && (key.a != pair.a || key.b != pair.b)) continue;
          if (std::find(meets_.begin(), meets_.end(), other) != meets_.end()) continue;
          if (!closed(other, bounding_radius_[body], t, h)) continue;
          tied = tied || on_joints(touches_[other]);
          few = int(meets_.size()) < InstantImpact<D>::few(tied, int(model_.bodies.size()));
          if (few) meets_.push_back(other);
        }
      });
    }
  }
  return few;
}

void SpaceIterative::begin_rows(int contacts) {
  impact_rows_.assign(std::size_t(D * contacts), {}), impact_responses_.resize(std::size_t(D * contacts));
}

// the k-th contact's rows, along the normal and two ways across it, and their M^-1 J'
void SpaceIterative::set_rows(int k, const ContactConstraint& touch, const Vec<D>& normal,
                              const Vec<D>& arm_a, const Vec<D>& arm_b, const BodyMotion<D>& a,
                              const BodyMotion<D>& b) {
  const std::array<Row<D>, D> rows = rows_of(touch, normal, arm_a, arm_b);
  for (int i = 0; i < D; ++i) {
    impact_rows_[D * k + i] = rows[std::size_t(i)];
    impact_responses_[D * k + i] = response_.of(rows[std::size_t(i)], a, b);
  }
}

// the rows of a touch, along its normal and across it
std::array<Row<3>, 3> SpaceIterative::rows_of(const ContactConstraint& touch, const Vec<D>& normal,
                                              const Vec<D>& arm_a, const Vec<D>& arm_b) const {
  const Vec<D> across = perpendicular<D>(normal), ways[D] = {normal, across, normal.cross(across)};
  std::array<Row<D>, D> rows;
  for (int i = 0; i < D; ++i) {
    Row<D>& row = rows[std::size_t(i)];
    row.a = touch.a, row.b = touch.b == int(model_.bodies.size()) ? -1 : touch.b, row.along = ways[i];
    row.angular_a = moment<D>(arm_a, ways[i]), row.angular_b = moment<D>(arm_b, ways[i]);
  }
  return rows;
}

void SpaceIterative::couple_rows(Eigen::Ref<Eigen::MatrixXd> K) const {
  for (int i = 0; i < int(impact_rows_.size()); ++i) {
    for (int j = 0; j <= i; ++j)
      K(i, j) = K(j, i) = coupling(impact_rows_[i], impact_responses_[i], impact_rows_[j]);
  }
}

// where an impact finds the joints of a body
void SpaceIterative::place_joints(int body, double t, double h) {
  const int component = joints_.component(body);
  if (component < 0) return;
  struck_joints_.compute_rows_at(t, joints_, component, [&](int it, BodyMotion<D>& at, Orientation<D>& turn) {
    const Flown& there = flown(it, t, h);
    at.x = there.stance.x, at.room_from_body = there.stance.room_from_body, turn = there.turn;
  });
}

// whether joints leave a touch nothing to move
bool SpaceIterative::locked(const ContactConstraint& touch) {
  const int none = int(model_.bodies.size());
  Row<D>& row = locked_response_.row;
  row.a = touch.a, row.b = touch.b == none ? -1 : touch.b, row.along = touch.n;
  row.angular_a = moment<D>(touch.arm_a, touch.n), row.angular_b = moment<D>(touch.arm_b, touch.n);
  return joints_.locks(locked_response_);
}

// the ends of joints that are reached by what meets at a time
void SpaceIterative::gather_ends(double t, double h) {
  struck_ends_.clear();
  if (joints_.empty()) return;
  for (const int touch : meets_) {
    for (const int body : {touches_[touch].a, touches_[touch].b}) {
      if (body == int(model_.bodies.size())) continue;
      place_joints(body, t, h);
      struck_ends_.add(joints_, struck_joints_, body, 1 - t / h,
                       [&](int member, Vec<D>& v, AngularVec<D>& w) {
                         if (inactive_[member]) return false;
                         const BodyMotion<D>& at = flown(member, t, h).stance;
                         v = at.v, w = at.w;
                         return true;
                       });
    }
  }
  struck_ends_.limit();
}

// the rows of what meets at a time, n and across it of each gap, their M^-1 J', K and J v
void SpaceIterative::build_impact_rows(double t, double h) {
  const int count = int(meets_.size()), rows = D * count, n = int(model_.bodies.size());
  begin_rows(count);
  impact_tied_ = false;
  gather_ends(t, h);
  instant_.resize(count, struck_ends_.count());
  for (int k = 0; k < count; ++k) {
    const ContactConstraint& touch = touches_[meets_[k]];
    const Instant at = instant(meets_[k], t, h);
    instant_.blocks[k].mu = touch.mu;
    instant_.driven = instant_.driven || !touch.belt.isZero(0) || drives_.number(touch.a) >= 0 ||
                      (touch.b < n && drives_.number(touch.b) >= 0);
    set_rows(k, touch, at.now.normal, at.now.point - at.a.x, at.now.point - at.b.x, at.a, at.b);
    for (int i = 0; i < D; ++i) {
      const Row<D>& row = impact_rows_[D * k + i];
      instant_.speeds[D * k + i] =
          row.along.dot(at.a.v - at.b.v) + row.angular_a.dot(at.a.w) - row.angular_b.dot(at.b.w);
      if (i > 0 && !touch.belt.isZero(0)) instant_.speeds[D * k + i] += row.along.dot(touch.belt);
    }
    if (instant_.speeds[D * k] < -strike_speed(touch))
      instant_.strikes[k] = 1, instant_.elasticity[k] = touch.bounce;
    if (joints_.empty()) continue;
    for (const auto& [body, it] : {std::pair(touch.a, &at.a), std::pair(touch.b, &at.b)}) {
      if (body == n) continue;
      const bool tied = joints_.component(body) >= 0;
      impact_tied_ = impact_tied_ || tied;
      if (!tied) struck_joints_.body_motion(body) = *it;
    }
  }
  if (!impact_tied_) return couple_rows(instant_.K);
  auto& K = instant_.K;
  if (int(tied_responses_.size()) < rows) tied_responses_.resize(rows);
  for (int i = 0; i < rows; ++i) {
    tied_responses_[i].row = impact_rows_[i];
    struck_joints_.compute_response(tied_responses_[i]);
    for (int j = 0; j <= i; ++j)
      K(i, j) = K(j, i) = struck_joints_.response_between(tied_responses_[i], tied_responses_[j]);
  }
  struck_ends_.couple(struck_joints_, std::span(tied_responses_).first(std::size_t(rows)), instant_);
}

// all that meets at a time, at once; false where no impulses were found
bool SpaceIterative::solve_impact(double t, double h, std::vector<double>& work) {
  // what joints leave nothing to move meets nothing
  if (!joints_.empty()) {
    std::erase_if(meets_, [&](int i) { return on_joints(touches_[i]) && locked(touches_[i]); });
    if (meets_.empty()) return false;
  }
  build_impact_rows(t, h);
  const int rows = int(impact_rows_.size());
  if (!instant_.solve()) return false;
  const auto& impulses = instant_.p;

  for (const int i : meets_) {
    for (const int side : {touches_[i].a, touches_[i].b}) {
      each_tied(side, [&](int body) {
        if (when_[body] != t) {
          flown_[body] = flown(body, t, h);
          rested_since_[body] = std::max(0.0, when_[body]), when_[body] = t;
        }
        courses_[body].forget();  // also of a second impact in this instant
      });
    }
  }
  if (!carries_.empty() && !work.empty()) {
    for (int i = 0; i < rows; ++i) {
      const ContactConstraint& touch = touches_[meets_[i / D]];
      const Row<D>& row = impact_rows_[i];
      double gives = i % D != 0 ? -row.along.dot(touch.belt) : 0;
      for (const auto& [body, turn, sign] :
           {std::tuple(row.a, row.angular_a, 1.0), std::tuple(row.b, row.angular_b, -1.0)}) {
        if (body < 0 || drives_.number(body) < 0) continue;
        const BodyMotion<D>& at = flown(body, t, h).stance;
        gives -= sign * (row.along.dot(at.v) + turn.dot(at.w));
      }
      if (impact_tied_) gives += struck_joints_.given(tied_responses_[i]);
      work[0] += impulses[i] * gives;
    }
  }
  for (int i = 0; i < rows; ++i) {
    touches_[meets_[i / D]].impact_impulse += impulses[i] * impact_rows_[i].along;
    if (impact_tied_) {
      struck_joints_.each_push(tied_responses_[i], impulses[i],
                               [&](int body, const Vec<D>& dv, const AngularVec<D>& dw) {
                                 flown_[body].stance.v += dv, flown_[body].stance.w += dw;
                               });
      continue;
    }
    each_response(impact_rows_[i], impact_responses_[i], impulses[i],
                  [&](int body, const Vec<D>& dv, const AngularVec<D>& spin, double p) {
                    BodyMotion<D>& it = flown_[body].stance;
                    it.v += dv, it.w += p * spin;
                  });
  }
  hold_until(t);
  const double gives =
      struck_ends_.apply(struck_joints_, instant_, [&](int body, const Vec<D>& dv, const AngularVec<D>& dw) {
        flown_[body].stance.v += dv, flown_[body].stance.w += dw;
      });
  if (!carries_.empty() && !work.empty()) work[0] += gives;
  return true;
}

// What rested until an impact has not fallen before it, as its flight has: what held it did so all the time.
// What only came to rest then turned before, and has turned.
void SpaceIterative::hold_until(double t) {
  const auto hold = [&](int body, const Vec<D>& dv) {
    flown_[body].stance.x += 0.5 * (t - rested_since_[body]) * dv;
  };
  for (int i = 0; i < int(impact_rows_.size()); ++i) {
    const double p = instant_.rested()[i];
    if (p == 0) continue;
    if (impact_tied_)
      struck_joints_.each_push(tied_responses_[i], p,
                               [&](int body, const Vec<D>& dv, const AngularVec<D>&) { hold(body, dv); });
    else
      each_response(impact_rows_[i], impact_responses_[i], p,
                    [&](int body, const Vec<D>& dv, const AngularVec<D>&, double) { hold(body, dv); });
  }
}

// Adds the step's impacts to the positions without contacts, and leaves the rest to the iterations of the
// gaps of those that had one.
void SpaceIterative::resolve_impacts(StepPart<D> step) {
  State<D>& state = step.state;
  const double h = step.h;
  const int n = int(model_.bodies.size());
  struck_ = false;
  when_.assign(n + 1, -1), rested_since_.assign(n + 1, 0), due_.clear();
  const auto fast = [&](int i) { return most_passing(touches_[i]) >= touches_[i].least_strike; };
  std::atomic<bool> any = false;
  each(workers(), int(touches_.size()), kTouchPiece, [&](int begin, int end) {
    for (int i = begin; i < end && !any.load(std::memory_order_relaxed); ++i)
      if (fast(i)) any = true;
  });
  if (!any) return;
  lay_down_ends(state, h);
  begin_flights(state, h);
  begin_struck_joints(state);
  find_closing(state, h);
  renewed_.clear();
  rounds_.assign(n + 1, 0), crowded_.assign(n + 1, 0);
  find_turned_pairs(h);
  if (due_.empty()) {
    restore_features(), give_back_ends(state);
    return;
  }

  around_.build(n, int(touches_.size()), [&](int i, const auto& act) {
    for (const int body : {touches_[i].a, touches_[i].b}) {
      if (body < n && !inactive_[body]) act(body);
    }
  });

  // in the order of time, then of gaps
  std::size_t looked_at = 0;
  while (!due_.empty()) {
    const ImpactQueue::Due due = due_.pop();
    if (due.rounds != rounds(due.number)) continue;
    if (crowded_[touches_[due.number].a] || crowded_[touches_[due.number].b]) continue;
    if (++looked_at > kMostImpacts) end_of_impacts(model_.bodies[touches_[due.number].a].name, step.t, h);
    if (!has_nearest_features(due, h)) continue;
    if (!gather_impact(due.number, due.when, h)) {
      // so many touch there that what meets them later is left to the iterations, too
      for (const int i : meets_) crowded_[touches_[i].a] = crowded_[touches_[i].b] = 1;
      crowded_.back() = 0;
      continue;
    }
    if (!solve_impact(due.when, h, state.work)) continue;
    struck_ = true;
    changed_.clear();
    for (const int i : meets_) {
      for (const int side : {touches_[i].a, touches_[i].b}) {
        each_tied(side, [&](int body) {
          ++rounds_[body];
          limit_speed(body, h);
          const std::span<const int> its = around_.of(body);
          changed_.insert(changed_.end(), its.begin(), its.end());
        });
      }
    }
    std::sort(changed_.begin(), changed_.end());
    changed_.erase(std::unique(changed_.begin(), changed_.end()), changed_.end());
    for (const int i : changed_) {
      reach_[i] = {reach_[i].least(due.when), due.when, approach_limit(i, h)};
      const double when = closing_time(i, h);
      if (when < kNeverCloses) due_.push(when, i, rounds(i));
    }
  }
  restore_features();
  if (!struck_) return give_back_ends(state);

  for (int i = 0; i < int(touches_.size()); ++i) {
    ContactConstraint& touch = touches_[i];
    if (when_[touch.a] < 0 && when_[touch.b] < 0) continue;
    const double t = std::max(when_[touch.a], when_[touch.b]), left = h - t;
    const Instant at = instant(i, t, h);
    const auto along = [&](const BodyMotion<D>& body, const Vec<D>& arm) {
      return touch.n.dot(body.velocity(arm));
    };
    touch.after = true;
    touch.rests =
        std::fabs(at.speed) <= kLasting * (swiftness(touch.a) + (touch.b < n ? swiftness(touch.b) : 0));
    touch.apart = along(at.a, touch.arm_a) - along(at.b, touch.arm_b) - at.speed;
    touch.least =
        target_after_impacts(touch.apart, {at.now.value, at.speed}, kTogether * bounding_radius_[touch.a],
                             -restitution_threshold_, left, h);
    // where other features have met, those that it had say nothing of what bounces and parts by these
    if (touch.renewals > 0 && touch.bounce > kBounces && parts_at(touch.a, touch.b, t, h))
      touch.least = kNoAim;
  }
  end_struck_joints(h, [&](int body) {
    Twist<D> given;
    if (when_[body] < 0) return given;
    const BodyMotion<D> end = flown(body, h, h).stance;
    given.v = end.v - v_free_[body];
    if (const int k = turning(state, body); k >= 0) given.w = end.w - w_free_[k];
    return given;
  });
  for (int i = 0; i < n; ++i) {
    if (when_[i] < 0) continue;
    Flown end = flown(i, h, h);
    if (joints_.stopped() && joints_.has(i))
      end.stance.x += bends_[i], end.turn = turned<D>(end.turn, turn_bends_[i]);
    state.x[i] = x_free_[i] = end.stance.x, state.v[i] = v_free_[i] = moving_[i].v = end.stance.v;
    if (const int k = turning(state, i); k >= 0) {
      state.turn[k] = turn_free_[k] = end.turn, state.spin[k] = w_free_[k] = moving_[i].w = end.stance.w;
    }
  }
  give_back_ends(state);
  energy_guard_.open(state);
}

// What is struck flies without contacts, also on joints: what these give is taken out of where the free
// motion ends.
void SpaceIterative::lay_down_ends(const State<D>& state, double h) {
  borne_ends_.clear();
  for (const int i : joints_.bodies()) {
    if (!gives(i)) continue;
    const int k = turning(state, i);
    Vec<D>&x = x_free_[std::size_t(i)], &v = v_free_[std::size_t(i)];
    Orientation<D>* const turn = k < 0 ? nullptr : &turn_free_[std::size_t(k)];
    AngularVec<D>* const spin = k < 0 ? nullptr : &w_free_[std::size_t(k)];
    Flown& end = borne_ends_.emplace_back();
    end.stance.x = x, end.stance.v = v;
    if (turn) end.turn = *turn, end.stance.w = *spin;
    take_out(i, h, x, v, turn, spin);
  }
}

// the same back, to those that nothing has struck
void SpaceIterative::give_back_ends(const State<D>& state) {
  auto end = borne_ends_.begin();
  for (const int i : joints_.bodies()) {
    if (!gives(i)) continue;
    const Flown& its = *end++;
    if (when_[i] >= 0) continue;
    x_free_[std::size_t(i)] = its.stance.x, v_free_[std::size_t(i)] = its.stance.v;
    if (const int k = turning(state, i); k >= 0)
      turn_free_[std::size_t(k)] = its.turn, w_free_[std::size_t(k)] = its.stance.w;
  }
}

// where bodies begin, and how fast they may become
void SpaceIterative::begin_flights(const State<D>& state, double h) {
  const int n = int(model_.bodies.size());
  flown_.resize(n + 1), courses_.resize(n + 1), fastest_.resize(n + 1), twist_.resize(n + 1);
  const auto begin = [&](int i) {
    flown_[i] = {}, courses_[i].forget(), fastest_[i] = {}, twist_[i].setZero();
    if (i == n) return;
    flown_[i].stance = stances_[i];
    if (const int k = turning(state, i); k >= 0) flown_[i].turn = turn_[k];
    if (inactive_[i] && drives_.number(i) < 0) return;
    fastest_[i].gain = std::sqrt((v_free_[i] - stances_[i].v).squaredNorm());
    const int k = turning(state, i);
    if (k >= 0 && drives_.number(i) >= 0) {
      fastest_[i].turns = std::sqrt((w_free_[k] - stances_[i].w).squaredNorm());
    } else if (k >= 0 && model_.bodies[i].turns()) {
      const AngularVec<D>& inertia = model_.bodies[i].inertia;
      const Rotation<D>&from = stances_[i].room_from_body, to = rotation<D>(turn_free_[k]);
      const AngularVec<D> ends = carried_spin<D>(inertia, to, from, w_free_[k]);
      twist_[i] = inertia_times<D>(inertia, from, AngularVec<D>(ends - stances_[i].w));
      fastest_[i].turns = std::sqrt((ends - stances_[i].w).squaredNorm());
    }
    limit_speed(i, h);
  };
  each(workers(), n + 1, kBodyPiece, [&](int first, int end) {
    for (int i = first; i < end; ++i) begin(i);
  });
  if (!joints_.stopped()) return;
  // what has been stopped on its way is elsewhere than flights lead
  bends_.assign(std::size_t(n), Vec<D>::Zero()), turn_bends_.assign(std::size_t(n), AngularVec<D>::Zero());
  for (const int i : joints_.bodies()) {
    if (inactive_[i]) continue;
    const Flown end = fly(i, h, h);
    bends_[i] = x_free_[i] - end.stance.x;
    if (const int k = turning(state, i); k >= 0)
      turn_bends_[i] = logarithm(product(turn_free_[k], inverse<D>(end.turn)));
  }
}

// those gaps that close fast before anything has been struck, each due then
void SpaceIterative::find_closing(const State<D>& state, double h) {
  const int count = int(touches_.size());
  reach_.resize(touches_.size()), may_close_.resize(touches_.size()), meets_at_.resize(touches_.size());
  nearest_.resize(touches_.size());
  each(workers(), count, kTouchPiece, [&](int first, int end) {
    auto known =
        std::lower_bound(state.contacts.begin(), state.contacts.end(), touches_[first].key,
                         [](const auto& contact, const ContactKey& key) { return contact.key < key; });
    for (int i = first; i < end; ++i) {
      ContactConstraint& touch = touches_[i];
      while (known != state.contacts.end() && known->key < touch.key) ++known;
      reach_[i] = {touch.gap, 0, approach_limit(i, h)}, may_close_[i] = 0;
      if (most_passing(touch) < touch.least_strike) continue;
      if (known != state.contacts.end() && known->key == touch.key && lasts(touch, known->force)) continue;
      touch.passes = stays_apart(i, kInTime * bounding_radius_[touch.a], h), may_close_[i] = !touch.passes;
    }
  });
  const auto pieces = std::size_t(count / kBodyPiece + 1);
  if (nearest_gaps_.size() < pieces) nearest_gaps_.resize(pieces);
  // where most are asked for
  ends_.assign(courses_.size(), 0);
  for (int i = 0; i < count; ++i)
    if (touches_[i].passes || may_close_[i]) ends_[touches_[i].a] = ends_[touches_[i].b] = 1;
  each(workers(), int(model_.bodies.size()), kBodyPiece, [&](int first, int end) {
    for (int i = first; i < end; ++i)
      if (ends_[i] && (!inactive_[i] || drives_.number(i) >= 0))
        courses_[i].end = fly(i, h, h), courses_[i].ends = true;
  });
  each(workers(), count, kBodyPiece, [&](int first, int end) {
    Flown own[2];
    std::vector<ContactCandidate<D>>& gaps = nearest_gaps_[std::size_t(first / kBodyPiece)];
    for (int i = first; i < end; ++i) {
      if (!may_close_[i]) continue;
      meets_at_[i] = meeting_time(i, h, own);
      touches_[i].passes = !(meets_at_[i] < kNeverCloses);
      if (!touches_[i].passes) nearest_[i] = meets_by_nearest(i, meets_at_[i], h, gaps, own);
    }
  });
  for (int i = 0; i < count; ++i)
    if (may_close_[i] && !touches_[i].passes) due_.push(meets_at_[i], i, 0);
}

// features of the step's start, where impacts have looked at others
void SpaceIterative::restore_features() {
  for (const auto& [i, feature] : renewed_) features_[i] = feature;
}

}  // namespace obscura::sim

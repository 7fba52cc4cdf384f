// One step from v to v' of bodies with contacts:
//   1. where everyone stands; pairs anew, if it is time
//   2. free motion: dv, dx of the step without contacts, springs and hands by Runge-Kutta
//   3. rows of the touches: gap g, n, arms; least speed v_n' >= -g / h
//   4. blows: touches that close in this step faster than the resting speed, Newton's law
//   5. warm sweeps
//   6. positions: by the mean of old and new velocity; a body struck at tau by that up to tau and after it;
//      by the new one where a slow touch closed
//   7. forces into the state, and who is quiet

#include "sim/iterative.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>

namespace obscura::sim {

using sweep::Feature;
using sweep::Group;
using sweep::kLanes;
using sweep::Pair;
using sweep::Place;

namespace {

constexpr int kEvery = 10;         // steps between two looks for pairs
constexpr int kMostSweeps = 40;    // of few pairs
constexpr int kPairSweeps = 2000;  // pairs times sweeps where there are more; at least one sweep
constexpr double kCalm = 0.02;     // of its thickness: what a pair may move between two looks, features kept
constexpr double kProject = 0.2;   // of a penetration each time pairs are looked for
constexpr int kColours = 40;       // groups of more colours hold one pair each

}  // namespace

template <int D>
Iterative<D>::Iterative(const Model<D>& model, const std::vector<Path<D>>& paths)
    : model_(model), cores_(model), pairs_(model, cores_), tied_(model, paths) {
  const int n = int(model.bodies.size());
  const double h = 1 / value(model.rate);
  span_ = kEvery * h;
  rest_speed_ = 2 * h * std::sqrt(model.gravity.squaredNorm()) + 1e-9 * model.scale;
  poses_.resize(n), turns_.assign(n, 0);
  im_.resize(n + 1), ii_.resize(n + 1);
  v_.resize(n + 1), old_.resize(n + 1), dv_.resize(n + 1), dx_.resize(n + 1), push_.resize(n + 1);
  before_.resize(n + 1), after_.resize(n + 1);
  closing_.resize(n + 1), tau_.assign(n + 1, -1), colours_.resize(n + 1), around_start_.resize(n + 2);
  for (const Body<D>& body : model.bodies) drag_ = drag_ || body.drag != 0;
}

template <int D>
void Iterative<D>::step(State<D>& state, double t, double h) {
  const int n = int(model_.bodies.size());
  if (int(state.frozen.size()) != n) state.frozen.assign(n, 0);
  if (int(state.quiet.size()) != n) state.quiet.assign(n, 0);

  gather(state);
  const bool look = state.step % kEvery == 0;
  if (look) {
    pairs_.find(state, poses_, span_);
  } else {
    pairs_.adopt(state);
  }
  if (version_ != pairs_.version() || frozen_ != state.frozen) colour(state);
  fall(state, t, h);
  prepare(state, h);
  strike(state, h);
  solve(h);
  if (look) project();
  advance(state, h);
  keep(state, h);
  if (outran(state, h)) {
    gather(state);
    pairs_.find(state, poses_, span_);
  }
}

template <int D>
void Iterative<D>::gather(const State<D>& state) {
  const int n = int(poses_.size()), still = n - int(state.turn.size());
  for (int i = 0; i < n; ++i) {
    poses_[i].x = state.x[i][0], poses_[i].y = state.x[i][1];
    v_[i].x = state.v[i][0], v_[i].y = state.v[i][1];
    if (i < still) continue;
    v_[i].w = state.spin[i - still][0];
    const double turn = state.turn[i - still][0];
    if (turn == turns_[i]) continue;
    const SinCos sc = sin_cos(turn);
    poses_[i].c = sc.cos, poses_[i].s = sc.sin, turns_[i] = turn;
  }
}

// which pairs are awake, and rows for them: greedy colours, in the order of pairs
template <int D>
void Iterative<D>::colour(const State<D>& state) {
  const int n = int(poses_.size());
  version_ = pairs_.version(), frozen_ = state.frozen;
  for (int i = 0; i < n; ++i) {
    const Body<D>& body = model_.bodies[i];
    const bool moves = !body.fixed && !state.frozen[i];
    im_[i] = moves ? 1 / body.mass : 0;
    ii_[i] = moves && body.turns() ? 1 / body.inertia[0] : 0;
  }

  std::vector<Pair>& all = pairs_.all();
  std::fill(colours_.begin(), colours_.end(), 0);
  std::fill(around_start_.begin(), around_start_.end(), 0);
  count_.assign(kColours + 1, 0);
  awake_pairs_ = 0;
  for (Pair& pair : all) {
    const bool a = im_[pair.a] > 0, b = pair.b >= 0 && im_[pair.b] > 0;
    pair.slot = -1;
    if (!a && !b) continue;
    ++awake_pairs_;
    const std::uint64_t used = (a ? colours_[pair.a] : 0) | (b ? colours_[pair.b] : 0);
    const int which = std::min(std::countr_one(used), kColours);
    if (which < kColours) {
      if (a) colours_[pair.a] |= std::uint64_t(1) << which;
      if (b) colours_[pair.b] |= std::uint64_t(1) << which;
    }
    pair.slot = which;  // for now
    ++count_[which];
    if (a) ++around_start_[pair.a + 2];
    if (b) ++around_start_[pair.b + 2];
  }

  // a colour begins with a group of its own
  int begin = 0;
  for (int which = 0; which <= kColours; ++which) {
    const int lanes =
        which < kColours ? (count_[which] + kLanes - 1) / kLanes * kLanes : count_[which] * kLanes;
    count_[which] = begin, begin += lanes;
  }
  groups_.assign(begin / kLanes, Group{});
  projections_.resize(groups_.size());
  for (Group& g : groups_) {
    for (int lane = 0; lane < kLanes; ++lane) g.a[lane] = g.b[lane] = n;
  }
  for (int i = 2; i < n + 2; ++i) around_start_[i] += around_start_[i - 1];
  around_.resize(around_start_[n + 1]);
  approach_.assign(all.size(), {});
  for (int i = 0; i < int(all.size()); ++i) {
    Pair& pair = all[i];
    if (pair.slot < 0) continue;
    const int which = pair.slot;
    pair.slot = count_[which], count_[which] += which < kColours ? 1 : kLanes;
    Group& g = groups_[pair.slot / kLanes];
    const int lane = pair.slot % kLanes;
    const bool a = im_[pair.a] > 0, b = pair.b >= 0 && im_[pair.b] > 0;
    if (a) {
      g.a[lane] = pair.a, g.ima[lane] = im_[pair.a], g.iia[lane] = ii_[pair.a];
      around_[around_start_[pair.a + 1]++] = i;
    }
    if (b) {
      g.b[lane] = pair.b, g.imb[lane] = im_[pair.b], g.iib[lane] = ii_[pair.b];
      around_[around_start_[pair.b + 1]++] = i;
    }
    g.mu[lane] = pair.friction;
  }
}

// what everyone would do in the step if nothing touched
template <int D>
void Iterative<D>::fall(State<D>& state, double t, double h) {
  const int n = int(poses_.size()), still = n - int(state.turn.size());
  const double gx = model_.gravity[0], gy = model_.gravity[1];
  for (int i = 0; i < n; ++i) {
    old_[i] = v_[i];
    if (im_[i] == 0) {
      v_[i] = dv_[i] = dx_[i] = {};
      continue;
    }
    // Runge-Kutta's polynomials of z = -h c/m
    double p = 0, q = 1, r = 0.5;
    if (drag_) {
      const double z = -h * model_.bodies[i].drag * im_[i];
      p = z * (1 + z / 2 * (1 + z / 3 * (1 + z / 4)));
      q = 1 + z / 2 * (1 + z / 3 * (1 + z / 4)), r = 0.5 * (1 + z / 3 * (1 + z / 4));
    }
    dv_[i] = {v_[i].x * p + h * q * gx, v_[i].y * p + h * q * gy, 0, 0};
    dx_[i] = {h * (v_[i].x * q + h * r * gx), h * (v_[i].y * q + h * r * gy), h * v_[i].w, 0};
  }

  // springs and hands
  if (model_.springs.empty() && model_.mice.empty()) return;
  tied_.gather(state);
  const std::vector<int>& bodies = tied_.bodies();
  stages_.reserve(bodies.size() * (D + kSpins<D>));
  tied_.step(integrate(model_.integrator), state, t, h, stages_);
  for (const int i : bodies) {
    if (im_[i] > 0) {
      dv_[i].x = state.v[i][0] - old_[i].x, dv_[i].y = state.v[i][1] - old_[i].y;
      dx_[i].x = state.x[i][0] - poses_[i].x, dx_[i].y = state.x[i][1] - poses_[i].y;
      if (i >= still) {
        dv_[i].w = state.spin[i - still][0] - old_[i].w, dx_[i].w = state.turn[i - still][0] - turns_[i];
      }
    }
    state.x[i] = {poses_[i].x, poses_[i].y}, state.v[i] = {old_[i].x, old_[i].y};
    if (i >= still) state.turn[i - still][0] = turns_[i], state.spin[i - still][0] = old_[i].w;
  }
}

// whether features may change before pairs are looked for again; those of round things do at any time
template <int D>
bool Iterative<D>::lively(const Pair& pair) const {
  if (pair.b < 0) return pair.touches > 1;
  const sweep::Core &a = cores_.all[pair.core_a], &b = cores_.all[pair.core_b];
  if (pair.touches == 1) return a.count > 1 || b.count > 1;
  const double speed = std::fabs(v_[pair.a].x - v_[pair.b].x) + std::fabs(v_[pair.a].y - v_[pair.b].y) +
                       std::fabs(v_[pair.a].w) * a.reach + std::fabs(v_[pair.b].w) * b.reach;
  return speed * span_ > kCalm * std::min(a.inside, b.inside);
}

template <int D>
void Iterative<D>::prepare(State<D>& state, double h) {
  const std::vector<Pair>& all = pairs_.all();
  queue_.clear();
  for (int i = 0; i < int(all.size()); ++i) {
    const Pair& pair = all[i];
    if (pair.slot < 0) continue;
    if (lively(pair)) pairs_.renew(pair, state, poses_);
    Group& g = groups_[pair.slot / kLanes];
    const int lane = pair.slot % kLanes;
    Approach& approach = approach_[i];
    approach = {};
    const double ima = g.ima[lane], iia = g.iia[lane], imb = g.imb[lane], iib = g.iib[lane];
    const Motion &va = v_[g.a[lane]], &vb = v_[g.b[lane]], &dva = dv_[g.a[lane]], &dvb = dv_[g.b[lane]];
    bool there[2] = {false, false}, blow = false;
    for (int k = 0; k < 2; ++k) {
      Group::Side& side = g.side[k];
      const Feature feature =
          k < pair.touches ? Feature::of(state.contacts[pair.first + k].key.feature) : Feature{};
      if (feature.kind == Feature::none) {
        side.nx[lane] = side.ny[lane] = side.na[lane] = side.nb[lane] = side.ta[lane] = side.tb[lane] = 0;
        side.mt[lane] = side.ln[lane] = side.lt[lane] = 0, side.target[lane] = -1e300;
        continue;
      }
      there[k] = true;
      Contact<D>& contact = state.contacts[pair.first + k];
      const Place at = pairs_.place(pair, poses_, feature);
      contact.point = {at.x, at.y}, contact.normal = {at.nx, at.ny}, contact.gap = at.gap;

      // arms, and how hard it is to move
      const double ax = at.x - poses_[pair.a].x, ay = at.y - poses_[pair.a].y;
      double bx = 0, by = 0;
      if (pair.b >= 0) bx = at.x - poses_[pair.b].x, by = at.y - poses_[pair.b].y;
      const double na = ax * at.ny - ay * at.nx, nb = bx * at.ny - by * at.nx;
      const double ta = ax * at.nx + ay * at.ny, tb = bx * at.nx + by * at.ny;
      side.nx[lane] = at.nx, side.ny[lane] = at.ny, side.na[lane] = na, side.nb[lane] = nb;
      side.ta[lane] = ta, side.tb[lane] = tb;
      side.mt[lane] = 1 / (ima + imb + (iia * ta * ta + iib * tb * tb));
      side.target[lane] = at.gap > 0 ? -at.gap / h : 0;

      // the force of the last step
      side.ln[lane] = std::max(0.0, h * (contact.force[0] * at.nx + contact.force[1] * at.ny));
      const double most = pair.friction * side.ln[lane];
      side.lt[lane] = std::clamp(h * (contact.force[1] * at.nx - contact.force[0] * at.ny), -most, most);

      // whether it closes, and with a blow
      const double vn = at.nx * (va.x - vb.x) + at.ny * (va.y - vb.y) + (na * va.w - nb * vb.w);
      const double dvn = at.nx * (dva.x - dvb.x) + at.ny * (dva.y - dvb.y) + (na * dva.w - nb * dvb.w);
      approach.vn[k] = vn, approach.gap[k] = at.gap;
      blow = blow || (vn < -rest_speed_ && at.gap + h * (vn + 0.5 * dvn) < 0);
    }
    if (blow) queue_.push_back(i);

    const Group::Side &s = g.side[0], &u = g.side[1];
    const auto yields = [&](const Group::Side& p, const Group::Side& q) {
      return (p.nx[lane] * q.nx[lane] + p.ny[lane] * q.ny[lane]) * (ima + imb) +
             (iia * p.na[lane] * q.na[lane] + iib * p.nb[lane] * q.nb[lane]);
    };
    const double k11 = there[0] ? yields(s, s) : 0, k22 = there[1] ? yields(u, u) : 0;
    const double k12 = there[0] && there[1] ? yields(s, u) : 0, det = k11 * k22 - k12 * k12;
    g.k11[lane] = k11, g.k22[lane] = k22, g.k12[lane] = k12;
    g.r11[lane] = k11 > 0 ? 1 / k11 : 0, g.r22[lane] = k22 > 0 ? 1 / k22 : 0;
    if (det > 1e-8 * k11 * k22) {
      const double inverse = 1 / det;
      g.i11[lane] = k22 * inverse, g.i22[lane] = k11 * inverse, g.i12[lane] = -k12 * inverse;
    } else {
      g.i11[lane] = g.i22[lane] = g.i12[lane] = std::numeric_limits<double>::quiet_NaN();
    }
  }
}

// a body meets its first blow of the step
template <int D>
void Iterative<D>::struck(int body, double after, double h) {
  if (im_[body] == 0 || tau_[body] >= 0) return;
  tau_[body] = after;
  hit_.push_back(body);
  const double part = after / h;
  v_[body].x += part * dv_[body].x, v_[body].y += part * dv_[body].y, v_[body].w += part * dv_[body].w;
  before_[body] = v_[body];
}

// one pair, both touches together; false where it does not approach
template <int D>
bool Iterative<D>::hit(int i, double h) {
  const Pair& pair = pairs_.all()[i];
  Approach& approach = approach_[i];
  Group& g = groups_[pair.slot / kLanes];
  const int lane = pair.slot % kLanes, a = g.a[lane], b = g.b[lane];
  const auto along = [&](const Group::Side& s, const std::vector<Motion>& v) {
    return s.nx[lane] * (v[a].x - v[b].x) + s.ny[lane] * (v[a].y - v[b].y) +
           (s.na[lane] * v[a].w - s.nb[lane] * v[b].w);
  };
  const auto push = [&](double dx, double dy, double ra, double rb, double l) {
    v_[a].x += dx * (g.ima[lane] * l), v_[a].y += dy * (g.ima[lane] * l), v_[a].w += g.iia[lane] * (ra * l);
    v_[b].x -= dx * (g.imb[lane] * l), v_[b].y -= dy * (g.imb[lane] * l), v_[b].w -= g.iib[lane] * (rb * l);
  };

  // which touches close, and when
  double e[2] = {1e300, 1e300};
  bool closes[2] = {false, false}, fast[2] = {false, false};
  double when = h;
  for (int k = 0; k < 2; ++k) {
    const Group::Side& s = g.side[k];
    if (s.mt[lane] == 0) continue;
    const double vn = along(s, v_);
    closes[k] = approach.gap[k] + h * vn < 0 || approach.struck[k];
    fast[k] = closes[k] && vn < -rest_speed_;
    if (!fast[k]) continue;
    const double gap = std::max(0.0, approach.gap[k]), dvn = along(s, dv_);
    when = std::min(when, gap / -std::min(vn, vn - 0.5 * dvn * gap / (h * vn)));
  }
  if (!fast[0] && !fast[1]) return false;
  struck(a, when, h), struck(b, when, h);
  for (int k = 0; k < 2; ++k) {
    if (closes[k]) e[k] = (fast[k] ? 1 + pair.elasticity : 1) * along(g.side[k], v_);
  }

  // impulses l >= 0 with e + K l >= 0
  double l[2] = {0, 0};
  const double k12 = g.k12[lane];
  const double both0 = -(g.i11[lane] * e[0] + g.i12[lane] * e[1]);
  const double both1 = -(g.i12[lane] * e[0] + g.i22[lane] * e[1]);
  if (closes[0] && closes[1] && both0 >= 0 && both1 >= 0) {
    l[0] = both0, l[1] = both1;
  } else {
    const double only0 = std::max(0.0, -g.r11[lane] * e[0]), only1 = std::max(0.0, -g.r22[lane] * e[1]);
    (e[1] + k12 * only0 >= e[0] + k12 * only1 ? l[0] : l[1]) =
        e[1] + k12 * only0 >= e[0] + k12 * only1 ? only0 : only1;
  }
  for (int k = 0; k < 2; ++k) {
    if (!closes[k]) continue;
    const Group::Side& s = g.side[k];
    approach.struck[k] = true;
    approach.n[k] += l[k];
    push(s.nx[lane], s.ny[lane], s.na[lane], s.nb[lane], l[k]);
  }

  // friction
  for (int k = 0; k < 2; ++k) {
    if (!closes[k]) continue;
    const Group::Side& s = g.side[k];
    const double tx = -s.ny[lane], ty = s.nx[lane];
    const double vt =
        tx * (v_[a].x - v_[b].x) + ty * (v_[a].y - v_[b].y) + (s.ta[lane] * v_[a].w - s.tb[lane] * v_[b].w);
    const double most = pair.friction * approach.n[k];
    const double next = std::clamp(approach.t[k] - s.mt[lane] * vt, -most, most);
    push(tx, ty, s.ta[lane], s.tb[lane], next - approach.t[k]);
    approach.t[k] = next;
  }
  return true;
}

// blows go on from pair to pair until none approaches, in the order in which they come up
template <int D>
void Iterative<D>::strike(State<D>& state, double h) {
  (void)state;
  hit_.clear();
  const std::size_t most = 40 * queue_.size() + 100;
  for (const int i : queue_) approach_[i].waiting = 1;
  for (std::size_t at = 0; at < queue_.size() && at < most; ++at) {
    const int i = queue_[at];
    approach_[i].waiting = 0;
    if (!hit(i, h)) continue;
    const Pair& pair = pairs_.all()[i];
    for (const int body : {pair.a, pair.b}) {
      if (body < 0 || im_[body] == 0) continue;
      for (int k = around_start_[body]; k < around_start_[body + 1]; ++k) {
        const int next = around_[k];
        if (approach_[next].waiting) continue;
        approach_[next].waiting = 1;
        queue_.push_back(next);
      }
    }
  }
  // back to when the step began, as if the blow had been then
  for (const int body : hit_) {
    after_[body] = v_[body];
    const double part = tau_[body] / h;
    v_[body].x -= part * dv_[body].x, v_[body].y -= part * dv_[body].y, v_[body].w -= part * dv_[body].w;
  }
  for (const int i : queue_) {
    const Pair& pair = pairs_.all()[i];
    for (int k = 0; k < 2; ++k) {
      if (approach_[i].struck[k]) groups_[pair.slot / kLanes].side[k].target[pair.slot % kLanes] = 0;
    }
  }
}

template <int D>
void Iterative<D>::solve(double h) {
  (void)h;
  const int n = int(poses_.size());
  for (int i = 0; i < n; ++i) v_[i].x += dv_[i].x, v_[i].y += dv_[i].y, v_[i].w += dv_[i].w;
  const int count = int(groups_.size());
  sweep::start(groups_.data(), count, v_.data());
  const int sweeps = std::clamp(kPairSweeps / std::max(1, awake_pairs_), 1, kMostSweeps);
  for (int i = 0; i < sweeps; ++i) sweep::sweep(groups_.data(), count, v_.data());
}

// positions out of each other, a part of the way
template <int D>
void Iterative<D>::project() {
  const std::vector<Pair>& all = pairs_.all();
  bool deep = false;
  for (sweep::Projection& p : projections_) p = {};
  for (int i = 0; i < int(all.size()); ++i) {
    const int slot = all[i].slot;
    if (slot < 0) continue;
    for (int k = 0; k < 2; ++k) {
      const double gap = approach_[i].gap[k];
      const bool there = groups_[slot / kLanes].side[k].mt[slot % kLanes] > 0;
      projections_[slot / kLanes].target[k][slot % kLanes] = !there    ? -1e300
                                                             : gap < 0 ? -kProject * gap
                                                                       : -gap;
      deep = deep || gap < 0;
    }
  }
  std::fill(push_.begin(), push_.end(), Motion{});
  if (!deep) return;
  const int sweeps = std::clamp(kPairSweeps / std::max(1, awake_pairs_), 2, kMostSweeps);
  for (int i = 0; i < sweeps; ++i)
    sweep::project(groups_.data(), projections_.data(), int(groups_.size()), push_.data());
}

template <int D>
void Iterative<D>::advance(State<D>& state, double h) {
  const int n = int(poses_.size()), still = n - int(state.turn.size());
  const bool look = state.step % kEvery == 0;

  // whose slow touches closed
  const std::vector<Pair>& all = pairs_.all();
  std::fill(closing_.begin(), closing_.end(), 0);
  for (int i = 0; i < int(all.size()); ++i) {
    const int slot = all[i].slot;
    if (slot < 0) continue;
    const Group& g = groups_[slot / kLanes];
    for (int k = 0; k < 2; ++k) {
      if (approach_[i].vn[k] < -0.05 * rest_speed_ && g.side[k].ln[slot % kLanes] > 0) {
        closing_[g.a[slot % kLanes]] = closing_[g.b[slot % kLanes]] = 1;
      }
    }
  }

  const double quiet_speed = 0.02;
  for (int i = 0; i < n; ++i) {
    if (im_[i] == 0) continue;
    Motion d;
    const Motion &v = v_[i], &o = old_[i], &dv = dv_[i], &dx = dx_[i];
    if (tau_[i] >= 0) {
      const double one = 0.5 * tau_[i], two = 0.5 * (h - tau_[i]);
      const Motion &b = before_[i], &a = after_[i];
      d = {one * (o.x + b.x) + two * (a.x + v.x), one * (o.y + b.y) + two * (a.y + v.y),
           one * (o.w + b.w) + two * (a.w + v.w), 0};
    } else if (closing_[i]) {
      d = {h * v.x, h * v.y, h * v.w, 0};
    } else {
      const double half = 0.5 * h;
      d = {dx.x + half * (v.x - (o.x + dv.x)), dx.y + half * (v.y - (o.y + dv.y)),
           dx.w + half * (v.w - (o.w + dv.w)), 0};
    }
    if (look) d.x += push_[i].x, d.y += push_[i].y, d.w += push_[i].w;
    state.x[i][0] += d.x, state.x[i][1] += d.y;
    state.v[i][0] = v.x, state.v[i][1] = v.y;
    const double reach = cores_.reach[i];
    if (i >= still) state.turn[i - still][0] += d.w, state.spin[i - still][0] = v.w;
    const bool quiet = v.x * v.x + v.y * v.y + v.w * v.w * (reach * reach) < quiet_speed * quiet_speed;
    state.quiet[i] = quiet ? state.quiet[i] + h : 0;
  }
}

template <int D>
void Iterative<D>::keep(State<D>& state, double h) {
  const std::vector<Pair>& all = pairs_.all();
  for (int i = 0; i < int(all.size()); ++i) {
    const Pair& pair = all[i];
    if (pair.slot < 0) continue;
    const Group& g = groups_[pair.slot / kLanes];
    const int lane = pair.slot % kLanes;
    for (int k = 0; k < pair.touches; ++k) {
      Contact<D>& contact = state.contacts[pair.first + k];
      const Group::Side& s = g.side[k];
      const double fn = s.ln[lane] / h, ft = s.lt[lane] / h, nx = s.nx[lane], ny = s.ny[lane];
      contact.force = {fn * nx - ft * ny, fn * ny + ft * nx};
      const Approach& p = approach_[i];
      contact.impulse = {p.n[k] * nx - p.t[k] * ny, p.n[k] * ny + p.t[k] * nx};
      contact.touching = fn == 0 && p.n[k] == 0               ? Touching::open
                         : std::fabs(ft) < pair.friction * fn ? Touching::stick
                                                              : Touching::slide;
    }
  }
  for (const int body : hit_) tau_[body] = -1;
}

// whether a body may come farther than its pairs foresaw
template <int D>
bool Iterative<D>::outran(const State<D>& state, double h) const {
  const int n = int(poses_.size());
  const double falls = 3 * h * span_ * std::sqrt(model_.gravity.squaredNorm());
  (void)state;
  for (int i = 0; i < n; ++i) {
    if (im_[i] == 0) continue;
    const Motion &v = v_[i], &o = old_[i];
    const double reach = cores_.reach[i];
    const double gain = std::fabs(v.x - o.x) + std::fabs(v.y - o.y) + std::fabs(v.w - o.w) * reach;
    if (gain * span_ < 0.01 * cores_.inside[i] + falls) continue;
    const auto speed = [&](const Motion& m) {
      return std::sqrt(m.x * m.x + m.y * m.y) + std::fabs(m.w) * reach;
    };
    if ((speed(v) - speed(o)) * span_ > 0.01 * cores_.inside[i] + falls) return true;
  }
  return false;
}

template class Iterative<2>;

}  // namespace obscura::sim

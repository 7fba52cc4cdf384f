// One step from v to v' of bodies with contacts:
//   1. where everyone stands; pairs anew, if it is time, and features of pairs that move
//   2. free motion: dv, dx of the step without contacts, springs and hands by Runge-Kutta
//   3. forces of the last step
//   4. blows: touches that close in this step faster than the resting speed
//   5. warm sweeps: v_n' >= -g / h
//   6. positions: by the mean of old and new velocity; a body struck at tau by that up to tau and after it;
//      by the new one where a slow touch closed

#include "sim/iterative.h"

#include <algorithm>
#include <bit>
#include <cmath>

namespace obscura::sim {

using sweep::Feature;
using sweep::kLanes;
using sweep::Pair;
using sweep::Seats;

namespace {

constexpr double kLooks = 60;      // a second: how often pairs are looked for
constexpr int kMostSweeps = 40;    // of few pairs
constexpr int kPairSweeps = 2000;  // pairs times sweeps where there are more; at least one sweep
constexpr int kFirstSweeps = 100;  // of the first step, which knows no forces
constexpr double kCalm = 0.02;     // of its thickness: what a pair may move between two looks, features kept
constexpr double kSoft = 0.05;  // of its thickness between two looks: slower inelastic closings are no blows
constexpr double kSight = 0.5;  // of its thickness: what may pass within a step is swept instead
constexpr double kProject = 0.2;  // of a penetration each time pairs are looked for
constexpr int kColours = 40;      // seats of more colours hold one pair each
constexpr double kNowhere = 1e9;  // m: the gap of a touch that is none

}  // namespace

template <int D>
Iterative<D>::Iterative(const Model<D>& model, const std::vector<Path<D>>& paths)
    : model_(model),
      cores_(model),
      pairs_(model, cores_),
      blows_(int(model.bodies.size())),
      rest_(model, cores_),
      tied_(model, paths) {
  const int n = int(model.bodies.size());
  const double h = 1 / value(model.rate);
  every_ = std::max<std::int64_t>(1, std::llround(value(model.rate) / kLooks));
  span_ = double(every_) * h;
  rest_speed_ = 2 * h * std::sqrt(model.gravity.squaredNorm()) + 1e-9 * model.scale;
  poses_.resize(n + 1), turns_.assign(n, 0), ii_.resize(n + 1);
  v_.resize(n + 1), old_.resize(n + 1), dv_.resize(n + 1), dx_.resize(n + 1), push_.resize(n + 1);
  closing_.resize(n + 1), colours_.resize(n + 1), movers_.assign(n, 0);
  for (const Body<D>& body : model.bodies) {
    drag_ = drag_ || body.drag != 0;
    fixed_.push_back(body.fixed);
  }
}

template <int D>
void Iterative<D>::step(State<D>& state, double t, double h) {
  const int n = int(model_.bodies.size());
  if (int(state.frozen.size()) != n) state.frozen.assign(n, 0);
  if (int(state.quiet.size()) != n) state.quiet.assign(n, 0);

  const bool due = state.step % every_ == 0;

  // whom springs and hands hold
  if (tied_.ever()) {
    tied_.gather(state);
    for (int i = 0; i < n; ++i) movers_[i] = tied_.has(i);
  }
  bool held = false, asleep = true;
  for (int i = 0; i < n; ++i) {
    held = held || (movers_[i] && state.frozen[i]);
    asleep = asleep && (state.frozen[i] | fixed_[i]);
  }
  if (asleep && !held) {
    next_step_ = -1;
    return;
  }
  const bool known = gather(state);
  if (!known) pairs_.adopt(state);
  if (due || held) {
    look(state);
  } else if (!known) {
    seat(state);
  }
  sweep::find_lively(seats_.data(), int(seats_.size()), v_.data(), lively_);
  for (const int i : lively_) {
    const Pair& pair = pairs_.all()[seats_[i / kLanes].pair[i % kLanes]];
    if (pairs_.renew(pair, state, poses_)) sit(pair, state);
  }

  fall(state, t, h);
  const sweep::Pace pace{h, 0.05 * rest_speed_, h * std::sqrt(model_.gravity.squaredNorm())};
  const int count = int(seats_.size());
  sweep::start(seats_.data(), count, poses_.data(), old_.data(), v_.data(), pace, slow_, fast_);
  blows_.run(fast_, pairs_.all(), seats_, poses_, old_, dv_, v_, pace);
  int sweeps = std::clamp(kPairSweeps / std::max(1, awake_pairs_), 1, kMostSweeps);
  if (state.step == 0) sweeps = kFirstSweeps;
  for (int i = 1; i < sweeps; ++i) sweep::sweep(seats_.data(), count, poses_.data(), v_.data(), pace);
  sweep::finish(seats_.data(), count, poses_.data(), v_.data(), pace, state.contacts.data());
  blows_.keep(pairs_.all(), state.contacts);
  if (due) project();
  advance(state, h, due);
  if (outran(h)) look(state);
  if (due && rest_.freeze(state, pairs_.all(), seats_, poses_, v_, movers_, h)) {
    for (int i = 0; i < n; ++i) {
      if (state.frozen[i]) v_[i] = {};
    }
    seat(state);
  }
  next_step_ = state.step + 1;
}

// pairs anew, who wakes by them, and seats for all
template <int D>
void Iterative<D>::look(State<D>& state) {
  pairs_.find(state, poses_, span_);
  if (rest_.wake(state, pairs_.all(), v_, movers_, span_)) pairs_.find(state, poses_, span_);
  seat(state);
  const bool fresh =
      state.step == 0 && std::all_of(state.contacts.begin(), state.contacts.end(),
                                     [](const Contact<D>& c) { return c.force == Vec<D>::Zero(); });
  if (fresh) {
    guess(state);
    seat(state);
  }
}

// false where the state is not the one that the last step left
template <int D>
bool Iterative<D>::gather(const State<D>& state) {
  const int n = int(turns_.size()), still = n - int(state.turn.size());
  std::size_t contacts = 0;
  if (!pairs_.all().empty()) contacts = pairs_.all().back().first + pairs_.all().back().touches;
  bool known = state.step == next_step_ && state.contacts.size() == contacts && state.frozen == frozen_;
  for (int i = 0; i < n; ++i) {
    const double x = state.x[i][0], y = state.x[i][1], vx = state.v[i][0], vy = state.v[i][1];
    const bool same = (poses_[i].x == x) & (poses_[i].y == y) & (v_[i].x == vx) & (v_[i].y == vy);
    known = known && same;
    poses_[i].x = x, poses_[i].y = y, v_[i].x = vx, v_[i].y = vy;
  }
  for (int i = still; i < n; ++i) {
    const double turn = state.turn[i - still][0], w = state.spin[i - still][0];
    known = known && v_[i].w == w;
    v_[i].w = w;
    if (turn == turns_[i]) continue;
    known = false;
    const SinCos sc = sin_cos(turn);
    poses_[i].c = sc.cos, poses_[i].s = sc.sin, turns_[i] = turn;
  }
  return known;
}

// seats for the pairs that are awake: greedy colours, in the order of pairs
template <int D>
void Iterative<D>::seat(const State<D>& state) {
  std::vector<Pair>& all = pairs_.all();
  if (version_ == pairs_.version() && frozen_ == state.frozen) {
    for (const Pair& pair : all) {
      if (pair.slot >= 0) sit(pair, state);
    }
    return;
  }
  const int n = int(turns_.size());
  version_ = pairs_.version(), frozen_ = state.frozen;
  for (int i = 0; i < n; ++i) {
    const Body<D>& body = model_.bodies[i];
    const bool moves = !body.fixed && !state.frozen[i];
    v_[i].im = moves ? 1 / body.mass : 0;
    ii_[i] = moves && body.turns() ? 1 / body.inertia[0] : 0;
  }

  std::fill(colours_.begin(), colours_.end(), 0);
  count_.assign(kColours + 1, 0);
  awake_pairs_ = 0;
  for (Pair& pair : all) {
    const bool a = v_[pair.a].im > 0, b = pair.b >= 0 && v_[pair.b].im > 0;
    pair.slot = -1;
    if (!a && !b) continue;
    ++awake_pairs_;
    const std::uint64_t used = (a ? colours_[pair.a] : 0) | (b ? colours_[pair.b] : 0);
    const int which = std::min(std::countr_one(used), kColours);
    if (which < kColours) {
      if (a) colours_[pair.a] |= std::uint64_t(1) << which;
      if (b) colours_[pair.b] |= std::uint64_t(1) << which;
    }
    pair.slot = pair.colour = which;  // for now
    pair.alone = which == kColours;
    ++count_[which];
  }

  // a colour begins with seats of its own
  int begin = 0;
  for (int which = 0; which <= kColours; ++which) {
    const int taken =
        which < kColours ? (count_[which] + kLanes - 1) / kLanes * kLanes : count_[which] * kLanes;
    count_[which] = begin, begin += taken;
  }
  Seats empty{};
  for (int lane = 0; lane < kLanes; ++lane) {
    empty.a[lane] = empty.b[lane] = n, empty.pair[lane] = empty.first[lane] = -1;
    empty.d[0][lane] = empty.d[1][lane] = -kNowhere;
  }
  seats_.assign(begin / kLanes, empty);
  projections_.resize(seats_.size());
  for (int i = 0; i < int(all.size()); ++i) {
    Pair& pair = all[i];
    if (pair.slot < 0) continue;
    const int which = pair.slot;
    pair.slot = count_[which], count_[which] += which < kColours ? 1 : kLanes;
    Seats& g = seats_[pair.slot / kLanes];
    const int lane = pair.slot % kLanes;
    const sweep::Core& a = cores_.all[pair.core_a];
    double sight = 1e300, far = a.reach, thin = a.inside, radius = a.radius;
    bool round = a.count == 1;
    if (pair.b >= 0) {
      const sweep::Core& b = cores_.all[pair.core_b];
      far = std::max(far, b.reach), thin = std::min(thin, b.inside), radius += b.radius;
      sight = kSight * std::max(thin, 0.5 * radius);
      // features of round things may change at any time, if there are more than one
      round = (a.count == 1) != (b.count == 1);
    } else {
      round = false;
    }
    g.a[lane] = pair.a, g.iia[lane] = ii_[pair.a];
    g.b[lane] = pair.b >= 0 ? pair.b : n, g.iib[lane] = pair.b >= 0 ? ii_[pair.b] : 0;
    g.pair[lane] = i, g.first[lane] = pair.first, g.touches[lane] = static_cast<unsigned char>(pair.touches);
    g.blow[lane] = -(pair.elasticity > 0 ? rest_speed_ : std::max(rest_speed_, kSoft * thin / span_));
    g.sight[lane] = sight, g.mu[lane] = pair.friction, g.radius[lane] = radius;
    g.far[lane] = far, g.calm[lane] = round ? -1 : pair.touches == 1 ? 1e300 : kCalm * thin / span_;
    sit(pair, state);
  }
  blows_.join(all, v_);
}

// features and forces of a pair
template <int D>
void Iterative<D>::sit(const Pair& pair, const State<D>& state) {
  Seats& g = seats_[pair.slot / kLanes];
  const int lane = pair.slot % kLanes, bit = 1 << lane;
  g.first[lane] = pair.first;
  for (int k = 0; k < 2; ++k) {
    g.of_b[k] = static_cast<unsigned char>(g.of_b[k] & ~bit);
    g.corners[k] = static_cast<unsigned char>(g.corners[k] & ~bit);
    g.cx[k][lane] = g.cy[k][lane] = g.fx[k][lane] = g.fy[k][lane] = g.p[k][lane] = g.q[k][lane] = 0;
    g.d[k][lane] = -kNowhere;
    if (k >= pair.touches) continue;
    const Contact<D>& contact = state.contacts[pair.first + k];
    const Feature f = Feature::of(contact.key.feature);
    if (f.kind == Feature::none) continue;
    g.p[k][lane] = contact.force[0], g.q[k][lane] = contact.force[1];
    const sweep::Core& a = cores_.all[pair.core_a];
    if (pair.b < 0) {
      const Wall<D>& wall = model_.walls[-1 - pair.b];
      g.cx[k][lane] = cores_.x[a.first + f.corner], g.cy[k][lane] = cores_.y[a.first + f.corner];
      g.fx[k][lane] = wall.normal[0], g.fy[k][lane] = wall.normal[1];
      g.d[k][lane] = wall.normal.dot(wall.point);
      continue;
    }
    const sweep::Core& b = cores_.all[pair.core_b];
    if (f.kind == Feature::corners) {
      g.corners[k] = static_cast<unsigned char>(g.corners[k] | bit);
      g.cx[k][lane] = cores_.x[a.first + f.corner], g.cy[k][lane] = cores_.y[a.first + f.corner];
      g.fx[k][lane] = cores_.x[b.first + f.face], g.fy[k][lane] = cores_.y[b.first + f.face];
      g.d[k][lane] = b.radius;
      continue;
    }
    const bool of_a = f.kind == Feature::corner_of_a;
    const int corner = (of_a ? a : b).first + f.corner, face = (of_a ? b : a).first + f.face;
    if (!of_a) g.of_b[k] = static_cast<unsigned char>(g.of_b[k] | bit);
    g.cx[k][lane] = cores_.x[corner], g.cy[k][lane] = cores_.y[corner];
    g.fx[k][lane] = cores_.nx[face], g.fy[k][lane] = cores_.ny[face], g.d[k][lane] = cores_.d[face];
  }
}

// forces that a pile may begin with: from the top down, each body hands its weight and its load to what lies
// below it, in equal parts
template <int D>
void Iterative<D>::guess(State<D>& state) {
  const double g = std::sqrt(model_.gravity.squaredNorm());
  if (g == 0) return;
  const int n = int(turns_.size());
  const Vec<D> down = model_.gravity / g;
  std::vector<std::pair<double, int>> order;
  std::vector<std::vector<int>> below(n);
  for (int i = 0; i < n; ++i) order.emplace_back(down.dot(state.x[i]), i);
  std::sort(order.begin(), order.end());
  const auto lower = [&](const Pair& pair) {  // who bears whom: -1 where neither does
    if (pair.b < 0) return pair.a;
    return down.dot(state.x[pair.a]) > down.dot(state.x[pair.b]) ? pair.b : pair.a;
  };
  for (int i = 0; i < int(pairs_.all().size()); ++i) {
    if (pairs_.all()[i].slot >= 0) below[lower(pairs_.all()[i])].push_back(i);
  }
  std::vector<double> load(n, 0);
  std::vector<Contact<D>*> bears;
  for (const auto& [height, body] : order) {
    if (v_[body].im == 0) continue;
    bears.clear();
    for (const int i : below[body]) {
      const Pair& pair = pairs_.all()[i];
      for (int k = 0; k < pair.touches; ++k) {
        Contact<D>& contact = state.contacts[pair.first + k];
        const Feature f = Feature::of(contact.key.feature);
        if (f.kind == Feature::none) continue;
        const sweep::Place at = pairs_.place(pair, poses_, f);
        const double side = pair.a == body ? 1 : -1;
        contact.normal = {at.nx, at.ny};
        if (at.gap < 1e-3 * cores_.inside[body] && -side * down.dot(contact.normal) > 0.5)
          bears.push_back(&contact);
      }
    }
    const double weight = g / v_[body].im + load[body];
    for (Contact<D>* contact : bears) {
      const double side = contact->key.a == body ? 1 : -1;
      const double part = weight / double(bears.size()) / (-side * down.dot(contact->normal));
      contact->force = part * contact->normal;
      const int other = contact->key.a == body ? contact->key.b : contact->key.a;
      if (other >= 0) load[other] += weight / double(bears.size());
    }
  }
}

// what everyone would do in the step if nothing touched
template <int D>
void Iterative<D>::fall(State<D>& state, double t, double h) {
  const int n = int(turns_.size()), still = n - int(state.turn.size());
  const double gx = model_.gravity[0], gy = model_.gravity[1];
  for (int i = 0; i < n; ++i) {
    old_[i] = v_[i];
    if (v_[i].im == 0) {
      old_[i] = v_[i] = dv_[i] = dx_[i] = {};
      continue;
    }
    // Runge-Kutta's polynomials of z = -h c/m
    double p = 0, q = 1, r = 0.5;
    if (drag_) {
      const double z = -h * model_.bodies[i].drag * v_[i].im;
      p = z * (1 + z / 2 * (1 + z / 3 * (1 + z / 4)));
      q = 1 + z / 2 * (1 + z / 3 * (1 + z / 4)), r = 0.5 * (1 + z / 3 * (1 + z / 4));
    }
    dv_[i] = {v_[i].x * p + h * q * gx, v_[i].y * p + h * q * gy, 0, 0};
    dx_[i] = {h * (v_[i].x * q + h * r * gx), h * (v_[i].y * q + h * r * gy), h * v_[i].w, 0};
    v_[i].x += dv_[i].x, v_[i].y += dv_[i].y;
  }

  // springs and hands
  if (!tied_.ever()) return;
  const std::vector<int>& bodies = tied_.bodies();
  stages_.reserve(bodies.size() * (D + kSpins<D>));
  tied_.step(integrate(model_.integrator), state, t, h, stages_);
  for (const int i : bodies) {
    if (v_[i].im > 0) {
      v_[i].x = state.v[i][0], v_[i].y = state.v[i][1];
      dv_[i].x = v_[i].x - old_[i].x, dv_[i].y = v_[i].y - old_[i].y;
      dx_[i].x = state.x[i][0] - poses_[i].x, dx_[i].y = state.x[i][1] - poses_[i].y;
      if (i >= still) {
        v_[i].w = state.spin[i - still][0];
        dv_[i].w = v_[i].w - old_[i].w, dx_[i].w = state.turn[i - still][0] - turns_[i];
      }
    }
    state.x[i] = {poses_[i].x, poses_[i].y}, state.v[i] = {old_[i].x, old_[i].y};
    if (i >= still) state.turn[i - still][0] = turns_[i], state.spin[i - still][0] = old_[i].w;
  }
}

// positions out of each other, a part of the way
template <int D>
void Iterative<D>::project() {
  std::fill(projections_.begin(), projections_.end(), sweep::Projection{});
  for (std::size_t i = 0; i < v_.size(); ++i) push_[i] = {0, 0, 0, v_[i].im};
  const int sweeps = std::clamp(kPairSweeps / std::max(1, awake_pairs_), 2, kMostSweeps);
  for (int i = 0; i < sweeps; ++i)
    sweep::project(seats_.data(), projections_.data(), int(seats_.size()), poses_.data(), push_.data(),
                   kProject);
}

template <int D>
void Iterative<D>::advance(State<D>& state, double h, bool look) {
  const int n = int(turns_.size()), still = n - int(state.turn.size());

  // whose slow touches closed
  std::fill(closing_.begin(), closing_.end(), 0);
  for (const int i : slow_)
    closing_[seats_[i / kLanes].a[i % kLanes]] = closing_[seats_[i / kLanes].b[i % kLanes]] = 1;

  const double quiet_speed = 0.02;
  for (int i = 0; i < n; ++i) {
    if (v_[i].im == 0) continue;
    Motion d = course(i, h);
    const Motion& v = v_[i];
    if (look) d.x += push_[i].x, d.y += push_[i].y, d.w += push_[i].w;
    state.x[i][0] = poses_[i].x += d.x, state.x[i][1] = poses_[i].y += d.y;
    state.v[i][0] = v.x, state.v[i][1] = v.y;
    if (i >= still) {
      state.spin[i - still][0] = v.w;
      state.turn[i - still][0] = turns_[i] += d.w;
      const SinCos sc = sin_cos(turns_[i]);
      poses_[i].c = sc.cos, poses_[i].s = sc.sin;
    }
    const double reach = cores_.reach[i];
    const bool quiet = v.x * v.x + v.y * v.y + v.w * v.w * (reach * reach) < quiet_speed * quiet_speed;
    state.quiet[i] = quiet ? state.quiet[i] + h : 0;
  }
}

// the way of a body in the step
template <int D>
sweep::Motion Iterative<D>::course(int i, double h) {
  const Motion &v = v_[i], &o = old_[i], &dv = dv_[i], &dx = dx_[i];
  const double when = blows_.when(i);
  Motion d;
  if (when >= 0) {
    const double one = 0.5 * when, two = 0.5 * (h - when);
    const Motion &b = blows_.before(i), &a = blows_.after(i);
    const Motion there{one * (o.x + b.x), one * (o.y + b.y), one * (o.w + b.w), 0};
    Motion back{two * (a.x + v.x), two * (a.y + v.y), two * (a.w + v.w), 0};
    if (fast(i, back)) {
      sweep::Pose from = poses_[i];
      from.x += there.x, from.y += there.y;
      const double part = clear(i, from, back, true);
      back.x *= part, back.y *= part, back.w *= part;
    }
    d = {there.x + back.x, there.y + back.y, there.w + back.w, 0};
  } else if (closing_[i]) {
    d = {h * v.x, h * v.y, h * v.w, 0};
  } else {
    const double half = 0.5 * h;
    d = {dx.x + half * (v.x - (o.x + dv.x)), dx.y + half * (v.y - (o.y + dv.y)),
         dx.w + half * (v.w - (o.w + dv.w)), 0};
  }
  // who is too fast to have been seen comes as far as what it meets, and strikes in the next step
  const Motion way{h * o.x, h * o.y, h * o.w, 0};
  if (!fast(i, way)) return d;
  const double part = clear(i, poses_[i], way, false);
  if (part >= 1 || (when >= 0 && when <= part * h)) return d;
  const double im = v_[i].im;
  v_[i] = o, v_[i].im = im;
  return {part * way.x, part * way.y, part * way.w, 0};
}

// whether it may pass through something in the step
template <int D>
bool Iterative<D>::fast(int body, const Motion& way) const {
  const double inside = 0.5 * kSight * cores_.inside[body];
  return way.x * way.x + way.y * way.y > inside * inside;
}

// the part of its way that a body may go before it meets another where that stands, or a wall: by steps as
// long as the distance that is left
template <int D>
double Iterative<D>::clear(int body, const sweep::Pose& from, const Motion& way, bool walls) const {
  const double length = std::sqrt(way.x * way.x + way.y * way.y);
  double part = 1;
  Feature features[2];
  for (const int i : blows_.around(body)) {
    const Pair& pair = pairs_.all()[i];
    const sweep::Core& a = cores_.all[pair.core_a];
    if (pair.b < 0) {
      const Wall<D>& wall = model_.walls[-1 - pair.b];
      const double nears = -(wall.normal[0] * way.x + wall.normal[1] * way.y);
      const double gap = nearest(cores_, a, from, wall, features) + 0.02 * a.inside;
      if (walls && nears > gap) part = std::min(part, std::max(gap, 0.0) / nears);
      continue;
    }
    const sweep::Core& b = cores_.all[pair.core_b];
    const double close = 0.02 * std::max(std::min(a.inside, b.inside), 1e-6 * model_.scale);
    sweep::Pose at = from;
    for (double gone = 0; gone < part;) {
      at.x = from.x + gone * way.x, at.y = from.y + gone * way.y;
      const double left = body == pair.a ? nearest(cores_, a, at, b, poses_[pair.b], features)
                                         : nearest(cores_, a, poses_[pair.a], b, at, features);
      if (left <= close) {
        if (gone > 0) part = gone;
        break;
      }
      gone += std::max(left - 0.5 * close, 0.5 * close) / length;
    }
  }
  return part;
}

// whether a body may come farther than its pairs foresaw, by more than a part of its thickness
template <int D>
bool Iterative<D>::outran(double h) const {
  const int n = int(turns_.size());
  const double falls = 3 * h * span_ * std::sqrt(model_.gravity.squaredNorm());
  for (int i = 0; i < n; ++i) {
    const Motion &v = v_[i], &o = old_[i];
    const double reach = cores_.reach[i];
    const double gain = std::fabs(v.x - o.x) + std::fabs(v.y - o.y) + std::fabs(v.w - o.w) * reach;
    if (gain * span_ < 0.04 * cores_.inside[i] + falls) continue;
    const auto speed = [&](const Motion& m) {
      return std::sqrt(m.x * m.x + m.y * m.y) + std::fabs(m.w) * reach;
    };
    if ((speed(v) - speed(o)) * span_ > 0.25 * cores_.inside[i] + pairs_.spare(i, speed(o), span_) + falls)
      return true;
  }
  return false;
}

template class Iterative<2>;

}  // namespace obscura::sim

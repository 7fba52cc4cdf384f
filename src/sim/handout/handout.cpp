// Impulses at a wall, handout §2.4, §3.5, for points that strike in one instant.
//   v_i = n . (v + w x r_i)                            speed of point i along the normal, m/s
//   A_ij = 1/m + (r_i x n) . I^-1 (r_j x n)            what a unit impulse at j does to v_i
//   p >= 0,  v_i + (A p)_i >= -e v_i,  with equality where p_i > 0
// One point alone gives p = -(1 + e) v_i / (1/m + (r x n)^2 / I), the handout's J.

#include "sim/handout/handout.h"

#include <algorithm>
#include <bit>
#include <cmath>

#include "sim/constraint/material.h"
#include "sim/constraint/response.h"
#include "sim/energy/energy.h"

namespace obscura::sim {

namespace {

constexpr int kRounds = 16;       // over the walls one by one; then all of them at once
constexpr double kStill = 1e-26;  // square of the part of a speed that is its rounding
constexpr double kMetTogether =
    1e-9;  // of a body's bounding radius: points this near the wall touch in the same instant
constexpr double kOutside = 1e-13;  // of the room's height: a depth that is rounding

// moves the wrong way, by more than the rounding of the speed it came with (squared)
bool strikes(double vn, double speed) { return vn < 0 && vn * vn > kStill * speed; }

template <int D>
void mark(int n, const double* __restrict x, const double* __restrict rims, const Wall<D>& wall,
          std::int64_t* __restrict signs) {
  const Vec<D> p = wall.point, normal = wall.normal;
  for (int i = 0; i < n; ++i) {
    double distance = -rims[i];
    for (int axis = 0; axis < D; ++axis) distance += (x[D * i + axis] - p[axis]) * normal[axis];
    signs[i] |= std::bit_cast<std::int64_t>(distance);
  }
}

}  // namespace

template <int D>
Handout<D>::Handout(const Model<D>& model, const std::vector<Path<D>>& paths)
    : model_(model), paths_(paths), forces_(model), tips_(model.bodies) {
  springs_.resize(model.bodies.size());
  for (const Body<D>& body : model.bodies) bounding_radius_.push_back(bounding_radius(body.shape));
  const int most = tips_.most();
  arms_.resize(most), distances_.resize(most), striking_.resize(most), met_.reserve(most);
  for (int spring = 0; spring < int(model.springs.size()); ++spring) {
    const int a = model.springs[spring].a.body, b = model.springs[spring].b.body;
    if (a >= 0) springs_[a].push_back(spring);
    if (b >= 0 && b != a) springs_[b].push_back(spring);
  }
  hits_.reserve(64);
}

template <int D>
void Handout<D>::look(const State<D>& state, int first, int count, std::vector<int>& suspects) {
  if (int(signs_.size()) < count) signs_.resize(count);
  std::fill_n(signs_.begin(), count, 0);
  for (const Wall<D>& wall : model_.walls) {
    mark<D>(count, state.x[first].data(), bounding_radius_.data() + first, wall, signs_.data());
  }
  for (int i = 0; i < count; ++i) {
    if (signs_[i] < 0) suspects.push_back(first + i);
  }
}

template <int D>
Vec<D> Handout<D>::arm(const Striker& s, int point, const Wall<D>& wall) const {
  const double radius = s.tips[point].radius;
  if (s.centred) return radius == 0 ? Vec<D>(Vec<D>::Zero()) : Vec<D>(-radius * wall.normal);
  return radius == 0 ? arms_[point] : Vec<D>(arms_[point] - radius * wall.normal);
}

// the energy stored in the springs on a body, J
template <int D>
double Handout<D>::springs(const State<D>& state, int body, double t) const {
  double sum = 0;
  for (const int spring : springs_[body]) sum += spring_energy(model_, state, spring);
  for (int mouse = 0; mouse < int(state.grips.size()); ++mouse) {
    if (state.grips[mouse].body == body) sum += spring_energy(model_, state, paths_, mouse, t);
  }
  return sum;
}

template <int D>
void Handout<D>::collide(State<D>& state, std::span<const int> suspects, double t) {
  for (const int body : suspects) {
    const Body<D>& b = model_.bodies[body];
    if (b.fixed || bounce(state, body)) continue;
    Striker s;
    s.body = &b;
    hits_.clear();
    s.tips = tips_[body];
    s.centred = particle_like(body);
    if (!s.centred) {
      s.at = body_motion(state, body);
      for (std::size_t i = 0; i < s.tips.size(); ++i) arms_[i] = s.at.arm(s.tips[i].at);
      s.speed = s.at.v.squaredNorm() + s.at.w.squaredNorm() * bounding_radius_[body] * bounding_radius_[body];
      if (!extended(s)) continue;
    } else {
      s.at.x = state.x[body], s.at.v = state.v[body];
      s.speed = s.at.v.squaredNorm();
      if (!particle(s)) continue;
    }
    put_inside(s);

    // the change of energy by the displacement
    const double held = springs(state, body, t), moving = kinetic(model_, state, body);
    state.ledger.displacement -= b.mass * model_.gravity.dot(s.at.x - state.x[body]);
    if (forces_.any() && forces_.push(body)) {
      state.ledger.displacement += forces_.energy_of(state, body, s.at, t) -
                                   forces_.energy_of(state, body, body_motion(state, body), t);
    }
    state.x[body] = s.at.x, state.v[body] = s.at.v;
    if (b.turns()) state.spin[turning(state, body)] = s.at.w;
    state.ledger.displacement += springs(state, body, t) - held;
    state.ledger.impacts += kinetic(model_, state, body) - moving;

    for (const Hit& h : hits_) {
      state.touches.push_back({body, h.wall, s.at.x + arm(s, h.point, model_.walls[h.wall]), h.impulse});
    }
  }
}

template <int D>
bool Handout<D>::particle_like(int body) const {
  const Body<D>& b = model_.bodies[body];
  return !b.turns() && round_radius(b.shape);
}

// the plain case, and the only one that happens often: a particle that no spring or force acts on meets one
// wall. False, and nothing done, where it is anything else
template <int D>
bool Handout<D>::bounce(State<D>& state, int body) const {
  const Body<D>& b = model_.bodies[body];
  if (!particle_like(body) || !springs_[body].empty() || forces_.push(body)) return false;
  for (const Grip<D>& grip : state.grips) {
    if (grip.body == body) return false;
  }
  Vec<D> x = state.x[body], v = state.v[body];
  const double speed = v.squaredNorm(), radius = *round_radius(b.shape);
  int met = -1;
  double jump = 0;
  for (int round = 0; round < 2; ++round) {
    for (int wall = 0; wall < int(model_.walls.size()); ++wall) {
      const Wall<D>& w = model_.walls[wall];
      const double distance = (x - w.point).dot(w.normal) - radius;
      if (!(distance < 0)) continue;
      const double vn = v.dot(w.normal);
      if (!strikes(vn, speed)) continue;
      if (met >= 0) return false;
      met = wall, jump = -(1 + mixed(b.elasticity, w.elasticity)) * vn;
      x -= distance * w.normal;
      v += jump * w.normal;
    }
    if (met < 0) return true;
  }
  const Wall<D>& w = model_.walls[met];
  state.ledger.displacement -= b.mass * model_.gravity.dot(x - state.x[body]);
  state.ledger.impacts += 0.5 * b.mass * (v.squaredNorm() - speed);
  state.x[body] = x, state.v[body] = v;
  state.touches.push_back({body, met, x - radius * w.normal, b.mass * jump * w.normal});
  return true;
}

// a particle at each wall in turn, §2.5; false where nothing happened
template <int D>
bool Handout<D>::particle(Striker& s) {
  const double mass = s.body->mass, radius = *round_radius(s.body->shape);
  Vec<D>&x = s.at.x, &v = s.at.v;
  for (int round = 0; round < kRounds; ++round) {
    bool quiet = true;
    for (int wall = 0; wall < int(model_.walls.size()); ++wall) {
      const Wall<D>& w = model_.walls[wall];
      const double distance = (x - w.point).dot(w.normal) - radius;
      if (!(distance < 0)) continue;
      const double vn = v.dot(w.normal);
      if (!strikes(vn, s.speed)) continue;
      const double jump = -(1 + mixed(s.body->elasticity, w.elasticity)) * vn;
      x -= distance * w.normal;
      v += jump * w.normal;
      hit(wall, 0, mass * jump * w.normal);
      quiet = false;
    }
    if (quiet) return !hits_.empty();
  }
  meet_all(s);
  return true;
}

// a body with an extent at each wall in turn, §3.5; false where nothing happened
template <int D>
bool Handout<D>::extended(Striker& s) {
  for (int round = 0; round < kRounds; ++round) {
    bool quiet = true;
    for (int wall = 0; wall < int(model_.walls.size()); ++wall) {
      if (meet(s, wall)) quiet = false;
    }
    if (quiet) return !hits_.empty();
  }
  meet_all(s);
  return true;
}

// one wall: puts the deepest of the points that come through on it, and solves those that then touch it
// together
template <int D>
bool Handout<D>::meet(Striker& s, int wall) {
  const Wall<D>& w = model_.walls[wall];
  const double middle = (s.at.x - w.point).dot(w.normal);
  const double span = bounding_radius_[s.body - model_.bodies.data()];
  if (middle > span) return false;

  double depth = -1;
  for (int i = 0; i < int(s.tips.size()); ++i) {
    const Vec<D> r = arm(s, i, w);
    distances_[i] = middle + r.dot(w.normal);
    striking_[i] = strikes(s.at.velocity(r).dot(w.normal), s.speed);
    if (distances_[i] < 0 && striking_[i]) depth = std::max(depth, -distances_[i]);
  }
  if (depth < 0) return false;
  s.at.x += depth * w.normal;

  met_.clear();
  for (int i = 0; i < int(s.tips.size()); ++i) {
    if (striking_[i] && std::fabs(distances_[i] + depth) <= kMetTogether * span) met_.push_back(i);
  }
  // if a face has more vertices than are solved together, take every second one, or third, ...
  const int stride = (int(met_.size()) + kMostRows - 1) / kMostRows;
  PointAtWall rows[kMostRows];
  int n = 0;
  for (std::size_t i = 0; i < met_.size(); i += stride) {
    const Vec<D> r = arm(s, met_[i], w);
    rows[n++] = {wall, met_[i], r, moment<D>(r, w.normal)};
  }
  strike(s, rows, n, s.body->turns() ? D : 1);
  return true;
}

// treats all touched or passed walls at once, as in a narrow wedge
template <int D>
void Handout<D>::meet_all(Striker& s) {
  const double span = bounding_radius_[s.body - model_.bodies.data()];
  const double near = std::max(kMetTogether * span, kOutside * model_.scale);
  PointAtWall rows[kMostRows];
  int n = 0;
  for (int wall = 0; wall < int(model_.walls.size()); ++wall) {
    const Wall<D>& w = model_.walls[wall];
    for (int i = 0; i < int(s.tips.size()) && n < kMostRows; ++i) {
      const Vec<D> r = arm(s, i, w);
      if ((s.at.x + r - w.point).dot(w.normal) > near) continue;
      if (!strikes(s.at.velocity(r).dot(w.normal), s.speed)) continue;
      rows[n++] = {wall, i, r, moment<D>(r, w.normal)};
    }
  }
  strike(s, rows, n, D + (s.body->turns() ? kAngular<D> : 0));
}

template <int D>
void Handout<D>::strike(Striker& s, const PointAtWall* rows, int n, int rank) {
  const Body<D>& body = *s.body;
  const auto respond = [&](const AngularVec<D>& turn) {
    return angular_response<D>(body, s.at.room_from_body, turn);
  };
  Square A(n, n);
  SmallVector b(n), p;
  for (int i = 0; i < n; ++i) {
    const Wall<D>& w = model_.walls[rows[i].wall];
    const AngularVec<D> response = respond(rows[i].turn);
    for (int j = 0; j < n; ++j) {
      A(j, i) = w.normal.dot(model_.walls[rows[j].wall].normal) / body.mass + rows[j].turn.dot(response);
    }
    b[i] = (1 + mixed(body.elasticity, w.elasticity)) * s.at.velocity(rows[i].arm).dot(w.normal);
  }
  solve_lcp(A, b, rank, p);

  Vec<D> push = Vec<D>::Zero();
  AngularVec<D> turn = AngularVec<D>::Zero();
  for (int i = 0; i < n; ++i) {
    const Vec<D> impulse = p[i] * model_.walls[rows[i].wall].normal;
    push += impulse;
    turn += p[i] * rows[i].turn;
    hit(rows[i].wall, rows[i].point, impulse);
  }
  s.at.v += push / body.mass;
  s.at.w += respond(turn);
}

// A body displaced by several walls may have come back through one of them: find the nearest place inside all
// that it touched.
//   x += sum p_i n_i,  p >= 0,  gap_i + n_i . sum p_j n_j >= 0
template <int D>
void Handout<D>::put_inside(Striker& s) const {
  int walls[kMostRows], n = 0;
  SmallVector gaps(kMostRows);
  bool outside = false;
  for (const Hit& h : hits_) {
    const Wall<D>& w = model_.walls[h.wall];
    const double gap = (s.at.x + arm(s, h.point, w) - w.point).dot(w.normal);
    outside = outside || gap < -kOutside * model_.scale;
    const int at = int(std::find(walls, walls + n, h.wall) - walls);
    if (at < n) {
      gaps[at] = std::min(gaps[at], gap);
    } else if (n < kMostRows) {
      walls[n] = h.wall, gaps[n++] = gap;
    }
  }
  if (n < 2 || !outside) return;
  Square A(n, n);
  for (int i = 0; i < n; ++i) {
    for (int j = 0; j < n; ++j) A(i, j) = model_.walls[walls[i]].normal.dot(model_.walls[walls[j]].normal);
  }
  SmallVector p;
  // walls that leave no place between them keep it where it is
  if (!solve_lcp(A, gaps.head(n), D, p)) return;
  for (int i = 0; i < n; ++i) s.at.x += p[i] * model_.walls[walls[i]].normal;
}

template <int D>
void Handout<D>::hit(int wall, int point, const Vec<D>& impulse) {
  for (Hit& h : hits_) {
    if (h.wall == wall && h.point == point) {
      h.impulse += impulse;
      return;
    }
  }
  hits_.push_back({wall, point, impulse});
}

template class Handout<2>;
template class Handout<3>;

}  // namespace obscura::sim

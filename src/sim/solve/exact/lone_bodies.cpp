// A body has an impact in a step of h if it reaches a wall, or a fixed body, faster than it falls in one
// step:
//   gap + h u - 2 g h^2 < 0,   u < -g h         u  speed of its nearest point along the normal, at least
// It rolls if it is not round about its centre of mass, turns, and bears on nothing else.
// It is alone if no other body can reach it, nor one that is moved or a belt:
//   |x_i - x_j| > r_i + r_j + s_i + s_j       s = 1.1 h sqrt(2 K / m) + g h^2, r  bounding radius

#include "sim/solve/exact/lone_bodies.h"

#include <algorithm>
#include <cmath>

#include "sim/energy/energy.h"
#include "sim/force/force_coupling.h"

namespace obscura::sim {

namespace {

constexpr double kSpareWay = 1.1;
constexpr double kNearby = 1e-6;        // of the room's size
constexpr double kSlowApproach = 1e-9;  // of the room's size, 1/s: slower is no impact
constexpr double kSlowTurn = 1e-6;      // of sqrt(g L): slower does not roll
constexpr double kInside = 1e-5;        // of its bounding radius: more than iterations leave
constexpr std::size_t kFew = 50000;     // couples to look at one by one

}  // namespace

template <int D>
LoneBodies<D>::LoneBodies(const Model<D>& model, const std::vector<Path<D>>& paths)
    : model_(model),
      direct_(model, paths, ExactSolver<D>::Serves::lone),
      drives_(model),
      g_(std::sqrt(model.gravity.squaredNorm())) {
  const int n = int(model.bodies.size());
  free_.assign(n, 1), still_.resize(n), moved_.assign(n, 0), ways_.resize(n), bounds_.resize(n);
  const auto tie = [&](int body) {
    if (body >= 0) free_[body] = 0;
  };
  for (int i = 0; i < n; ++i) {
    const Body<D>& body = model.bodies[i];
    bounding_radius_.push_back(bounding_radius(body.shape));
    points_.push_back(is_point(body.shape));
    if (body.fixed) fixed_.push_back(i);
    carries_.push_back(body.carries());
    if (body.fixed || body.handout || body.linked) tie(i);
  }
  for (const Spring<D>& spring : model.springs) tie(spring.a.body), tie(spring.b.body);
  for (const Joint<D>& joint : model.joints) joint.each_body(tie);
  for (const std::vector<int>& together : tied_by_forces(model)) {
    for (const int body : together) tie(body);
  }
}

// whether it reaches a wall or a fixed body in the step, faster than what rests
template <int D>
bool LoneBodies<D>::strikes(const State<D>& state, int body, double h) const {
  const Vec<D>&x = state.x[body], &v = state.v[body];
  const Shape<D>& shape = model_.bodies[body].shape;
  // as far as others count it as an impact: with some to spare
  const double least = g_ * h + kSlowApproach * model_.scale, fall = 2 * g_ * h * h + kNearby * model_.scale;
  double skin = 0;  // speed of its skin by its spin
  if (const int k = turning(state, body); k >= 0 && !round_radius(shape))
    skin = bounding_radius_[body] * std::sqrt(state.spin[k].squaredNorm());
  for (const Wall<D>& wall : model_.walls) {
    const double u = v.dot(wall.normal) - skin;
    if (u < -least && (x - wall.point).dot(wall.normal) - bounding_radius_[body] + h * u < fall) return true;
  }
  const double fast = std::sqrt(v.squaredNorm()) + skin;
  for (const int other : fixed_) {
    if (fast <= least) break;
    const double far = bounding_radius_[body] + bounding_radius_[other] + h * fast + fall;
    if ((x - state.x[other]).squaredNorm() < far * far) return true;
  }
  return false;
}

// Which roll or rock on walls or fixed bodies alone, so that the place where they touch moves in them: all
// that turns but what is round about its centre of mass, whose contact stays below that.
template <int D>
void LoneBodies<D>::find_rolling(const State<D>& state) {
  rolls_.assign(model_.bodies.size(), 0);
  const auto alone = [&](int body) { return body < 0 || (model_.bodies[body].fixed && !carries_[body]); };
  for (const Contact<D>& contact : state.contacts) {
    const int a = contact.key.a, b = contact.key.b;
    if (contact.touching == ContactMode::open) continue;
    for (const auto& [body, other] : {std::pair(a, b), std::pair(b, a)}) {
      if (body < 0) continue;
      // and what lies in another is put out of it by the iterations
      if (!alone(other) || contact.gap < -kInside * bounding_radius_[body]) rolls_[body] = 2;
      const int k = turning(state, body);
      if (rolls_[body] != 0 || k < 0 || round_radius(model_.bodies[body].shape)) continue;
      const double skin = bounding_radius_[body] * std::sqrt(state.spin[k].squaredNorm());
      if (skin > kSlowTurn * std::sqrt(g_ * model_.scale)) rolls_[body] = 1;
    }
  }
}

// leaves only candidates that no other body can reach
template <int D>
void LoneBodies<D>::leave_out_near(const State<D>& state) {
  const int n = int(model_.bodies.size());
  const auto apart = [&](int a, int b) {
    const Shape<D>&p = model_.bodies[a].shape, &q = model_.bodies[b].shape;
    if (is_point(p) && is_point(q)) return true;
    const double far = bounding_radius_[a] + bounding_radius_[b] + ways_[a] + ways_[b];
    return (state.x[a] - state.x[b]).squaredNorm() > far * far;
  };
  if (candidates_.size() * std::size_t(n) <= kFew) {
    std::erase_if(candidates_, [&](int a) {
      for (int b = 0; b < n; ++b) {
        if (a != b && meets(b) && !apart(a, b)) return true;
      }
      return false;
    });
    return;
  }
  std::fill(still_.begin(), still_.end(), 1);
  for (const int i : candidates_) still_[i] = 0;
  for (int i = 0; i < n; ++i) {
    const Vec<D> far = Vec<D>::Constant(bounding_radius_[i] + ways_[i]);
    bounds_[i] = {state.x[i] - far, state.x[i] + far};
  }
  for (const auto& [a, b] : broad_.find(bounds_, still_, {}, points_)) {
    if (meets(a) && meets(b) && !apart(a, b)) still_[a] = still_[b] = 1;
  }
  std::erase_if(candidates_, [&](int i) { return still_[i] != 0; });
}

template <int D>
void LoneBodies<D>::find(const State<D>& state, double t, double h) {
  candidates_.clear(), began_.clear();
  const int n = int(model_.bodies.size());
  find_rolling(state);
  for (int i = 0; i < n; ++i) {
    const bool frozen = !state.frozen.empty() && state.frozen[i];
    if (free_[i] && !frozen && (rolls_[i] == 1 || strikes(state, i, h))) candidates_.push_back(i);
  }
  for (const Grip<D>& grip : state.grips) std::erase(candidates_, grip.body);
  if (candidates_.empty()) return;
  for (int i = 0; i < n; ++i) {
    const bool still = model_.bodies[i].fixed || (!state.frozen.empty() && state.frozen[i]);
    ways_[i] =
        still ? 0
              : kSpareWay * h * std::sqrt(2 * kinetic(model_, state, i) / model_.bodies[i].mass) + g_ * h * h;
  }
  for (int i = 0; i < drives_.size(); ++i) ways_[drives_.body(i)] = kSpareWay * drives_.travel(i, t, h);
  leave_out_near(state);
  for (const int i : candidates_) {
    Began it{i, state.x[i], state.v[i], no_rotation<D>(), AngularVec<D>::Zero(), {}};
    if (const int k = turning(state, i); k >= 0) {
      it.turn = state.turn[k], it.spin = state.spin[k];
      if (std::size_t(k) < state.body_spin.size()) it.body_spin = state.body_spin[k];
    }
    began_.push_back(it);
  }
}

template <int D>
void LoneBodies<D>::step(State<D>& state, double t, double h) {
  std::fill(moved_.begin(), moved_.end(), 0);
  if (began_.empty()) return;
  // another that was struck on its way may have come farther than it could
  std::fill(still_.begin(), still_.end(), 0);
  for (const Contact<D>& contact : state.contacts) {
    const int a = contact.key.a, b = contact.key.b;
    if (b < 0 || model_.bodies[a].fixed || model_.bodies[b].fixed) continue;
    if (!contact.impulse.isZero(0) || !contact.force.isZero(0)) still_[a] = still_[b] = 1;
  }
  for (const Began& it : began_) {
    const int body = it.body;
    if (still_[body]) continue;
    moved_[body] = 1;
    state.x[body] = it.x, state.v[body] = it.v;
    if (const int k = turning(state, body); k >= 0) {
      state.turn[k] = it.turn, state.spin[k] = it.spin;
      if (std::size_t(k) < state.body_spin.size()) state.body_spin[k] = it.body_spin;
    }
    direct_.step_alone(state, body, t, h);
  }
}

template class LoneBodies<2>;
template class LoneBodies<3>;

}  // namespace obscura::sim

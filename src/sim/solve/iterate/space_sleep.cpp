// Rest. A quiet island at rest needs forces that leave it there,
//   g + sum f / m = 0,  sum r x f = 0        each f in its friction cone
// which iterations search for as in a step of bodies without speed: what speed they leave, over h, is the
// residual. Of small islands they are found exactly, at the beginning, and later where iterations do not come
// near.

#include <algorithm>
#include <cmath>

#include "sim/force/explosion.h"
#include "sim/solve/iterate/space.h"

namespace obscura::sim {

namespace {

constexpr double kDeepest = 2e-3;  // of a body's bounding radius: deeper nothing rests
constexpr double kHeld = 1e-6;     // of gravity
constexpr int kRestSweeps = 400;   // of an island at a time
constexpr int kFew = 32;           // touches of one that is solved exactly where these are too few
constexpr int kBetweenChecks = 10;
constexpr double kClosed = 1e-6;  // of a body's bounding radius: no wider a gap bears what rests

}  // namespace

// wakes the islands that something awake will touch, and those in a hand
template <int D>
bool SpaceIterative<D>::wake(State<D>& state, double h) {
  const int n = int(model_.bodies.size());
  if (std::none_of(state.frozen.begin(), state.frozen.end(), [](char frozen) { return frozen != 0; }))
    return false;
  ripe_.assign(n, 0);
  bool any = false;
  for (const ContactConstraint& touch : touches_) {
    if (touch.b == n || state.frozen[touch.a] == state.frozen[touch.b]) continue;
    const int sleeper = state.frozen[touch.a] ? touch.a : touch.b, other = touch.a + touch.b - sleeper;
    if (model_.bodies[other].fixed) continue;
    if (touch.gap < h * swiftness(other) + g_ * h * h) ripe_[sleeper] = 1, any = true;
  }
  const auto mark = [&](int body) {
    if (body >= 0 && state.frozen[body]) ripe_[body] = 1, any = true;
  };
  for (const Grip<D>& grip : state.grips) mark(grip.body);
  for (const Spring<D>& spring : model_.springs) {
    const auto awake = [&](int body) {
      return body >= 0 && !state.frozen[body] && !model_.bodies[body].fixed;
    };
    if (awake(spring.b.body)) mark(spring.a.body);
    if (awake(spring.a.body)) mark(spring.b.body);
  }
  for (std::size_t i = 0; i < model_.joints.size(); ++i) {
    const int a = model_.joints[i].a.body, b = model_.joints[i].b.body;
    if (a < 0 || b < 0 || state.broken[i] || model_.bodies[a].fixed || model_.bodies[b].fixed) continue;
    if (state.frozen[a] != state.frozen[b]) mark(a), mark(b);
  }
  if (!any) return false;
  join(state);
  for (int i = 0; i < n; ++i) {
    if (ripe_[i]) ripe_[islands_.root(i)] = 1;
  }
  for (int i = 0; i < n; ++i) {
    if (state.frozen[i] && ripe_[islands_.root(i)]) state.frozen[i] = 0, state.quiet[i] = 0;
  }
  return true;
}

// islands: bodies joined by contacts that bear or are closed, springs and joints; fixed bodies join none
template <int D>
void SpaceIterative<D>::join(const State<D>& state) {
  islands_.reset(int(model_.bodies.size()));
  const auto link = [&](int a, int b) {
    if (a < 0 || b < 0 || model_.bodies[a].fixed || model_.bodies[b].fixed) return;
    islands_.join(a, b);
  };
  for (const Contact<D>& contact : state.contacts) {
    const bool near =
        contact.touching != ContactMode::open || contact.gap < 1e-3 * bounding_radius_[contact.key.a];
    if (near) link(contact.key.a, contact.key.b);
  }
  for (const Spring<D>& spring : model_.springs) link(spring.a.body, spring.b.body);
  for (std::size_t i = 0; i < model_.joints.size(); ++i) {
    if (!state.broken[i]) link(model_.joints[i].a.body, model_.joints[i].b.body);
  }
}

// whether exact forces hold an island of bodies that stand still; its touches take them
template <int D>
bool SpaceIterative<D>::held(int island, double h, int most) {
  const auto moving = [&](int body) { return body < int(inactive_.size()) && !inactive_[body] ? body : -1; };
  exact_.clear(), bearing_.clear();
  for (int i = 0; i < int(touches_.size()); ++i) {
    const ContactConstraint& touch = touches_[i];
    const int a = moving(touch.a), b = moving(touch.b);
    if ((a < 0 && b < 0) || islands_.root(a < 0 ? b : a) != island) continue;
    bearing_.push_back(i);
    if (touch.gap > kClosed * bounding_radius_[touch.a]) continue;
    exact_.push_back({.a = a,
                      .b = b,
                      .normal = touch.n,
                      .arm_a = touch.arm_a,
                      .arm_b = touch.arm_b,
                      .friction = touch.mu,
                      .force = (touch.normal_impulse * touch.n + touch.tangent_impulse) / h});
    if (int(exact_.size()) > most) return false;
  }
  rotations_.resize(stances_.size());
  for (const auto& touch : exact_) {
    for (const int body : {touch.a, touch.b}) {
      if (body >= 0) rotations_[body] = stances_[body].room_from_body;
    }
  }
  if (!statics_.in_equilibrium(exact_, rotations_)) return false;
  auto bears = exact_.begin();
  for (const int i : bearing_) {
    ContactConstraint& touch = touches_[i];
    touch.normal_impulse = 0, touch.tangent_impulse.setZero(), touch.least = 0;
    if (touch.gap > kClosed * bounding_radius_[touch.a]) continue;
    touch.normal_impulse = h * bears->force.dot(touch.n);
    touch.tangent_impulse = h * bears->force - touch.normal_impulse * touch.n;
    ++bears;
  }
  return true;
}

// whether what bears an island leaves its motion any freedom: that is in kept_, while the trial of rest has
// moving_
template <int D>
Mobile SpaceIterative<D>::mobile(int island, double h) {
  const int n = int(model_.bodies.size());
  mobility_.clear();
  const auto member = [&](int body) { return body < n && !inactive_[body] && islands_.root(body) == island; };
  for (int i = 0; i < n; ++i) {
    if (member(i)) mobility_.add(i, kept_[i].v, kept_[i].w, stances_[i].room_from_body);
  }
  for (const int i : some_) {
    const ContactConstraint& touch = touches_[i];
    if (!member(touch.a) && !member(touch.b)) continue;
    mobility_.add_contact({.a = touch.a,
                           .b = touch.b < n ? touch.b : -1,
                           .normal = touch.n,
                           .arm_a = touch.arm_a,
                           .arm_b = touch.arm_b,
                           .friction = touch.mu,
                           .force = (touch.normal_impulse * touch.n + touch.tangent_impulse) / h});
  }
  for (const int part : parts_)
    joints_.each_bearing(part, [&](const Row<D>& row, double gain) { mobility_.add_row(row, gain / h); });
  return mobility_.mobile();
}

// freezes what begins without speed and in equilibrium, small islands without springs, hands and joints
template <int D>
bool SpaceIterative<D>::sleep_at_start(State<D>& state, double h) {
  if (blasting(state)) return false;
  const int n = int(model_.bodies.size());
  islands_.reset(n), ripe_.assign(n, 1);
  for (const ContactConstraint& touch : touches_) {
    if (touch.b < n && touch.gap < 1e-3 * bounding_radius_[touch.a] && !inactive_[touch.a] &&
        !inactive_[touch.b])
      islands_.join(touch.a, touch.b);
  }
  const auto restless = [&](int body) {
    if (body >= 0) ripe_[islands_.root(body)] = 0;
  };
  for (int i = 0; i < n; ++i) {
    if (!moving_[i].v.isZero(0) || !moving_[i].w.isZero(0)) restless(i);
  }
  for (const Spring<D>& spring : model_.springs) restless(spring.a.body), restless(spring.b.body);
  for (const Grip<D>& grip : state.grips) restless(grip.body);
  for (const Joint<D>& joint : model_.joints) restless(joint.a.body), restless(joint.b.body);
  bool froze = false;
  for (int root = 0; root < n; ++root) {
    if (inactive_[root] || islands_.root(root) != root || !ripe_[root] || !held(root, h, Statics<D>::kMost))
      continue;
    for (int i = 0; i < n; ++i) {
      if (!inactive_[i] && islands_.root(i) == root) state.frozen[i] = 1, froze = true;
    }
  }
  if (froze) report(state, h);
  return froze;
}

// freezes quiet islands; forces found on the way are kept
template <int D>
bool SpaceIterative<D>::put_to_sleep(State<D>& state, double h) {
  const int n = int(model_.bodies.size());
  bool ripe = false;
  for (int i = 0; i < n; ++i) ripe = ripe || (!inactive_[i] && state.quiet[i] >= kWait);
  if (!ripe || blasting(state)) return false;
  join(state);
  ripe_.assign(n, 1);
  for (int i = 0; i < n; ++i) {
    if (!inactive_[i] && state.quiet[i] < kWait) ripe_[islands_.root(i)] = 0;
  }
  for (const Spring<D>& spring : model_.springs) {
    for (const int body : {spring.a.body, spring.b.body}) {
      if (body >= 0) ripe_[islands_.root(body)] = 0;
    }
  }
  for (const Grip<D>& grip : state.grips) {
    if (grip.body >= 0) ripe_[islands_.root(grip.body)] = 0;
  }
  const auto resting = [&](int body) { return body < n && !inactive_[body] && ripe_[islands_.root(body)]; };
  some_.clear();
  for (int i = 0; i < int(touches_.size()); ++i) {
    const ContactConstraint& touch = touches_[i];
    if (!resting(touch.a) && !resting(touch.b)) continue;
    // too deep to stay so, or awake beyond
    const int body = resting(touch.a) ? touch.a : touch.b;
    if (touch.gap < -kDeepest * bounding_radius_[touch.a]) ripe_[islands_.root(body)] = 0;
    some_.push_back(i);
  }
  std::erase_if(some_, [&](int i) { return !resting(touches_[i].a) && !resting(touches_[i].b); });
  bool any = false;
  for (int i = 0; i < n; ++i) any = any || resting(i);
  if (!any) return false;

  kept_ = moving_;
  for (int i = 0; i < n; ++i) {
    if (!resting(i)) {
      moving_[i] = {};
      continue;
    }
    moving_[i].v = h * model_.gravity, moving_[i].w.setZero();
  }
  for (const int i : some_) {
    ContactConstraint& touch = touches_[i];
    touch.least = std::min(-touch.gap / h, 0.0);
    push(touch, touch.normal_impulse * touch.n + touch.tangent_impulse);
  }
  on_joints_.assign(n, 0), parts_.clear();
  for (const int i : joints_.bodies()) {
    if (!resting(i)) continue;
    on_joints_[i] = 1, parts_.push_back(joints_.part(i));
  }
  std::sort(parts_.begin(), parts_.end());
  parts_.erase(std::unique(parts_.begin(), parts_.end()), parts_.end());
  if (!parts_.empty()) copy_to_joints(&on_joints_), joints_.begin(h);
  const auto solve_held_joints = [&] {
    if (parts_.empty()) return;
    copy_to_joints(&on_joints_);
    for (const int part : parts_) joints_.iterate(part);
    copy_from_joints(&on_joints_);
  };
  double worst = 1e300;
  for (int i = 1; i < kRestSweeps && worst > kHeld * g_ * h; ++i) {
    solve_held_joints();
    iterate(some_, i % 2 != 0);
    if (i % kBetweenChecks != 0) continue;
    worst = 0;
    for (int k = 0; k < n; ++k) {
      if (resting(k)) worst = std::max(worst, swiftness(k));
    }
  }
  // island by island
  left_.assign(n, 0);
  for (int i = 0; i < n; ++i) {
    if (resting(i)) left_[islands_.root(i)] = std::max(left_[islands_.root(i)], swiftness(i));
  }
  const auto on_joints = [&](int root) {
    return std::any_of(joints_.bodies().begin(), joints_.bodies().end(),
                       [&](int i) { return resting(i) && islands_.root(i) == root; });
  };
  for (int root = 0; root < n; ++root) {
    if (!resting(root) || islands_.root(root) != root || on_joints(root)) continue;
    if (left_[root] <= kHeld * g_ * h) continue;
    // after one wait, two, four, ...
    double quiet = 1e300, due = kWait;
    for (int i = 0; i < n; ++i) {
      if (!inactive_[i] && islands_.root(i) == root) quiet = std::min(quiet, state.quiet[i]);
    }
    while (2 * due <= quiet) due *= 2;
    if (quiet - double(every_) * h < due && held(root, h, kFew)) left_[root] = 0;
  }
  moves_.assign(n, Mobile::unknown);
  for (int root = 0; root < n; ++root) {
    if (resting(root) && islands_.root(root) == root && left_[root] <= kHeld * g_ * h)
      moves_[root] = mobile(root, h);
  }
  bool froze = false;
  for (int i = 0; i < n; ++i) {
    if (!resting(i)) continue;
    if (moves_[islands_.root(i)] != Mobile::no) continue;
    state.frozen[i] = 1, froze = true;
    state.v[i].setZero();
    if (const int k = turning(state, i); k >= 0) state.spin[k].setZero();
  }
  if (!parts_.empty()) joints_.keep(state, h, &on_joints_);
  moving_.swap(kept_);
  report(state, h);
  return froze;
}

template void SpaceIterative<3>::join(const State<3>&);
template bool SpaceIterative<3>::wake(State<3>&, double);
template bool SpaceIterative<3>::sleep_at_start(State<3>&, double);
template bool SpaceIterative<3>::put_to_sleep(State<3>&, double);

}  // namespace obscura::sim

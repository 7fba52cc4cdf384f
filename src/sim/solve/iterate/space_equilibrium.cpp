// Sleep of the solver of space. An island at rest needs forces with
//   g + sum f / m = 0,  sum r x f = 0        each f in its friction cone
// which iterations search for as in a step of bodies without speed: what speed they leave, over h, is the
// residual.

#include <algorithm>
#include <cmath>

#include "sim/solve/iterate/space.h"

namespace obscura::sim {

namespace {

constexpr int kRestSweeps = 400;  // of all islands at a time
constexpr int kBetweenChecks = 10;
constexpr double kClosedGap = 1e-6;  // of the narrower body: so near it bears

}  // namespace

// a contact as the state keeps it
Contact<3> SpaceIterative::contact(const ContactConstraint& touch, double h) const {
  Contact<D> it;
  it.key = touch.key, it.point = touch.point, it.normal = touch.n, it.gap = touch.gap;
  const Vec<D> impulse = touch.normal_impulse * touch.n + touch.tangent_impulse;
  it.force = impulse / h;
  if (touch.bounces && touch.least > 0) it.impulse = impulse;
  it.impulse += touch.impact_impulse;
  it.touching =
      touch.normal_impulse <= 0 ? ContactMode::open
      : std::sqrt(touch.tangent_impulse.squaredNorm()) < touch.mu * touch.normal_impulse * (1 - 1e-9)
          ? ContactMode::stick
          : ContactMode::slide;
  if (it.touching == ContactMode::open && !touch.impact_impulse.isZero(0)) it.touching = ContactMode::slide;
  return it;
}

void SpaceIterative::update_sleep(StepPart<D> step) {
  State<D>& state = step.state;
  bool changed = wake_near_driven(step, step.h);
  if (state.step == 0 || sleep_.any(state)) {
    near_.clear();
    for (const ContactConstraint& touch : touches_) near_.push_back(contact(touch, step.h));
    changed = sleep_.wake(state, near_, step.h, step.h) || changed;
    if (!changed && state.step == 0 && sleep_.at_start(state, near_)) state.contacts = near_, changed = true;
  }
  if (changed) prepare(state, step.t, step.h), find(step);
}

// bodies of candidates for sleep without speed, for a step; what they touch and hang on
void SpaceIterative::fall_from_rest(std::span<const Sleep<D>::Island> islands, double h) {
  const int n = int(model_.bodies.size());
  ripe_.assign(n + 1, 0), on_joints_.assign(n, 0);
  kept_ = moving_;
  for (PointBody<D>& m : moving_) m = {};
  for (const auto& island : islands) {
    for (const int body : island.bodies) {
      ripe_[body] = 1, on_joints_[body] = island.jointed && joints_.has(body);
      moving_[body] = kept_[body];
      moving_[body].v = h * model_.gravity, moving_[body].w.setZero();
    }
  }
  some_.clear(), components_.clear();
  for (int i = 0; i < int(touches_.size()); ++i) {
    ContactConstraint& touch = touches_[i];
    if (!ripe_[touch.a] && !ripe_[touch.b]) continue;
    some_.push_back(i);
    touch.least = touch.gap * touch.per_width < kClosedGap ? 0 : -touch.gap / h;
    push(touch, touch.normal_impulse * touch.n + touch.tangent_impulse);
  }
  for (const int i : joints_.bodies()) {
    if (on_joints_[i]) components_.push_back(joints_.component(i));
  }
  std::sort(components_.begin(), components_.end());
  components_.erase(std::unique(components_.begin(), components_.end()), components_.end());
  if (!components_.empty()) velocities_to_joints(&on_joints_), joints_.stop_rows(), joints_.begin(h);
}

// forces of candidates for sleep, all at once, into their contacts; and what they leave
void SpaceIterative::find_equilibrium(std::span<Sleep<D>::Island> islands, State<D>& state, double h) {
  fall_from_rest(islands, h);
  const double near = Sleep<D>::kBalanced * g_ * h;
  batches_.build(touches_, some_, moving_);
  settling_.begin(touches_, some_, moving_, {});
  for (Settling::Island& island : settling_.islands) island.follows = true;
  batches_.set_islands(settling_);
  batches_.begin_directions();
  for (int i = 1, found = 0; i < kRestSweeps && !found; ++i) {
    if (!components_.empty()) {
      velocities_to_joints(&on_joints_);
      for (const int component : components_) joints_.iterate(component);
      velocities_from_joints(&on_joints_);
    }
    batches_.iterate(moving_, i % 2 == 0);
    if (i % 2 == 0 && components_.empty()) batches_.follow_directions(moving_, settling_);
    if (i % kBetweenChecks != 0) continue;
    found = std::all_of(islands.begin(), islands.end(), [&](const auto& island) {
      return std::all_of(island.bodies.begin(), island.bodies.end(),
                         [&](int body) { return swiftness(body) <= near; });
    });
  }
  batches_.store(touches_);
  for (auto& island : islands) {
    double fastest = 0;
    for (const int body : island.bodies) fastest = std::max(fastest, swiftness(body));
    island.residual = fastest / h;
    for (const int component : joints_.components_of(island.bodies))
      joints_.each_bearing(
          component, [&](const Row<D>& row, double gain) { sleep_.add_joint_row(island, row, gain / h); });
  }
  if (!components_.empty()) joints_.keep(state, h, &on_joints_);
  moving_.swap(kept_);
  report_contacts(state, h);
}

}  // namespace obscura::sim

// An island at rest needs forces with
//   g + sum f / m = 0,  sum r x f = 0        each f in its friction cone
// which iterations search for as in a step of h of bodies without speed: what speed they leave, over h, is
// the residual.

#include "sim/solve/iterate/plane_equilibrium.h"

#include <algorithm>
#include <cmath>

#include "sim/solve/iterate/moving_body.h"

namespace obscura::sim::plane {

namespace {

constexpr int kPairSweeps = 40000;  // pairs times iterations of an island at a time
constexpr int kMostSweeps = 400;
constexpr int kBetweenChecks = 10;

}  // namespace

Equilibrium::Equilibrium(const Model<2>& model, const CoreShapes& cores) : model_(model), cores_(cores) {
  const std::size_t n = model.bodies.size();
  marked_.assign(n, 0), v_.resize(n + 1), zero_.resize(n + 1);
}

void Equilibrium::find(std::span<Sleep<2>::Island> islands, Sleep<2>& sleep, State<2>& state,
                       const Step& step, double h) {
  if (islands.empty()) return;
  pair_of_.resize(state.contacts.size());
  for (int i = 0; i < int(step.pairs.size()); ++i) {
    const Pair& pair = step.pairs[i];
    for (int k = 0; k < pair.touches; ++k) pair_of_[pair.first + k] = i;
  }
  fall(islands, step.joints, h);
  for (Sleep<2>::Island& island : islands) {
    gather(island, state, step);
    island.residual = iterate(island, state, step, h) / h;
    for (const int component : components_) {
      step.joints.each_bearing(
          component, [&](const Row<2>& row, double gain) { sleep.add_joint_row(island, row, gain / h); });
    }
  }
}

// bodies without speed, for a step
void Equilibrium::fall(std::span<const Sleep<2>::Island> islands, JointSolver<2>& joints, double h) {
  std::fill(v_.begin(), v_.end(), Motion{});
  bool jointed = false;
  for (const Sleep<2>::Island& island : islands) {
    for (const int body : island.bodies)
      v_[body] = {h * model_.gravity[0], h * model_.gravity[1], 0, 1 / model_.bodies[body].mass};
    copy_to_joints(island, joints);
    jointed = jointed || island.jointed;
  }
  if (!jointed) return;
  joints.stop_rows();
  joints.begin(h);
  for (const Sleep<2>::Island& island : islands) copy_from_joints(island, joints);
}

void Equilibrium::copy_to_joints(const Sleep<2>::Island& island, JointSolver<2>& joints) const {
  if (!island.jointed) return;
  for (const int body : island.bodies) {
    if (!joints.has(body)) continue;
    joints.body_motion(body).v = velocity(v_[body]), joints.body_motion(body).w = spin(v_[body]);
  }
}

void Equilibrium::copy_from_joints(const Sleep<2>::Island& island, JointSolver<2>& joints) {
  if (!island.jointed) return;
  for (const int body : island.bodies) {
    if (!joints.has(body)) continue;
    set_velocity(v_[body], joints.body_motion(body).v, joints.body_motion(body).w);
  }
}

// the pairs of an island in batches of its own, those of one colour together; the components of its joints
void Equilibrium::gather(const Sleep<2>::Island& island, const State<2>& state, const Step& step) {
  pairs_.clear(), components_.clear(), batches_.clear();
  for (const int contact : island.contacts) {
    const int pair = pair_of_[contact];
    if (pairs_.empty() || pairs_.back() != pair) pairs_.push_back(pair);
  }
  std::sort(pairs_.begin(), pairs_.end(),
            [&](int i, int j) { return step.pairs[i].slot < step.pairs[j].slot; });
  if (island.jointed) {
    const std::span<const int> components = step.joints.components_of(island.bodies);
    components_.assign(components.begin(), components.end());
  }

  const int none = int(state.x.size());
  ContactBatch empty{};
  for (int k = 0; k < kLanes; ++k) {
    empty.a[k] = empty.b[k] = none, empty.pair[k] = empty.first[k] = -1;
    empty.d[0][k] = empty.d[1][k] = -kNowhere, empty.per_width[k] = 1;
  }
  int lane = kLanes, colour = -1;
  for (const int i : pairs_) {
    const Pair& pair = step.pairs[i];
    if (lane == kLanes || pair.colour != colour || pair.alone)
      batches_.push_back(empty), lane = 0, colour = pair.colour;
    copy_lane(step.batches[pair.slot / kLanes], pair.slot % kLanes, batches_.back(), lane++);
  }
}

// forces into the state and the lanes; what speed they leave its fastest point, m/s
double Equilibrium::iterate(const Sleep<2>::Island& island, State<2>& state, const Step& step, double h) {
  const StepConstants constants{h, 1e300, 0, {}, nullptr};
  const int count = int(batches_.size());
  const auto solve_joint_velocities = [&] {
    copy_to_joints(island, step.joints);
    for (const int component : components_) step.joints.iterate(component);
    copy_from_joints(island, step.joints);
  };
  const double near = Sleep<2>::kBalanced * std::sqrt(model_.gravity.squaredNorm()) * h;
  const int most = std::clamp(kPairSweeps / std::max(1, int(pairs_.size())), kBetweenChecks, kMostSweeps);
  warm_start(batches_.data(), count, step.poses.data(), zero_.data(), v_.data(), constants, slow_, fast_);
  double worst = 1e300;
  for (int i = 1; worst > near && i < most; ++i) {
    solve_joint_velocities();
    plane::iterate(batches_.data(), count, step.poses.data(), v_.data(), constants);
    if (i % kBetweenChecks != 0 && i + 1 < most) continue;
    worst = 0;
    for (const int body : island.bodies) {
      const Motion& m = v_[body];
      worst =
          std::max(worst, std::sqrt(m.x * m.x + m.y * m.y) + std::fabs(m.w) * cores_.bounding_radius[body]);
    }
  }
  solve_joint_velocities();
  iterate_last(batches_.data(), count, step.poses.data(), v_.data(), constants, state.contacts.data());
  for (const ContactBatch& own : batches_) {
    for (int k = 0; k < kLanes; ++k) {
      if (own.pair[k] < 0) continue;
      const int slot = step.pairs[own.pair[k]].slot;
      copy_lane_forces(own, k, step.batches[slot / kLanes], slot % kLanes);
    }
  }
  if (components_.empty()) return worst;
  for (const int body : island.bodies) marked_[body] = 1;
  step.joints.keep(state, h, &marked_);
  for (const int body : island.bodies) marked_[body] = 0;
  return worst;
}

}  // namespace obscura::sim::plane

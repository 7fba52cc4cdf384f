// The stage `sleep`. An island at rest needs forces with
//   g + sum f / m = 0,  sum r x f = 0        each f in its friction cone
// which iterations search for as in a substep of bodies without speed: what speed they leave, over h, is the
// residual. Islands one by one, so that what one finds does not hang on the others.

#include <algorithm>
#include <cmath>

#include "sim/solve/iterate/iterative.h"

namespace obscura::sim {

namespace {

constexpr int kBetweenChecks = 10;  // iterations

}  // namespace

template <int D>
void Iterative<D>::sleep(StepPart<D> step) {
  if (!sleep_.due(step.state)) return;
  const std::span<typename Sleep<D>::Island> islands = sleep_.candidates(step.state);
  if (islands.empty()) return;
  const double h = step.h / substeps_;
  kept_ = moving_;
  fall_from_rest(islands, h);
  for (typename Sleep<D>::Island& island : islands) find_equilibrium(island, step.state, h);
  if (!joints_.empty()) joints_.keep(step.state, h, &on_joints_);
  moving_.swap(kept_);
  if (sleep_.put_to_sleep(step.state)) stop_sleeping(step.state);
}

// bodies of the candidates without speed, for a substep; no others move
template <int D>
void Iterative<D>::fall_from_rest(std::span<const typename Sleep<D>::Island> islands, double h) {
  std::fill(moving_.begin(), moving_.end(), MovingBody<D>{});
  on_joints_.assign(model_.bodies.size(), 0);
  bool jointed = false;
  for (const auto& island : islands) {
    jointed = jointed || island.jointed;
    // what a motor gives that pushes against a stop is not found from rest: joints go on bearing what they
    // bore
    const bool driven = std::any_of(island.bodies.begin(), island.bodies.end(),
                                    [&](int body) { return on_motors_[std::size_t(body)] != 0; });
    for (const int body : island.bodies) {
      MovingBody<D>& m = moving_[std::size_t(body)] = kept_[std::size_t(body)];
      set_velocity(m, Vec<D>(h * model_.gravity), AngularVec<D>(AngularVec<D>::Zero()));
      on_joints_[std::size_t(body)] = island.jointed && !driven && joints_.has(body);
    }
    if (island.jointed) velocities_to_joints(island.bodies);
  }
  if (jointed) joints_.stop_rows(), joints_.begin(h);
}

// forces of an island, into the state; what they leave
template <int D>
void Iterative<D>::find_equilibrium(typename Sleep<D>::Island& island, State<D>& state, double h) {
  std::span<const int> components;
  if (island.jointed) components = joints_.components_of(island.bodies);
  const auto solve_joints = [&] {
    if (components.empty()) return;
    velocities_to_joints(island.bodies);
    for (const int component : components) joints_.iterate(component);
    velocities_from_joints(island.bodies);
  };
  const double near = Sleep<D>::kBalanced * g_ * h;
  const int most = begin_rest(island, state, h);
  double fastest = 1e300;
  for (int i = 1; fastest > near && i < most; ++i) {
    solve_joints();
    iterate_rest(i);
    if (i % kBetweenChecks != 0 && i + 1 < most) continue;
    fastest = 0;
    for (const int body : island.bodies) fastest = std::max(fastest, swiftness(body));
  }
  solve_joints();
  finish_rest(island, state, h);
  island.residual = fastest / h;
  for (const int component : components) {
    joints_.each_bearing(
        component, [&](const Row<D>& row, double gain) { sleep_.add_joint_row(island, row, gain / h); });
  }
}

template void Iterative<2>::sleep(StepPart<2>);
template void Iterative<3>::sleep(StepPart<3>);

}  // namespace obscura::sim

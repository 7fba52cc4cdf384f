// Responses of rows that may move chains as well as free bodies (sim/constraint/response.h).

#include "sim/solve/exact/exact.h"

namespace obscura::sim {

// the diagonal of K for a contact's row: its response to a force along it, 1/kg
template <int D>
double ExactSolver<D>::self_coupling(int row) const {
  const Row<D>& it = rows_[row];
  double sum = coupling(it, response_.of(it, poses_), it);
  sum += chain_response_.coupling(row, row);
  return sum;
}

// M^-1 J' f_ onto the velocities of a state, or onto its places
template <int D>
void ExactSolver<D>::apply_impulses(State<D>& state, bool places) {
  const bool chains = dynamics_.chains().size() > 0;
  if (places) scratch_.turns.assign(model_.bodies.size(), AngularVec<D>::Zero());
  if (chains) scratch_.chain_change.assign(std::size_t(dynamics_.chains().size()), 0.0);
  for (int i = 0; i < int(rows_.size()); ++i) {
    if (f_[i] == 0) continue;
    apply_impulses(state, rows_[i], f_[i], places);
    if (!chain_response_.moves(i)) continue;
    const auto U = chain_response_.response(i);
    for (std::size_t k = 0; k < U.size(); ++k) scratch_.chain_change[k] += f_[i] * U[k];
  }
  // turns one after another would depend on their order
  for (const int body : active_.subset.bodies) {
    if (!places || scratch_.turns[body].isZero(0)) continue;
    const int k = turning(state, body);
    state.turn[k] = turned<D>(state.turn[k], scratch_.turns[body]);
  }
  if (!chains) return;
  dynamics_.chains().jump(state, scratch_.chain_change, places);
  dynamics_.chains().follow(state);
}

// the forces that the joints of chains bear at this instant, into outcome_.joint_loads; before those of rows
template <int D>
void ExactSolver<D>::record_chain_forces() {
  Articulated<D>& chains = dynamics_.chains();
  if (chains.links().empty()) return;
  for (int i = 0; i < int(rows_.size()); ++i) {
    if (!chain_response_.moves(i) || f_[i] == 0) continue;
    const Row<D>& row = rows_[i];
    if (response_.linked(row.a)) chains.pull(chains.link(row.a), Wrench<D>{row.angular_a, row.along} * f_[i]);
    if (response_.linked(row.b))
      chains.pull(chains.link(row.b), Wrench<D>{row.angular_b, row.along} * -f_[i]);
    for (const RowSide<D>& side : row.more) {
      if (response_.linked(side.body))
        chains.pull(chains.link(side.body), Wrench<D>{side.angular, side.along} * f_[i]);
    }
  }
  chains.joint_loads(outcome_.joint_loads);
}

#define OBSCURA_INSTANTIATE(D)                                   \
  template double ExactSolver<D>::self_coupling(int) const;      \
  template void ExactSolver<D>::apply_impulses(State<D>&, bool); \
  template void ExactSolver<D>::record_chain_forces()
OBSCURA_INSTANTIATE(2);
OBSCURA_INSTANTIATE(3);
#undef OBSCURA_INSTANTIATE

}  // namespace obscura::sim

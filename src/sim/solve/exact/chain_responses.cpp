// Rows that move chains. A side that is a link moves all of its tree:
//   J = (turn, along) at the link's centre, carried down to each freedom         M^-1 J' by Featherstone
// and two rows meet in J_i . (M^-1 J_j'), where free bodies meet in the mass of the one they share.

#include <algorithm>
#include <numeric>

#include "sim/solve/exact/exact.h"

namespace obscura::sim {

// J and M^-1 J' of all rows that move chains, which stand at the stage at hand; to the drift of such a row
// comes what its links accelerate by where no joint does
template <int D>
void ExactSolver<D>::reach() {
  Articulated<D>& chains = free_.chains();
  reaches_.assign(rows_.size(), -1);
  if (chains.size() == 0) return;
  const std::size_t n = std::size_t(chains.size());
  int found = 0;
  for (std::size_t i = 0; i < rows_.size(); ++i) {
    if (linked(rows_[i].a) || linked(rows_[i].b)) reaches_[i] = found++;
  }
  chain_J_.assign(n * std::size_t(found), 0.0), chain_U_.resize(n * std::size_t(found));
  for (std::size_t i = 0; i < rows_.size(); ++i) {
    if (reaches_[i] < 0) continue;
    Row<D>& row = rows_[i];
    const std::span<double> J(chain_J_.data() + n * std::size_t(reaches_[i]), n);
    const auto side = [&](int body, const Wrench<D>& wrench) {
      if (!linked(body)) return;
      const int link = chains.link(body);
      chains.add_row(link, wrench, J);
      row.velocity_product += power(wrench, chains.velocity_product(link));
    };
    side(row.a, {row.angular_a, row.along});
    side(row.b, {-row.angular_b, -row.along});
    chains.respond(J, std::span<double>(chain_U_.data() + n * std::size_t(reaches_[i]), n));
  }
}

// the numbers of a row that moves chains: of chain_J_ or chain_U_
template <int D>
std::span<const double> ExactSolver<D>::reached(const std::vector<double>& numbers, int row) const {
  const std::size_t n = std::size_t(free_.chains().size());
  return {numbers.data() + n * std::size_t(reaches_[row]), n};
}

// K of a row of a contact with itself: what it answers to a force along it, 1/kg
template <int D>
double ExactSolver<D>::answer(int row) const {
  const Row<D>& it = rows_[row];
  double sum = (free(it.a) ? light_[it.a] : 0) + (free(it.b) ? light_[it.b] : 0);
  if (free(it.a)) sum += it.angular_a.dot(turned_by(it.a, it.angular_a));
  if (free(it.b)) sum += it.angular_b.dot(turned_by(it.b, it.angular_b));
  if (reaches_[row] >= 0) {
    const auto J = reached(chain_J_, row), U = reached(chain_U_, row);
    sum += std::inner_product(J.begin(), J.end(), U.begin(), 0.0);
  }
  return sum;
}

// M^-1 J' f_ onto the velocities of a state, or onto its places
template <int D>
void ExactSolver<D>::jump(State<D>& state, bool places) {
  const bool chains = free_.chains().size() > 0;
  if (chains) chain_change_.assign(std::size_t(free_.chains().size()), 0.0);
  for (int i = 0; i < int(rows_.size()); ++i) {
    if (f_[i] == 0) continue;
    jump(state, rows_[i], f_[i], places);
    if (reaches_[i] < 0) continue;
    const auto U = reached(chain_U_, i);
    for (std::size_t k = 0; k < U.size(); ++k) chain_change_[k] += f_[i] * U[k];
  }
  if (!chains) return;
  free_.chains().jump(state, chain_change_, places);
  free_.chains().follow(state);
}

// what the joints of chains bear under the forces of the instant, into joint_forces_; before those of rows
template <int D>
void ExactSolver<D>::chain_forces() {
  Articulated<D>& chains = free_.chains();
  if (chains.size() == 0) return;
  for (int i = 0; i < int(rows_.size()); ++i) {
    if (reaches_[i] < 0 || f_[i] == 0) continue;
    const Row<D>& row = rows_[i];
    if (linked(row.a)) chains.pull(chains.link(row.a), Wrench<D>{row.angular_a, row.along} * f_[i]);
    if (linked(row.b)) chains.pull(chains.link(row.b), Wrench<D>{row.angular_b, row.along} * -f_[i]);
  }
  chains.joint_forces(joint_forces_);
}

#define OBSCURA_INSTANTIATE(D)                                                                     \
  template void ExactSolver<D>::reach();                                                           \
  template std::span<const double> ExactSolver<D>::reached(const std::vector<double>&, int) const; \
  template double ExactSolver<D>::answer(int) const;                                               \
  template void ExactSolver<D>::jump(State<D>&, bool);                                             \
  template void ExactSolver<D>::chain_forces()
OBSCURA_INSTANTIATE(2);
OBSCURA_INSTANTIATE(3);
#undef OBSCURA_INSTANTIATE

}  // namespace obscura::sim

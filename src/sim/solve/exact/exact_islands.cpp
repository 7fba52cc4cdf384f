// Rows that share no body are independent: K falls into blocks, each solved alone.

#include <algorithm>

#include "sim/solve/exact/exact.h"

namespace obscura::sim {

namespace {

constexpr int kFewestRoughSweeps = 40;  // of a rough solve: as many as
constexpr double kRoughSize = 2e7;      // elements of K can be visited in
constexpr double kThoroughSize = 5e8;   // of the size of all systems that a thorough one solves

}  // namespace

// the connected parts of constraints_, by the bodies that they move
template <int D>
void ExactSolver<D>::find_islands() {
  roots_.reset(active_.subset.bodies);
  for (const int number : active_.subset.chains) {
    const Articulation<D>& chain = model_.chains[number];
    for (const int body : chain.bodies) roots_.join(body, chain.bodies[0]);
  }
  for (const Constraint& constraint : constraints_) {
    const Row<D>& row = rows_[constraint.first];
    if (response_.moves(row.a) && response_.moves(row.b)) roots_.join(row.a, row.b);
    const int first = mover(row);
    for (const RowSide<D>& side : row.more)
      if (response_.moves(side.body)) roots_.join(side.body, first);
  }
  for (const int body : active_.subset.bodies) island_of_[body] = -1;
  islands_ = 0;
  for (const Constraint& constraint : constraints_) {
    const Row<D>& row = rows_[constraint.first];
    const int body = roots_.root(mover(row));
    if (island_of_[body] < 0) island_of_[body] = islands_++;
    if (int(island_members_.size()) < islands_) island_members_.emplace_back();
  }
  for (int part = 0; part < islands_; ++part) island_members_[part].clear();
  for (int i = 0; i < int(constraints_.size()); ++i) {
    const Row<D>& row = rows_[constraints_[i].first];
    island_members_[island_of_[roots_.root(mover(row))]].push_back(i);
  }
}

// K of the rows in scratch_.rows
template <int D>
void ExactSolver<D>::build_K() {
  const int n = int(scratch_.rows.size());
  scratch_.K.resize(n, n), scratch_.island_b.resize(n), scratch_.island_f.setZero(n);
  for (int i = 0; i < n; ++i) {
    const Row<D>& r = rows_[scratch_.rows[i]];
    scratch_.island_b[i] = b_[scratch_.rows[i]];
    const RowResponse<D> response = response_.of(r, poses_);
    for (int j = 0; j <= i; ++j) {
      double k = coupling(r, response, rows_[scratch_.rows[j]]);
      k += chain_response_.coupling(scratch_.rows[i], scratch_.rows[j]);
      scratch_.K(i, j) = k, scratch_.K(j, i) = k;
    }
  }
}

// f_ and modes_ of all rows under b_, exactly; false where a part has none. Or roughly
template <int D>
bool ExactSolver<D>::solve() {
  if (progress_.rough) {
    solve_roughly();
    return true;
  }
  bool found = true;
  each_island(modes_, [&](std::vector<ConeMode<D>>& modes) {
    const double rows = double(scratch_.rows.size()), size = rows * rows * rows;
    const int patience = cone_.patience;
    if (cone_.thorough && model_.collision != Collision::event)
      cone_.patience = int(std::min<double>(patience, kThoroughSize / size));
    const ConeReport report =
        cone_.solve(scratch_.K, scratch_.island_b, scratch_.island_blocks, modes, scratch_.island_f);
    cone_.patience = patience;
    found = report.found && found;
    progress_.work += report.tries * size;
  });
  return found;
}

// the same, roughly, by so many sweeps at most
template <int D>
void ExactSolver<D>::solve_roughly(int most) {
  each_island(modes_, [&](std::vector<ConeMode<D>>& modes) {
    const double rows = double(scratch_.rows.size()),
                 sweeps = std::clamp<double>(kRoughSize / (rows * rows), kFewestRoughSweeps, most);
    cone_.sweep(scratch_.K, scratch_.island_b, scratch_.island_blocks, modes, scratch_.island_f, int(sweeps));
  });
}

// f_ where what holds goes on holding
template <int D>
void ExactSolver<D>::solve_held() {
  each_island(interval_.modes, [&](std::vector<ConeMode<D>>& modes) {
    cone_.solve_modes(scratch_.K, scratch_.island_b, scratch_.island_blocks, modes, scratch_.island_f);
  });
}

template <int D>
template <class Solve>
void ExactSolver<D>::each_island(std::vector<ConeMode<D>>& modes, Solve&& solve) {
  f_.setZero(Eigen::Index(rows_.size()));
  for (int part = 0; part < islands_; ++part) {
    scratch_.rows.clear(), scratch_.island_blocks.clear(), scratch_.island_modes.clear();
    const auto blocks_end = [&](int i) {
      return i + 1 < int(constraints_.size()) ? constraints_[i + 1].block : int(blocks_.size());
    };
    for (const int i : island_members_[part]) {
      for (int row = 0; row < constraints_[i].rows; ++row)
        scratch_.rows.push_back(constraints_[i].first + row);
      for (int block = constraints_[i].block; block < blocks_end(i); ++block) {
        scratch_.island_blocks.push_back(blocks_[block]);
        scratch_.island_modes.push_back(modes[block]);
      }
    }
    build_K();
    for (int i = 0; i < int(scratch_.rows.size()) && warm_.size() == f_.size(); ++i)
      scratch_.island_f[i] = warm_[scratch_.rows[i]];
    progress_.work += double(scratch_.rows.size()) * scratch_.rows.size() * scratch_.rows.size();
    solve(scratch_.island_modes);
    for (int i = 0; i < int(scratch_.rows.size()); ++i) f_[scratch_.rows[i]] = scratch_.island_f[i];
    int at = 0;
    for (const int i : island_members_[part]) {
      for (int block = constraints_[i].block; block < blocks_end(i); ++block)
        modes[block] = scratch_.island_modes[at++];
    }
  }
}

// f_ of least norm that gives the rows in scratch_.chosen what b_ has for them
template <int D>
void ExactSolver<D>::solve_least_norm() {
  f_.setZero(Eigen::Index(rows_.size()));
  scratch_.wanted.assign(rows_.size(), 0);
  for (const int row : scratch_.chosen) scratch_.wanted[row] = 1;
  for (int part = 0; part < islands_; ++part) {
    scratch_.rows.clear(), scratch_.wanted_rows.clear();
    for (const int i : island_members_[part]) {
      for (int row = constraints_[i].first; row < constraints_[i].first + constraints_[i].rows; ++row) {
        if (scratch_.wanted[row]) scratch_.rows.push_back(row);
      }
    }
    if (scratch_.rows.empty()) continue;
    build_K();
    for (int i = 0; i < int(scratch_.rows.size()); ++i) scratch_.wanted_rows.push_back(i);
    cone_.least(scratch_.K, scratch_.island_b, scratch_.wanted_rows, scratch_.island_f);
    for (int i = 0; i < int(scratch_.rows.size()); ++i) f_[scratch_.rows[i]] = scratch_.island_f[i];
  }
}

template void ExactSolver<2>::find_islands();
template bool ExactSolver<2>::solve();
template void ExactSolver<2>::solve_roughly(int);
template void ExactSolver<2>::solve_held();
template void ExactSolver<2>::solve_least_norm();
template void ExactSolver<3>::find_islands();
template bool ExactSolver<3>::solve();
template void ExactSolver<3>::solve_roughly(int);
template void ExactSolver<3>::solve_held();
template void ExactSolver<3>::solve_least_norm();

}  // namespace obscura::sim

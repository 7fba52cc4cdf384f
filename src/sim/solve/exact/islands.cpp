// Rows that share no body are independent: K falls into blocks, each solved alone.

#include <algorithm>

#include "sim/solve/exact/exact.h"

namespace obscura::sim {

namespace {

constexpr int kRoughIterations = 40;   // of a rough solve
constexpr double kThoroughSize = 5e8;  // of the size of all systems that a thorough one solves

}  // namespace

// what of held_ belongs together, by the bodies it moves
template <int D>
void ExactSolver<D>::split() {
  roots_.reset(active_.subset.bodies);
  for (const int number : active_.subset.chains) {
    const Articulation<D>& chain = model_.chains[number];
    for (const int body : chain.bodies) roots_.join(body, chain.bodies[0]);
  }
  for (const Held& held : held_) {
    const Row<D>& row = rows_[held.first];
    if (response_.moves(row.a) && response_.moves(row.b)) roots_.join(row.a, row.b);
  }
  for (const int body : active_.subset.bodies) part_of_[body] = -1;
  parts_ = 0;
  for (const Held& held : held_) {
    const Row<D>& row = rows_[held.first];
    const int body = roots_.root(response_.moves(row.a) ? row.a : row.b);
    if (part_of_[body] < 0) part_of_[body] = parts_++;
    if (int(members_.size()) < parts_) members_.emplace_back();
  }
  for (int part = 0; part < parts_; ++part) members_[part].clear();
  for (int i = 0; i < int(held_.size()); ++i) {
    const Row<D>& row = rows_[held_[i].first];
    members_[part_of_[roots_.root(response_.moves(row.a) ? row.a : row.b)]].push_back(i);
  }
}

// K of the rows in part_rows_
template <int D>
void ExactSolver<D>::assemble() {
  const int n = int(part_rows_.size());
  K_.resize(n, n), part_b_.resize(n), part_f_.setZero(n);
  for (int i = 0; i < n; ++i) {
    const Row<D>& r = rows_[part_rows_[i]];
    part_b_[i] = b_[part_rows_[i]];
    const RowResponse<D> response = response_.of(r, stances_);
    for (int j = 0; j <= i; ++j) {
      double k = coupling(r, response, rows_[part_rows_[j]]);
      k += chain_response_.coupling(part_rows_[i], part_rows_[j]);
      K_(i, j) = k, K_(j, i) = k;
    }
  }
}

// f_ and modes_ of all rows under b_, exactly; false where a part has none. Or roughly
template <int D>
bool ExactSolver<D>::solve() {
  if (rough_) {
    sweep(kRoughIterations);
    return true;
  }
  bool found = true;
  each_part(modes_, [&](std::vector<ConeMode<D>>& modes) {
    const double rows = double(part_rows_.size()), size = rows * rows * rows;
    const int patience = cone_.patience;
    if (cone_.thorough && model_.collision != Collision::event)
      cone_.patience = int(std::min<double>(patience, kThoroughSize / size));
    const ConeReport report = cone_.solve(K_, part_b_, part_blocks_, modes, part_f_);
    cone_.patience = patience;
    found = report.found && found;
    work_ += report.tries * size;
  });
  return found;
}

// the same, roughly
template <int D>
void ExactSolver<D>::sweep(int sweeps) {
  each_part(modes_, [&](std::vector<ConeMode<D>>& modes) {
    cone_.sweep(K_, part_b_, part_blocks_, modes, part_f_, sweeps);
  });
}

// f_ where what holds goes on holding
template <int D>
void ExactSolver<D>::hold() {
  each_part(holding_,
            [&](std::vector<ConeMode<D>>& modes) { cone_.hold(K_, part_b_, part_blocks_, modes, part_f_); });
}

template <int D>
template <class Solve>
void ExactSolver<D>::each_part(std::vector<ConeMode<D>>& modes, Solve&& solve) {
  f_.setZero(Eigen::Index(rows_.size()));
  for (int part = 0; part < parts_; ++part) {
    part_rows_.clear(), part_blocks_.clear(), part_modes_.clear();
    const auto blocks_end = [&](int i) {
      return i + 1 < int(held_.size()) ? held_[i + 1].block : int(blocks_.size());
    };
    for (const int i : members_[part]) {
      for (int row = 0; row < held_[i].rows; ++row) part_rows_.push_back(held_[i].first + row);
      for (int block = held_[i].block; block < blocks_end(i); ++block) {
        part_blocks_.push_back(blocks_[block]);
        part_modes_.push_back(modes[block]);
      }
    }
    assemble();
    for (int i = 0; i < int(part_rows_.size()) && warm_.size() == f_.size(); ++i)
      part_f_[i] = warm_[part_rows_[i]];
    work_ += double(part_rows_.size()) * part_rows_.size() * part_rows_.size();
    solve(part_modes_);
    for (int i = 0; i < int(part_rows_.size()); ++i) f_[part_rows_[i]] = part_f_[i];
    int at = 0;
    for (const int i : members_[part]) {
      for (int block = held_[i].block; block < blocks_end(i); ++block) modes[block] = part_modes_[at++];
    }
  }
}

// f_ of least norm that gives the rows in chosen_ what b_ has for them
template <int D>
void ExactSolver<D>::least() {
  f_.setZero(Eigen::Index(rows_.size()));
  wanted_.assign(rows_.size(), 0);
  for (const int row : chosen_) wanted_[row] = 1;
  for (int part = 0; part < parts_; ++part) {
    part_rows_.clear(), part_chosen_.clear();
    for (const int i : members_[part]) {
      for (int row = held_[i].first; row < held_[i].first + held_[i].rows; ++row) {
        if (wanted_[row]) part_rows_.push_back(row);
      }
    }
    if (part_rows_.empty()) continue;
    assemble();
    for (int i = 0; i < int(part_rows_.size()); ++i) part_chosen_.push_back(i);
    cone_.least(K_, part_b_, part_chosen_, part_f_);
    for (int i = 0; i < int(part_rows_.size()); ++i) f_[part_rows_[i]] = part_f_[i];
  }
}

template void ExactSolver<2>::split();
template bool ExactSolver<2>::solve();
template void ExactSolver<2>::sweep(int);
template void ExactSolver<2>::hold();
template void ExactSolver<2>::least();
template void ExactSolver<3>::split();
template bool ExactSolver<3>::solve();
template void ExactSolver<3>::sweep(int);
template void ExactSolver<3>::hold();
template void ExactSolver<3>::least();

}  // namespace obscura::sim

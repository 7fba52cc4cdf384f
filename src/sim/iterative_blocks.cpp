// L D L' by blocks. For each k in the order of elimination, of the entries A_ik below it
//   L_ik = A_ik D_k^-1,   A_ij -= L_ik A_jk'
// and a solution by L y = x, z = D^-1 y, L' x = z.

#include "sim/iterative_blocks.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <set>

#include "sim/islands.h"

namespace obscura::sim {

namespace {

constexpr double kSlight = 1e-12;  // of a block's own size, added to its diagonal

// the inverse of a symmetric positive block of n rows, by Gauss and Jordan without pivoting
template <int M>
void invert(const std::array<double, M * M>& a, int n, double least, std::array<double, M * M>& out) {
  std::array<double, M* M> m = a;
  out = {};
  for (int i = 0; i < n; ++i) out[i * M + i] = 1, m[i * M + i] += least;
  for (int k = 0; k < n; ++k) {
    const double pivot = 1 / std::max(m[k * M + k], least);
    for (int j = 0; j < n; ++j) m[k * M + j] *= pivot, out[k * M + j] *= pivot;
    for (int i = 0; i < n; ++i) {
      if (i == k) continue;
      const double by = m[i * M + k];
      for (int j = 0; j < n; ++j) m[i * M + j] -= by * m[k * M + j], out[i * M + j] -= by * out[k * M + j];
    }
  }
}

}  // namespace

template <int M>
void Blocks<M>::plan(const std::vector<int>& sizes, const std::vector<std::pair<int, int>>& pairs) {
  const int n = int(sizes.size());
  sizes_ = sizes;
  first_.resize(n), rows_ = 0;
  for (int i = 0; i < n; ++i) first_[i] = rows_, rows_ += sizes[i];
  diagonal_.assign(n, {}), inverse_.assign(n, {}), entries_.assign(pairs.size(), {});

  // parts, each told by its lowest block
  Islands parts;
  parts.reset(n);
  std::vector<std::set<int>> near(n);
  for (const auto& [i, j] : pairs) {
    near[i].insert(j), near[j].insert(i);
    parts.join(i, j);
  }
  std::vector<std::vector<int>> members(n);
  for (int i = 0; i < n; ++i) members[parts.root(i)].push_back(i);

  // whoever has the fewest neighbours left goes first, then by number
  part_.assign(n, 0), parts_.assign(1, 0), order_.clear();
  std::vector<int> place(n, -1);
  std::vector<std::vector<int>> left(n);
  for (int r = 0; r < n; ++r) {
    if (members[r].empty()) continue;
    std::set<std::pair<int, int>> queue;
    for (const int i : members[r]) queue.emplace(int(near[i].size()), i), part_[i] = int(parts_.size()) - 1;
    while (!queue.empty()) {
      const int k = queue.begin()->second;
      queue.erase(queue.begin());
      place[k] = int(order_.size()), order_.push_back(k);
      left[k].assign(near[k].begin(), near[k].end());
      for (const int i : left[k]) queue.erase({int(near[i].size()), i});
      for (const int i : left[k]) {
        near[i].erase(k);
        for (const int j : left[k]) {
          if (i != j) near[i].insert(j);
        }
      }
      for (const int i : left[k]) queue.emplace(int(near[i].size()), i);
    }
    parts_.push_back(int(order_.size()));
  }

  // entries below each, in the order of elimination
  begin_.assign(1, 0), below_.clear(), sources_.clear(), updates_.clear();
  for (const int k : order_) {
    std::sort(left[k].begin(), left[k].end(), [&](int i, int j) { return place[i] < place[j]; });
    for (const int i : left[k]) below_.push_back({i, {}});
    begin_.push_back(int(below_.size()));
  }
  const auto slot = [&](int row, int column) {
    const int p = place[column];
    int e = begin_[p];
    while (below_[e].block != row) ++e;
    assert(e < begin_[p + 1]);
    return e;
  };
  for (int e = 0; e < int(pairs.size()); ++e) {
    const auto [i, j] = pairs[e];
    // an entry has i's rows; below stands who goes later
    const bool turned = place[i] < place[j];
    sources_.push_back({e, turned ? slot(j, i) : slot(i, j), turned});
  }
  for (int p = 0; p < n; ++p) {
    for (int e = begin_[p]; e < begin_[p + 1]; ++e) {
      for (int f = begin_[p]; f <= e; ++f)
        updates_.push_back(f == e ? -1 - below_[e].block : slot(below_[e].block, below_[f].block));
    }
  }
}

template <int M>
void Blocks<M>::factorise() {
  for (Below& below : below_) below.l = {};
  for (const Source& source : sources_) {
    const Block& from = entries_[source.pair];
    Block& to = below_[source.below].l;
    for (int i = 0; i < M; ++i) {
      for (int j = 0; j < M; ++j) to[i * M + j] = source.turned ? from[j * M + i] : from[i * M + j];
    }
  }
  std::size_t update = 0;
  std::vector<Block>& d = inverse_;  // the diagonal first, then its inverse
  std::copy(diagonal_.begin(), diagonal_.end(), d.begin());
  for (int p = 0; p < int(order_.size()); ++p) {
    const int k = order_[p], n = sizes_[k];
    double own = 0;
    for (int i = 0; i < n; ++i) own = std::max(own, diagonal_[k][i * M + i]);
    const Block pivot = d[k];
    invert<M>(pivot, n, kSlight * own, d[k]);
    for (int e = begin_[p]; e < begin_[p + 1]; ++e) {
      const int rows = sizes_[below_[e].block];
      const Block a = below_[e].l;
      Block l{};
      for (int i = 0; i < rows; ++i) {
        for (int j = 0; j < n; ++j) {
          double sum = 0;
          for (int m = 0; m < n; ++m) sum += a[i * M + m] * d[k][m * M + j];
          l[i * M + j] = sum;
        }
      }
      // those before it have become L already: L_e A_f' = A_e L_f'
      for (int f = begin_[p]; f <= e; ++f, ++update) {
        const Block& other = f == e ? l : below_[f].l;
        const int columns = sizes_[below_[f].block], to = updates_[update];
        Block& target = to < 0 ? d[-1 - to] : below_[to].l;
        for (int i = 0; i < rows; ++i) {
          for (int j = 0; j < columns; ++j) {
            double sum = 0;
            for (int m = 0; m < n; ++m) sum += a[i * M + m] * other[j * M + m];
            target[i * M + j] -= sum;
          }
        }
      }
      below_[e].l = l;
    }
  }
}

template <int M>
void Blocks<M>::solve(double* x) const {
  for (int part = 0; part + 1 < int(parts_.size()); ++part) solve(x, part);
}

template <int M>
void Blocks<M>::solve(double* x, int part) const {
  for (int p = parts_[part]; p < parts_[part + 1]; ++p) {
    const int k = order_[p], n = sizes_[k];
    const double* from = x + first_[k];
    for (int e = begin_[p]; e < begin_[p + 1]; ++e) {
      const Below& below = below_[e];
      double* to = x + first_[below.block];
      for (int i = 0; i < sizes_[below.block]; ++i) {
        for (int j = 0; j < n; ++j) to[i] -= below.l[i * M + j] * from[j];
      }
    }
  }
  for (int p = parts_[part + 1]; p-- > parts_[part];) {
    const int k = order_[p], n = sizes_[k];
    double* to = x + first_[k];
    double z[M] = {};
    for (int i = 0; i < n; ++i) {
      for (int j = 0; j < n; ++j) z[i] += inverse_[k][i * M + j] * to[j];
    }
    for (int e = begin_[p]; e < begin_[p + 1]; ++e) {
      const Below& below = below_[e];
      const double* from = x + first_[below.block];
      for (int i = 0; i < sizes_[below.block]; ++i) {
        for (int j = 0; j < n; ++j) z[j] -= below.l[i * M + j] * from[i];
      }
    }
    for (int i = 0; i < n; ++i) to[i] = z[i];
  }
}

template class Blocks<3>;
template class Blocks<6>;

}  // namespace obscura::sim

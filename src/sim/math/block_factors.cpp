// L D L' by blocks. For each k in the order of elimination, for the entries A_ik below it
//   L_ik = A_ik D_k^-1,   A_ij -= L_ik A_jk'
// and a solution by L y = x, z = D^-1 y, L' x = z. If rows are redundant, A has no inverse: then repeat, with
// S = (A + e)^-1,
//   x := x + S A S (b - A x)
// which converges for the part of b in the range of A, and adds nothing along its null space.

#include "sim/math/block_factors.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>
#include <set>

#include "sim/math/islands.h"

namespace obscura::sim {

namespace {

// of a row's own entry on the diagonal: rows of lengths and of angles have other units
constexpr double kSlight = 1e-12;  // added to it
constexpr double kImplied = 1e-9;  // pivots as small are of rows that others imply
constexpr double kStiff = 1e-7;    // added where there are such
constexpr int kRefinements = 4;    // there

// The inverse of a symmetric positive block of n rows, by Gauss and Jordan without pivoting; `part` of each
// row's own size is added to its diagonal. Returns the least pivot as against that size.
template <int M>
double invert(const std::array<double, M * M>& a, int n, const double* own, double part,
              std::array<double, M * M>& out) {
  std::array<double, M* M> m = a;
  out = {};
  double smallest = std::numeric_limits<double>::infinity();
  for (int i = 0; i < n; ++i) out[i * M + i] = 1, m[i * M + i] += part * own[i];
  for (int k = 0; k < n; ++k) {
    const double pivot = 1 / std::max(m[k * M + k], part * own[k]);
    smallest = std::min(smallest, m[k * M + k] / own[k]);
    for (int j = 0; j < n; ++j) m[k * M + j] *= pivot, out[k * M + j] *= pivot;
    for (int i = 0; i < n; ++i) {
      if (i == k) continue;
      const double by = m[i * M + k];
      for (int j = 0; j < n; ++j) m[i * M + j] -= by * m[k * M + j], out[i * M + j] -= by * out[k * M + j];
    }
  }
  return smallest;
}

}  // namespace

template <int M>
void Blocks<M>::plan(const std::vector<int>& sizes, const std::vector<std::pair<int, int>>& pairs) {
  const int n = int(sizes.size());
  sizes_ = sizes, pairs_ = pairs;
  first_.resize(n), rows_ = 0;
  for (int i = 0; i < n; ++i) first_[i] = rows_, rows_ += sizes[i];
  diagonal_.assign(n, {}), inverse_.assign(n, {}), entries_.assign(pairs.size(), {});
  implied_.assign(n, 0);

  // components, each told by its lowest block
  Islands components;
  components.reset(n);
  std::vector<std::set<int>> near(n);
  for (const auto& [i, j] : pairs) {
    near[i].insert(j), near[j].insert(i);
    components.join(i, j);
  }
  std::vector<std::vector<int>> members(n);
  for (int i = 0; i < n; ++i) members[components.root(i)].push_back(i);

  // eliminate the block with the fewest remaining neighbours first, then by number
  component_.assign(n, 0), components_.assign(1, 0), order_.clear();
  std::vector<int> place(n, -1);
  std::vector<std::vector<int>> left(n);
  for (int r = 0; r < n; ++r) {
    if (members[r].empty()) continue;
    std::set<std::pair<int, int>> queue;
    for (const int i : members[r])
      queue.emplace(int(near[i].size()), i), component_[i] = int(components_.size()) - 1;
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
    components_.push_back(int(order_.size()));
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
    // an entry has i's rows; the block eliminated later stands below
    const bool turned = place[i] < place[j];
    sources_.push_back({e, turned ? slot(j, i) : slot(i, j), turned});
  }
  const auto component_of = [&](const Source& source) { return component_[pairs[source.pair].first]; };
  std::stable_sort(sources_.begin(), sources_.end(),
                   [&](const Source& a, const Source& b) { return component_of(a) < component_of(b); });
  first_source_.clear(), first_update_.clear();
  int source = 0;
  for (int k = 0; k <= this->components(); ++k) {
    while (source < int(sources_.size()) && component_of(sources_[source]) < k) ++source;
    first_source_.push_back(source);
  }
  for (int p = 0; p < n; ++p) {
    if (p == components_[first_update_.size()]) first_update_.push_back(int(updates_.size()));
    for (int e = begin_[p]; e < begin_[p + 1]; ++e) {
      for (int f = begin_[p]; f <= e; ++f)
        updates_.push_back(f == e ? -1 - below_[e].block : slot(below_[e].block, below_[f].block));
    }
  }
}

template <int M>
void Blocks<M>::factorise(int component) {
  implied_[component] = 0;
  if (eliminate(component)) eliminate(component);
}

// L and D; true where rows turned out to be implied by others
template <int M>
bool Blocks<M>::eliminate(int component) {
  bool found = false;
  const int first = components_[component], last = components_[component + 1];
  for (int e = begin_[first]; e < begin_[last]; ++e) below_[e].l = {};
  for (int s = first_source_[component]; s < first_source_[component + 1]; ++s) {
    const Source& source = sources_[s];
    const Block& from = entries_[source.pair];
    Block& to = below_[source.below].l;
    for (int i = 0; i < M; ++i) {
      for (int j = 0; j < M; ++j) to[i * M + j] = source.turned ? from[j * M + i] : from[i * M + j];
    }
  }
  auto update = std::size_t(first_update_[component]);
  std::vector<Block>& d = inverse_;  // the diagonal first, then its inverse
  for (int p = first; p < last; ++p) d[order_[p]] = diagonal_[order_[p]];
  for (int p = first; p < last; ++p) {
    const int k = order_[p], n = sizes_[k];
    double own[M], most = 0;
    for (int i = 0; i < n; ++i) own[i] = diagonal_[k][i * M + i], most = std::max(most, own[i]);
    // what moves nothing has the size of the others
    for (int i = 0; i < n; ++i)
      if (!(own[i] > 0)) own[i] = most;
    const Block pivot = d[k];
    char& implied = implied_[component];
    const double least = invert<M>(pivot, n, own, implied ? kStiff : kSlight, d[k]);
    if (!implied && least < kImplied) implied = 1, found = true;
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
  return found;
}

template <int M>
void Blocks<M>::solve(double* x) const {
  for (int component = 0; component + 1 < int(components_.size()); ++component) solve(x, component);
}

template <int M>
void Blocks<M>::solve(double* x, int component) const {
  if (!implied_[component]) return substitute(x, component);
  const auto each = [&](auto&& act) {
    for (int p = components_[component]; p < components_[component + 1]; ++p) {
      for (int r = first_[order_[p]]; r < first_[order_[p]] + sizes_[order_[p]]; ++r) act(r);
    }
  };
  right_.resize(rows_), rest_.resize(rows_), way_.resize(rows_);
  each([&](int r) { right_[r] = x[r], x[r] = 0; });
  for (int round = 0; round < kRefinements; ++round) {
    each([&](int r) { rest_[r] = right_[r], way_[r] = 0; });
    take_product(x, rest_.data(), component);
    substitute(rest_.data(), component);
    take_product(rest_.data(), way_.data(), component);
    substitute(way_.data(), component);
    each([&](int r) { x[r] -= way_[r]; });
  }
}

// y := y - A x
template <int M>
void Blocks<M>::take_product(const double* x, double* y, int component) const {
  const auto take = [&](const Block& a, int i, int j, bool turned) {
    for (int r = 0; r < sizes_[i]; ++r) {
      for (int c = 0; c < sizes_[j]; ++c)
        y[first_[i] + r] -= (turned ? a[c * M + r] : a[r * M + c]) * x[first_[j] + c];
    }
  };
  for (int p = components_[component]; p < components_[component + 1]; ++p)
    take(diagonal_[order_[p]], order_[p], order_[p], false);
  for (std::size_t e = 0; e < pairs_.size(); ++e) {
    const auto [i, j] = pairs_[e];
    if (component_[i] == component) take(entries_[e], i, j, false), take(entries_[e], j, i, true);
  }
}

// by L and D alone
template <int M>
void Blocks<M>::substitute(double* x, int component) const {
  for (int p = components_[component]; p < components_[component + 1]; ++p) {
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
  for (int p = components_[component + 1]; p-- > components_[component];) {
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

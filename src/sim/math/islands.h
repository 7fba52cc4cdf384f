#pragma once

#include <algorithm>
#include <numeric>
#include <span>
#include <vector>

namespace obscura::sim {

/// Disjoint sets of the numbers 0 .. n-1: those joined directly or through others. The name of a set is its
/// lowest member, whatever the order of joining, so that results do not depend on it. Path halving after
/// Tarjan and van Leeuwen (1984).
class Islands {
 public:
  /// n sets of one member each; keeps its memory.
  void reset(int n) {
    parent_.resize(n);
    std::iota(parent_.begin(), parent_.end(), 0);
  }

  /// Makes sets of one member each of `members`, which must not have been joined to others; n as before.
  void reset(std::span<const int> members) {
    for (const int i : members) parent_[i] = i;
  }

  /// The lowest member of i's set.
  int root(int i) {
    while (parent_[i] != i) i = parent_[i] = parent_[parent_[i]];
    return i;
  }

  /// Makes one set of the two that a and b are in.
  void join(int a, int b) {
    a = root(a), b = root(b);
    parent_[std::max(a, b)] = std::min(a, b);
  }

 private:
  std::vector<int> parent_;
};

}  // namespace obscura::sim

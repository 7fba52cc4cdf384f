#pragma once

#include <algorithm>
#include <cstddef>
#include <vector>

namespace obscura::sim {

/// Levels of pairs that are solved in a given order: one more than that of the last pair before that shares a
/// body which moves. Pairs of one level share none, so level by level comes to what the given order does.
class PairLevels {
 public:
  /// Begins anew with `bodies` bodies. Keeps its memory.
  void begin(std::size_t bodies) { next_.assign(bodies, 0), count_ = 0; }

  /// The level of the next pair, of two bodies that move or do not.
  int next(int a, bool a_moves, int b, bool b_moves) {
    int &of_a = next_[std::size_t(a)], &of_b = next_[std::size_t(b)];
    const int level = std::max(of_a, of_b);
    if (a_moves) of_a = level + 1;
    if (b_moves) of_b = level + 1;
    count_ = std::max(count_, level + 1);
    return level;
  }

  /// How many levels there are.
  int count() const { return count_; }

 private:
  std::vector<int> next_;  // of each body: the level of its next pair
  int count_ = 0;
};

}  // namespace obscura::sim

#pragma once

#include <utility>
#include <vector>

#include "sim/model/model.h"

namespace obscura::sim {

/// Which bodies may touch. Two do not where both are fixed or both are points, where one keeps the handout's
/// law, where their groups ignore each other, and where a joint, be it broken or whole, does not let them.
template <int D>
class MayTouch {
 public:
  explicit MayTouch(const Model<D>& model);

  bool operator()(int a, int b) const {
    if (!but_for_joints(a, b)) return false;
    if (!jointed_[a] || !jointed_[b]) return true;
    return !joined(a, b);
  }

  /// The same without joints: for bodies of equal kinds, fixedness and groups the answers are equal.
  bool but_for_joints(int a, int b) const {
    if ((kind_[a] & kind_[b]) != 0 || ((kind_[a] | kind_[b]) & kHandout) != 0) return false;
    return !ignored_[group_[a] * groups_ + group_[b]];
  }

 private:
  static constexpr char kFixed = 1, kPoint = 2, kHandout = 4;

  bool joined(int a, int b) const;

  std::vector<char> kind_;                 // one a body: the bits above
  std::vector<int> group_;                 // one a body, numbered from 0 as they come
  std::vector<char> ignored_;              // one a couple of groups
  std::vector<std::pair<int, int>> held_;  // bodies on joints, a < b, sorted
  std::vector<char> jointed_;              // one a body: whether it is in held_
  std::size_t groups_ = 0;
};

}  // namespace obscura::sim

#pragma once

#include <utility>
#include <vector>

#include "sim/model/model.h"

namespace obscura::sim {

/// Collision filter. Two bodies do not touch if both are fixed, both are points, one follows the handout's
/// law, their groups ignore each other, or a joint between them forbids it, unless an event is yet to make
/// it. One that has broken forbids it until they are apart: ContactStep then lets its bodies touch.
template <int D>
class MayTouch {
 public:
  explicit MayTouch(const Model<D>& model);

  bool operator()(int a, int b) const {
    if (!but_for_joints(a, b)) return false;
    if (!jointed_[a] || !jointed_[b]) return true;
    return !joined(a, b);
  }

  /// The same without joints. Depends on kind, fixed flag and group alone.
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

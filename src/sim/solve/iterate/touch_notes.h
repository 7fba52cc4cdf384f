#pragma once

#include <algorithm>
#include <tuple>
#include <utility>
#include <vector>

#include "sim/model/course.h"
#include "sim/model/state.h"

namespace obscura::sim {

/// Notes which watched bodies touch within a step of several substeps, for the conditions of events: for each
/// pair one span, from the beginning of the first substep in which it bears or is struck to the end of the
/// last. In between a contact may bear in one substep and not in the next, without a meaning.
template <int D>
class TouchNotes {
 public:
  void watch(Course<D>* course) { course_ = course; }
  /// Whether anything is watched.
  bool any() const { return course_ != nullptr; }
  /// Whether a contact of `a` with `b` is to be noted; b < 0: a wall.
  bool watches(int a, int b) const { return course_ && (course_->watches(a) || course_->watches(b)); }

  /// Begins a step. What touches now touches from its beginning on.
  void begin(const State<D>& state) {
    held_.clear(), found_.clear();
    if (!course_) return;
    for (const Contact<D>& it : state.contacts)
      if (it.touching != ContactMode::open && watches(it.key.a, it.key.b))
        held_.emplace_back(it.key.a, it.key.b);
    std::sort(held_.begin(), held_.end());
  }
  /// The two touch in a substep from `begun` to `ended`, s from the beginning of the step.
  void note(int a, int b, double begun, double ended) {
    if (watches(a, b)) found_.push_back({a, b, begun, ended});
  }
  /// Ends a step.
  void end() {
    if (!course_) return;
    std::sort(found_.begin(), found_.end(), [](const Meeting& p, const Meeting& q) {
      return std::tuple(p.a, p.b, p.begun) < std::tuple(q.a, q.b, q.begun);
    });
    for (std::size_t i = 0, j = 0; i < found_.size(); i = j) {
      Meeting whole = found_[i];
      for (; j < found_.size() && found_[j].a == whole.a && found_[j].b == whole.b; ++j)
        whole.ended = std::max(whole.ended, found_[j].ended);
      if (std::binary_search(held_.begin(), held_.end(), std::pair(whole.a, whole.b))) whole.begun = 0;
      course_->meetings.push_back(whole);
    }
  }

 private:
  using Meeting = typename Course<D>::Meeting;

  Course<D>* course_ = nullptr;
  std::vector<std::pair<int, int>> held_;
  std::vector<Meeting> found_;  // a substep each
};

}  // namespace obscura::sim
